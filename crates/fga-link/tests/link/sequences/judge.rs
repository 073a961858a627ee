//! Watches from outside of the companion for what must never happen.

use fga_emulator::PlaneMode;
use fga_link::authority::Authority;

use super::Rig;
use super::plan::{Fault, Planned};

/// The companion reports a lost ability within this, s.
const TOLD_WITHIN_S: f64 = 3.0;

/// A track lasts this long after its last report, and a request for a mode is on its way for a while, s.
const LONGEST_TRACK_S: f64 = 30.0;

/// The watched facts, and their start.
pub struct Judge {
    /// The pilot's last mode, and when it was chosen, seconds.
    pub pilot: Option<(PlaneMode, f64)>,
    /// Arrival of a true heartbeat with it at the program.
    pub known_s: Option<f64>,
    pub telemetry_s: f64,
    pub able: bool,
    pub lost_s: f64,
    pub told_s: f64,
    pub failures: Vec<String>,
    /// The last report of traffic, seconds.
    pub reported_s: f64,
    /// Changes of the mode looked at.
    pub changes: usize,
}

impl Rig {
    /// The mode is taken only for traffic, never for a fence.
    pub fn judge_changes(&mut self) {
        let changes = self.emulator.mode_changes().iter().skip(self.judge.changes);
        let taken = changes
            .filter(|change| change.mode == PlaneMode::Guided && change.component_id == 196)
            .count();
        self.judge.changes = self.emulator.mode_changes().len();
        if taken > 0 && self.time_s - self.judge.reported_s > LONGEST_TRACK_S {
            self.fail("GUIDED without traffic".to_owned());
        }
    }

    /// A command of the mission runs, or the operator reads that it does not.
    fn judge_commands(&mut self) {
        if self.emulator.mode() != PlaneMode::Auto {
            // What waits for AUTO runs then.
            return;
        }
        let ran = self.emulator.items_run();
        // Odd items are commands; those up to the first flown one ran before.
        let lost: Vec<u16> = (3..self.emulator.mission_item())
            .filter(|item| item % 2 == 1)
            .filter(|item| !ran.iter().any(|(_, ran)| ran == item))
            .filter(|item| {
                let words = format!("fga: item {item} not run: DO_SET_SERVO");
                !self.texts.contains(&words)
            })
            .collect();
        if !lost.is_empty() {
            self.fail(format!("commands vanished: {lost:?}"));
        }
    }

    pub fn judge(&mut self) {
        let state = self.companion.authority();
        let able = matches!(
            state,
            Authority::Ready
                | Authority::Taking { .. }
                | Authority::InCommand { .. }
                | Authority::Returning { .. }
        );
        if self.judge.able && !able {
            self.judge.lost_s = self.time_s;
        }
        if able || self.is_on(Fault::Stalled) {
            self.judge.able = able;
            self.judge.lost_s = self.time_s;
            return;
        }
        if self.judge.able && self.time_s - self.judge.lost_s > TOLD_WITHIN_S {
            self.judge.able = false;
            if self.judge.told_s < self.judge.lost_s - 1.5 {
                self.fail(format!("silence about {}", state.name()));
            }
        }
    }

    /// Conditions that must hold long after all faults.
    pub fn at_the_end(&mut self) {
        self.judge_commands();
        let owns = matches!(
            self.companion.authority(),
            Authority::Taking { .. } | Authority::InCommand { .. } | Authority::Returning { .. }
        );
        let texts = &self.texts;
        // It ended before it could restore the mode: the note is left.
        let is_forged = |row: &Planned| matches!(row.fault, Fault::Forged(..));
        let owns = owns
            || self.ends_s.is_some()
                && (self.companion.owed().is_some()
                    // A forged heartbeat said that the mode was restored.
                    || self.planned.iter().any(is_forged));
        // Tasks given to the operator remain the operator's.
        let left_to_pilot = texts.iter().any(|text| {
            [
                "fga: mode changed by others, released",
                "fga: heartbeats contradict, released",
                "fga: mode not restored, pilot must set it",
                "fga: autopilot restarted, released",
                "fga: an old note of a manoeuvre, mode left alone",
                "fga: mode is perhaps our late request: set one",
            ]
            .contains(&text.as_str())
        });
        let outlived = self.emulator.mode() == PlaneMode::Guided && !owns && !left_to_pilot;
        if outlived {
            let texts = format!("GUIDED is nobody's: {texts:?}");
            self.fail(texts);
        }
    }
}
