//! Encounters and drawn situations, the same on every machine, through the C interface.
#![no_std]

use core::hint::black_box;
use core::ptr::{null, null_mut};

use fga_c::*;
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

/// A firmware of some calls, with what they take of flash. It is linked, not run.
#[macro_export]
macro_rules! linked {
    ($($calls:tt)*) => {
        #[cfg(target_os = "none")]
        #[panic_handler]
        fn stop(_: &core::panic::PanicInfo<'_>) -> ! {
            loop {}
        }

        #[cfg(target_os = "none")]
        #[cortex_m_rt::entry]
        fn main() -> ! {
            use core::hint::black_box;
            use core::ptr::null_mut;
            use fga_c::*;
            loop {
                // SAFETY: never run.
                unsafe { $($calls)* }
            }
        }

        #[cfg(not(target_os = "none"))]
        fn main() {}
    };
}

/// An avoider with a mission, for a firmware that is linked, by pointers that the compiler knows nothing of.
///
/// # Safety
/// It must never run.
pub unsafe fn linked_avoider() -> *mut fga_avoider {
    let mut avoider = null_mut();
    // SAFETY: never run.
    unsafe {
        fga_avoider_init(
            black_box(null_mut()),
            black_box(0),
            1,
            16,
            32,
            black_box(null_mut()),
            black_box(null_mut()),
            &raw mut avoider,
            null_mut(),
        );
        fga_avoider_set_mission(avoider, black_box(null_mut()), null_mut());
    }
    avoider
}

/// Most obstacles of a step here.
pub const OBSTACLES_MOST: u32 = 16;

/// Most waypoints here.
pub const WAYPOINTS_MOST: u32 = 32;

const STORAGE_BYTES: usize = fga_avoider_size(OBSTACLES_MOST, WAYPOINTS_MOST);

/// Time from one step to the next, seconds.
pub const PERIOD_S: f64 = 0.1;

/// Steps of an encounter.
pub const STEPS: u32 = 450;

/// Encounters of all but the crowded aircraft.
pub const ENCOUNTERS: u32 = 10;

/// Encounters of the crowded aircraft.
pub const CROWDED_ENCOUNTERS: u32 = 3;

/// Work limit of the crowded aircraft: the least that there is.
const CROWDED_WORK: u32 = 10_000;

/// Posts of the ground in a row, and rows.
const POSTS: u32 = 41;

/// Bytes with the alignment of all storage.
#[repr(C, align(16))]
struct Storage<const BYTES: usize>([u8; BYTES]);

static mut AVOIDER: Storage<STORAGE_BYTES> = Storage([0; STORAGE_BYTES]);
static mut BELIEFS: Storage<FGA_BELIEFS_BYTES> = Storage([0; FGA_BELIEFS_BYTES]);
static mut PROVER: Storage<FGA_PROVER_BYTES> = Storage([0; FGA_PROVER_BYTES]);

/// Hills of 120 m, 400 m apart, lower about the leg.
static HEIGHTS_M: [f32; (POSTS * POSTS) as usize] = hills();
/// `fga_ground_peak_count` of them are used.
static mut PEAKS_M: [f32; 110] = [0.0; 110];

const fn hills() -> [f32; (POSTS * POSTS) as usize] {
    let mut heights_m = [0.0; (POSTS * POSTS) as usize];
    let mut at = 0;
    while at < POSTS * POSTS {
        let (east, north) = (at % POSTS % 8, at / POSTS);
        let beside = (north as f32 - 20.0) / 20.0;
        let slope = if east < 4 { east } else { 8 - east };
        heights_m[at as usize] = slope as f32 * 30.0 * beside * beside;
        at += 1;
    }
    heights_m
}

/// Bytes of the storage of the avoider.
pub const AVOIDER_BYTES: usize = STORAGE_BYTES;

/// A structure with its size; all else is zero.
fn sized<T: Copy>() -> T {
    // SAFETY: structures of the interface begin with their size, and zeros are values of theirs.
    unsafe {
        let mut value: T = core::mem::zeroed();
        (&raw mut value).cast::<u32>().write(size_of::<T>() as u32);
        value
    }
}

/// The aircraft that fly.
#[derive(Clone, Copy, PartialEq)]
pub enum Aircraft {
    /// Without delay, turns of 30 m at 15 m/s, climbs of 15 degrees.
    Ideal,
    /// Its bank follows with a time constant of 0.5 s.
    Lagged,
    /// The same, held at its altitude among obstacles known within 5 m and 0.5 m/s.
    Noisy,
    /// As the lagged one, among sixteen small unmanned aircraft known as badly, over hills and beside a zone.
    Crowded,
    /// As the lagged one, on beliefs about one aircraft that reports once a second, known as badly.
    Believing,
    /// The same about sixteen.
    Surrounded,
}

impl Aircraft {
    pub const ALL: [Self; 6] = [
        Self::Ideal,
        Self::Lagged,
        Self::Noisy,
        Self::Crowded,
        Self::Believing,
        Self::Surrounded,
    ];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ideal => "ideal",
            Self::Lagged => "lagged",
            Self::Noisy => "noisy",
            Self::Crowded => "crowded",
            Self::Believing => "believing",
            Self::Surrounded => "surrounded",
        }
    }

    /// Whether it decides on beliefs.
    const fn believes(self) -> bool {
        matches!(self, Self::Believing | Self::Surrounded)
    }

    /// Its encounters, and the obstacles of each.
    pub fn encounters(self) -> impl Iterator<Item = (u32, u32)> {
        let row = self as u32;
        let of_all = (0..ENCOUNTERS)
            .filter(move |encounter| encounter % 3 == row)
            .map(|encounter| (encounter, 1 + encounter / 3 % 3));
        let (others, count) = match self {
            Self::Crowded => (CROWDED_ENCOUNTERS, OBSTACLES_MOST),
            Self::Believing => (CROWDED_ENCOUNTERS, 1),
            Self::Surrounded => (1, OBSTACLES_MOST),
            _ => (0, 0),
        };
        let others = ENCOUNTERS..ENCOUNTERS + others;
        of_all.chain(others.map(move |encounter| (encounter, count)))
    }

    fn vehicle(self) -> fga_vehicle {
        let climb_rad = if self == Self::Noisy { 0.0 } else { 0.26 };
        fga_vehicle {
            airspeed_mps: 15.0,
            turn_radius_m: 30.0,
            climb_min_rad: -climb_rad,
            climb_max_rad: climb_rad,
            climb_rate_radps: 0.2,
            bank_time_constant_s: if self == Self::Ideal { 0.0 } else { 0.5 },
            turn_rate_factor: 1.0,
            ..sized()
        }
    }
}

/// One avoider, its beliefs and one prover, in static storage. There is one of these at a time.
pub struct Flight {
    aircraft: Aircraft,
    avoider: *mut fga_avoider,
    beliefs: *mut fga_beliefs,
    prover: *mut fga_prover,
}

impl Flight {
    /// Constructs all.
    pub fn new(aircraft: Aircraft) -> Option<Self> {
        let (mut settings, vehicle) = (sized(), aircraft.vehicle());
        let (mut avoider, mut beliefs, mut prover) = (null_mut(), null_mut(), null_mut());
        let waypoints = [0.0, 2000.0].map(|east| fga_waypoint {
            position_m: fga_enu {
                east,
                north: 0.0,
                up: 100.0,
            },
            passing: fga_passing::FlyBy as u32,
        });
        let mission = fga_mission {
            waypoint_count: 2,
            waypoints: waypoints.as_ptr(),
            floor_m: f64::NEG_INFINITY,
            ceiling_m: f64::INFINITY,
            ..mission()
        };
        // SAFETY: right pointers, and this is the only flight.
        let done = unsafe {
            let defaults = fga_settings_default(&raw mut settings);
            if aircraft == Aircraft::Crowded {
                settings.work_limit = CROWDED_WORK;
            }
            let peaks =
                fga_ground_fill_peaks(POSTS, POSTS, HEIGHTS_M.as_ptr(), (&raw mut PEAKS_M).cast());
            let made = fga_avoider_init(
                (&raw mut AVOIDER).cast(),
                STORAGE_BYTES,
                FGA_ABI_VERSION,
                OBSTACLES_MOST,
                WAYPOINTS_MOST,
                &raw const settings,
                &raw const vehicle,
                &raw mut avoider,
                null_mut(),
            );
            [
                defaults,
                peaks,
                made,
                fga_avoider_set_mission(avoider, &raw const mission, null_mut()),
                fga_beliefs_init(
                    (&raw mut BELIEFS).cast(),
                    FGA_BELIEFS_BYTES,
                    FGA_ABI_VERSION,
                    &raw mut beliefs,
                    null_mut(),
                ),
                fga_prover_init(
                    (&raw mut PROVER).cast(),
                    FGA_PROVER_BYTES,
                    FGA_ABI_VERSION,
                    &raw const vehicle,
                    &raw mut prover,
                    null_mut(),
                ),
            ]
        };
        done.iter()
            .all(|&status| status == fga_status::Ok)
            .then_some(Self {
                aircraft,
                avoider,
                beliefs,
                prover,
            })
    }

    /// Forgets the last flight.
    fn restart(&mut self) {
        // SAFETY: right pointers; nobody else uses the storage.
        unsafe {
            fga_avoider_restart(self.avoider);
            fga_beliefs_init(
                (&raw mut BELIEFS).cast(),
                FGA_BELIEFS_BYTES,
                FGA_ABI_VERSION,
                &raw mut self.beliefs,
                null_mut(),
            );
        }
    }

    /// Beliefs hear each aircraft once a second.
    fn hear(&mut self, time_s: f64, own: &fga_ownship, obstacles: &[fga_obstacle]) {
        for of in obstacles {
            let report = fga_report {
                id: of.id,
                movement: of.movement,
                has_velocity: 1,
                time_s,
                position_m: of.position_m,
                velocity_mps: of.velocity_mps,
                position_sigma_m: of.position_sigma_m,
                velocity_sigma_mps: of.velocity_sigma_mps,
                ..sized()
            };
            // SAFETY: right pointers.
            unsafe {
                fga_beliefs_hear(
                    self.beliefs,
                    &raw const report,
                    of.radius_m,
                    0.0,
                    time_s,
                    own.position_m,
                    null_mut(),
                )
            };
        }
    }

    /// One decision.
    fn step(
        &mut self,
        (time_s, own): (f64, &fga_ownship),
        obstacles: &[fga_obstacle],
        decision: &mut fga_decision,
    ) -> fga_status {
        let corners = [
            (250.0, -15.0),
            (700.0, -15.0),
            (700.0, -200.0),
            (250.0, -200.0),
        ]
        .map(|(east_m, north_m)| place(east_m, north_m));
        let village = fga_zone {
            kind: fga_zone_kind::KeepOut as u32,
            corner_count: 4,
            corners: corners.as_ptr(),
            center: place(0.0, 0.0),
            radius_m: 0.0,
            floor_m: f64::NEG_INFINITY,
            ceiling_m: 300.0,
        };
        let ground = fga_ground {
            columns: POSTS,
            rows: POSTS,
            corner: place(-500.0, -1000.0),
            spacing: place(50.0, 50.0),
            heights_m: HEIGHTS_M.as_ptr(),
            peaks_m: (&raw const PEAKS_M).cast(),
            error_m: 5.0,
            clearance_m: 30.0,
            ..sized()
        };
        let is_crowded = self.aircraft == Aircraft::Crowded;
        let believes = self.aircraft.believes();
        let situation = fga_situation {
            size: size_of::<fga_situation>() as u32,
            obstacle_count: if believes { 0 } else { obstacles.len() as u32 },
            obstacles: obstacles.as_ptr(),
            time_s,
            ownship: *own,
            wind_mps: fga_enu {
                east: 0.0,
                north: 0.0,
                up: 0.0,
            },
            zone_count: u32::from(is_crowded),
            zones: &raw const village,
            ground: if is_crowded {
                &raw const ground
            } else {
                null()
            },
        };
        let situation = &raw const situation;
        // SAFETY: right pointers.
        unsafe {
            if believes {
                let (avoider, beliefs) = (self.avoider, self.beliefs);
                fga_avoider_step_on_beliefs(avoider, beliefs, situation, decision, null_mut())
            } else {
                fga_avoider_step(self.avoider, situation, decision, null_mut())
            }
        }
    }

    /// Flies an encounter; `decide` makes each step. Returns the square of the least distance from an
    /// obstacle, square metres.
    pub fn fly(
        &mut self,
        seed: u64,
        obstacle_count: u32,
        mut decide: impl FnMut(&mut dyn FnMut(&mut fga_decision) -> fga_status, &mut fga_decision),
    ) -> f64 {
        self.restart();
        let mut drawn = Drawn::new(seed);
        let mut obstacles = drawn.obstacles(self.aircraft, obstacle_count);
        let obstacles = obstacles
            .get_mut(..obstacle_count as usize)
            .unwrap_or_default();
        let (mut own, mut least_m2) = (start(), f64::INFINITY);
        for cycle in 0..STEPS {
            let mut decision = sized();
            let time_s = f64::from(cycle) * PERIOD_S;
            if self.aircraft.believes() && cycle % 10 == 0 {
                self.hear(time_s, &own, obstacles);
            }
            let mut step = |out: &mut fga_decision| self.step((time_s, &own), obstacles, out);
            decide(&mut step, &mut decision);
            let (mut then, still_air) = (
                own,
                fga_enu {
                    east: 0.0,
                    north: 0.0,
                    up: 0.0,
                },
            );
            // SAFETY: right pointers.
            unsafe {
                fga_predict(
                    self.prover,
                    &raw const own,
                    decision.stages.as_ptr(),
                    decision.stage_count,
                    still_air,
                    PERIOD_S,
                    &raw mut then,
                    null_mut(),
                )
            };
            own = then;
            for obstacle in &mut *obstacles {
                obstacle.position_m.east += obstacle.velocity_mps.east * PERIOD_S;
                obstacle.position_m.north += obstacle.velocity_mps.north * PERIOD_S;
                obstacle.position_m.up += obstacle.velocity_mps.up * PERIOD_S;
                let [x, y, z] = [
                    obstacle.position_m.east - own.position_m.east,
                    obstacle.position_m.north - own.position_m.north,
                    obstacle.position_m.up - own.position_m.up,
                ];
                least_m2 = least_m2.min(x * x + y * y + z * z);
            }
        }
        least_m2
    }

    /// Decides two steps in each of some drawn situations, a tenth of them on beliefs, where steps are long; returns one hash over all
    /// decisions.
    pub fn hash_of_drawn(&mut self, count: u32, mut hash: u64) -> u64 {
        let mut drawn = Drawn::new(1);
        let count = if self.aircraft.believes() {
            count / 10
        } else {
            count
        };
        for _ in 0..count {
            self.restart();
            let obstacle_count = 1 + drawn.below(4);
            let mut obstacles = drawn.obstacles(self.aircraft, obstacle_count);
            let obstacles = obstacles
                .get_mut(..obstacle_count as usize)
                .unwrap_or_default();
            let mut own = start();
            for cycle in 0..2 {
                let mut decision = sized();
                let time_s = f64::from(cycle) * PERIOD_S;
                if self.aircraft.believes() {
                    self.hear(time_s, &own, obstacles);
                }
                let status = self.step((time_s, &own), obstacles, &mut decision);
                hash = add(hash, &[status as u64]);
                hash = add_decision(hash, &decision);
                own.position_m.east += 15.0 * PERIOD_S;
                for obstacle in &mut *obstacles {
                    obstacle.position_m.east += obstacle.velocity_mps.east * PERIOD_S;
                    obstacle.position_m.north += obstacle.velocity_mps.north * PERIOD_S;
                }
            }
        }
        hash
    }
}

/// A place on the ground.
const fn place(east_m: f64, north_m: f64) -> fga_place {
    fga_place { east_m, north_m }
}

/// A mission that says nothing.
fn mission() -> fga_mission {
    fga_mission {
        size: size_of::<fga_mission>() as u32,
        waypoint_count: 0,
        waypoints: null(),
        floor_m: 0.0,
        ceiling_m: 0.0,
    }
}

/// The aircraft at the start of the leg.
fn start() -> fga_ownship {
    fga_ownship {
        position_m: fga_enu {
            east: 0.0,
            north: 0.0,
            up: 100.0,
        },
        course_from_east_rad: 0.0,
        climb_rad: 0.0,
        bank_left_rad: 0.0,
        airspeed_mps: 15.0,
    }
}

/// The first value of [`add`].
pub const HASH_SEED: u64 = 0xcbf2_9ce4_8422_2325;

/// FNV-1a over words.
fn add(hash: u64, words: &[u64]) -> u64 {
    words.iter().fold(hash, |hash, word| {
        (hash ^ word).wrapping_mul(0x100_0000_01b3)
    })
}

fn add_decision(hash: u64, decision: &fga_decision) -> u64 {
    let words = [
        decision.state as u32,
        decision.reason as u32,
        decision.has,
        decision.stage_count,
    ];
    let mut hash = add(hash, &words.map(u64::from));
    for stage in decision.stages.iter().take(decision.stage_count as usize) {
        let reals = [
            stage.start_s,
            stage.course_from_east_rad,
            stage.climb_rad,
            stage.rate_share,
        ];
        hash = add(hash, &reals.map(f64::to_bits));
    }
    let reals = [
        decision.margin_m,
        decision.cost,
        decision.certified_margin_m,
        decision.threat.entry_s,
    ];
    // The work is left out: it counts tables by their bytes, of which 32-bit machines need fewer.
    add(hash, &reals.map(f64::to_bits))
}

/// Draws obstacles about the leg.
struct Drawn(ChaCha8Rng);

impl Drawn {
    fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    fn below(&mut self, most: u32) -> u32 {
        self.0.next_u32() % most
    }

    fn real(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (f64::from(self.0.next_u32()) / f64::from(u32::MAX))
    }

    /// Some obstacles that come near the leg within the next half minute.
    fn obstacles(
        &mut self,
        aircraft: Aircraft,
        count: u32,
    ) -> [fga_obstacle; OBSTACLES_MOST as usize] {
        let mut obstacles = [(); OBSTACLES_MOST as usize].map(|()| obstacle());
        for (id, slot) in (1..=count).zip(&mut obstacles) {
            let meets_s = self.real(8.0, 30.0);
            let is_crowded = aircraft == Aircraft::Crowded || aircraft.believes();
            let is_still = self.below(3) == 0 && !is_crowded;
            let velocity_mps = if is_still {
                fga_enu {
                    east: 0.0,
                    north: 0.0,
                    up: 0.0,
                }
            } else {
                fga_enu {
                    east: self.real(-25.0, 10.0),
                    north: self.real(-20.0, 20.0),
                    up: 0.0,
                }
            };
            let place_m = fga_enu {
                east: 15.0 * meets_s - velocity_mps.east * meets_s,
                north: self.real(-25.0, 25.0) - velocity_mps.north * meets_s,
                up: 100.0 + self.real(-10.0, 10.0),
            };
            let is_noisy = is_crowded || aircraft == Aircraft::Noisy;
            *slot = fga_obstacle {
                id,
                position_m: place_m,
                velocity_mps,
                volume: fga_volume::Sphere as u32,
                movement: match (is_crowded, is_still) {
                    (true, _) => fga_movement::SmallUas,
                    (_, true) => fga_movement::AtRest,
                    _ => fga_movement::Straight,
                } as u32,
                radius_m: 30.0,
                position_sigma_m: if is_noisy { 5.0 } else { 0.0 },
                velocity_sigma_mps: if is_noisy && !is_still { 0.5 } else { 0.0 },
                age_s: 0.0,
                ..obstacle()
            };
        }
        obstacles
    }
}

fn obstacle() -> fga_obstacle {
    sized()
}
