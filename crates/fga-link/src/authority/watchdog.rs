//! The reaction when the deciding thread stands still.
//!
//! The watchdog counts its own looks, not time: a program that is stopped as a whole (`SIGSTOP`, a
//! debugger, a suspended computer) counts no look, and its threads continue together.

use super::Hearing;
use crate::mode::Mode;

/// Time between two looks, seconds.
pub const LOOK_EVERY_S: f64 = 0.2;
/// The thread stands still if it took no step between this many looks: 1.6 s.
const STILL: u32 = 8;
/// Most commands of the mode, one every other look.
const MOST_TRIES: u32 = 6;
/// Looks after which the program ends in any case: 5 s.
const LAST: u32 = STILL + 25;

/// The mode to restore if the program stops now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Owed {
    /// System id of the vehicle.
    pub system_id: u8,
    /// The mode that the companion owns: the watchdog commands nothing in any other.
    pub owned: Mode,
    /// The mode from before.
    pub previous: Mode,
}

/// The result of a look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Nothing.
    Wait,
    /// Command the mode from before.
    Restore(Owed),
    /// End the program, so that the service manager starts it again.
    EndProgram,
}

/// Watches the thread that decides.
#[derive(Debug, Clone, Copy, Default)]
pub struct Watchdog {
    ticks: u64,
    still: u32,
    tries: u32,
}

impl Watchdog {
    /// A watchdog for a thread that has ended after `ticks` steps: it restores at once.
    pub const fn of_ended(ticks: u64) -> Self {
        Self {
            ticks,
            still: STILL,
            tries: 0,
        }
    }

    /// Looks, every [`LOOK_EVERY_S`]: `ticks` counts the thread's steps, `owed` is the mode that it owes, and
    /// `hearing` is the vehicle's reported mode.
    pub fn look(&mut self, ticks: u64, owed: Option<Owed>, hearing: &Hearing, now_s: f64) -> Order {
        if ticks != self.ticks {
            *self = Self {
                ticks,
                ..Self::default()
            };
            return Order::Wait;
        }
        self.still = self.still.saturating_add(1);
        if self.still < STILL {
            return Order::Wait;
        }
        let Some(owed) = owed else {
            return Order::EndProgram;
        };
        let elsewhere = hearing.is_sure(now_s) && hearing.mode() != Some(owed.owned);
        if elsewhere || self.tries >= MOST_TRIES || self.still >= LAST {
            return Order::EndProgram;
        }
        if self.still % 2 == STILL % 2 && hearing.permits(owed.owned, now_s) {
            self.tries += 1;
            return Order::Restore(owed);
        }
        Order::Wait
    }
}

#[cfg(test)]
mod tests {
    use super::super::Beat;
    use super::*;

    const OWED: Owed = Owed {
        system_id: 1,
        owned: Mode::GUIDED,
        previous: Mode::AUTO,
    };

    struct Bench {
        watchdog: Watchdog,
        hearing: Hearing,
        sequence: u8,
        now_s: f64,
    }

    impl Bench {
        fn new() -> Self {
            Self {
                watchdog: Watchdog::default(),
                hearing: Hearing::default(),
                sequence: 0,
                now_s: 0.0,
            }
        }

        fn look(&mut self, ticks: u64, owed: Option<Owed>, mode: Option<Mode>) -> Order {
            self.now_s += LOOK_EVERY_S;
            if let Some(mode) = mode {
                self.sequence = self.sequence.wrapping_add(9);
                let beat = Beat {
                    sequence: self.sequence,
                    mode,
                    armed: true,
                };
                self.hearing.hear(beat, self.now_s);
            }
            self.watchdog.look(ticks, owed, &self.hearing, self.now_s)
        }
    }

    #[test]
    fn it_waits_while_the_thread_works() {
        let mut bench = Bench::new();
        for tick in 1..100 {
            assert_eq!(
                bench.look(tick / 7, Some(OWED), Some(Mode::GUIDED)),
                Order::Wait
            );
        }
    }

    #[test]
    fn it_restores_a_limited_number_of_times_and_ends_the_program() {
        let mut bench = Bench::new();
        bench.look(1, Some(OWED), Some(Mode::GUIDED));
        let orders: Vec<Order> = (0..40)
            .map(|_| bench.look(1, Some(OWED), Some(Mode::GUIDED)))
            .collect();
        let count = |order| orders.iter().filter(|other| **other == order).count();
        assert_eq!(count(Order::Restore(OWED)), 6);
        assert_eq!(orders.iter().position(|o| *o != Order::Wait), Some(7));
        let end = orders.iter().position(|o| *o == Order::EndProgram).unwrap();
        assert!(end < 30, "{end}");
        assert!(orders[end..].iter().all(|o| *o == Order::EndProgram));
    }

    #[test]
    fn it_leaves_every_other_mode_alone_and_ends_the_program() {
        for mode in [Mode(0), Mode(2), Mode(5), Mode::AUTO, Mode::RTL] {
            let mut bench = Bench::new();
            bench.look(1, Some(OWED), Some(Mode::GUIDED));
            let orders: Vec<Order> = (0..12)
                .map(|_| bench.look(1, Some(OWED), Some(mode)))
                .collect();
            assert!(!orders.contains(&Order::Restore(OWED)), "{mode:?}");
            assert_eq!(orders.last(), Some(&Order::EndProgram));
        }
    }

    #[test]
    fn it_commands_nothing_while_nothing_is_heard_and_ends_the_program() {
        let mut bench = Bench::new();
        for tick in 1..=5 {
            bench.look(tick, Some(OWED), Some(Mode::GUIDED));
        }
        let orders: Vec<Order> = (0..40).map(|_| bench.look(5, Some(OWED), None)).collect();
        assert!(!orders.contains(&Order::Restore(OWED)));
        assert_eq!(
            orders.iter().position(|o| *o == Order::EndProgram),
            Some(32)
        );
    }

    #[test]
    fn it_ends_a_program_that_owes_nothing() {
        let mut bench = Bench::new();
        bench.look(1, None, Some(Mode::AUTO));
        let last = (0..8).map(|_| bench.look(1, None, Some(Mode::AUTO))).last();
        assert_eq!(last, Some(Order::EndProgram));
        // A thread that goes on in time is forgiven.
        let mut bench = Bench::new();
        bench.look(1, None, Some(Mode::AUTO));
        for _ in 0..7 {
            assert_eq!(bench.look(1, None, Some(Mode::AUTO)), Order::Wait);
        }
        assert_eq!(bench.look(2, None, Some(Mode::AUTO)), Order::Wait);
        assert_eq!(bench.look(2, None, Some(Mode::AUTO)), Order::Wait);
    }

    #[test]
    fn for_an_ended_thread_it_restores_at_once() {
        let mut bench = Bench::new();
        bench.watchdog = Watchdog::of_ended(0);
        let first: Vec<Order> = (0..2)
            .map(|_| bench.look(0, Some(OWED), Some(Mode::GUIDED)))
            .collect();
        assert!(first.contains(&Order::Restore(OWED)));
        assert_eq!(
            bench.look(0, Some(OWED), Some(Mode::AUTO)),
            Order::EndProgram
        );
    }
}
