//! Decisions with a dead time: a command takes effect later, so the pilot decides about that later moment.

use alloc::collections::VecDeque;

use fga::avoider::Decision;
use fga::avoider::belief::Beliefs;
use fga::maneuver::{Maneuver, Stage};
use fga::pilot::Pilot;
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::{Obstacle, Obstacles, Ownship, Situation};
use fga::vehicle::Vehicle;

/// Asks a pilot about the moment at which its command takes effect: the aircraft has flown the
/// commands under way, the obstacles have kept their velocity since their reports. Times in the decision count from that
/// moment, as the vehicle applies them.
#[derive(Debug)]
pub struct Ahead<P> {
    pilot: P,
    flyer: Flyer,
    dead_time_s: f64,
    /// Commands still in effect, with the times of their decisions, seconds.
    under_way: VecDeque<(f64, Maneuver)>,
    path: FlightPath,
    obstacles: Vec<Obstacle>,
}

impl<P: Pilot> Ahead<P> {
    /// A pilot of a vehicle with a dead time.
    pub fn new(pilot: P, vehicle: &Vehicle) -> Self {
        Self {
            pilot,
            flyer: Flyer::new(vehicle),
            dead_time_s: vehicle.response.dead_time_s,
            under_way: VecDeque::new(),
            path: FlightPath::new(),
            obstacles: Vec::new(),
        }
    }

    /// The aircraft after following a command for some seconds.
    fn flown(&mut self, own: &MotionState, command: &Maneuver, for_s: f64) -> MotionState {
        let stage = command.stage_at(for_s).copied().unwrap_or(Stage {
            start_s: 0.0,
            course_rad: own.course_rad,
            climb_rad: own.climb_rad,
            rate_share: 1.0,
        });
        // A stage that begins at the end makes it a node of the path, where the bank is exact.
        let mut to_end = Maneuver::hold();
        let before = command.stages().iter().filter(|s| s.start_s < for_s);
        for stage in before.copied().chain([Stage {
            start_s: for_s,
            ..stage
        }]) {
            to_end.push(stage);
        }
        let start = MotionState {
            time_s: 0.0,
            ..*own
        };
        self.path.predict(&self.flyer, &start, &to_end, for_s);
        self.path.state_at(&self.flyer, for_s).unwrap_or(start)
    }

    /// The aircraft in its air mass when the present command takes effect.
    fn ownship_then(&mut self, now_s: f64, ownship: &Ownship) -> Ownship {
        let then_s = now_s + self.dead_time_s;
        let mut own = MotionState::of(ownship);
        let mut at_s = now_s;
        let mut flown = Maneuver::hold();
        for index in 0..=self.under_way.len() {
            let next = self.under_way.get(index).copied();
            let effect_s = next.map_or(then_s, |(decided_s, _)| decided_s + self.dead_time_s);
            let until_s = effect_s.clamp(at_s, then_s);
            if until_s > at_s {
                own = self.flown(&own, &flown, until_s - at_s);
                flown = flown.after(until_s - at_s);
                at_s = until_s;
            }
            if let Some((_, command)) = next {
                flown = command.after((at_s - effect_s).max(0.0));
            }
        }
        Ownship {
            position_m: own.position_m,
            course_rad: own.course_rad,
            climb_rad: own.climb_rad,
            bank_rad: own.bank_rad,
            ..*ownship
        }
    }
}

impl<P: Pilot> Pilot for Ahead<P> {
    fn step(&mut self, situation: &Situation<'_>) -> Decision {
        let (now_s, dead_s) = (situation.time_s, self.dead_time_s);
        if !situation.is_usable() {
            return self.pilot.step(situation);
        }
        // The effect of a command ends where the next one's begins.
        while self
            .under_way
            .get(1)
            .is_some_and(|(decided_s, _)| decided_s + dead_s <= now_s)
        {
            self.under_way.pop_front();
        }
        let mut ownship = self.ownship_then(now_s, &situation.ownship);
        ownship.position_m += situation.wind_mps * dead_s;
        self.obstacles.clear();
        self.obstacles
            .extend(situation.obstacles.iter().map(|obstacle| {
                let mut then = obstacle;
                then.position_m = obstacle.position_after_m(dead_s);
                then.age_s += dead_s;
                then.uncertainty.position_m += obstacle.uncertainty.velocity_mps * dead_s;
                then
            }));
        let decision = self.pilot.step(&Situation {
            time_s: now_s + dead_s,
            ownship,
            obstacles: Obstacles::Rows(&self.obstacles),
            mission: situation.mission,
            wind_mps: situation.wind_mps,
        });
        self.under_way.push_back((now_s, *decision.command));
        decision
    }

    fn beliefs(&self) -> Option<&Beliefs> {
        self.pilot.beliefs()
    }

    fn retune(&mut self, vehicle: &Vehicle) {
        self.flyer = Flyer::new(vehicle);
        self.dead_time_s = vehicle.response.dead_time_s;
        self.pilot.retune(vehicle);
    }

    fn replace_mission(&mut self, kept: usize) {
        self.pilot.replace_mission(kept);
    }

    fn restart(&mut self) {
        self.under_way.clear();
        self.pilot.restart();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission_pilot::MissionPilot;
    use fga::Vec3;
    use fga::situation::{Mission, ProtectedVolume};

    /// A pilot that remembers the obstacle it was asked about.
    struct Seen(MissionPilot, Option<Obstacle>);

    impl Pilot for Seen {
        fn step(&mut self, situation: &Situation<'_>) -> Decision {
            self.1 = situation.obstacles.iter().next();
            self.0.step(situation)
        }

        fn retune(&mut self, vehicle: &Vehicle) {
            self.0.retune(vehicle);
        }

        fn restart(&mut self) {
            self.0.restart();
        }
    }

    /// What an intruder may have done during the dead time counts like what it may have done since its report.
    #[test]
    fn d2_a_report_is_older_when_the_command_takes_effect() {
        let mut vehicle = Vehicle::from_bank(15.0, 0.5).unwrap();
        vehicle.response.dead_time_s = 1.5;
        let pilot = MissionPilot::new(30.0, vehicle).unwrap();
        let mut ahead = Ahead::new(Seen(pilot, None), &vehicle);
        let (position_m, velocity_mps) = (Vec3::new(500.0, 0.0, 0.0), Vec3::new(-20.0, 4.0, 1.0));
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        let rows = [Obstacle {
            age_s: 0.5,
            ..Obstacle::straight(1, position_m, velocity_mps, volume)
        }];
        ahead.step(&Situation {
            time_s: 0.0,
            ownship: Ownship {
                position_m: Vec3::ZERO,
                airspeed_mps: 15.0,
                course_rad: 0.0,
                climb_rad: 0.0,
                bank_rad: 0.0,
            },
            obstacles: Obstacles::Rows(&rows),
            mission: Mission::new(&[]),
            wind_mps: Vec3::ZERO,
        });
        let seen = ahead.pilot.1.unwrap();
        assert_eq!(seen.age_s, 2.0);
        assert_eq!(seen.position_m, position_m + velocity_mps * 1.5);
    }
}
