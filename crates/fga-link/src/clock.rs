//! When was it measured? The vehicle's time since boot on this computer's clock.
//!
//! Each message arrives later than it was measured, by a delay that varies. The least of
//! "arrival − boot time" is the offset of the clocks plus the shortest delay; it is tracked with a
//! slow leak, so that clocks that drift apart are followed. A boot time that falls back far and
//! stays there is a restart; one that falls back a little is a message out of order.

/// How fast the offset may grow: 200 parts per million of drift.
const LEAK: f64 = 2e-4;
/// A boot time this far behind the newest is no reordering, seconds.
const RESTART_GAP_S: f64 = 3.0;
/// So many in a row are believed.
const RESTART_COUNT: u8 = 3;
/// Boot times run over after 2³² milliseconds.
const WRAP_S: f64 = 4_294_967.296;

/// What a boot time says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stamp {
    /// Measured at this time of the local clock, seconds; newer than any before.
    New {
        /// Seconds, local clock.
        measured_s: f64,
    },
    /// A message that was overtaken by a newer one, or a copy; not to be used.
    Old,
    /// The vehicle started anew.
    Restarted {
        /// Seconds, local clock.
        measured_s: f64,
    },
}

/// The vehicle's clock seen from here; one for each kind of message.
#[derive(Debug, Clone, Default)]
pub struct BootClock {
    newest_boot_s: Option<f64>,
    offset_s: f64,
    offset_at_s: f64,
    suspects: u8,
}

impl BootClock {
    /// Takes the boot time of a message that arrived at `now_s`.
    pub fn stamp(&mut self, boot_ms: u32, now_s: f64) -> Stamp {
        let mut boot_s = f64::from(boot_ms) * 1e-3;
        let Some(newest_s) = self.newest_boot_s else {
            return Stamp::New {
                measured_s: self.begin(boot_s, now_s),
            };
        };
        // Unwrap, so that the count goes on after 49.7 days.
        boot_s += ((newest_s - boot_s) / WRAP_S).round() * WRAP_S;
        if boot_s < newest_s - RESTART_GAP_S {
            self.suspects += 1;
            if self.suspects < RESTART_COUNT {
                return Stamp::Old;
            }
            let measured_s = self.begin(f64::from(boot_ms) * 1e-3, now_s);
            return Stamp::Restarted { measured_s };
        }
        if boot_s <= newest_s {
            return Stamp::Old;
        }
        self.suspects = 0;
        self.newest_boot_s = Some(boot_s);
        let grown = self.offset_s + LEAK * (now_s - self.offset_at_s).max(0.0);
        self.offset_s = grown.min(now_s - boot_s);
        self.offset_at_s = now_s;
        Stamp::New {
            measured_s: boot_s + self.offset_s,
        }
    }

    fn begin(&mut self, boot_s: f64, now_s: f64) -> f64 {
        *self = Self {
            newest_boot_s: Some(boot_s),
            offset_s: now_s - boot_s,
            offset_at_s: now_s,
            suspects: 0,
        };
        now_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(stamp: Stamp) -> f64 {
        match stamp {
            Stamp::New { measured_s } => measured_s,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn delays_are_seen_through() {
        let mut clock = BootClock::default();
        // Measured at 100.0, 100.1, …; delays 50 ms, then 250 ms, then 20 ms, then 120 ms.
        assert_eq!(measured(clock.stamp(5000, 100.05)), 100.05);
        assert!((measured(clock.stamp(5100, 100.35)) - 100.15).abs() < 1e-3);
        assert!((measured(clock.stamp(5200, 100.22)) - 100.22).abs() < 1e-3);
        assert!((measured(clock.stamp(5300, 100.42)) - 100.32).abs() < 1e-3);
    }

    #[test]
    fn reordered_and_repeated_messages_are_old() {
        let mut clock = BootClock::default();
        clock.stamp(5000, 0.0);
        clock.stamp(5200, 0.2);
        assert_eq!(clock.stamp(5100, 0.25), Stamp::Old);
        assert_eq!(clock.stamp(5200, 0.25), Stamp::Old);
    }

    #[test]
    fn a_restart_is_believed_after_three() {
        let mut clock = BootClock::default();
        clock.stamp(60_000, 0.0);
        assert_eq!(clock.stamp(1000, 1.0), Stamp::Old);
        assert_eq!(clock.stamp(1100, 1.1), Stamp::Old);
        assert_eq!(clock.stamp(1200, 1.2), Stamp::Restarted { measured_s: 1.2 });
        assert!((measured(clock.stamp(1300, 1.3)) - 1.3).abs() < 1e-3);
    }

    #[test]
    fn one_stray_packet_is_no_restart() {
        let mut clock = BootClock::default();
        clock.stamp(60_000, 0.0);
        for n in 0..10_u32 {
            assert_eq!(clock.stamp(1000, f64::from(n)), Stamp::Old);
            measured(clock.stamp(60_100 + 1000 * n, f64::from(n) + 0.1));
        }
    }

    #[test]
    fn the_count_runs_over() {
        let mut clock = BootClock::default();
        clock.stamp(u32::MAX - 50, 0.0);
        assert!((measured(clock.stamp(49, 0.1)) - 0.1).abs() < 1e-3);
    }
}
