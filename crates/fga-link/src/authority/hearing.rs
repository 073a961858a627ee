//! The mode that the vehicle itself reports, and whether the program may command another one now.
//!
//! Only this code decides it. The companion, the watchdog and the thread that sends each ask [`Hearing::permits`]: a
//! command of a mode is only an answer to a heartbeat that has just reported the mode which the command leaves. So a
//! mode that the pilot chose meanwhile stays, whichever thread sends the command and after whatever pause.
//!
//! Heartbeats of one system may contradict each other: somebody else sends under its id. Then the mode that
//! differs from the believed one counts, because it may be the pilot's, and the program commands nothing
//! until they have agreed for a while.

use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{HEARTBEAT_DATA, MavAutopilot, MavModeFlag, MavType};

use crate::clock::{BootClock, BootStamp};
use crate::mode::{Mode, ModeChange};
use crate::outgoing::AUTOPILOT;

/// A heartbeat with a lower sequence number this soon after another was overtaken by it, seconds.
pub(super) const OVERTAKEN_S: f64 = 0.45;
/// Two apparently overtaken heartbeats that report the same other mode within this time contradict, seconds.
const SUSPECT_S: f64 = 1.5;
/// This many changes of the mode, or of the armed flag, within this time contradict, seconds: no switch
/// moves that fast.
const CHANGES: usize = 3;
const CHANGES_S: f64 = 2.0;
/// After a contradiction heartbeats count again after this time without another, seconds.
const QUIET_S: f64 = 3.0;
/// Number of intervals between heartbeats, of which the longest counts.
const INTERVALS: usize = 4;
/// Shortest and longest assumed interval, seconds.
const SHORTEST_INTERVAL_S: f64 = 0.25;
const LONGEST_INTERVAL_S: f64 = 1.1;
/// A mode is known for this many intervals after its heartbeat, and this time for the network, seconds.
const FRESH_INTERVALS: f64 = 1.5;
const FRESH_S: f64 = 0.15;
/// Telemetry that is later than this comes from a queue: its modes are history, seconds.
const LATE_S: f64 = 1.0;
/// The mode in a heartbeat, and its sequence number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Beat {
    /// Sequence number of the frame.
    pub sequence: u8,
    /// The mode.
    pub mode: Mode,
    /// Whether the armed flag is set.
    pub armed: bool,
}

impl Beat {
    /// The heartbeat of a fixed-wing autopilot; `None` for all others.
    pub fn of_plane(header: MavHeader, data: &HEARTBEAT_DATA) -> Option<Self> {
        let is_plane = data.autopilot == MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA
            && matches!(data.mavtype, MavType::MAV_TYPE_FIXED_WING)
            && header.component_id == AUTOPILOT;
        is_plane.then_some(Self {
            sequence: header.sequence,
            mode: Mode(data.custom_mode),
            armed: data
                .base_mode
                .contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED),
        })
    }

    const fn reports_the_same(self, other: Self) -> bool {
        self.mode.0 == other.mode.0 && self.armed == other.armed
    }
}

/// The relation of a heartbeat to the earlier ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BeatOrder {
    /// The newest one.
    New,
    /// A newer one came before it, or it is a copy: it has no meaning.
    Overtaken,
    /// It is the newest one, but contradicts the earlier ones: two senders use one system id.
    Contradicts,
}

/// The knowledge about the vehicle's mode.
#[derive(Debug, Clone)]
pub struct Hearing {
    last: Option<(Beat, f64)>,
    /// The heartbeat before the last one.
    before: Option<Beat>,
    intervals_s: [f64; INTERVALS],
    mode_changes_s: [f64; CHANGES],
    armed_changes_s: [f64; CHANGES],
    suspect: Option<(Beat, f64)>,
    /// The last requested mode, until a heartbeat reports it.
    asked: Option<Mode>,
    contradicted_s: f64,
    clock: BootClock,
    late_s: f64,
}

impl Default for Hearing {
    fn default() -> Self {
        Self {
            last: None,
            before: None,
            intervals_s: [LONGEST_INTERVAL_S; INTERVALS],
            mode_changes_s: [f64::NEG_INFINITY; CHANGES],
            armed_changes_s: [f64::NEG_INFINITY; CHANGES],
            suspect: None,
            asked: None,
            contradicted_s: f64::NEG_INFINITY,
            clock: BootClock::default(),
            late_s: 0.0,
        }
    }
}

impl Hearing {
    /// Takes a heartbeat of the vehicle.
    pub fn hear(&mut self, beat: Beat, now_s: f64) -> BeatOrder {
        let Some((last, last_s)) = self.last else {
            self.accept(beat, now_s);
            return BeatOrder::New;
        };
        let behind = last.sequence.wrapping_sub(beat.sequence);
        if now_s - last_s < OVERTAKEN_S && behind < 128 {
            if last.reports_the_same(beat) || self.was_passed(beat) {
                return BeatOrder::Overtaken;
            }
            let again = self.suspect.is_some_and(|(suspect, since_s)| {
                suspect.reports_the_same(beat)
                    && suspect.sequence != beat.sequence
                    && now_s - since_s <= SUSPECT_S
            });
            if !again {
                self.suspect = Some((beat, now_s));
                return BeatOrder::Overtaken;
            }
            self.contradicted_s = now_s;
        }
        // The first report of a requested mode is no change by others.
        let changed = last.mode != beat.mode && self.asked.take_if(|to| *to == beat.mode).is_none();
        let too_often = (changed && too_many(&mut self.mode_changes_s, now_s))
            | (last.armed != beat.armed && too_many(&mut self.armed_changes_s, now_s));
        if too_often {
            self.contradicted_s = now_s;
        }
        self.accept(beat, now_s);
        if self.contradicted_s == now_s {
            BeatOrder::Contradicts
        } else {
            BeatOrder::New
        }
    }

    /// Whether the vehicle passed through the mode of an overtaken heartbeat between the last two, which report two other modes.
    fn was_passed(&self, overtaken: Beat) -> bool {
        let (Some(before), Some((last, _))) = (self.before, self.last) else {
            return false;
        };
        ![last, overtaken]
            .iter()
            .any(|beat| before.reports_the_same(*beat))
            && overtaken.sequence.wrapping_sub(before.sequence) < 128
    }

    fn accept(&mut self, beat: Beat, now_s: f64) {
        if let Some((last, last_s)) = self.last {
            self.before = Some(last);
            self.intervals_s.rotate_left(1);
            if let Some(newest_s) = self.intervals_s.last_mut() {
                *newest_s = now_s - last_s;
            }
        }
        self.last = Some((beat, now_s));
    }

    /// Takes the vehicle's boot time of a regular message, which shows how late the link is.
    pub fn stamp(&mut self, boot_ms: u32, now_s: f64) {
        match self.clock.stamp(boot_ms, now_s) {
            BootStamp::New { measured_s } | BootStamp::Restarted { measured_s } => {
                self.late_s = now_s - measured_s;
            }
            BootStamp::Old => {}
        }
    }

    /// Takes a round trip of the vehicle's clock ([`BootClock::round_trip`]).
    pub fn round_trip(&mut self, sent_s: f64, boot_s: f64, now_s: f64) {
        self.clock.round_trip(sent_s, boot_s, now_s);
    }

    /// The last reported mode.
    pub fn mode(&self) -> Option<Mode> {
        self.last.map(|(beat, _)| beat.mode)
    }

    /// Whether the vehicle is armed: a single heartbeat that says otherwise does not count.
    pub fn is_armed(&self) -> bool {
        let was_armed = self.before.is_some_and(|before| before.armed);
        self.last.is_some_and(|(beat, _)| beat.armed || was_armed)
    }

    /// Time of the last heartbeat, seconds.
    pub fn heard_s(&self) -> Option<f64> {
        self.last.map(|(_, heard_s)| heard_s)
    }

    /// Whether heartbeats have contradicted each other lately.
    pub fn is_contradicted(&self, now_s: f64) -> bool {
        now_s - self.contradicted_s < QUIET_S
    }

    /// How long a heartbeat is valid for the present mode, seconds.
    fn fresh_s(&self) -> f64 {
        let longest_s = self.intervals_s.iter().copied().fold(0.0, f64::max);
        FRESH_INTERVALS * longest_s.clamp(SHORTEST_INTERVAL_S, LONGEST_INTERVAL_S) + FRESH_S
    }

    /// Whether the vehicle's present mode is known.
    pub fn is_sure(&self, now_s: f64) -> bool {
        let fresh = self
            .heard_s()
            .is_some_and(|heard_s| now_s - heard_s <= self.fresh_s());
        let doubted = self
            .suspect
            .is_some_and(|(_, since_s)| now_s - since_s < OVERTAKEN_S);
        fresh && !doubted && !self.is_contradicted(now_s) && self.late_s <= LATE_S
    }

    /// Whether the program may now send a command that takes the vehicle out of the mode `from`.
    pub fn permits(&self, from: Mode, now_s: f64) -> bool {
        self.mode() == Some(from) && self.is_sure(now_s)
    }

    /// Whether the program may now command a change of the mode. If so, it counts as commanded: the
    /// heartbeat that reports it does not contradict the earlier ones.
    pub fn ask(&mut self, change: ModeChange, now_s: f64) -> bool {
        let may = self.permits(change.from, now_s);
        if may {
            self.asked = Some(change.to);
        }
        may
    }

    /// Forgets everything before a pause of this program: the next heartbeat counts as the first.
    pub fn forget(&mut self) {
        self.last = None;
        self.suspect = None;
    }
}

/// Whether a change now is one too many.
fn too_many(changes_s: &mut [f64; CHANGES], now_s: f64) -> bool {
    changes_s.rotate_left(1);
    if let Some(newest_s) = changes_s.last_mut() {
        *newest_s = now_s;
    }
    changes_s
        .first()
        .is_some_and(|first_s| now_s - first_s <= CHANGES_S)
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn beat(sequence: u8, mode: Mode) -> Beat {
        Beat {
            sequence,
            mode,
            armed: true,
        }
    }

    /// Four heartbeats a second in a mode, the last one at 2 s with sequence 80.
    fn steady(mode: Mode) -> Hearing {
        let mut hearing = Hearing::default();
        for n in 0_u8..=8 {
            hearing.hear(beat(10 * n, mode), 0.25 * f64::from(n));
        }
        hearing
    }

    #[test]
    fn a_mode_is_left_only_while_the_vehicle_tells_it() {
        assert!(!Hearing::default().permits(Mode::GUIDED, 0.0));
        let mut hearing = steady(Mode::GUIDED);
        assert!(hearing.permits(Mode::GUIDED, 2.0));
        assert!(hearing.permits(Mode::GUIDED, 2.5));
        assert!(!hearing.permits(Mode::AUTO, 2.0));
        assert!(!hearing.permits(Mode::GUIDED, 2.6), "nobody knows any more");
        assert_eq!(hearing.hear(beat(90, Mode(0)), 2.25), BeatOrder::New);
        assert!(!hearing.permits(Mode::GUIDED, 2.25));
        hearing.forget();
        assert!(!hearing.permits(Mode(0), 2.25));
    }

    /// An earlier version saw a contradiction when both directions of the link were cut during the take-over:
    /// it requested GUIDED, AUTO and GUIDED again, and heard all three within a second.
    #[test]
    fn changes_that_were_asked_for_do_not_contradict() {
        let change = |from, to| ModeChange { from, to };
        let mut hearing = steady(Mode::AUTO);
        assert!(hearing.ask(change(Mode::AUTO, Mode::GUIDED), 2.1));
        assert_eq!(hearing.hear(beat(120, Mode::GUIDED), 7.0), BeatOrder::New);
        assert!(hearing.ask(change(Mode::GUIDED, Mode::AUTO), 7.1));
        assert_eq!(hearing.hear(beat(130, Mode::AUTO), 7.25), BeatOrder::New);
        assert!(hearing.ask(change(Mode::AUTO, Mode::GUIDED), 7.3));
        assert_eq!(hearing.hear(beat(140, Mode::GUIDED), 7.5), BeatOrder::New);
        // Each only once, and nothing that was not asked for.
        hearing.hear(beat(150, Mode::AUTO), 7.75);
        hearing.hear(beat(160, Mode::GUIDED), 8.0);
        assert_eq!(
            hearing.hear(beat(170, Mode::AUTO), 8.25),
            BeatOrder::Contradicts
        );
        assert!(!hearing.ask(change(Mode::AUTO, Mode::GUIDED), 8.3));
    }

    #[test]
    fn rare_and_lost_heartbeats_are_waited_for() {
        let mut hearing = Hearing::default();
        for n in 0_u8..6 {
            hearing.hear(beat(n, Mode::AUTO), f64::from(n));
        }
        assert!(hearing.permits(Mode::AUTO, 6.6));
        assert!(!hearing.permits(Mode::AUTO, 6.9));
        // Once a second counts for a while after they come four times a second.
        for n in 0_u8..3 {
            hearing.hear(beat(6 + n, Mode::AUTO), 5.25 + 0.25 * f64::from(n));
        }
        assert!(hearing.permits(Mode::AUTO, 7.2));
        hearing.hear(beat(9, Mode::AUTO), 6.0);
        assert!(!hearing.permits(Mode::AUTO, 6.6));
    }

    #[test]
    fn heartbeats_out_of_a_queue_are_history() {
        let mut hearing = steady(Mode::GUIDED);
        hearing.stamp(60_000, 2.0);
        // The program was stopped for 20 s; what comes first is what it missed.
        hearing.stamp(60_100, 22.0);
        hearing.hear(beat(90, Mode::GUIDED), 22.0);
        assert!(!hearing.permits(Mode::GUIDED, 22.0));
        hearing.stamp(80_050, 22.05);
        hearing.hear(beat(95, Mode::GUIDED), 22.05);
        assert!(hearing.permits(Mode::GUIDED, 22.05));
    }

    #[test]
    fn an_overtaken_heartbeat_says_nothing() {
        let mut hearing = steady(Mode::AUTO);
        assert_eq!(hearing.hear(beat(90, Mode::GUIDED), 2.05), BeatOrder::New);
        assert_eq!(
            hearing.hear(beat(89, Mode::AUTO), 2.1),
            BeatOrder::Overtaken
        );
        assert_eq!(
            hearing.hear(beat(89, Mode::AUTO), 2.1),
            BeatOrder::Overtaken
        );
        assert_eq!(hearing.mode(), Some(Mode::GUIDED));
        // Until it is out of sight nothing is commanded.
        assert!(!hearing.permits(Mode::GUIDED, 2.1));
        assert_eq!(hearing.hear(beat(100, Mode::GUIDED), 2.5), BeatOrder::New);
        assert!(hearing.permits(Mode::GUIDED, 2.6));
        assert!(!hearing.is_contradicted(2.6));
    }

    #[test]
    fn the_pilots_mode_is_seen_among_forged_heartbeats_in_every_order_of_numbers() {
        for ahead in [1_u8, 20, 64, 100, 127, 128, 150, 200, 255] {
            let mut hearing = steady(Mode::GUIDED);
            let mut seen_s = f64::INFINITY;
            for n in 0_u8..40 {
                let now_s = 2.05 + 0.1 * f64::from(n);
                let sequence = 80 + 4 * n;
                hearing.hear(beat(sequence.wrapping_add(ahead), Mode::GUIDED), now_s);
                // The true ones, four a second, report MANUAL.
                if n % 3 == 1 {
                    let verdict = hearing.hear(beat(sequence, Mode(0)), now_s + 0.05);
                    if verdict != BeatOrder::Overtaken {
                        seen_s = seen_s.min(now_s);
                        assert_eq!(hearing.mode(), Some(Mode(0)));
                    }
                }
            }
            assert!(seen_s < 3.0, "{ahead}: {seen_s}");
            assert!(hearing.is_contradicted(6.0), "{ahead}");
            assert!(!hearing.permits(Mode::GUIDED, 6.0));
            assert!(!hearing.permits(Mode(0), 6.0));
        }
    }

    #[test]
    fn a_pilot_who_moves_the_switch_twice_contradicts_nobody() {
        let mut hearing = steady(Mode::AUTO);
        hearing.hear(beat(90, Mode(5)), 2.25);
        hearing.hear(beat(100, Mode(0)), 2.5);
        assert!(!hearing.is_contradicted(2.5));
        // Three times within two seconds is too fast, a change after that time is not.
        hearing.hear(beat(110, Mode(5)), 4.3);
        assert!(!hearing.is_contradicted(4.3));
        assert_eq!(
            hearing.hear(beat(120, Mode(0)), 4.45),
            BeatOrder::Contradicts
        );
        assert!(hearing.is_contradicted(7.4));
        assert!(!hearing.is_contradicted(7.5));
    }

    #[test]
    fn one_disarmed_heartbeat_is_not_believed() {
        let mut hearing = steady(Mode::GUIDED);
        let disarmed = |sequence| Beat {
            armed: false,
            ..beat(sequence, Mode::GUIDED)
        };
        hearing.hear(disarmed(90), 2.25);
        assert!(hearing.is_armed());
        hearing.hear(beat(100, Mode::GUIDED), 2.5);
        assert!(hearing.is_armed());
        hearing.hear(disarmed(110), 4.75);
        hearing.hear(disarmed(120), 5.0);
        assert!(!hearing.is_armed());
        // A vehicle that was never armed is not armed by default.
        let mut hearing = Hearing::default();
        hearing.hear(disarmed(0), 0.0);
        assert!(!hearing.is_armed());
    }

    /// The vehicle passes through a mode, and the network delivers the next one first.
    #[test]
    fn a_mode_that_was_passed_contradicts_only_where_the_mode_did_not_change() {
        for (mode, verdict) in [
            (Mode::AUTO, BeatOrder::Overtaken),
            (Mode::GUIDED, BeatOrder::Contradicts),
        ] {
            let mut hearing = steady(Mode::GUIDED);
            hearing.hear(beat(100, mode), 2.25);
            assert_eq!(hearing.hear(beat(85, Mode::RTL), 2.3), BeatOrder::Overtaken);
            assert_eq!(hearing.hear(beat(90, Mode::RTL), 2.35), verdict);
            assert_eq!(hearing.permits(mode, 2.35), verdict == BeatOrder::Overtaken);
        }
    }

    /// Now and then a frame under an old number says something else: only two soon after each other contradict.
    #[test]
    fn overtaken_heartbeats_of_another_mode_contradict_only_soon_after_each_other() {
        for (later, verdict) in [(4, BeatOrder::Contradicts), (8, BeatOrder::Overtaken)] {
            let mut hearing = Hearing::default();
            let mut heard = BeatOrder::New;
            for n in 0_u8..=100 {
                let now_s = 0.25 * f64::from(n);
                hearing.hear(beat(n, Mode::AUTO), now_s);
                if n == 80 || n == 80 + later {
                    heard = hearing.hear(beat(n - 20, Mode(0)), now_s + 0.05);
                }
            }
            assert_eq!(heard, verdict, "{later}");
        }
    }

    #[test]
    fn mode_and_armed_flag_that_change_together_contradict() {
        let mut hearing = steady(Mode::AUTO);
        let verdicts = [
            (90, Mode(0), false),
            (100, Mode::AUTO, true),
            (110, Mode(0), false),
        ]
        .map(|(sequence, mode, armed)| {
            let beat = Beat {
                sequence,
                mode,
                armed,
            };
            hearing.hear(beat, 0.025 * f64::from(sequence))
        });
        assert_eq!(
            verdicts,
            [BeatOrder::New, BeatOrder::New, BeatOrder::Contradicts]
        );
    }

    #[test]
    fn a_round_trip_shows_that_a_clock_stood_still() {
        let mut hearing = steady(Mode::AUTO);
        for n in 0_u32..20 {
            hearing.stamp(100 * n, 0.1 * f64::from(n));
        }
        hearing.stamp(2000, 3.6);
        hearing.hear(beat(90, Mode::AUTO), 3.6);
        assert!(!hearing.is_sure(3.6), "it may come from a queue");
        hearing.round_trip(3.6, 2.01, 3.62);
        hearing.stamp(2100, 3.7);
        assert!(hearing.is_sure(3.7));
    }
}
