//! A request of our own that the vehicle carries out after the companion gave it up.
//!
//! On a slow link a request for a mode can reach the vehicle seconds after it was given up: a heartbeat
//! from before it arrived looks like a return, or the pilot has chosen meanwhile. The vehicle's answer
//! tells it from a choice of the pilot: the vehicle accepts a request, and then tells the mode. Where the
//! answer was lost, the two look alike, and the companion asks the operator.

use crate::mode::{Mode, ModeChange};

/// A mode reported within this time after the vehicle accepted a request is the accepted one, seconds.
const ACCEPTED_FOR_S: f64 = 1.5;
/// Longest time that an unanswered request may be on its way, seconds.
const ON_ITS_WAY_S: f64 = 30.0;

/// Why the vehicle has changed to a mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// It carried out a request of ours.
    Ours,
    /// It may have carried out one: no answer was heard.
    Unknown,
    /// Somebody else chose the mode.
    Others,
}

/// The requests for one mode, and the vehicle's answers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Requests {
    /// The last requested mode.
    to: Option<Mode>,
    asked_s: f64,
    unanswered: u8,
    accepted_s: f64,
    /// That answer came later than a request may be on its way.
    late: bool,
    /// No request for another mode waits for its answer: an answer can only be to one of these.
    only: bool,
}

impl Requests {
    pub(super) const NONE: Self = Self {
        to: None,
        asked_s: f64::NEG_INFINITY,
        unanswered: 0,
        accepted_s: f64::NEG_INFINITY,
        late: false,
        only: true,
    };

    /// A request was sent.
    pub(super) fn asked(&mut self, change: ModeChange, now_s: f64) {
        if self.to != Some(change.to) {
            *self = Self {
                to: Some(change.to),
                only: self.unanswered == 0 || now_s - self.asked_s > ON_ITS_WAY_S,
                ..Self::NONE
            };
        }
        self.asked_s = now_s;
        self.unanswered = self.unanswered.saturating_add(1);
    }

    /// The vehicle answered a request.
    pub(super) const fn answered(&mut self, accepted: bool, now_s: f64) {
        // One answer too many is a copy.
        if self.unanswered == 0 {
            return;
        }
        self.unanswered -= 1;
        if accepted && self.only {
            self.accepted_s = now_s;
            self.late = now_s - self.asked_s > ON_ITS_WAY_S;
        }
    }

    /// A heartbeat tells that the vehicle has left this mode, and nothing tells that it did so for a request
    /// of ours: where it is heard in it again, the heartbeat may have been somebody else's.
    pub(super) const fn doubt(&mut self, mode: Mode, now_s: f64) {
        *self = Self {
            to: Some(mode),
            asked_s: now_s,
            unanswered: 1,
            accepted_s: f64::NEG_INFINITY,
            late: false,
            only: false,
        };
    }

    /// The vehicle has changed to a mode.
    pub(super) fn origin(&mut self, mode: Mode, now_s: f64) -> Origin {
        if self.to != Some(mode) {
            return Origin::Others;
        }
        let accepted_s = core::mem::replace(&mut self.accepted_s, f64::NEG_INFINITY);
        if now_s - accepted_s <= ACCEPTED_FOR_S {
            // An answer as late as that may be forged.
            return if self.late {
                Origin::Unknown
            } else {
                Origin::Ours
            };
        }
        if self.unanswered == 0 || now_s - self.asked_s > ON_ITS_WAY_S {
            return Origin::Others;
        }
        self.unanswered -= 1;
        Origin::Unknown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TAKE: ModeChange = ModeChange {
        from: Mode::AUTO,
        to: Mode::GUIDED,
    };
    const RETURN: ModeChange = ModeChange {
        from: Mode::GUIDED,
        to: Mode::AUTO,
    };

    fn asked(times: u8) -> Requests {
        let mut requests = Requests::NONE;
        for n in 0..times {
            requests.asked(TAKE, 0.4 * f64::from(n));
        }
        requests
    }

    #[test]
    fn what_was_accepted_is_ours_once_and_for_a_moment() {
        let mut requests = asked(1);
        requests.answered(true, 5.0);
        assert_eq!(requests.origin(Mode::GUIDED, 6.5), Origin::Ours);
        assert_eq!(requests.origin(Mode::GUIDED, 6.5), Origin::Others);
        let mut requests = asked(1);
        requests.answered(true, 5.0);
        assert_eq!(requests.origin(Mode::GUIDED, 6.6), Origin::Others);
        let mut requests = asked(1);
        requests.answered(true, 5.0);
        assert_eq!(requests.origin(Mode::AUTO, 5.1), Origin::Others);
        assert_eq!(requests.origin(Mode::GUIDED, 5.2), Origin::Ours);
    }

    #[test]
    fn what_was_refused_is_nobodys() {
        let mut requests = asked(1);
        requests.answered(false, 5.0);
        assert_eq!(requests.origin(Mode::GUIDED, 5.1), Origin::Others);
    }

    #[test]
    fn each_request_without_an_answer_may_be_carried_out_once_within_thirty_seconds() {
        let mut requests = asked(2);
        assert_eq!(requests.origin(Mode::GUIDED, 30.4), Origin::Unknown);
        assert_eq!(requests.origin(Mode::GUIDED, 30.4), Origin::Unknown);
        assert_eq!(requests.origin(Mode::GUIDED, 30.4), Origin::Others);
        assert_eq!(asked(2).origin(Mode::GUIDED, 30.5), Origin::Others);
        assert_eq!(asked(0).origin(Mode::GUIDED, 0.0), Origin::Others);
        // A copy of an answer answers nothing.
        let mut requests = asked(1);
        requests.answered(true, 1.0);
        assert_eq!(requests.origin(Mode::GUIDED, 1.1), Origin::Ours);
        requests.answered(true, 1.2);
        assert_eq!(requests.origin(Mode::GUIDED, 1.3), Origin::Others);
    }

    #[test]
    fn a_mode_that_is_doubted_is_nobodys_for_thirty_seconds() {
        for (later_s, origin) in [(30.0, Origin::Unknown), (30.1, Origin::Others)] {
            let mut requests = Requests::NONE;
            requests.doubt(Mode::GUIDED, 0.0);
            requests.answered(true, later_s);
            requests.doubt(Mode::GUIDED, 0.0);
            assert_eq!(requests.origin(Mode::AUTO, 0.1), Origin::Others);
            assert_eq!(requests.origin(Mode::GUIDED, later_s), origin);
        }
    }

    #[test]
    fn an_answer_that_may_be_to_another_request_says_nothing() {
        let mut requests = asked(1);
        requests.asked(RETURN, 1.0);
        requests.answered(true, 1.1);
        assert_eq!(requests.origin(Mode::AUTO, 1.2), Origin::Others);
        // However long this program has run.
        let mut requests = Requests::NONE;
        requests.asked(TAKE, 20.0);
        requests.asked(RETURN, 30.0);
        requests.answered(true, 30.1);
        assert_eq!(requests.origin(Mode::AUTO, 30.2), Origin::Others);
        // Had the first one been answered, or been sent long ago, it would.
        let mut requests = asked(1);
        requests.answered(true, 0.1);
        requests.asked(RETURN, 1.0);
        requests.answered(true, 1.1);
        assert_eq!(requests.origin(Mode::AUTO, 1.2), Origin::Ours);
        let mut requests = asked(1);
        requests.asked(RETURN, 30.1);
        requests.answered(true, 30.2);
        assert_eq!(requests.origin(Mode::AUTO, 30.3), Origin::Ours);
    }

    #[test]
    fn an_answer_long_after_the_request_tells_nothing() {
        for (answered_s, origin) in [(30.0, Origin::Ours), (30.1, Origin::Unknown)] {
            let mut requests = asked(1);
            requests.answered(true, answered_s);
            assert_eq!(requests.origin(Mode::GUIDED, answered_s + 0.1), origin);
        }
    }
}
