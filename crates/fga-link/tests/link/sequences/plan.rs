//! The faults of a sequence, and their times.

use fga_emulator::PlaneMode;

use crate::common::random::Random;

/// The companion is ready by then; faults come later, and none lasts beyond [`LAST_FAULT_S`].
const FIRST_FAULT_S: f64 = 12.0;
const LAST_FAULT_S: f64 = 45.0;
/// Modes that the companion must never leave.
pub const PILOTS: [PlaneMode; 5] = [
    PlaneMode::Manual,
    PlaneMode::Stabilize,
    PlaneMode::FlyByWireA,
    PlaneMode::Loiter,
    PlaneMode::Rtl,
];

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    Pilot(PlaneMode),
    /// Nothing comes from the vehicle.
    Deaf,
    /// Nothing reaches the vehicle.
    Mute,
    /// Neither.
    Cut,
    /// Only heartbeats come.
    Telemetry,
    /// The deciding thread stands still.
    Stalled,
    /// The whole program is stopped; messages to it wait.
    Stopped,
    /// The program is killed, and started again at the end.
    Killed,
    /// One heartbeat with the armed bit clear.
    Disarmed,
    /// Heartbeats of this mode, ten a second, with numbers this far ahead.
    Forged(u32, u8),
    RollLimit,
    Refuses,
    Ignores,
    Reboots,
    Sinks,
    /// The network delays by more and more.
    Late,
    /// The program gets a signal to end.
    Term,
    /// The vehicle's port speaks MAVLink 1.
    Version1,
    /// The pitot tube is blocked.
    Pitot,
    /// The vehicle's own avoidance is on, with this action.
    Avoidance(f32),
    /// A queue delays what goes to the vehicle, seconds.
    Queue(f64),
}

/// What is wrong but not gone, from the start on.
#[derive(Debug, Clone, Copy, Default)]
pub struct Degraded {
    /// The link is signed, and the program's clock is this far off, seconds.
    pub clock_off_s: Option<i64>,
    /// The first start finds a note of another flight of the vehicle.
    pub stale_note: bool,
}

impl Degraded {
    /// Draws one or two things, and adds to the faults.
    pub fn draw(random: &mut Random, planned: &mut Vec<Planned>) -> Self {
        let mut degraded = Self::default();
        for _ in 0..=random.next() % 2 {
            let begin_s = random.uniform(FIRST_FAULT_S, LAST_FAULT_S - 12.0);
            let end_s = begin_s + random.uniform(0.3, 12.0);
            let fault = match random.next() % 5 {
                0 => Fault::Pitot,
                1 => Fault::Avoidance([3.0, 4.0][(random.next() % 2) as usize]),
                2 => Fault::Queue(random.uniform(1.0, 5.0)),
                3 => {
                    let off_s = [-2_000_000_000, -3600, 3600][(random.next() % 3) as usize];
                    degraded.clock_off_s = Some(off_s);
                    continue;
                }
                _ => {
                    degraded.stale_note = true;
                    continue;
                }
            };
            planned.push(Planned {
                fault,
                begin_s,
                end_s,
            });
        }
        degraded
    }
}

/// What a trial found: faults that last, and those of [`Self::plan`].
#[derive(Debug, Clone, Copy)]
pub struct Trial {
    /// Interval of the reports of traffic, seconds.
    pub report_every_s: f64,
    /// Whether a fence that the mission crosses is stored, and enabled.
    pub fence: Option<bool>,
    /// Whether each start finds a note of another vehicle.
    pub foreign_note: bool,
}

impl Trial {
    /// Nothing of it.
    pub const NONE: Self = Self {
        report_every_s: 0.5,
        fence: None,
        foreign_note: false,
    };

    /// Draws it, and adds to the faults.
    pub fn draw(random: &mut Random, planned: &mut Vec<Planned>) -> Self {
        let begin_s = random.uniform(FIRST_FAULT_S, LAST_FAULT_S - 12.0);
        let end_s = begin_s + random.uniform(0.3, 12.0);
        let fault = match random.next() % 6 {
            0 | 1 => Some(Fault::Term),
            2 => Some(Fault::Killed),
            3 => Some(Fault::Version1),
            _ => None,
        };
        planned.extend(fault.map(|fault| Planned {
            fault,
            begin_s,
            end_s,
        }));
        Self {
            report_every_s: [0.5, 1.0, 5.0][(random.next() % 3) as usize],
            fence: [None, Some(false), Some(true)][(random.next() % 3) as usize],
            foreign_note: random.next().is_multiple_of(2),
        }
    }
}

/// A fault with its start and end, seconds.
#[derive(Debug, Clone, Copy)]
pub struct Planned {
    pub fault: Fault,
    pub begin_s: f64,
    pub end_s: f64,
}

pub fn plan(random: &mut Random) -> Vec<Planned> {
    let two_at_once = random.next().is_multiple_of(2);
    let count = if two_at_once { 2 } else { 1 } + random.next() % 2;
    let mut planned: Vec<Planned> = Vec::new();
    for number in 0..count {
        let mode = PILOTS[(random.next() % 5) as usize];
        let fault = match random.next() % 18 {
            0..=2 => Fault::Pilot(mode),
            3 => Fault::Deaf,
            4 => Fault::Mute,
            5 => Fault::Cut,
            6 => Fault::Telemetry,
            7 => Fault::Stalled,
            8 => Fault::Stopped,
            9 => Fault::Killed,
            10 => Fault::Disarmed,
            11 => Fault::Forged(15, random.next() as u8),
            12 => Fault::Forged(mode.number(), random.next() as u8),
            13 => Fault::RollLimit,
            14 => Fault::Refuses,
            15 => Fault::Ignores,
            16 => {
                if random.next().is_multiple_of(2) {
                    Fault::Reboots
                } else {
                    Fault::Sinks
                }
            }
            _ => Fault::Late,
        };
        let begin_s = match planned.first() {
            Some(first) if number == 1 && two_at_once => first.begin_s,
            _ => random.uniform(FIRST_FAULT_S, LAST_FAULT_S - 12.0),
        };
        let end_s = begin_s + random.uniform(0.3, 12.0);
        planned.push(Planned {
            fault,
            begin_s,
            end_s,
        });
    }
    planned
}
