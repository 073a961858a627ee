//! When an avoider would fly: in the modes that it takes over from and flies in, and not while the aircraft takes off or
//! lands.
//!
//! Source: ArduPlane's mode numbers and the commands of the message set `common` of MAVLink.

/// CIRCLE, FBWB, CRUISE, AUTO, RTL, LOITER, `AVOID_ADSB`, GUIDED and THERMAL: a guidance loop holds height and airspeed.
const MODES: [u32; 9] = [1, 6, 7, 10, 11, 12, 14, 15, 24];
const AUTO: u32 = 10;
/// `NAV_LAND`, `NAV_TAKEOFF`, `NAV_VTOL_TAKEOFF` and `NAV_VTOL_LAND`.
const TAKE_OFF_OR_LAND: [u32; 4] = [21, 22, 84, 85];

/// What an avoider would fly of a log.
#[derive(Debug, Clone, Default)]
pub(super) struct Phases {
    mode: Option<u32>,
    command: Option<u32>,
    is_disarmed: bool,
    /// Modes, commands and arming as they came.
    words: Vec<(f64, Word)>,
    /// Changes: from then on it would fly, or not.
    changes: Vec<(f64, bool)>,
}

/// A mode, the command of the mission that is flown from then on, or whether the vehicle is armed.
#[derive(Debug, Clone, Copy)]
pub(super) enum Word {
    Mode(u32),
    Command(u32),
    Armed(bool),
}

impl Phases {
    /// The same with further commands of the mission, all in order of time.
    pub(super) fn with_commands(&self, commands: impl Iterator<Item = (f64, u32)>) -> Self {
        let mut words = self.words.clone();
        words.extend(commands.map(|(time_s, command)| (time_s, Word::Command(command))));
        words.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut all = Self::default();
        for (time_s, word) in words {
            all.take(time_s, word);
        }
        all
    }

    pub(super) fn take(&mut self, time_s: f64, word: Word) {
        self.words.push((time_s, word));
        match word {
            Word::Mode(mode) => self.mode = Some(mode),
            Word::Command(command) => self.command = Some(command),
            Word::Armed(is_armed) => self.is_disarmed = !is_armed,
        }
        // Without modes the log says nothing of them.
        let flies_in = self.mode.is_none_or(|mode| MODES.contains(&mode));
        let is_auto = self.mode.is_none_or(|mode| mode == AUTO);
        let command = self.command.filter(|_| is_auto);
        let near_ground = command.is_some_and(|command| TAKE_OFF_OR_LAND.contains(&command));
        let would_fly = flies_in && !near_ground && !self.is_disarmed;
        if self.changes.last().is_none_or(|last| last.1 != would_fly) {
            self.changes.push((time_s, would_fly));
        }
    }

    /// Whether an avoider would fly at a time. Before the first word of a log it is as after.
    pub(super) fn would_fly(&self, time_s: f64) -> bool {
        let before = self.changes.partition_point(|change| change.0 <= time_s);
        let change = before
            .checked_sub(1)
            .map_or(self.changes.first(), |at| self.changes.get(at));
        change.is_none_or(|change| change.1)
    }
}

/// Limits of the vehicle, by its own parameters.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Limits {
    /// Largest bank, radians.
    pub bank_rad: Option<f64>,
    /// Fastest climb and descent that its guidance flies, metres per second.
    pub climb_mps: Option<f64>,
    /// The same downwards.
    pub sink_mps: Option<f64>,
    /// Largest pitch angle, radians.
    pub pitch_max_rad: Option<f64>,
    /// Least pitch angle, radians, negative.
    pub pitch_min_rad: Option<f64>,
}

impl Limits {
    /// Takes over a parameter of ArduPlane or PX4; older versions have hundredths of degrees under other names.
    pub(super) fn take(&mut self, name: &str, value: f64) {
        if !value.is_finite() {
            return;
        }
        let (place, value) = match name {
            "ROLL_LIMIT_DEG" | "FW_R_LIM" => (&mut self.bank_rad, value.to_radians()),
            "LIM_ROLL_CD" => (&mut self.bank_rad, (value / 100.0).to_radians()),
            "TECS_CLMB_MAX" | "FW_T_CLMB_MAX" => (&mut self.climb_mps, value),
            "TECS_SINK_MAX" | "FW_T_SINK_MAX" => (&mut self.sink_mps, value),
            "PTCH_LIM_MAX_DEG" | "FW_P_LIM_MAX" => (&mut self.pitch_max_rad, value.to_radians()),
            "LIM_PITCH_MAX" => (&mut self.pitch_max_rad, (value / 100.0).to_radians()),
            "PTCH_LIM_MIN_DEG" | "FW_P_LIM_MIN" => (&mut self.pitch_min_rad, value.to_radians()),
            "LIM_PITCH_MIN" => (&mut self.pitch_min_rad, (value / 100.0).to_radians()),
            _ => return,
        };
        *place = Some(value);
    }
}
