//! Who decides with which limits, what was decided last, and since when is no decision possible?

use fga::avoider::{Decision, Reason, Start, State, Threat};
use fga::limit::SettingsError;
use fga::vehicle::Vehicle;

use super::decider::CompanionPilot;
use crate::config::Config;
use crate::ownship::OwnState;

/// A change of airspeed or response that requires new limits, as a share.
const LIMITS_CHANGE: f64 = 0.02;
/// A change of airspeed that counts in a manoeuvre too, as a share: the aircraft is elsewhere than planned, whether it turns
/// faster or slower. Load and gusts change the airspeed by less.
const SPEED_CHANGE: f64 = 0.05;
/// After this long without a decision no decision is possible, seconds.
const NO_DECISION_S: f64 = 0.5;
/// Interval of log lines about the same state and reason, seconds.
const LOGGED_AGAIN_S: f64 = 1.0;

/// A decision and its context.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decided {
    pub(super) decision: Decision,
    /// Time of the state that it is based on, seconds.
    pub(super) for_s: f64,
    pub(super) own: OwnState,
}

/// The pilot and its last decision.
#[derive(Debug)]
pub(super) struct Decisions {
    pilot: Option<CompanionPilot>,
    last: Option<Decided>,
    /// Start of a time without possible decisions, seconds; a late step does not count.
    missing_s: Option<f64>,
    logged: Option<(State, Reason, f64)>,
    count: u64,
}

impl Default for Decisions {
    fn default() -> Self {
        Self {
            pilot: None,
            last: None,
            missing_s: Some(f64::NEG_INFINITY),
            logged: None,
            count: 0,
        }
    }
}

impl Decisions {
    /// Who decides; `None` until the vehicle's limits are known.
    pub(super) const fn pilot(&self) -> Option<&CompanionPilot> {
        self.pilot.as_ref()
    }

    /// The last decision.
    pub(super) const fn last(&self) -> Option<&Decided> {
        self.last.as_ref()
    }

    /// The threat of the last decision.
    pub(super) fn threat(&self) -> Option<Threat> {
        self.last()?.decision.record.threat
    }

    /// Number of decisions.
    pub(super) const fn count(&self) -> u64 {
        self.count
    }

    /// Whether the last decision uses the bank in need.
    pub(super) fn is_in_need(&self) -> bool {
        let decided = self.last();
        decided.is_some_and(|decided| decided.decision.record.in_need)
    }

    /// Whether a threat or a manoeuvre occupies the pilot.
    pub(super) fn is_busy(&self) -> bool {
        self.pilot()
            .is_some_and(|pilot| pilot.state() != State::Cruise)
    }

    /// Whether the last decision may be flown on without telemetry.
    pub(super) fn is_certified(&self) -> bool {
        self.last.is_some() && self.pilot().is_some_and(CompanionPilot::certifies)
    }

    /// Whether decisions are made.
    pub(super) fn are_possible(&self, now_s: f64) -> bool {
        self.missing_s
            .is_none_or(|since_s| now_s - since_s <= NO_DECISION_S)
    }

    /// No decision was possible now.
    pub(super) fn miss(&mut self, now_s: f64) {
        self.missing_s.get_or_insert(now_s);
    }

    /// Another way needs another pilot; the last decision stays until its first one.
    pub(super) fn begin_way(&mut self) {
        self.pilot = None;
    }

    /// Neither a plan nor a decision counts any more.
    pub(super) fn forget(&mut self) {
        self.pilot = None;
        self.last = None;
    }

    /// Makes the pilot, or gives it the vehicle's present limits; `in_need` those of plans in need, and `drift_mps` the velocity with which
    /// it may leave a prediction, metres per second. In a manoeuvre nothing changes but the airspeed: what is learned in it counts for the
    /// next one, and until then the drift that the pilot measures.
    ///
    /// # Errors
    /// Limits that cannot be flown, for a first pilot.
    pub(super) fn tune(
        &mut self,
        config: &Config,
        wanted: &Vehicle,
        in_need: Option<Vehicle>,
        drift_mps: f64,
    ) -> Result<(), SettingsError> {
        let Some(pilot) = &mut self.pilot else {
            self.pilot = Some(CompanionPilot::new(config, *wanted)?);
            return self.tune(config, wanted, in_need, drift_mps);
        };
        let known = pilot.vehicle();
        let off_mps = (wanted.airspeed_mps - known.airspeed_mps).abs();
        let counts = off_mps > SPEED_CHANGE * known.airspeed_mps;
        let idle = pilot.state() == State::Cruise;
        if idle {
            pilot.set_drift(drift_mps);
        }
        if idle || counts || pilot.vehicle_in_need().is_none() {
            pilot.set_vehicle_in_need(in_need);
        }
        let known = pilot.vehicle();
        if differs(wanted, known) && (counts || idle || !pilot.certifies()) {
            pilot.retune(wanted);
        }
        Ok(())
    }

    /// The pilot for a decision; [`take`](Self::take) gives it back.
    pub(super) const fn lend_pilot(&mut self) -> Option<CompanionPilot> {
        self.pilot.take()
    }

    /// Sets when a manoeuvre begins.
    pub(super) fn set_start(&mut self, start: Start) {
        if let Some(pilot) = &mut self.pilot {
            pilot.set_start(start);
        }
    }

    /// Takes a decision, and the pilot as it is after the decision.
    pub(super) fn take(&mut self, pilot: CompanionPilot, decided: &Decided) {
        self.pilot = Some(pilot);
        self.last = Some(*decided);
        self.missing_s = None;
        self.count += 1;
    }

    /// The last decision, where the log needs a line of it: another state or reason, or a manoeuvre that lasts.
    pub(super) fn news(&mut self, now_s: f64) -> Option<&Decided> {
        let decision = &self.last.as_ref()?.decision;
        let (state, reason) = (decision.state, decision.record.reason);
        let is_known = self.logged.is_some_and(|(last_state, last_reason, at_s)| {
            let is_same = (last_state, last_reason) == (state, reason);
            is_same && (state == State::Cruise || now_s - at_s < LOGGED_AGAIN_S)
        });
        if is_known {
            return None;
        }
        self.logged = Some((state, reason, now_s));
        self.last.as_ref()
    }
}

/// Whether limits differ enough to plan with the new ones.
fn differs(wanted: &Vehicle, known: &Vehicle) -> bool {
    let off = |a: f64, b: f64| (a - b).abs() > LIMITS_CHANGE * b.abs();
    // Also the limits of a climb: their parameters may come later than the others.
    off(wanted.airspeed_mps, known.airspeed_mps)
        || off(wanted.climb_max_rad, known.climb_max_rad)
        || off(wanted.climb_min_rad, known.climb_min_rad)
        || off(wanted.course_rate_radps(), known.course_rate_radps())
        || off(
            wanted.response.bank_time_constant_s,
            known.response.bank_time_constant_s,
        )
}

#[cfg(test)]
mod tests {
    use fga::Vec3;
    use fga::avoider::Record;
    use fga::maneuver::Maneuver;
    use fga::situation::Ownship;

    use super::*;

    fn decided(state: State, in_need: bool) -> Decided {
        let decision = Decision {
            state,
            command: Maneuver::hold().into(),
            record: Record {
                in_need,
                ..Record::default()
            },
        };
        let ownship = Ownship {
            position_m: Vec3::ZERO,
            airspeed_mps: 20.0,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
        };
        let own = OwnState {
            ownship,
            ground_velocity_mps: ownship.velocity_mps(),
            wind_mps: Vec3::ZERO,
            above_home_m: 100.0,
            pitch_rad: 0.0,
            course_rate_radps: 0.0,
        };
        Decided {
            decision,
            for_s: 0.0,
            own,
        }
    }

    /// Takes a decision, with the pilot that there is.
    fn take(decisions: &mut Decisions, state: State, in_need: bool) {
        let pilot = decisions.lend_pilot().unwrap();
        decisions.take(pilot, &decided(state, in_need));
    }

    fn tuned() -> Decisions {
        let mut decisions = Decisions::default();
        let vehicle = Vehicle::from_bank(20.0, 0.6).unwrap();
        decisions
            .tune(&Config::default(), &vehicle, None, 0.0)
            .unwrap();
        decisions
    }

    /// The pilot in a manoeuvre for an aircraft ahead.
    fn avoiding(mut pilot: CompanionPilot) -> CompanionPilot {
        use fga::situation::{Mission, Obstacle, Obstacles, ProtectedVolume, Situation};
        let volume = ProtectedVolume::Sphere { radius_m: 60.0 };
        let ahead = Vec3::new(300.0, 0.0, 0.0);
        let others = [Obstacle::straight(
            7,
            ahead,
            Vec3::new(-20.0, 0.0, 0.0),
            volume,
        )];
        let way_m = [Vec3::ZERO, Vec3::new(5000.0, 0.0, 0.0)];
        let decision = pilot.step(&Situation {
            time_s: 0.0,
            ownship: decided(State::Cruise, false).own.ownship,
            obstacles: Obstacles::Rows(&others),
            mission: Mission::new(&way_m),
            wind_mps: Vec3::ZERO,
        });
        assert_ne!(decision.state, State::Cruise);
        pilot
    }

    #[test]
    fn decisions_are_possible_from_the_first_one_until_half_a_second_without() {
        let mut decisions = tuned();
        assert!(!decisions.are_possible(0.0) && !decisions.is_certified());
        take(&mut decisions, State::Cruise, true);
        assert!(decisions.are_possible(100.0) && decisions.is_certified());
        assert!(decisions.is_in_need() && decisions.count() == 1);
        decisions.miss(100.0);
        decisions.miss(100.4);
        assert!(decisions.are_possible(100.5) && !decisions.are_possible(100.6));
        decisions.begin_way();
        assert!(decisions.last().is_some() && !decisions.is_certified());
        decisions.forget();
        assert!(decisions.last().is_none() && !decisions.is_in_need());
    }

    #[test]
    fn the_log_has_each_change_and_a_manoeuvre_once_a_second() {
        let mut decisions = tuned();
        assert!(decisions.news(0.0).is_none(), "nothing decided");
        let mut logs = |state, now_s| {
            take(&mut decisions, state, false);
            decisions.news(now_s).is_some()
        };
        assert!(logs(State::Cruise, 1.0) && !logs(State::Cruise, 60.0));
        assert!(logs(State::Avoiding, 60.1) && !logs(State::Avoiding, 61.0));
        assert!(logs(State::Avoiding, 61.1) && logs(State::Cruise, 61.2));
    }

    #[test]
    fn in_a_manoeuvre_no_limit_changes_but_the_airspeed() {
        let slower = |mps: f64| Vehicle {
            response: fga::vehicle::Response {
                turn_rate_factor: 0.8,
                ..fga::vehicle::Response::IDEAL
            },
            ..Vehicle::from_bank(mps, 0.6).unwrap()
        };
        let tune = |decisions: &mut Decisions, mps| {
            let wanted = slower(mps);
            decisions
                .tune(&Config::default(), &wanted, None, 0.0)
                .unwrap();
            decisions
                .pilot()
                .unwrap()
                .vehicle()
                .response
                .turn_rate_factor
        };
        let mut decisions = tuned();
        assert_eq!(tune(&mut decisions, 20.0), 0.8, "nobody is avoided");
        let mut decisions = tuned();
        let pilot = avoiding(decisions.lend_pilot().unwrap());
        decisions.take(pilot, &decided(State::Avoiding, false));
        assert_eq!(tune(&mut decisions, 20.0), 1.0);
        assert_eq!(tune(&mut decisions, 22.0), 0.8, "another airspeed");
    }

    #[test]
    fn limits_that_differ_by_a_share_are_planned_with() {
        let mut decisions = tuned();
        let mut airspeed_mps = |mps| {
            let vehicle = Vehicle::from_bank(mps, 0.6).unwrap();
            decisions
                .tune(&Config::default(), &vehicle, None, 0.0)
                .unwrap();
            decisions.pilot().unwrap().vehicle().airspeed_mps
        };
        assert_eq!(airspeed_mps(20.3), 20.0);
        assert_eq!(airspeed_mps(20.5), 20.5);
        assert_eq!(airspeed_mps(20.2), 20.5);
    }
}
