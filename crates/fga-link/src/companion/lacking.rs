//! What is missing for a take-over, and which of it the operator has read.

use super::voice::Voice;
use crate::authority::Severity;

/// The companion reports what is missing after this long, s …
const LOST_S: f64 = 1.0;
/// … and if it was never ready, after this long, seconds.
const NEVER_READY_S: f64 = 8.0;

/// Another airspeed than at the beginning of a manoeuvre differs by more than this, as a share: load and gusts make less.
const OTHER_SPEED: f64 = 0.15;
/// Home has moved up or down when it did so by more than this, metres: altitudes of two sensors drift apart by less.
const HOME_MOVED_M: f64 = 10.0;

/// The missing conditions: how the operator reads each.
macro_rules! conditions {
    ($($condition:ident: $severity:ident, $words:literal;)*) => {
        /// A missing condition.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(super) enum Lacking {
            $($condition),*
        }

        impl Lacking {
            #[cfg(test)]
            const ALL: &[Self] = &[$(Self::$condition),*];

            /// What the operator reads, and how severe that is.
            const fn report(self) -> (Severity, &'static str) {
                match self {
                    $(Self::$condition => (Severity::$severity, concat!("fga: not ready: ", $words))),*
                }
            }
        }
    };
}

// The operator's own action is no news for the operator.
conditions! {
    Link: Warning, "no heartbeat";
    Contradiction: Warning, "heartbeats contradict";
    Rate: Warning, "telemetry comes too seldom";
    Telemetry: Warning, "no fresh telemetry";
    Disarmed: Info, "vehicle is disarmed";
    Height: Warning, "too low";
    Slow: Warning, "too slow to fly a turn";
    Mode: Info, "mode is not to be taken over";
    Mission: Warning, "mission is not known";
    TakeOffOrLanding: Info, "take-off or landing";
    FenceAction: Warning, "FENCE_ACTION uses GUIDED";
    Listens: Warning, "listens for other vehicles";
    TwoSenders: Warning, "two senders with one id";
    TwoVehicles: Warning, "two vehicles, set system_id";
    Limits: Warning, "vehicle's limits not known";
    OtherAvoider: Warning, "AVD_F_ACTION avoids by itself";
    SlowLink: Warning, "link answers too late";
    BankLimit: Warning, "bank limit cannot be flown";
    Decision: Warning, "no decision possible";
    FeedUnreadable: Warning, "traffic feed not understood";
    FeedSilent: Warning, "no traffic feed";
    Ground: Warning, "the ground is not made yet";
}

/// The reports about readiness and need.
#[derive(Debug, Clone, Copy, Default)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each report is made once, by itself"
)]
pub(super) struct OperatorReports {
    /// Missing now, and since when, seconds.
    lacking: Option<(Lacking, f64)>,
    /// Whether the operator has read that the companion is ready.
    ready: bool,
    /// The last report.
    last: Option<Lacking>,
    /// Whether the bank in need was reported, and a flight that is not the certified one.
    need: bool,
    missed: bool,
    /// Whether a home that moved in the manoeuvre was reported, another airspeed, a fence that it left.
    home: bool,
    speed: bool,
    fence: bool,
    /// The airspeed when the manoeuvre began, metres per second.
    begun_mps: Option<f64>,
    /// Whether an obstacle without a way round was reported.
    no_way: bool,
    /// Whether a failing airspeed sensor was reported, and since when it fails, seconds.
    airspeed: bool,
    airspeed_fails_s: Option<f64>,
}

impl OperatorReports {
    /// A manoeuvre begins.
    pub(super) const fn begin(&mut self) {
        (self.need, self.missed) = (false, false);
        (self.home, self.speed, self.fence) = (false, false, false);
        self.begun_mps = None;
    }

    /// Reports once in a manoeuvre that the airspeed is not the one of its beginning, metres per second.
    pub(super) fn flies_at(&mut self, mps: f64, voice: &mut Voice) {
        let begun_mps = *self.begun_mps.get_or_insert(mps);
        let is_other = (mps - begun_mps).abs() > OTHER_SPEED * begun_mps;
        if is_other && !core::mem::replace(&mut self.speed, true) {
            voice.warn(&format!(
                "fga: airspeed now {mps:.0} m/s, was {begun_mps:.0}"
            ));
        }
    }

    /// Reports once in a manoeuvre that it has left the fence.
    pub(super) fn outside_fence(&mut self, voice: &mut Voice) {
        if !core::mem::replace(&mut self.fence, true) {
            voice.warn("fga: outside the fence in the manoeuvre");
        }
    }

    /// Reports once in a manoeuvre that home has risen by this, metres.
    pub(super) fn home_moved(&mut self, rose_m: f64, voice: &mut Voice) {
        if rose_m.abs() > HOME_MOVED_M && !core::mem::replace(&mut self.home, true) {
            voice.warn(&format!("fga: home moved {rose_m:+.0} m, floor stays"));
        }
    }

    /// Reports once in a manoeuvre that it uses the bank in need.
    pub(super) fn need(&mut self, voice: &mut Voice) {
        if !core::mem::replace(&mut self.need, true) {
            voice.warn("fga: bank in need");
        }
    }

    /// Reports once in a manoeuvre that the flight is off what was certified, metres.
    pub(super) fn missed(&mut self, off_m: f64, voice: &mut Voice) {
        if !core::mem::replace(&mut self.missed, true) {
            voice.warn(&format!("fga: {off_m:.0} m off what was certified"));
        }
    }

    /// Takes the name of an obstacle without a way round, if there is one, and reports the first.
    pub(super) fn no_way(&mut self, round: Option<String>, voice: &mut Voice) {
        let was_told = core::mem::replace(&mut self.no_way, round.is_some());
        if let Some(name) = round.filter(|_| !was_told) {
            voice.warn(&format!("fga: no way round {name} keeps it, not begun"));
        }
    }

    /// Reports once that ground speed and wind stand in for the airspeed sensor.
    pub(super) fn airspeed(&mut self, fails: bool, voice: &mut Voice) {
        let now_s = voice.now_s();
        if !fails {
            self.airspeed_fails_s = None;
            return;
        }
        // In a take-off run the airspeed comes after the ground speed.
        let since_s = *self.airspeed_fails_s.get_or_insert(now_s);
        if now_s - since_s >= LOST_S && !core::mem::replace(&mut self.airspeed, true) {
            voice.warn("fga: airspeed sensor fails, ground speed used");
        }
    }

    /// The companion is ready.
    pub(super) const fn ready(&mut self) {
        self.ready = true;
        self.last = None;
    }

    /// Reports to the operator of a vehicle a lost ability, or why it does not come.
    pub(super) fn lacking(&mut self, lacking: Option<Lacking>, voice: &mut Voice) {
        let now_s = voice.now_s();
        let Some(lacking) = lacking else {
            self.lacking = None;
            return;
        };
        let since_s = match self.lacking {
            Some((before, since_s)) if before == lacking => since_s,
            _ => now_s,
        };
        self.lacking = Some((lacking, since_s));
        let after_s = if self.ready { LOST_S } else { NEVER_READY_S };
        if now_s - since_s >= after_s && self.last != Some(lacking) {
            self.ready = false;
            self.last = Some(lacking);
            let (severity, words) = lacking.report();
            voice.tell(severity, words);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_fits_into_one_message() {
        for lacking in Lacking::ALL {
            assert!(lacking.report().1.len() <= 50, "{lacking:?}");
        }
    }

    #[test]
    fn what_is_missing_is_told_once_after_a_while_and_sooner_where_it_was_there() {
        let (mut told, mut voice) = (OperatorReports::default(), Voice::default());
        let mut texts_at = |lacking, now_s| {
            told.lacking(lacking, voice.at(now_s));
            voice.texts()
        };
        let rate = Some(Lacking::Rate);
        assert_eq!(texts_at(rate, 0.0), 0);
        assert_eq!(texts_at(rate, 7.9), 0);
        assert_eq!(texts_at(rate, 8.0), 1);
        assert_eq!(texts_at(rate, 20.0), 1, "once");
        assert_eq!(texts_at(None, 21.0), 1);
        told.ready();
        let mut texts_at = |lacking, now_s| {
            told.lacking(lacking, voice.at(now_s));
            voice.texts()
        };
        assert_eq!(texts_at(rate, 30.0), 1);
        assert_eq!(texts_at(rate, 31.0), 2);
    }
}
