//! One flight with everything logged, for `fga run`.

mod conflict;
mod decision;
mod futures;

pub use crate::plan::Plan;
pub use conflict::RunConflict;
pub use decision::DecisionLog;
pub use futures::{AircraftFutures, FutureWay};

use std::path::{Path, PathBuf};

use fga::avoider::{Decision, SettingsError, State};
use fga::situation::{Obstacle, ProtectedVolume};
use fga_files::TomlText;
use fga_files::from_mission::{over, scenario_text};
use fga_formats::error::{read_bytes, text_of};
use fga_formats::words::{LEAST_CHANCE, proof_key};
use fga_formats::{InputError, gzip, missions};
use fga_judge::ground::GroundSeparation;

use crate::engine::{DecisionMoment, Engine, Observer, Outcome, Sample};
use crate::own::FailureKind;
use crate::policy::PolicyChoice;
use crate::progress::{MissedWaypoint, mission_line_m};
use crate::separation::Least;
use crate::vehicle_file::VehicleModel;
use crate::whole::nearest;
use crate::{recording, scenario};

/// The file of a plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlanSource {
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// What of a mission is not flown, or otherwise than it is written; one sentence each.
    pub notes: Vec<String>,
}

impl Plan {
    /// Reads a scenario (`.toml`), a recording (`.daa`) or a mission (`.plan`, `.waypoints`). `vehicle` replaces the
    /// vehicle of a scenario, the light aircraft that flies recordings, and Table 4's, which flies missions.
    ///
    /// # Errors
    /// A file of no such kind, or an unusable one.
    pub fn read(path: &Path, vehicle: Option<VehicleModel>) -> Result<Self, InputError> {
        Ok(Self::read_once(path, vehicle, None, &[])?.0)
    }

    /// The same, with the name of a recording's ownship (without it the first aircraft) and the files of heights under a mission.
    ///
    /// # Errors
    /// As [`Plan::read`]; an ownship that is not in the recording, or an ownship or heights for another file.
    pub fn read_once(
        path: &Path,
        vehicle: Option<VehicleModel>,
        ownship: Option<&str>,
        terrain: &[PathBuf],
    ) -> Result<(Self, PlanSource), InputError> {
        let refused = |reason| Err(InputError::in_file(path, reason));
        let ending = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
        let ending = ending.as_ref().and_then(|ending| ending.to_str());
        if ownship.is_some() && ending.is_some_and(|ending| ending != "daa") {
            return refused("is no recording, expected a .daa recording with --ownship");
        }
        if !terrain.is_empty() && matches!(ending, Some("toml" | "daa")) {
            return refused(
                "is no mission, expected a mission with --terrain; [terrain] is the ground of a scenario",
            );
        }
        if !matches!(ending, Some("toml" | "daa")) {
            if path.is_dir() {
                return refused(
                    "is a folder, expected a .toml scenario, a .daa recording or a mission; fga batch flies folders",
                );
            }
            if !missions::is_mission_file(path) {
                return refused(
                    "is of no known kind, expected a .toml scenario, a .daa recording or a mission (.plan, .waypoints)",
                );
            }
        }
        let bytes = read_bytes(path)?;
        let text = text_of(&gzip::unpacked(&bytes, path)?);
        let mut notes = Vec::new();
        let plan = match ending {
            Some("toml") => scenario::parse(TomlText::new(path, &text), vehicle)?,
            Some("daa") => {
                let model = vehicle.map_or_else(VehicleModel::recorded, Ok)?;
                recording::parse(&text, path, model, ownship)?
            }
            _ => {
                let model = vehicle.map_or_else(VehicleModel::built_in, Ok)?;
                let mission = missions::parse(&text, path)?;
                let mission = over(mission, path, terrain, &model.vehicle)?;
                let text = scenario_text(&mission, path, model.vehicle.airspeed_mps, terrain)?;
                notes = mission.notes;
                let plan = scenario::parse(TomlText::new(path, &text), Some(model));
                // Lines of the text that was made are no lines of the file.
                plan.map_err(|error| InputError {
                    line: None,
                    ..error
                })?
            }
        };
        Ok((plan, PlanSource { bytes, notes }))
    }
}

/// Futures are logged this far apart, seconds: as often as there is a choice without a report.
const FUTURES_EVERY_S: f64 = 1.0;

/// Accuracy of an altitude at a limit, metres.
const LIMIT_KNOWN_M: f64 = 0.1;

/// The result for one obstacle.
#[derive(Debug, Clone, PartialEq)]
pub struct ObstacleOutcome {
    /// Its number.
    pub id: u32,
    /// Its name.
    pub name: String,
    /// Its protected volume.
    pub volume: ProtectedVolume,
    /// Least distance to its centre.
    pub separation: Least,
    /// Least signed distance to its volume.
    pub margin: Least,
    /// First sight, seconds.
    pub first_seen_s: Option<f64>,
}

/// The result for one zone.
#[derive(Debug, Clone, PartialEq)]
pub struct ZoneOutcome {
    /// Its name.
    pub name: String,
    /// Whether the aircraft keeps within it, not out of it.
    pub keep_in: bool,
    /// Least distance to it on the allowed side, to a millimetre and a thousandth of it; negative on the other side.
    pub margin: Least,
}

/// Everything about one flight.
#[derive(Debug, Clone, PartialEq)]
pub struct RunLog {
    /// The plan.
    pub plan: Plan,
    /// The policy's name on the command line.
    pub policy: String,
    /// The flown states, at most 0.1 s apart.
    pub samples: Vec<Sample>,
    /// Every decision.
    pub decisions: Vec<DecisionLog>,
    /// The result for each obstacle, in the order of the world's.
    pub obstacles: Vec<ObstacleOutcome>,
    /// The result for each zone, in the order of the world's.
    pub zones: Vec<ZoneOutcome>,
    /// Height above the ground, where that is known.
    pub ground: Option<GroundSeparation>,
    /// The result of the flight.
    pub outcome: Outcome,
    /// Missed waypoints.
    pub missed: Vec<MissedWaypoint>,
    /// How the policy failed.
    pub failure: Option<FailureKind>,
}

/// Durations of the decisions of a run, microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DecisionTimes {
    /// Median.
    pub median_us: f64,
    /// 99th percentile.
    pub p99_us: f64,
    /// Largest.
    pub max_us: f64,
}

struct Logger<'a> {
    samples: Vec<Sample>,
    decisions: Vec<DecisionLog>,
    surveillance_radius_m: f64,
    /// When futures were logged last, seconds.
    futures_s: f64,
    watch: &'a mut dyn FnMut(&DecisionLog),
}

impl Observer for Logger<'_> {
    fn sample(&mut self, sample: &Sample) {
        self.samples.push(*sample);
    }

    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        let decision = *moment.decision;
        let changed = self
            .decisions
            .last()
            .is_none_or(|last| differs(&last.decision, &decision));
        let log = DecisionLog {
            time_s: moment.time_s,
            ownship: moment.situation.ownship,
            decision,
            elapsed_ns: moment.elapsed_ns,
            changed,
            known: self.known(moment),
            futures: self.futures(moment),
        };
        (self.watch)(&log);
        self.decisions.push(log);
    }
}

impl Logger<'_> {
    /// The futures that a choice weighs, where the mission has a chance of a loss and none were logged for a while.
    fn futures(&mut self, moment: &DecisionMoment<'_>) -> Vec<AircraftFutures> {
        let on_mission = moment.decision.record.p_loss_hold;
        let is_weighed = on_mission.is_some_and(|chance| chance >= LEAST_CHANCE);
        let is_due = moment.time_s - self.futures_s >= FUTURES_EVERY_S - 1e-6;
        let Some(beliefs) = moment.beliefs.filter(|_| is_weighed && is_due) else {
            return Vec::new();
        };
        self.futures_s = moment.time_s;
        AircraftFutures::nearest(beliefs, moment.situation.ownship.position_m, moment.time_s)
    }

    /// The situation of a decision against a threat.
    fn known(&self, moment: &DecisionMoment<'_>) -> Vec<Obstacle> {
        if !matches!(moment.decision.state, State::Threatened | State::Avoiding) {
            return Vec::new();
        }
        let own_m = moment.situation.ownship.position_m;
        moment
            .situation
            .obstacles
            .iter()
            .filter(|known| known.position_m.distance(own_m) <= self.surveillance_radius_m)
            .collect()
    }
}

/// Whether a decision has another state, reason or threat than the previous one, or lost or won its proof.
fn differs(before: &Decision, now: &Decision) -> bool {
    let threat = |decision: &Decision| decision.record.threat.map(|threat| threat.id);
    before.state != now.state
        || before.record.reason != now.record.reason
        || threat(before) != threat(now)
        || proof_key(&before.command) != proof_key(&now.command)
}

/// Flies a plan; `watch` sees every decision.
///
/// # Errors
/// Settings or limits that the core refuses.
pub fn fly(
    mut plan: Plan,
    policy: &PolicyChoice,
    watch: &mut dyn FnMut(&DecisionLog),
) -> Result<RunLog, SettingsError> {
    if let Some(seen) = policy.sees(&plan.world) {
        plan.world = seen;
    }
    let mut pilot = policy.pilot(&plan.world.settings, &plan.world.vehicle)?;
    let mut engine = Engine::new();
    let mut logger = Logger {
        samples: Vec::new(),
        decisions: Vec::new(),
        surveillance_radius_m: plan.world.settings.avoider.surveillance_radius_m,
        futures_s: f64::NEG_INFINITY,
        watch,
    };
    let outcome = engine.fly(&plan.world, pilot.as_mut(), &mut logger);
    let obstacles = plan
        .world
        .obstacles
        .iter()
        .zip(&plan.names)
        .zip(engine.separations())
        .zip(engine.first_seen_s())
        .map(
            |(((obstacle, name), separation), first_seen_s)| ObstacleOutcome {
                id: obstacle.id,
                name: name.clone(),
                volume: obstacle.volume,
                separation: separation.distance(),
                margin: separation.margin(),
                first_seen_s: *first_seen_s,
            },
        )
        .collect();
    let zones = (plan.world.zones.iter().zip(engine.zone_margins()))
        .map(|(zone, margin)| ZoneOutcome {
            name: zone.name().to_owned(),
            keep_in: zone.keep_in(),
            margin,
        })
        .collect();
    Ok(RunLog {
        zones,
        ground: engine.ground_separation(),
        policy: policy.name(),
        samples: logger.samples,
        decisions: logger.decisions,
        obstacles,
        outcome,
        missed: engine.missed().to_vec(),
        failure: pilot.failure(),
        plan,
    })
}

impl RunLog {
    /// Whether the aircraft was on the allowed side of every zone all the time.
    pub fn zones_kept(&self) -> bool {
        self.zones.iter().all(|zone| zone.margin.value_m >= 0.0)
    }

    /// Whether the aircraft stayed above the known ground.
    pub fn ground_kept(&self) -> bool {
        let ground = self.ground.as_ref();
        ground.is_none_or(|ground| ground.least.value_m >= 0.0)
    }

    /// Whether the aircraft flew below the floor, and above the ceiling, by more than the accuracy of the samples, once it was
    /// between them.
    pub fn limits_broken(&self) -> [bool; 2] {
        let (floor_m, ceiling_m) = self.plan.world.limits_m;
        let heights_m = self.samples.iter().map(|sample| sample.position_m.z);
        let broken = |beyond_m: &dyn Fn(f64) -> f64| {
            let outside = |z_m: &f64| beyond_m(*z_m) > 0.0;
            let mut since_inside = heights_m.clone().skip_while(outside);
            since_inside.any(|z_m| beyond_m(z_m) > LIMIT_KNOWN_M)
        };
        [broken(&|z_m| floor_m - z_m), broken(&|z_m| z_m - ceiling_m)]
    }

    /// The conflicts of the flight, in time order.
    pub fn conflicts(&self) -> Vec<RunConflict> {
        conflict::of(&self.decisions, &self.plan.world)
    }

    /// Durations of the decisions.
    pub fn decision_times(&self) -> DecisionTimes {
        let mut elapsed: Vec<u64> = self.decisions.iter().map(|d| d.elapsed_ns).collect();
        elapsed.sort_unstable();
        let at = |share: f64| nearest(&elapsed, share).unwrap_or(0) as f64 / 1000.0;
        DecisionTimes {
            median_us: at(0.5),
            p99_us: at(0.99),
            max_us: at(1.0),
        }
    }

    /// The path of the mission without obstacles, metres.
    pub fn mission_line_m(&self) -> Vec<fga::Vec3> {
        mission_line_m(&self.plan.world)
    }

    /// Name of the obstacle with this number.
    pub fn name_of(&self, id: u32) -> &str {
        self.obstacles
            .iter()
            .find(|obstacle| obstacle.id == id)
            .map_or("unknown", |obstacle| obstacle.name.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga_files::TomlText;

    #[test]
    fn a_decision_is_logged_with_the_obstacles_as_it_knew_them() {
        let text = "name = 'a'\nduration_s = 30.0\n[mission]\nwaypoints_m = [[0, 0, 0], [2000, 0, 0]]\n\
                    [noise]\nposition_m = 3.0\nvelocity_mps = 0.5\n\
                    [[obstacle]]\nposition_m = [250, 0, 0]\n";
        let plan = scenario::parse(TomlText::new(Path::new("a.toml"), text), None).unwrap();
        let log = fly(plan, &PolicyChoice::default(), &mut |_| ()).unwrap();
        let mut against_threats = 0;
        for moment in &log.decisions {
            let threatens = matches!(moment.decision.state, State::Threatened | State::Avoiding);
            assert_eq!(threatens, !moment.known.is_empty(), "{} s", moment.time_s);
            for known in &moment.known {
                let error_m = known
                    .position_m
                    .distance(log.plan.world.obstacles[0].track.at(0.0).unwrap().0);
                assert!(error_m > 0.0 && error_m < 30.0, "{error_m} m");
                assert!(known.uncertainty.position_m > 0.0);
                against_threats += 1;
            }
        }
        assert!(against_threats > 10);
    }

    fn flown(scenario: &str, vehicle: Option<VehicleModel>) -> RunLog {
        let text = TomlText::new(Path::new("a.toml"), scenario);
        let plan = scenario::parse(text, vehicle).unwrap();
        fly(plan, &PolicyChoice::default(), &mut |_| ()).unwrap()
    }

    /// An earlier version flew 8.8 km away: no way back closed in the wind.
    #[test]
    fn d1_in_a_crosswind_near_the_airspeed_it_returns() {
        let log = flown(
            "name = 'a'\nduration_s = 1500.0\n[mission]\nwaypoints_m = [[0, 0, 100], [2000, 0, 100]]\n\
             [wind]\nnorth_mps = 14.0\n[[obstacle]]\nposition_m = [2000, 0, 100]\n\
             velocity_mps = [-15, 0, 0]\nradius_m = 150.0\n",
            None,
        );
        assert!(log.outcome.mission_flown, "{:?}", log.outcome);
        assert!(log.outcome.max_cross_track_m < 300.0, "{:?}", log.outcome);
    }

    /// An earlier version flew in circles: each way back led behind the mast.
    #[test]
    fn d5_past_a_mast_in_a_strong_headwind_it_goes_on() {
        let vehicle = "name = 'slow'\nairspeed_mps = 10.0\nturn_radius_m = 18.0\nclimb_min_deg = 0.0\n\
                       climb_max_deg = 0.0\n[protection]\nradius_m = 22.0\n";
        let vehicle = VehicleModel::parse(TomlText::new(Path::new("v.toml"), vehicle)).unwrap();
        let log = flown(
            "name = 'a'\nduration_s = 1500.0\n[mission]\nwaypoints_m = [[0, 0, 0], [400, 0, 0]]\n\
             [wind]\neast_mps = -4.067\nnorth_mps = 8.028\n[[obstacle]]\nmovement = 'still'\n\
             position_m = [200, 7.3, 0]\nradius_m = 22.0\n",
            Some(vehicle),
        );
        assert!(
            log.outcome.mission_flown && log.outcome.separated(),
            "{:?}",
            log.outcome
        );
    }

    /// An earlier version counted a last waypoint as passed however far aside it was.
    #[test]
    fn d10_a_conflict_at_the_end_of_a_mission_leaves_no_waypoint_out() {
        let vehicles = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../vehicles");
        let vehicle = VehicleModel::read(&vehicles.join("apprentice-15e.toml")).unwrap();
        let log = flown(
            "name = 'a'\nduration_s = 600.0\n[mission]\nwaypoints_m = [[0, 0, 0], [371.4, 0, 0]]\n\
             [[obstacle]]\nmovement = 'uas'\nposition_m = [86.7, 289.3, 0]\n\
             velocity_mps = [11.337, -12.069, 0]\nradius_m = 30.0\n",
            Some(vehicle),
        );
        assert!(log.outcome.mission_flown, "{:?}", log.outcome);
    }

    /// A tall obstacle below a ceiling: only a descent is short, and the floor ends it.
    #[test]
    fn d1_no_manoeuvre_leaves_the_altitudes_of_the_file() {
        let with = |limits: &str| {
            format!(
                "name = 'a'\nduration_s = 120.0\n[mission]\nwaypoints_m = [[0, 0, 100], [1500, 0, 100]]\n{limits}\
                 [[obstacle]]\nposition_m = [600, 0, 110]\nvelocity_mps = [-10, 0, 0]\nradius_m = 40.0\n"
            )
        };
        let lowest_m = |log: &RunLog| {
            let heights_m = log.samples.iter().map(|sample| sample.position_m.z);
            heights_m.fold(f64::INFINITY, f64::min)
        };
        let free = flown(&with("[limits]\nfloor_m = 0\n"), None);
        assert!(lowest_m(&free) < 90.0, "{}", lowest_m(&free));
        let limited = flown(&with("[limits]\nfloor_m = 95\n"), None);
        assert!(lowest_m(&limited) >= 95.0, "{}", lowest_m(&limited));
        assert_eq!(limited.limits_broken(), [false; 2]);
        assert!(limited.outcome.separated() && limited.outcome.mission_flown);
        let text = with("[limits]\nfloor_m = 100\n");
        let error = scenario::parse(TomlText::new(Path::new("a.toml"), &text), None).unwrap_err();
        assert!(
            error.to_string().contains("inside the limits of altitude"),
            "{error}"
        );
        let low = flown(
            &with("[start]\nposition_m = [0, 0, 60]\n[limits]\nfloor_m = 80\n"),
            None,
        );
        assert!(low.outcome.mission_flown && low.limits_broken() == [false; 2]);
    }
}
