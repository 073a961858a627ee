//! When does the companion want control, and when may the vehicle have it back?

use fga::avoider::{Decision, State};

use crate::mode::Mode;

/// The companion takes over when a manoeuvre begins within this time, seconds.
const PREPARE_S: f64 = 0.6;
/// The vehicle gets its mode back after this long on the leg, seconds.
const ON_LEG_FOR_S: f64 = 0.4;
/// Without a threat the way back to the leg may take this long, seconds; then the vehicle gets its mode back beside the leg, and
/// flies to its waypoint.
const LONGEST_WAY_BACK_S: f64 = 120.0;
/// A manoeuvre that is taken up again listens this long for traffic before it may end, seconds: the longest interval of reports
/// (5 s), and the delay of one.
const LISTENS_S: f64 = 6.0;
/// After a refusal or a report that it would take over, the companion waits this long, seconds.
const PAUSE_S: f64 = 5.0;
/// After this many refusals in a row the operator must arm the companion again.
const MOST_REFUSALS: u32 = 3;

/// A program that is to end flies on for this long at most, seconds: service managers kill it after 90 s.
pub const LONGEST_END_S: f64 = 60.0;

/// What decides over a handover.
#[derive(Debug, Default)]
pub(super) struct Handover {
    /// The modes from which the companion takes over.
    take_over: Vec<Mode>,
    /// Number of manoeuvres begun.
    maneuvers: u32,
    /// Since when the program is to end, seconds.
    ending_s: Option<f64>,
    /// Since when it flies on a manoeuvre of an earlier run, or from before a lost link, without a threat known yet,
    /// seconds.
    resumed_s: Option<f64>,
    on_way_since_s: Option<f64>,
    /// Since when nothing threatens in a manoeuvre, seconds.
    cruises_since_s: Option<f64>,
    refusals: u32,
    pause_until_s: f64,
}

impl Handover {
    /// Nothing is taken over yet, and later only from these modes.
    pub(super) fn from_modes(take_over: Vec<Mode>) -> Self {
        Self {
            take_over,
            ..Self::default()
        }
    }

    /// Whether the companion takes over from a mode.
    pub(super) fn takes_over(&self, mode: Mode) -> bool {
        self.take_over.contains(&mode)
    }

    /// Number of manoeuvres begun.
    pub(super) const fn maneuvers(&self) -> u32 {
        self.maneuvers
    }

    /// The program is to end once the mode can be given back.
    pub(super) const fn end(&mut self, now_s: f64) {
        self.ending_s = Some(now_s);
    }

    /// Whether the program is to end.
    pub(super) const fn is_ending(&self) -> bool {
        self.ending_s.is_some()
    }

    /// Whether the program that is to end must not wait any longer.
    pub(super) fn must_end(&self, now_s: f64) -> bool {
        self.ending_s
            .is_some_and(|since_s| now_s - since_s >= LONGEST_END_S)
    }

    /// Whether a decision is to be flown now.
    pub(super) fn wants_control(&self, decision: &Decision, now_s: f64) -> bool {
        let wants = match decision.state {
            State::Avoiding => true,
            State::Threatened => decision.record.start_s.is_some_and(|s| s < PREPARE_S),
            State::Cruise | State::Recovering => false,
        };
        wants && now_s >= self.pause_until_s
    }

    /// The companion begins to command; `resumed` where it goes on with a manoeuvre from before.
    pub(super) const fn begin(&mut self, resumed: bool, now_s: f64) {
        self.maneuvers += 1;
        self.on_way_since_s = None;
        if resumed {
            self.resumed_s = Some(now_s);
        }
    }

    /// The plan is forgotten.
    pub(super) const fn forget(&mut self) {
        self.resumed_s = None;
    }

    /// The vehicle has its mode back as planned.
    pub(super) const fn succeeded(&mut self) {
        self.refusals = 0;
    }

    /// The vehicle has refused to be taken over.
    pub(super) const fn refused(&mut self, now_s: f64) {
        self.refusals += 1;
        self.pause(now_s);
    }

    /// The companion wants no control for a while.
    pub(super) const fn pause(&mut self, now_s: f64) {
        self.pause_until_s = now_s + PAUSE_S;
    }

    /// Whether the vehicle has refused so often that only the operator may try again; that begins a new count.
    pub(super) const fn is_refused_too_often(&mut self) -> bool {
        let is_so = self.refusals >= MOST_REFUSALS;
        if is_so {
            self.refusals = 0;
        }
        is_so
    }

    /// Whether it has taken up a manoeuvre so lately that aircraft may not have reported yet: nothing heard is no
    /// evidence that nothing threatens.
    pub(super) fn listens(&self, now_s: f64) -> bool {
        self.resumed_s
            .is_some_and(|since_s| now_s - since_s < LISTENS_S)
    }

    /// Whether the aircraft settles on its way.
    pub(super) const fn settles(&self) -> bool {
        self.on_way_since_s.is_some()
    }

    /// Whether the aircraft is back on its way and nothing threatens; `on_leg` says where it is, and `turns_onto_leg` that
    /// the command is the leg's course.
    pub(super) fn is_back(
        &mut self,
        decision: &Decision,
        on_leg: bool,
        turns_onto_leg: bool,
        now_s: f64,
    ) -> bool {
        if decision.state != State::Cruise {
            self.cruises_since_s = None;
        }
        if self.listens(now_s) {
            return false;
        }
        let on_way = match decision.state {
            State::Cruise => {
                let since_s = *self.cruises_since_s.get_or_insert(now_s);
                on_leg || now_s - since_s >= LONGEST_WAY_BACK_S
            }
            // The end of a planned way back leaves time for the slowest roll.
            State::Recovering => turns_onto_leg && on_leg,
            State::Threatened | State::Avoiding => false,
        };
        if !on_way || decision.record.threat.is_some() {
            self.on_way_since_s = None;
            return false;
        }
        now_s - *self.on_way_since_s.get_or_insert(now_s) >= ON_LEG_FOR_S
    }
}

#[cfg(test)]
mod tests {
    use fga::avoider::Record;
    use fga::maneuver::Maneuver;

    use super::*;

    fn decision(state: State, start_s: Option<f64>) -> Decision {
        Decision {
            state,
            command: Maneuver::hold().into(),
            record: Record {
                start_s,
                ..Record::default()
            },
        }
    }

    #[test]
    fn control_is_wanted_for_what_begins_now_and_not_soon_after_a_refusal() {
        let mut handover = Handover::default();
        let avoiding = decision(State::Avoiding, None);
        assert!(handover.wants_control(&avoiding, 0.0));
        assert!(handover.wants_control(&decision(State::Threatened, Some(0.5)), 0.0));
        assert!(!handover.wants_control(&decision(State::Threatened, Some(0.7)), 0.0));
        assert!(!handover.wants_control(&decision(State::Threatened, None), 0.0));
        assert!(!handover.wants_control(&decision(State::Recovering, Some(0.0)), 0.0));
        for n in 0..3_u8 {
            assert!(!handover.is_refused_too_often());
            handover.refused(f64::from(n) * 10.0);
        }
        assert!(
            !handover.wants_control(&avoiding, 24.9) && handover.wants_control(&avoiding, 25.0)
        );
        assert!(handover.is_refused_too_often() && !handover.is_refused_too_often());
    }

    #[test]
    fn a_program_that_is_to_end_waits_for_a_minute_at_most() {
        let mut handover = Handover::from_modes(vec![Mode::AUTO]);
        assert!(handover.takes_over(Mode::AUTO) && !handover.takes_over(Mode::RTL));
        assert!(!handover.is_ending() && !handover.must_end(1e3));
        handover.end(10.0);
        assert!(handover.is_ending() && !handover.must_end(69.9) && handover.must_end(70.0));
    }

    #[test]
    fn it_is_back_after_a_while_on_the_leg_or_long_beside_it_and_never_while_it_listens() {
        let mut handover = Handover::default();
        let cruise = decision(State::Cruise, None);
        assert!(!handover.is_back(&cruise, true, false, 0.0));
        assert!(handover.settles());
        assert!(handover.is_back(&cruise, true, false, 0.5));
        assert!(!handover.is_back(&cruise, false, false, 1.0) && !handover.settles());
        assert!(!handover.is_back(&cruise, false, false, 119.9));
        assert!(!handover.is_back(&cruise, false, false, 120.1));
        assert!(handover.is_back(&cruise, false, false, 120.6), "beside it");
        // The last turn onto the leg counts too, a threat does not.
        let recovering = decision(State::Recovering, None);
        assert!(!handover.is_back(&recovering, true, false, 131.0));
        assert!(!handover.is_back(&recovering, true, true, 131.5));
        assert!(handover.is_back(&recovering, true, true, 132.0));
        assert!(!handover.is_back(&decision(State::Threatened, None), true, true, 133.0));
        handover.begin(true, 140.0);
        assert!(!handover.is_back(&cruise, true, true, 145.9));
        assert!(!handover.is_back(&cruise, true, true, 146.0));
        assert!(handover.is_back(&cruise, true, true, 146.5));
    }
}
