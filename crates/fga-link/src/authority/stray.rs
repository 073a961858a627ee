//! A request of our own that the vehicle carries out after the companion gave it up.
//!
//! On a slow link a request for a mode can reach the vehicle seconds after the companion gave it up: an older heartbeat
//! looks like a return, or the pilot or a failsafe has chosen a mode meanwhile. The vehicle numbers its frames, and so shows the
//! order in which it reported its modes and accepted requests, whatever the network did to that order: a mode that it reported next
//! after it accepted a request for it is ours. Where the answer was lost, request and choice look alike, and the companion asks the operator.

use super::hearing::OVERTAKEN_S;
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

/// The requests of ours that may still be on their way, and the vehicle's reports.
///
/// Requests for two modes can be on their way at once, and a queue that ends delivers the newer one first. An
/// answer does not say which of them the vehicle carried out: the mode that it reports next does.
#[derive(Debug)]
pub(super) struct Requests {
    /// The last requested mode.
    to: Option<Mode>,
    /// The mode of earlier requests that may still be carried out.
    earlier: Option<Mode>,
    asked_s: f64,
    unanswered: u8,
    /// The last frames in the order in which the vehicle sent them: the number of each, the reported mode, or `None` for an accepted
    /// request, and when it was heard, seconds.
    frames: Vec<(u8, Option<Mode>, f64)>,
}

impl Requests {
    pub(super) const NONE: Self = Self {
        to: None,
        earlier: None,
        asked_s: f64::NEG_INFINITY,
        unanswered: 0,
        frames: Vec::new(),
    };

    /// Whether the vehicle may still carry out a request.
    fn is_on_its_way(&self, now_s: f64) -> bool {
        self.unanswered > 0 && now_s - self.asked_s <= ON_ITS_WAY_S
    }

    /// Whether the vehicle may still carry out a request for a mode.
    pub(super) fn may_arrive(&self, mode: Mode, now_s: f64) -> bool {
        self.is_on_its_way(now_s) && self.is_for(mode)
    }

    fn is_for(&self, mode: Mode) -> bool {
        self.to == Some(mode) || self.earlier == Some(mode)
    }

    /// A request was sent.
    pub(super) fn asked(&mut self, to: Mode, now_s: f64) {
        if !self.is_on_its_way(now_s) {
            (self.earlier, self.unanswered) = (None, 0);
        } else if self.to != Some(to) {
            self.earlier = self.to;
        }
        self.to = Some(to);
        self.asked_s = now_s;
        self.unanswered = self.unanswered.saturating_add(1);
    }

    /// The vehicle answered a request in the frame of this number; `true` if that shows more of the last change of the mode.
    pub(super) fn answered(&mut self, number: u8, accepted: bool, now_s: f64) -> bool {
        let is_copy = |frame: &(u8, Option<Mode>, f64)| frame.0 == number && frame.1.is_none();
        if self.frames.iter().any(is_copy) {
            return false;
        }
        if now_s - self.asked_s > ON_ITS_WAY_S {
            // It may be forged: the request may still be on its way.
            self.asked_s = now_s;
            return false;
        }
        self.unanswered = self.unanswered.saturating_sub(1);
        accepted && self.heard(number, None, now_s)
    }

    /// The vehicle reported its mode, or with `None` accepted a request, in the frame of this number; `true` if that shows
    /// more of the last change of the mode.
    pub(super) fn heard(&mut self, number: u8, mode: Option<Mode>, now_s: f64) -> bool {
        self.frames
            .retain(|(_, mode, heard_s)| mode.is_some() || now_s - heard_s <= ACCEPTED_FOR_S);
        let before = self.last_change();
        let overtook = |(newer, _, heard_s): &(u8, Option<Mode>, f64)| {
            now_s - heard_s < OVERTAKEN_S && newer.wrapping_sub(number) < 128
        };
        let earlier = self.frames.iter().rposition(|frame| !overtook(frame));
        let place = earlier.map_or(0, |earlier| earlier + 1);
        self.frames.insert(place, (number, mode, now_s));
        // One byte numbers no more.
        if self.frames.len() > usize::from(u8::MAX) {
            self.frames.remove(0);
        }
        self.last_change() != before
    }

    /// The last change of the mode in the vehicle's order, and whether it accepted a request in between.
    pub(super) fn last_change(&self) -> Option<(ModeChange, bool)> {
        let (mut last, mut accepted) = (None, false);
        for (_, mode, _) in self.frames.iter().rev() {
            match (*mode, last) {
                (Some(from), Some(to)) if from != to => {
                    return Some((ModeChange { from, to }, accepted));
                }
                // What it accepts in the mode itself changes nothing.
                (Some(to), _) => (last, accepted) = (Some(to), false),
                (None, _) => accepted = true,
            }
        }
        None
    }

    /// The vehicle has left a mode, and no answer shows that it did so for a request of ours: if it reports the mode
    /// again, the heartbeat in between may have been somebody else's.
    pub(super) fn doubt(&mut self, mode: Mode, now_s: f64) {
        // The answer to the request that it may have carried out may still come.
        let earlier = self.to;
        self.asked(mode, now_s);
        self.earlier = self.earlier.or(earlier);
    }

    /// The vehicle has changed to a mode.
    pub(super) fn origin(&mut self, mode: Mode, now_s: f64) -> ModeOrigin {
        let last = self.last_change();
        let accepted = last.is_some_and(|(change, accepted)| change.to == mode && accepted);
        if accepted && self.is_for(mode) {
            return ModeOrigin::Ours;
        }
        if !self.may_arrive(mode, now_s) {
            return ModeOrigin::Others;
        }
        self.unanswered -= 1;
        ModeOrigin::Unknown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A vehicle that numbers its frames, and what is heard of it.
    struct Vehicle {
        requests: Requests,
        number: u8,
    }

    impl Vehicle {
        /// In AUTO, with requests for GUIDED on their way.
        fn asked(times: u8) -> Self {
            let mut vehicle = Self {
                requests: Requests::NONE,
                number: 250,
            };
            vehicle.reports(Mode::AUTO, 0.0);
            for n in 0..times {
                vehicle.requests.asked(Mode::GUIDED, 0.4 * f64::from(n));
            }
            vehicle
        }

        fn next(&mut self) -> u8 {
            self.number = self.number.wrapping_add(1);
            self.number
        }

        fn answers(&mut self, accepted: bool, now_s: f64) {
            let number = self.next();
            self.requests.answered(number, accepted, now_s);
        }

        fn reports(&mut self, mode: Mode, now_s: f64) -> ModeOrigin {
            let number = self.next();
            self.requests.heard(number, Some(mode), now_s);
            self.requests.origin(mode, now_s)
        }
    }

    #[test]
    fn what_was_accepted_is_ours_once_and_for_a_moment() {
        let mut vehicle = Vehicle::asked(1);
        vehicle.answers(true, 5.0);
        assert_eq!(vehicle.reports(Mode::GUIDED, 6.5), ModeOrigin::Ours);
        vehicle.reports(Mode::AUTO, 6.5);
        assert_eq!(vehicle.reports(Mode::GUIDED, 6.5), ModeOrigin::Others);
        let mut vehicle = Vehicle::asked(1);
        vehicle.answers(true, 5.0);
        assert_eq!(vehicle.reports(Mode::GUIDED, 6.6), ModeOrigin::Others);
        // Accepted in AUTO, which it reports after that.
        let mut vehicle = Vehicle::asked(1);
        vehicle.answers(true, 5.0);
        assert_eq!(vehicle.reports(Mode::AUTO, 5.1), ModeOrigin::Others);
        assert_eq!(vehicle.reports(Mode::GUIDED, 5.2), ModeOrigin::Others);
    }

    #[test]
    fn what_was_refused_is_nobodys() {
        let mut vehicle = Vehicle::asked(1);
        vehicle.answers(false, 5.0);
        assert_eq!(vehicle.reports(Mode::GUIDED, 5.1), ModeOrigin::Others);
    }

    #[test]
    fn each_request_without_an_answer_may_be_carried_out_once_within_thirty_seconds() {
        let mut vehicle = Vehicle::asked(2);
        assert_eq!(vehicle.reports(Mode::GUIDED, 30.4), ModeOrigin::Unknown);
        assert_eq!(vehicle.reports(Mode::GUIDED, 30.4), ModeOrigin::Unknown);
        assert_eq!(vehicle.reports(Mode::GUIDED, 30.4), ModeOrigin::Others);
        let late = Vehicle::asked(2).reports(Mode::GUIDED, 30.5);
        assert_eq!(late, ModeOrigin::Others);
        let unasked = Vehicle::asked(0).reports(Mode::GUIDED, 0.0);
        assert_eq!(unasked, ModeOrigin::Others);
        // A copy of an answer answers nothing.
        let mut vehicle = Vehicle::asked(2);
        vehicle.answers(true, 1.0);
        vehicle.requests.answered(vehicle.number, true, 1.1);
        vehicle.reports(Mode::GUIDED, 1.2);
        vehicle.reports(Mode::AUTO, 1.3);
        assert_eq!(vehicle.reports(Mode::GUIDED, 1.4), ModeOrigin::Unknown);
    }

    #[test]
    fn a_mode_that_is_doubted_is_nobodys_for_thirty_seconds() {
        for (later_s, origin) in [(30.0, ModeOrigin::Unknown), (30.1, ModeOrigin::Others)] {
            let mut vehicle = Vehicle::asked(0);
            vehicle.requests.doubt(Mode::GUIDED, 0.0);
            assert_eq!(vehicle.reports(Mode(0), 0.1), ModeOrigin::Others);
            assert_eq!(vehicle.reports(Mode::GUIDED, later_s), origin);
        }
    }

    /// A queue that ends delivers the newer request first, and the older one follows.
    #[test]
    fn a_request_that_a_newer_one_overtook_is_remembered() {
        for (answers, late) in [(0, ModeOrigin::Unknown), (1, ModeOrigin::Ours)] {
            let mut vehicle = Vehicle::asked(2);
            vehicle.answers(true, 4.6);
            assert_eq!(vehicle.reports(Mode::GUIDED, 4.7), ModeOrigin::Ours);
            vehicle.requests.asked(Mode::AUTO, 4.8);
            vehicle.answers(true, 5.0);
            assert_eq!(vehicle.reports(Mode::AUTO, 5.1), ModeOrigin::Ours);
            for _ in 0..answers {
                vehicle.answers(true, 7.9);
            }
            assert_eq!(vehicle.reports(Mode::GUIDED, 8.0), late);
        }
    }

    #[test]
    fn an_answer_long_after_the_request_tells_nothing() {
        for (answered_s, origin) in [(30.0, ModeOrigin::Ours), (30.1, ModeOrigin::Unknown)] {
            let mut vehicle = Vehicle::asked(1);
            vehicle.answers(true, answered_s);
            assert_eq!(vehicle.reports(Mode::GUIDED, answered_s + 0.1), origin);
        }
    }
}
