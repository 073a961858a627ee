//! A request of our own that the vehicle carries out after the companion gave it up.
//!
//! On a slow link a request for a mode can reach the vehicle seconds after the companion gave it up: an older heartbeat
//! looks like a return, or the pilot has chosen a mode meanwhile. The vehicle's answer
//! distinguishes the request from a choice of the pilot: the vehicle accepts a request, and then reports the mode. Where the
//! answer was lost, request and choice look alike, and the companion asks the operator.

use crate::mode::{Mode, ModeChange};

/// A mode reported within this time after the vehicle accepted a request is the accepted one, seconds.
const ACCEPTED_FOR_S: f64 = 1.5;
/// Longest time that an unanswered request may be on its way, seconds.
const ON_ITS_WAY_S: f64 = 30.0;

/// Why the vehicle has changed to a mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ModeOrigin {
    /// It carried out a request of ours.
    Ours,
    /// It may have carried out one: no answer was heard.
    Unknown,
    /// Somebody else chose the mode.
    Others,
}

/// The requests of ours that may still be on their way, and the vehicle's answers.
///
/// Requests for two modes can be on their way at once, and a queue that ends delivers the newer one first: an
/// answer does not say which of them the vehicle carried out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Requests {
    /// The last requested mode.
    to: Option<Mode>,
    /// The mode of earlier requests, while an answer may be to one of them.
    earlier: Option<Mode>,
    asked_s: f64,
    unanswered: u8,
    accepted_s: f64,
    /// The mode that the vehicle accepted; `None` if it may be either.
    accepted: Option<Mode>,
}

impl Requests {
    pub(super) const NONE: Self = Self {
        to: None,
        earlier: None,
        asked_s: f64::NEG_INFINITY,
        unanswered: 0,
        accepted_s: f64::NEG_INFINITY,
        accepted: None,
    };

    /// Whether the vehicle may still carry out a request.
    fn is_on_its_way(&self, now_s: f64) -> bool {
        self.unanswered > 0 && now_s - self.asked_s <= ON_ITS_WAY_S
    }

    /// Whether the vehicle may still carry out a request for a mode.
    pub(super) fn may_arrive(&self, mode: Mode, now_s: f64) -> bool {
        self.is_on_its_way(now_s) && (self.to == Some(mode) || self.earlier == Some(mode))
    }

    /// A request was sent.
    pub(super) fn asked(&mut self, change: ModeChange, now_s: f64) {
        if !self.is_on_its_way(now_s) {
            (self.earlier, self.unanswered) = (None, 0);
        } else if self.to != Some(change.to) {
            self.earlier = self.to;
        }
        self.to = Some(change.to);
        self.asked_s = now_s;
        self.unanswered = self.unanswered.saturating_add(1);
    }

    /// The vehicle answered a request.
    pub(super) fn answered(&mut self, accepted: bool, now_s: f64) {
        // One answer too many is a copy.
        if self.unanswered == 0 {
            return;
        }
        // A later answer may be forged.
        let is_sure = self.earlier.is_none() && self.is_on_its_way(now_s);
        self.unanswered -= 1;
        if accepted {
            self.accepted_s = now_s;
            self.accepted = self.to.filter(|_| is_sure);
        }
    }

    /// The vehicle has left a mode, and no answer shows that it did so for a request of ours: if it reports the mode
    /// again, the heartbeat in between may have been somebody else's.
    pub(super) fn doubt(&mut self, mode: Mode, now_s: f64) {
        let doubted = ModeChange {
            from: mode,
            to: mode,
        };
        self.asked(doubted, now_s);
        // No answer is due: one that comes is to another request.
        self.earlier = self.earlier.or(self.to);
        self.accepted_s = f64::NEG_INFINITY;
    }

    /// The vehicle has changed to a mode.
    pub(super) fn origin(&mut self, mode: Mode, now_s: f64) -> ModeOrigin {
        if self.to != Some(mode) && self.earlier != Some(mode) {
            return ModeOrigin::Others;
        }
        if now_s - self.accepted_s <= ACCEPTED_FOR_S {
            match self.accepted {
                Some(accepted) if accepted != mode => {}
                Some(_) => {
                    self.accepted_s = f64::NEG_INFINITY;
                    return ModeOrigin::Ours;
                }
                None => return ModeOrigin::Unknown,
            }
        }
        if !self.is_on_its_way(now_s) {
            return ModeOrigin::Others;
        }
        self.unanswered -= 1;
        ModeOrigin::Unknown
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
        assert_eq!(requests.origin(Mode::GUIDED, 6.5), ModeOrigin::Ours);
        assert_eq!(requests.origin(Mode::GUIDED, 6.5), ModeOrigin::Others);
        let mut requests = asked(1);
        requests.answered(true, 5.0);
        assert_eq!(requests.origin(Mode::GUIDED, 6.6), ModeOrigin::Others);
        let mut requests = asked(1);
        requests.answered(true, 5.0);
        assert_eq!(requests.origin(Mode::AUTO, 5.1), ModeOrigin::Others);
        assert_eq!(requests.origin(Mode::GUIDED, 5.2), ModeOrigin::Ours);
    }

    #[test]
    fn what_was_refused_is_nobodys() {
        let mut requests = asked(1);
        requests.answered(false, 5.0);
        assert_eq!(requests.origin(Mode::GUIDED, 5.1), ModeOrigin::Others);
    }

    #[test]
    fn each_request_without_an_answer_may_be_carried_out_once_within_thirty_seconds() {
        let mut requests = asked(2);
        assert_eq!(requests.origin(Mode::GUIDED, 30.4), ModeOrigin::Unknown);
        assert_eq!(requests.origin(Mode::GUIDED, 30.4), ModeOrigin::Unknown);
        assert_eq!(requests.origin(Mode::GUIDED, 30.4), ModeOrigin::Others);
        assert_eq!(asked(2).origin(Mode::GUIDED, 30.5), ModeOrigin::Others);
        assert_eq!(asked(0).origin(Mode::GUIDED, 0.0), ModeOrigin::Others);
        // A copy of an answer answers nothing.
        let mut requests = asked(1);
        requests.answered(true, 1.0);
        assert_eq!(requests.origin(Mode::GUIDED, 1.1), ModeOrigin::Ours);
        requests.answered(true, 1.2);
        assert_eq!(requests.origin(Mode::GUIDED, 1.3), ModeOrigin::Others);
    }

    #[test]
    fn a_mode_that_is_doubted_is_nobodys_for_thirty_seconds() {
        for (later_s, origin) in [(30.0, ModeOrigin::Unknown), (30.1, ModeOrigin::Others)] {
            let mut requests = Requests::NONE;
            requests.doubt(Mode::GUIDED, 0.0);
            requests.answered(true, later_s);
            requests.doubt(Mode::GUIDED, 0.0);
            assert_eq!(requests.origin(Mode::AUTO, 0.1), ModeOrigin::Others);
            assert_eq!(requests.origin(Mode::GUIDED, later_s), origin);
        }
    }

    #[test]
    fn an_answer_that_may_be_to_another_request_says_nothing() {
        let mut requests = asked(1);
        requests.asked(RETURN, 1.0);
        requests.answered(true, 1.1);
        assert_eq!(requests.origin(Mode::AUTO, 1.2), ModeOrigin::Unknown);
        // However long this program has run.
        let mut requests = Requests::NONE;
        requests.asked(TAKE, 20.0);
        requests.asked(RETURN, 30.0);
        requests.answered(true, 30.1);
        assert_eq!(requests.origin(Mode::AUTO, 30.2), ModeOrigin::Unknown);
        // Had the first one been answered, or been sent long ago, it would.
        let mut requests = asked(1);
        requests.answered(true, 0.1);
        requests.asked(RETURN, 1.0);
        requests.answered(true, 1.1);
        assert_eq!(requests.origin(Mode::AUTO, 1.2), ModeOrigin::Ours);
        let mut requests = asked(1);
        requests.asked(RETURN, 30.1);
        requests.answered(true, 30.2);
        assert_eq!(requests.origin(Mode::AUTO, 30.3), ModeOrigin::Ours);
    }

    /// A queue that ends delivers the newer request first, and the older one follows.
    #[test]
    fn a_request_that_a_newer_one_overtook_is_remembered() {
        for answers in 0..=2 {
            let mut requests = asked(2);
            requests.answered(true, 4.6);
            assert_eq!(requests.origin(Mode::GUIDED, 4.7), ModeOrigin::Ours);
            requests.asked(RETURN, 4.8);
            for _ in 0..answers {
                requests.answered(true, 5.0);
            }
            // The vehicle returns, and carries out the older request later.
            assert_eq!(requests.origin(Mode::AUTO, 5.1), ModeOrigin::Unknown);
            if answers == 1 {
                requests.answered(true, 7.9);
            }
            let late = if answers == 2 { 6.0 } else { 8.0 };
            assert_eq!(requests.origin(Mode::GUIDED, late), ModeOrigin::Unknown);
        }
    }

    #[test]
    fn an_answer_long_after_the_request_tells_nothing() {
        for (answered_s, origin) in [(30.0, ModeOrigin::Ours), (30.1, ModeOrigin::Unknown)] {
            let mut requests = asked(1);
            requests.answered(true, answered_s);
            assert_eq!(requests.origin(Mode::GUIDED, answered_s + 0.1), origin);
        }
    }
}
