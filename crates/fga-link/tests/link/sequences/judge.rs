//! Watches from outside of the companion for what must never happen.

use fga_emulator::Mode;
use fga_link::authority::Authority;

use super::Rig;
use super::plan::Fault;

/// The companion reports a lost ability within this, s.
const TOLD_WITHIN_S: f64 = 3.0;

/// The watched facts, and their start.
pub struct Judge {
    /// The pilot's last mode, and when it was chosen, seconds.
    pub pilot: Option<(Mode, f64)>,
    /// Arrival of a true heartbeat with it at the program.
    pub known_s: Option<f64>,
    pub telemetry_s: f64,
    pub able: bool,
    pub lost_s: f64,
    pub told_s: f64,
    pub failures: Vec<String>,
}

impl Rig {
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
        let owns = matches!(
            self.companion.authority(),
            Authority::Taking { .. } | Authority::InCommand { .. } | Authority::Returning { .. }
        );
        let texts = &self.texts;
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
        let outlived = self.emulator.mode() == Mode::Guided && !owns && !left_to_pilot;
        if outlived {
            let texts = format!("GUIDED is nobody's: {texts:?}");
            self.fail(texts);
        }
    }
}
