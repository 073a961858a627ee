//! The recent bank commands, and the bank that they lead to.
//!
//! Between the measurement of an attitude and the moment at which the next command
//! takes effect lie some tenths of a second. Meanwhile the aircraft rolls to earlier commands, not only to
//! the last one, which has hardly arrived.

use alloc::collections::VecDeque;

use fga::vehicle::Response;

/// Older commands have no more effect, seconds.
const MEMORY_S: f64 = 12.0;
/// Most commands that are remembered.
const MOST: usize = 1024;

/// Commanded banks, oldest first.
#[derive(Debug, Clone, Default)]
pub struct Commanded(VecDeque<(f64, f64)>);

impl Commanded {
    /// Remembers a bank commanded at a time of the local clock, seconds and radians.
    pub fn push(&mut self, at_s: f64, bank_rad: f64) {
        while self.0.len() >= MOST || self.0.front().is_some_and(|row| at_s - row.0 > MEMORY_S) {
            self.0.pop_front();
        }
        self.0.push_back((at_s, bank_rad));
    }

    /// Forgets everything: somebody else flies.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// The last command before a time, radians.
    pub fn at(&self, at_s: f64) -> Option<f64> {
        let rows = self.0.iter().rev();
        rows.skip_while(|row| row.0 > at_s).map(|row| row.1).next()
    }

    /// The bank at `at_s` of an aircraft that had `bank_rad` at `measured_s`: each command takes
    /// effect after the dead time and acts with the lag; radians and seconds.
    pub fn bank_at(&self, bank_rad: f64, measured_s: f64, at_s: f64, response: &Response) -> f64 {
        let lag_s = response.bank_time_constant_s;
        let dead_s = response.dead_time_s;
        if lag_s <= 0.0 {
            return self.at(at_s - dead_s).unwrap_or(bank_rad);
        }
        let (mut bank_rad, mut from_s) = (bank_rad, measured_s);
        let mut follow = |target_rad: Option<f64>, until_s: f64| {
            if let Some(target_rad) = target_rad
                && until_s > from_s
            {
                bank_rad =
                    target_rad + (bank_rad - target_rad) * libm::exp((from_s - until_s) / lag_s);
            }
            from_s = from_s.max(until_s);
        };
        let mut target_rad = self.at(measured_s - dead_s);
        for (commanded_s, commanded_rad) in &self.0 {
            let effect_s = commanded_s + dead_s;
            if effect_s > measured_s && effect_s < at_s {
                follow(target_rad, effect_s);
                target_rad = Some(*commanded_rad);
            }
        }
        follow(target_rad, at_s);
        bank_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RESPONSE: Response = Response {
        dead_time_s: 0.2,
        bank_time_constant_s: 0.5,
        turn_rate_factor: 1.0,
    };

    #[test]
    fn each_command_counts_from_its_own_effect() {
        let mut commanded = Commanded::default();
        assert_eq!(commanded.bank_at(0.3, 1.0, 2.0, &RESPONSE), 0.3);
        commanded.push(1.0, 0.8);
        commanded.push(1.5, -0.8);
        // Nothing before 1.2 s; 0.5 s towards 0.8; then 0.3 s towards -0.8.
        assert_eq!(commanded.bank_at(0.3, 1.0, 1.2, &RESPONSE), 0.3);
        let turning = 0.8 - 0.5 * (-1.0_f64).exp();
        assert!((commanded.bank_at(0.3, 1.0, 1.7, &RESPONSE) - turning).abs() < 1e-12);
        let back = -0.8 + (turning + 0.8) * (-0.6_f64).exp();
        assert!((commanded.bank_at(0.3, 1.0, 2.0, &RESPONSE) - back).abs() < 1e-12);
        // Measured later, the rest only.
        assert!((commanded.bank_at(turning, 1.7, 2.0, &RESPONSE) - back).abs() < 1e-12);
    }

    #[test]
    fn old_commands_are_forgotten() {
        let mut commanded = Commanded::default();
        for n in 0..10_000 {
            commanded.push(f64::from(n) * 1e-3, 0.1);
        }
        assert!(commanded.0.len() <= MOST);
        assert_eq!(commanded.at(0.0), None);
        assert_eq!(commanded.at(20.0), Some(0.1));
    }
}
