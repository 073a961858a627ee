//! The paper's keyboard script: keys become stick positions and modes.
//!
//! | key | does |
//! |---|---|
//! | left, right arrow or `a`, `d` | roll stick a step to that side |
//! | up, down arrow or `w`, `s` | pitch stick a step (down is up, as in the air) |
//! | `+`, `-` | throttle stick a step |
//! | `c` or space | roll and pitch centred |
//! | `1` to `5` | mode FBWA, FBWB, CRUISE, AUTO, RTL |
//! | `x` | give the channels back to the transmitter |
//! | `q` | give them back and end |

use mavlink::dialects::ardupilotmega::MavMessage;

use crate::commands::VehicleCommand;
use crate::hand::sticks::override_message;
use crate::mode::Mode;

/// A step of a stick, microseconds.
const STEP_US: u16 = 50;

/// Stick positions, microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sticks {
    /// Roll; above 1500 is right.
    pub roll_us: u16,
    /// Pitch.
    pub pitch_us: u16,
    /// Throttle.
    pub throttle_us: u16,
}

impl Default for Sticks {
    fn default() -> Self {
        Self {
            roll_us: 1500,
            pitch_us: 1500,
            throttle_us: 1500,
        }
    }
}

/// The effect of a key besides moving a stick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KeyEffect {
    /// Nothing more.
    Nothing,
    /// A mode.
    Mode(Mode),
    /// The end.
    Quit,
}

/// Keys to sticks.
#[derive(Debug, Clone, Default)]
pub struct Keyboard {
    sticks: Option<Sticks>,
    /// Bytes of an escape sequence so far.
    escape: u8,
}

fn moved(value: u16, up: bool) -> u16 {
    if up { value + STEP_US } else { value - STEP_US }.clamp(1000, 2000)
}

impl Keyboard {
    /// The held sticks; `None` while the transmitter has them.
    pub const fn sticks(&self) -> Option<Sticks> {
        self.sticks
    }

    /// Takes a byte from the terminal.
    pub fn take(&mut self, byte: u8) -> KeyEffect {
        match (self.escape, byte) {
            (0, 0x1B) => {
                self.escape = 1;
                return KeyEffect::Nothing;
            }
            (1, b'[' | b'O') => {
                self.escape = 2;
                return KeyEffect::Nothing;
            }
            (2, letter) => {
                self.escape = 0;
                let key = match letter {
                    b'A' => b'w',
                    b'B' => b's',
                    b'C' => b'd',
                    b'D' => b'a',
                    _ => return KeyEffect::Nothing,
                };
                return self.key(key);
            }
            _ => self.escape = 0,
        }
        self.key(byte)
    }

    fn key(&mut self, key: u8) -> KeyEffect {
        let mut sticks = self.sticks.unwrap_or_default();
        match key {
            b'a' => sticks.roll_us = moved(sticks.roll_us, false),
            b'd' => sticks.roll_us = moved(sticks.roll_us, true),
            b'w' => sticks.pitch_us = moved(sticks.pitch_us, false),
            b's' => sticks.pitch_us = moved(sticks.pitch_us, true),
            b'+' | b'=' => sticks.throttle_us = moved(sticks.throttle_us, true),
            b'-' => sticks.throttle_us = moved(sticks.throttle_us, false),
            b'c' | b' ' => (sticks.roll_us, sticks.pitch_us) = (1500, 1500),
            b'1' => return KeyEffect::Mode(Mode(5)),
            b'2' => return KeyEffect::Mode(Mode::FBWB),
            b'3' => return KeyEffect::Mode(Mode::CRUISE),
            b'4' => return KeyEffect::Mode(Mode::AUTO),
            b'5' => return KeyEffect::Mode(Mode::RTL),
            b'x' => {
                self.sticks = None;
                return KeyEffect::Nothing;
            }
            // End of text (Ctrl-C) and end of transmission (Ctrl-D) too.
            b'q' | 3 | 4 => {
                self.sticks = None;
                return KeyEffect::Quit;
            }
            _ => return KeyEffect::Nothing,
        }
        self.sticks = Some(sticks);
        KeyEffect::Nothing
    }

    /// The message that holds the sticks, or gives them back.
    pub fn message(&self, target_system: u8) -> MavMessage {
        let values = self.sticks.map(|s| [s.roll_us, s.pitch_us, s.throttle_us]);
        override_message(values, target_system)
    }
}

/// The message that asks for a mode, whichever the vehicle is in.
pub fn mode_message(mode: Mode, target_system: u8) -> MavMessage {
    VehicleCommand::set_mode(mode, mode).message(target_system, 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_and_arrows_move_the_sticks_and_stop_at_their_ends() {
        let mut keyboard = Keyboard::default();
        assert_eq!(keyboard.sticks(), None);
        for byte in b"\x1b[C\x1b[Cd" {
            keyboard.take(*byte);
        }
        assert_eq!(keyboard.sticks().unwrap().roll_us, 1650);
        for _ in 0..40 {
            keyboard.take(b'a');
        }
        assert_eq!(keyboard.sticks().unwrap().roll_us, 1000);
        keyboard.take(b' ');
        assert_eq!(keyboard.sticks().unwrap(), Sticks::default());
        assert_eq!(keyboard.take(b'4'), KeyEffect::Mode(Mode::AUTO));
        assert_eq!(keyboard.take(b'q'), KeyEffect::Quit);
        assert_eq!(keyboard.sticks(), None);
    }
}
