//! Flies one encounter of a campaign under every policy.

use fga::Vec3;
use fga::avoider::SettingsError;
use fga::situation::ProtectedVolume;
use fga_formats::daa::Recording;
use fga_formats::encounters::Encounter;
use fga_judge::separation::{Separation, least_at};
use fga_sim::engine::Engine;
use fga_sim::policy::{PolicyChoice, PolicyPilot};
use fga_sim::world::World;

use super::judge::{FlownPath, WorldJudge};
use super::metrics::{Metrics, kept};
use super::opened::{CampaignScene, Drawn};
use super::{Campaign, CampaignError, Row};
use crate::batch::{self, BatchRow, BatchSettings};
use crate::oracle::{
    OracleObstacle, OracleSettings, OracleStart, OracleVehicle, airspace_of, best_margin_of_tracks,
    best_margin_within,
};
use crate::recorded::plan_of;

/// A row with the durations of its decisions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimedRow {
    /// The row.
    pub row: Row,
    /// Median time of a decision, nanoseconds.
    pub decision_median_ns: u64,
    /// Longest time of a decision, nanoseconds.
    pub decision_max_ns: u64,
    /// Number of decisions.
    pub decisions: u64,
    /// Duration of the whole flight, nanoseconds.
    pub flight_ns: u64,
}

/// The tools of a thread that flies encounters.
pub struct CampaignFlyer<'a> {
    campaign: &'a Campaign,
    engine: Engine,
    world: World,
    policies: Vec<(BatchSettings, Box<dyn PolicyPilot + Send>)>,
    line_velocity_mps: Vec3,
    oracle: Option<(OracleVehicle, OracleStart, OracleSettings)>,
    judge: WorldJudge,
    flown: FlownPath,
}

impl<'a> CampaignFlyer<'a> {
    /// For this campaign.
    ///
    /// # Errors
    /// A wind that is too strong for the line, or settings that the core refuses.
    pub fn new(campaign: &'a Campaign) -> Result<Self, CampaignError> {
        let world = campaign.world()?;
        Ok(Self {
            line_velocity_mps: campaign.line_velocity_mps(&world),
            oracle: campaign
                .configuration
                .oracle
                .then(|| campaign.oracle(&world)),
            policies: campaign
                .policies
                .iter()
                .map(|policy| {
                    let pilot = policy.pilot(&world.settings, &world.vehicle)?;
                    Ok((campaign.settings(policy.clone()), pilot))
                })
                .collect::<Result<_, SettingsError>>()?,
            engine: Engine::new(),
            world,
            campaign,
            judge: WorldJudge::new(),
            flown: FlownPath::default(),
        })
    }

    /// Draws the encounter with this number and flies it under every policy.
    ///
    /// # Errors
    /// A number past the last, or a recording that is gone.
    pub fn fly(&mut self, number: u64, take: &mut Vec<TimedRow>) -> Result<(), CampaignError> {
        self.fly_while(number, take, &|| true)
    }

    /// The same; `go_on` ends a draw that takes long.
    pub(super) fn fly_while(
        &mut self,
        number: u64,
        take: &mut Vec<TimedRow>,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<(), CampaignError> {
        let drawn = self.campaign.draw_while(number, go_on)?;
        match &drawn.scene {
            CampaignScene::Rows(encounter) => {
                self.fly_rows(number, &drawn, encounter, take);
                Ok(())
            }
            CampaignScene::Tracks(recording) => self.fly_tracks(number, &drawn, recording, take),
        }
    }

    /// Flies aircraft with tracks; each policy gets a pilot for the recorded airspeed.
    fn fly_tracks(
        &mut self,
        number: u64,
        drawn: &Drawn,
        recording: &Recording,
        take: &mut Vec<TimedRow>,
    ) -> Result<(), CampaignError> {
        let campaign = self.campaign;
        let mut world = plan_of(recording, "", &campaign.model)
            .map_err(CampaignError::Other)?
            .world;
        world.seed = drawn.seed;
        world.stream = drawn.stream;
        let oracle_margin_m = self
            .oracle
            .as_ref()
            .and_then(|(_, _, settings)| best_margin_of_tracks(&world, settings))
            .map(|answer| kept(answer.best_margin_m));
        let nominal = self.judge.nominal(&world);
        let mut mission = PolicyChoice::Mission.pilot(&world.settings, &world.vehicle)?;
        self.engine.fly(&world, mission.as_mut(), &mut ());
        let held: Vec<f64> = self
            .engine
            .separations()
            .iter()
            .map(|separation| kept(separation.margin().value_m))
            .collect();
        let recorded = world;
        for (index, policy) in (0..).zip(&campaign.policies) {
            let reacted = campaign.reacted(&recorded, recording, policy)?;
            let world = reacted.as_ref().map_or(&recorded, |reacted| &reacted.world);
            let seen = policy.sees(world);
            let world = seen.as_ref().unwrap_or(world);
            let begun = std::time::Instant::now();
            let mut pilot = policy.pilot(&world.settings, &world.vehicle)?;
            self.flown.clear();
            let outcome = self.engine.fly(world, pilot.as_mut(), &mut self.flown);
            let flown = batch::timed(number, outcome, self.engine.elapsed_ns());
            let flight_ns = u64::try_from(begun.elapsed().as_nanos()).unwrap_or(u64::MAX);
            let mut metrics = nominal;
            let is_other = world.obstacles != recorded.obstacles;
            (self.judge).flown((world, is_other), &self.flown, &mut metrics);
            let failure = reacted.as_ref().and_then(|reacted| reacted.failure);
            metrics.policy_failure = pilot.failure().or(failure);
            metrics.work = outcome.work();
            let made = Made {
                number,
                drawn,
                policy: index,
                oracle_margin_m,
                metrics: metrics.rounded(),
                flight_ns,
            };
            take.push(made.flown(&flown, &held, self.engine.separations()));
        }
        Ok(())
    }

    /// Flies obstacles around the line.
    fn fly_rows(
        &mut self,
        number: u64,
        drawn: &Drawn,
        encounter: &Encounter,
        take: &mut Vec<TimedRow>,
    ) {
        self.world.seed = drawn.seed;
        drawn.scenery.place(&mut self.world);
        batch::populate(&mut self.world, encounter, &self.campaign.model.protection);
        let held: Vec<f64> = encounter
            .obstacles
            .iter()
            .zip(&self.world.obstacles)
            .map(|(obstacle, real)| {
                let relative_mps = obstacle.velocity_mps - self.line_velocity_mps;
                let horizon_s = self.campaign.configuration.horizon_s;
                kept(least_margin(
                    -obstacle.position_m,
                    -relative_mps,
                    horizon_s,
                    &real.volume,
                ))
            })
            .collect();
        let oracle_margin_m = self.oracle.as_ref().map(|(vehicle, start, settings)| {
            let obstacles: Vec<OracleObstacle> = encounter
                .obstacles
                .iter()
                .zip(&self.world.obstacles)
                .map(|(obstacle, real)| {
                    OracleObstacle {
                        position_m: obstacle.position_m,
                        velocity_mps: obstacle.velocity_mps,
                        volume: real.volume,
                    }
                    .in_wind(self.campaign.model.blows_mps())
                })
                .collect();
            let airspace = airspace_of(&self.world);
            let answer = best_margin_within(start, vehicle, &obstacles, airspace, settings);
            kept(answer.best_margin_m)
        });
        for (policy, (settings, pilot)) in (0..).zip(&mut self.policies) {
            let begun = std::time::Instant::now();
            let flown = batch::fly_one(
                &mut self.engine,
                &mut self.world,
                pilot.as_mut(),
                encounter,
                settings,
            );
            let flight_ns = u64::try_from(begun.elapsed().as_nanos()).unwrap_or(u64::MAX);
            let made = Made {
                number,
                drawn,
                policy,
                oracle_margin_m,
                metrics: Metrics {
                    work: flown.outcome.work(),
                    policy_failure: flown.failure,
                    min_terrain_clearance_m: flown.outcome.min_terrain_clearance_m,
                    min_zone_margin_m: flown.outcome.min_zone_margin_m,
                    ..Metrics::default()
                }
                .rounded(),
                flight_ns,
            };
            take.push(made.flown(&flown, &held, self.engine.separations()));
        }
    }
}

/// The input of a row, besides the flight.
struct Made<'a> {
    number: u64,
    drawn: &'a Drawn,
    policy: u32,
    oracle_margin_m: Option<f64>,
    metrics: Metrics,
    flight_ns: u64,
}

impl Made<'_> {
    /// The row of a flight; `held` has the margins of holding the course, obstacle by obstacle.
    fn flown(&self, flown: &BatchRow, held: &[f64], separations: &[Separation]) -> TimedRow {
        let outcome = &flown.outcome;
        let caused = separations
            .iter()
            .zip(held)
            .any(|(separation, held)| kept(separation.margin().value_m) < 0.0 && *held >= 0.0);
        TimedRow {
            row: Row {
                encounter: self.number,
                source_encounter: self.drawn.source_encounter,
                seed: self.drawn.seed,
                source: self.drawn.source,
                policy: self.policy,
                obstacles: u32::try_from(held.len()).unwrap_or(u32::MAX),
                held_margin_m: held.iter().copied().fold(f64::INFINITY, f64::min),
                separated: flown.separated(),
                caused,
                min_separation_m: kept(outcome.min_separation_m),
                min_margin_m: kept(outcome.min_margin_m),
                start_s: outcome.start_s.map(kept),
                clear_s: outcome.clear_s.map(kept),
                rejoined_s: outcome.rejoined_s.map(kept),
                end_s: kept(outcome.end_s),
                max_cross_track_m: kept(outcome.max_cross_track_m),
                extra_path_m: kept(outcome.extra_path_m),
                oracle_margin_m: self.oracle_margin_m,
                name: self.drawn.name,
                weight: self.drawn.weight,
                metrics: self.metrics,
            },
            decision_median_ns: flown.decision_median_ns,
            decision_max_ns: flown.decision_max_ns,
            decisions: flown.decisions as u64,
            flight_ns: self.flight_ns,
        }
    }
}

/// Least signed distance to `volume` of a point that moves straight for `horizon_s` seconds.
fn least_margin(
    offset_m: Vec3,
    velocity_mps: Vec3,
    horizon_s: f64,
    volume: &ProtectedVolume,
) -> f64 {
    let speed_squared = velocity_mps.length_squared();
    let margin_at = |time_s: f64| volume.margin_m(offset_m + velocity_mps * time_s);
    if speed_squared <= 0.0 {
        return margin_at(0.0);
    }
    match volume {
        ProtectedVolume::Sphere { .. } => {
            margin_at((-offset_m.dot(velocity_mps) / speed_squared).clamp(0.0, horizon_s))
        }
        ProtectedVolume::Cylinder { .. } => {
            // The signed distance to a convex body is convex along a line.
            margin_at(0.0)
                .min(margin_at(least_at(margin_at, horizon_s, 100)))
                .min(margin_at(horizon_s))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn held_margin_against_numbers_by_hand() {
        // 15 m/s past a static point 20 m beside the line, 150 m ahead, radius 30 m.
        let sphere = ProtectedVolume::Sphere { radius_m: 30.0 };
        let margin = |horizon_s, volume| {
            least_margin(
                Vec3::new(-150.0, -20.0, 0.0),
                Vec3::X * 15.0,
                horizon_s,
                &volume,
            )
        };
        assert!((margin(60.0, sphere) + 10.0).abs() < 1e-12);
        // Only 5 s: 75 m short of it, √(75² + 20²) − 30.
        assert!((margin(5.0, sphere) - 47.620_873_48).abs() < 1e-8);
        let cylinder = ProtectedVolume::Cylinder {
            radius_m: 30.0,
            half_height_m: 5.0,
        };
        // The nearest way out of the cylinder is up or down, 5 m.
        assert!((margin(60.0, cylinder) + 5.0).abs() < 1e-6);
    }
}
