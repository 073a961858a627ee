//! Encounters in which the intruders react: each of them flies its recording until a policy of its own leaves it.
//!
//! All aircraft decide at the same times and know of each other what their sensors show then. An intruder is the light aircraft that flies
//! recordings without a vehicle file ([`VehicleModel::recorded`]), at its recorded airspeed, with the ownship's sensor, wind and protected volume.
//! It reacts from its own first row on; until it manoeuvres it is where the recording has it, and reported as there.
//!
//! The result is a world in which the intruders fly what they flew: the ownship's flight in it can be measured, judged and shown as any
//! other one. It belongs to one policy of the ownship, because the intruders react to what the ownship does.

use fga::avoider::{Decision, State};
use fga::situation::{Ownship, Uncertainty};
use fga_formats::daa::{Recording, Track as Recorded, TrackSample};

use crate::engine::{Observer, Sample, SteppedFlight};
use crate::obstacle::{TrackReport, WorldObstacle};
use crate::own::FailureKind;
use crate::policy::{PolicyChoice, PolicyPilot};
use crate::recording::{pieces, plan_of_pieces};
use crate::track::TrackPoint;
use crate::vehicle_file::VehicleModel;
use crate::world::World;

/// A world with the intruders' answers to a policy.
#[derive(Debug, Clone, PartialEq)]
pub struct Reacted {
    /// The world of the ownship.
    pub world: World,
    /// How an intruder's policy failed, if it is one outside of this crate.
    pub failure: Option<FailureKind>,
}

/// Flies all aircraft of a recording at once: the ownship of `world`, which `recording` describes, by `policy`, the others by `intruders`.
///
/// # Errors
/// Settings or limits that the core refuses; one sentence.
pub fn react(
    world: World,
    recording: &Recording,
    model: &VehicleModel,
    policy: &PolicyChoice,
    intruders: &PolicyChoice,
) -> Result<Reacted, String> {
    let period_s = world.settings.avoider.decision_period_s;
    let intruder_model = intruder_of(model)?;
    let begin_s = recording
        .ownship()
        .and_then(|track| track.samples.first())
        .map_or(0.0, |row| row.time_s);
    let recording = &pieces(recording);
    let mut others = Vec::new();
    // Rows of the recording that make no track are no obstacle either.
    for (place, aircraft) in recording.aircraft.iter().enumerate().skip(1) {
        let id = u32::try_from(place).unwrap_or(u32::MAX);
        if !world.obstacles.iter().any(|obstacle| obstacle.id == id) {
            continue;
        }
        let first_s = aircraft.samples.first().map_or(0.0, |row| row.time_s);
        let after_s = libm::ceil((first_s - begin_s).max(0.0) / period_s - 1e-9) * period_s;
        let Some(track) = begun_at(aircraft, begin_s + after_s) else {
            continue;
        };
        let mut turned = recording.clone();
        turned.aircraft.remove(place);
        turned.aircraft.insert(0, track);
        // An aircraft that does not move flies nothing.
        let plan = plan_of_pieces(
            &turned,
            String::new(),
            String::new(),
            intruder_model.clone(),
        );
        let Ok(plan) = plan else {
            continue;
        };
        let mut its = plan.world;
        (its.seed, its.stream) = (world.seed ^ (u64::from(id) << 32), world.stream);
        // The wind is the ownship's; what the recording says of it is the same air.
        its.wind_mps = world.blows_mps();
        let pilot = intruders
            .pilot(&its.settings, &its.vehicle)
            .map_err(|error| error.to_string())?;
        others.push((place, Party::new(its, pilot, after_s)));
    }
    let world = policy.sees(&world).unwrap_or(world);
    let pilot = policy
        .pilot(&world.settings, &world.vehicle)
        .map_err(|error| error.to_string())?;
    let mut own = Party::new(world, pilot, 0.0);
    let mut cycle = 0_u32;
    loop {
        let time_s = f64::from(cycle) * period_s;
        let own_moved = own.fly(time_s);
        let moved: Vec<(usize, Option<Moved>)> = others
            .iter_mut()
            .map(|(place, other)| (*place, other.fly(time_s)))
            .collect();
        if own.is_over() {
            break;
        }
        for (place, other) in &mut others {
            let each = core::iter::once((0, &own_moved)).chain(moved.iter().map(|(p, m)| (*p, m)));
            for (from, moved) in each.filter(|(from, _)| from != place) {
                // The aircraft that is the ownship here has left its place in the order.
                let id = if from < *place { from + 1 } else { from };
                other.see(id, moved.as_ref());
            }
            other.look();
        }
        for (place, moved) in &moved {
            own.see(*place, moved.as_ref());
        }
        own.look();
        cycle += 1;
    }
    let failure = others.iter().find_map(|(_, other)| other.pilot.failure());
    Ok(Reacted {
        world: own.flight.into_world(),
        failure,
    })
}

/// The aircraft of the intruders.
fn intruder_of(model: &VehicleModel) -> Result<VehicleModel, String> {
    let mut light = VehicleModel::recorded().map_err(|error| error.to_string())?;
    light.protection = model.protection;
    light.sensor = model.sensor;
    light.more_sensors.clone_from(&model.more_sensors);
    light.wind_mps = model.blows_mps();
    light.settings.avoider.decision_period_s = model.settings.avoider.decision_period_s;
    Ok(light)
}

/// A track from a time on, with a row then; `None` if it has ended by then.
fn begun_at(track: &Recorded, time_s: f64) -> Option<Recorded> {
    let next = track.samples.partition_point(|row| row.time_s < time_s);
    let after = track.samples.get(next)?;
    let mut samples = Vec::new();
    if after.time_s > time_s
        && let Some(before) = next.checked_sub(1).and_then(|at| track.samples.get(at))
    {
        let share = (time_s - before.time_s) / (after.time_s - before.time_s);
        samples.push(TrackSample {
            time_s,
            position_m: before.position_m + (after.position_m - before.position_m) * share,
            ..*before
        });
    }
    samples.extend(track.samples.get(next..)?.iter().copied());
    Some(Recorded {
        name: track.name.clone(),
        samples,
    })
}

/// An aircraft with its pilot, in a world of its own.
struct Party {
    flight: SteppedFlight,
    pilot: Box<dyn PolicyPilot + Send>,
    /// Its clock begins this long after the ownship's, seconds.
    after_s: f64,
    /// When it left its recording, seconds of the ownship's clock.
    left_s: Option<f64>,
}

/// The motion of an aircraft that has left its recording, over a cycle; times of the ownship's clock.
struct Moved {
    left_s: f64,
    points: Vec<TrackPoint>,
    report: TrackReport,
}

impl Party {
    fn new(world: World, mut pilot: Box<dyn PolicyPilot + Send>, after_s: f64) -> Self {
        pilot.restart();
        Self {
            flight: SteppedFlight::new(world),
            pilot,
            after_s,
            left_s: None,
        }
    }

    fn is_over(&self) -> bool {
        self.flight.situation().is_none()
    }

    /// Decides and flies until the next decision; the motion once it is no longer the recorded one.
    fn fly(&mut self, time_s: f64) -> Option<Moved> {
        if time_s < self.after_s - 1e-9 {
            return None;
        }
        if let Some(vehicle) = self.flight.take_retuned() {
            self.pilot.retune(&vehicle);
        }
        let decision: Decision = {
            let situation = self.flight.situation()?;
            self.pilot.step(&situation)
        };
        if decision.state == State::Avoiding {
            self.left_s.get_or_insert(time_s);
        }
        let mut flown = Points {
            after_s: self.after_s,
            points: Vec::new(),
        };
        self.flight.fly(&decision, &mut flown);
        let Ownship { position_m, .. } = *self.flight.ownship();
        let velocity_mps = self.flight.ground_velocity_mps();
        Some(Moved {
            left_s: self.left_s?,
            points: flown.points,
            report: TrackReport {
                age_s: 0.0,
                time_s: self.flight.time_s() + self.after_s,
                position_m,
                velocity_mps,
                uncertainty: Uncertainty::default(),
            },
        })
    }

    /// Learns the motion of another aircraft.
    fn see(&mut self, id: usize, moved: Option<&Moved>) {
        let after_s = self.after_s;
        let Some(moved) = moved else { return };
        let obstacles = self.flight.obstacles_mut().iter_mut();
        if let Some(obstacle) = obstacles.into_iter().find(|known| known.id as usize == id) {
            go_on(obstacle, moved, after_s);
        }
    }

    fn look(&mut self) {
        if !self.is_over() {
            self.flight.look();
        }
    }
}

/// Replaces the motion of an obstacle from the time on at which it left its recording.
fn go_on(obstacle: &mut WorldObstacle, moved: &Moved, after_s: f64) {
    let left_s = moved.left_s - after_s;
    let is_first = moved
        .points
        .first()
        .is_some_and(|point| point.time_s <= moved.left_s + 1e-9);
    if is_first {
        obstacle.track.leave_at(left_s);
        obstacle.reports.retain(|report| report.time_s <= left_s);
    }
    for point in &moved.points {
        obstacle.track.push(TrackPoint {
            time_s: point.time_s - after_s,
            ..*point
        });
    }
    let report = TrackReport {
        time_s: moved.report.time_s - after_s,
        ..moved.report
    };
    // The last cycle may have no length.
    let last = obstacle.reports.last();
    if last.is_none_or(|last| report.time_s > last.time_s) {
        obstacle.reports.push(report);
    }
}

/// Follows a flight, in the ownship's clock.
struct Points {
    after_s: f64,
    points: Vec<TrackPoint>,
}

impl Observer for Points {
    fn sample(&mut self, sample: &Sample) {
        self.points.push(TrackPoint {
            time_s: sample.time_s + self.after_s,
            position_m: sample.position_m,
        });
    }
}

#[cfg(test)]
mod tests;
