//! Kept obstacles: the same decisions as with all of them as rows, and few looks.

use fga::Vec3;
use fga::avoider::{Avoider, Block, Kept, KeptError, Settings, State};
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::{
    Mission, Movement, MovementBounds, Obstacle, Obstacles, Ownship, ProtectedVolume, Situation,
    Uncertainty,
};

use crate::flight::vehicle;

/// Flights in each world.
const SEEDS: u64 = 4;

/// Numbers from a seed (`SplitMix64`).
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn within(&mut self, from: f64, to: f64) -> f64 {
        let share = (self.next() >> 11) as f64 / (1_u64 << 53) as f64;
        from + share * (to - from)
    }

    fn one_in(&mut self, count: u64) -> bool {
        self.next().is_multiple_of(count)
    }

    fn id(&mut self, count: u32) -> u32 {
        // Far apart and side by side.
        let id = u32::try_from(self.next() % u64::from(count)).unwrap();
        if id.is_multiple_of(2) {
            id
        } else {
            u32::MAX - id
        }
    }

    fn vector(&mut self, across: f64, up: f64) -> Vec3 {
        Vec3::new(
            self.within(-across, across),
            self.within(-across, across),
            self.within(-up, up),
        )
    }

    /// An obstacle about a place: at rest, straight on or an aircraft, known exactly or not.
    fn obstacle(&mut self, id: u32, about_m: Vec3, across_m: f64) -> Obstacle {
        let radius_m = self.within(5.0, 60.0);
        let volume = if self.one_in(2) {
            ProtectedVolume::Sphere { radius_m }
        } else {
            let half_height_m = self.within(5.0, 40.0);
            ProtectedVolume::Cylinder {
                radius_m,
                half_height_m,
            }
        };
        let movement = match self.next() % 8 {
            0 => Movement::AtRest,
            1 => Movement::CREWED,
            2 => Movement::Aircraft(MovementBounds::SMALL_UAS),
            _ => Movement::Straight,
        };
        let speed = if self.one_in(3) { 0.0 } else { 40.0 };
        let uncertainty = if self.one_in(3) {
            Uncertainty {
                position_m: self.within(0.0, 8.0),
                velocity_mps: self.within(0.0, 1.5),
            }
        } else {
            Uncertainty::default()
        };
        // More of them near.
        let share = self.within(0.0, 1.0).powi(2);
        let place_m = about_m + self.vector(across_m, across_m.min(300.0)) * share;
        Obstacle {
            movement,
            uncertainty,
            ..Obstacle::straight(id, place_m, self.vector(speed, 0.1 * speed), volume)
        }
    }

    /// The same with a number that no obstacle can have.
    fn unusable(&mut self, obstacle: Obstacle) -> Obstacle {
        let number = match self.next() % 4 {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => f64::NEG_INFINITY,
            _ => 1e300,
        };
        let mut broken = obstacle;
        match self.next() % 4 {
            0 => broken.position_m.y = number,
            1 => broken.velocity_mps.z = number,
            2 => broken.uncertainty.velocity_mps = number,
            _ => broken.volume = ProtectedVolume::Sphere { radius_m: number },
        }
        broken
    }
}

/// The surroundings of a flight.
#[derive(Clone, Copy)]
struct World {
    count: u32,
    /// Half of its extent, metres.
    across_m: f64,
    surveillance_radius_m: f64,
    /// One in this many steps has each kind of surprise.
    calm: u64,
    /// Whether the flight stays on its leg, among obstacles that do not turn: most steps are quiet.
    quiet: bool,
}

/// A flight in a world by two avoiders: one takes all obstacles as rows, the other keeps them.
struct Flight<'m> {
    world: World,
    draw: Draw,
    by_rows: Avoider,
    by_kept: Avoider,
    kept: Kept<'m>,
    own: Ownship,
    wind_mps: Vec3,
    time_s: f64,
    /// Decisions in cruise, others, and reports that were refused.
    seen: [usize; 3],
}

impl<'m> Flight<'m> {
    fn new(seed: u64, world: World, blocks: &'m mut [Block]) -> Self {
        let settings = Settings {
            surveillance_radius_m: world.surveillance_radius_m,
            ..Settings::default()
        };
        let avoider = Avoider::new(settings, vehicle()).unwrap();
        let mut flight = Self {
            world,
            draw: Draw(seed),
            by_rows: avoider.clone(),
            by_kept: avoider,
            kept: Kept::new(blocks),
            own: Ownship {
                position_m: Vec3::ZERO,
                course_rad: 0.0,
                climb_rad: 0.0,
                bank_rad: 0.0,
                airspeed_mps: vehicle().airspeed_mps,
            },
            wind_mps: Vec3::ZERO,
            time_s: 100.0,
            seen: [0; 3],
        };
        for _ in 0..world.count {
            flight.report();
        }
        flight
    }

    /// A report of a drawn obstacle, from a little earlier or, by its clock, later.
    fn report(&mut self) {
        let World {
            count, across_m, ..
        } = self.world;
        let id = self.draw.id(2 * count);
        let mut obstacle = self.draw.obstacle(id, self.own.position_m, across_m);
        if self.world.quiet && obstacle.movement.bounds().is_some() {
            obstacle.movement = Movement::Straight;
        }
        let reported_s = self.time_s - self.draw.within(-0.5, 3.0);
        let _ = self.kept.put(&obstacle, reported_s);
    }

    /// What comes between two steps.
    fn surprise(&mut self) {
        let World {
            count,
            across_m,
            calm,
            quiet,
            ..
        } = self.world;
        if self.draw.one_in(calm) {
            self.report();
        }
        if self.draw.one_in(calm) {
            let id = self.draw.id(2 * count);
            self.kept.remove(id);
        }
        if self.draw.one_in(calm) {
            let id = self.draw.id(2 * count);
            let obstacle = self.draw.obstacle(id, self.own.position_m, across_m);
            let broken = self.draw.unusable(obstacle);
            assert_eq!(
                self.kept.put(&broken, self.time_s),
                Err(KeptError::Unusable { id })
            );
            self.seen[2] += 1;
        }
        if quiet {
            // A wind along the leg that changes, and gusts along it.
            self.wind_mps.x = (self.wind_mps.x + self.draw.within(-0.1, 0.1)).clamp(-3.0, 3.0);
            self.own.position_m.x += self.draw.within(-0.1, 0.1);
            return;
        }
        if self.draw.one_in(20 * calm) {
            self.own.position_m += self.draw.vector(across_m, 0.0);
        } else if self.draw.one_in(5 * calm) {
            // Back on its leg.
            self.own.position_m =
                Vec3::X * (self.own.position_m.x + self.draw.within(-50.0, 500.0));
            (self.own.course_rad, self.own.climb_rad, self.own.bank_rad) = (0.0, 0.0, 0.0);
        }
        if self.draw.one_in(20 * calm) {
            self.wind_mps = self.draw.vector(12.0, 1.0);
        }
        if self.draw.one_in(20 * calm) {
            let is_usual = self.own.airspeed_mps == vehicle().airspeed_mps;
            let other_mps = self.draw.within(8.0, 40.0);
            self.own.airspeed_mps = if is_usual {
                other_mps
            } else {
                vehicle().airspeed_mps
            };
        }
        if self.draw.one_in(20 * calm) {
            self.time_s += self.draw.within(-40.0, 40.0);
        }
        if self.draw.one_in(200 * calm) {
            // Beyond what the clock of the watch counts.
            self.time_s += 3e5;
        }
        // Gusts.
        self.own.position_m += self.draw.vector(0.03, 0.01);
    }

    /// One step of both, and the flight on.
    fn step(&mut self, waypoints_m: &[Vec3]) {
        let rows: Vec<Obstacle> = self.kept.obstacles(self.time_s).collect();
        let situation = Situation {
            time_s: self.time_s,
            ownship: self.own,
            obstacles: Obstacles::Rows(&rows),
            mission: Mission::new(waypoints_m),
            wind_mps: self.wind_mps,
        };
        let expected = self.by_rows.step(&situation);
        let none = Situation {
            obstacles: Obstacles::Rows(&[]),
            ..situation
        };
        let found = self.by_kept.step_kept(&none, &mut self.kept);
        // As text: a 0 is not a −0.
        assert_eq!(
            format!("{found:?}"),
            format!("{expected:?}"),
            "at {} s",
            self.time_s
        );
        self.seen[usize::from(found.state != State::Cruise)] += 1;
        let flyer = Flyer::new(&vehicle());
        let mut path = FlightPath::new();
        path.predict(&flyer, &MotionState::of(&self.own), &found.command, 0.2);
        let next = path.state_at(&flyer, 0.1).unwrap();
        self.own.position_m = next.position_m + self.wind_mps * 0.1;
        self.own.course_rad = next.course_rad;
        self.own.climb_rad = next.climb_rad;
        self.own.bank_rad = next.bank_rad;
        self.time_s += 0.1;
    }
}

/// Flies `steps` steps in a world from each seed. Returns the decisions in cruise, others, and refused reports.
fn flown(world: World, seeds: core::ops::Range<u64>, steps: usize) -> [usize; 3] {
    let leg = [Vec3::ZERO, Vec3::X * 1e6];
    let mut seen = [0; 3];
    for seed in seeds {
        let mut blocks = vec![Block::EMPTY; (3 * world.count as usize).div_ceil(Block::OBSTACLES)];
        let mut flight = Flight::new(seed, world, &mut blocks);
        for _ in 0..steps {
            flight.surprise();
            flight.step(&leg);
        }
        for (sum, count) in seen.iter_mut().zip(flight.seen) {
            *sum += count;
        }
    }
    seen
}

#[test]
fn decisions_are_those_with_all_obstacles_within_a_surveillance_radius() {
    let mut seen = [0; 3];
    for (count, across_m, surveillance_radius_m) in [
        (12, 1500.0, 300.0),
        (100, 4000.0, 300.0),
        (400, 2000.0, 1500.0),
        (300, 30_000.0, 5000.0),
    ] {
        let world = World {
            count,
            across_m,
            surveillance_radius_m,
            calm: 10,
            quiet: false,
        };
        for (sum, count) in seen.iter_mut().zip(flown(world, 0..SEEDS, 400)) {
            *sum += count;
        }
    }
    assert!(seen.iter().all(|count| *count > 500), "{seen:?}");
}

#[test]
fn decisions_are_those_with_all_obstacles_without_a_surveillance_radius() {
    let mut seen = [0; 3];
    for (count, across_m, calm) in [
        (12, 3000.0, 10),
        (60, 20_000.0, 10),
        (300, 60_000.0, 100),
        (2000, 200_000.0, 1000),
    ] {
        let world = World {
            count,
            across_m,
            surveillance_radius_m: f64::INFINITY,
            calm,
            quiet: false,
        };
        for (sum, count) in seen.iter_mut().zip(flown(world, 0..SEEDS, 400)) {
            *sum += count;
        }
    }
    assert!(seen.iter().all(|count| *count > 300), "{seen:?}");
}

#[test]
fn decisions_are_those_with_all_obstacles_along_a_leg() {
    let mut seen = [0; 3];
    for (count, across_m, surveillance_radius_m) in [
        (100, 10_000.0, f64::INFINITY),
        (300, 20_000.0, f64::INFINITY),
        (200, 3000.0, 2000.0),
    ] {
        let world = World {
            count,
            across_m,
            surveillance_radius_m,
            calm: 10,
            quiet: true,
        };
        for (sum, count) in seen.iter_mut().zip(flown(world, 0..2 * SEEDS, 400)) {
            *sum += count;
        }
    }
    assert!(seen.iter().all(|count| *count > 500), "{seen:?}");
}

/// A step on the way to the east among kept obstacles.
fn step(avoider: &mut Avoider, kept: &mut Kept<'_>, step: u32) -> State {
    let time_s = 0.1 * f64::from(step);
    let leg = [Vec3::ZERO, Vec3::X * 1e6];
    let ownship = Ownship {
        position_m: Vec3::X * (vehicle().airspeed_mps * time_s),
        course_rad: 0.0,
        climb_rad: 0.0,
        bank_rad: 0.0,
        airspeed_mps: vehicle().airspeed_mps,
    };
    let situation = Situation {
        time_s,
        ownship,
        obstacles: Obstacles::Rows(&[]),
        mission: Mission::new(&leg),
        wind_mps: Vec3::ZERO,
    };
    avoider.step_kept(&situation, kept).state
}

#[test]
fn a_step_looks_only_at_obstacles_that_could_matter() {
    for surveillance_radius_m in [300.0, 5000.0, f64::INFINITY] {
        let settings = Settings {
            surveillance_radius_m,
            ..Settings::default()
        };
        let mut avoider = Avoider::new(settings, vehicle()).unwrap();
        let mut blocks = vec![Block::EMPTY; 5000 / Block::OBSTACLES + 1];
        let mut kept = Kept::new(&mut blocks);
        let mut draw = Draw(3);
        for id in 0..5000 {
            // Ten a square kilometre, none on the way.
            let mut place_m = draw.vector(11e3, 100.0);
            place_m.y += 200.0_f64.copysign(place_m.y);
            let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
            let masts = Obstacle::straight(id, place_m, Vec3::ZERO, volume);
            kept.put(&masts, 0.0).unwrap();
        }
        assert_eq!(step(&mut avoider, &mut kept, 0), State::Cruise);
        assert!(kept.looked() >= 5000);
        let mut looked = 0;
        for k in 1..=600 {
            assert_eq!(step(&mut avoider, &mut kept, k), State::Cruise);
            looked += kept.looked();
        }
        // All of them once more, for a line, and then a few in each step.
        assert!(
            looked < 5000 + 600 * 100,
            "{looked} within {surveillance_radius_m} m"
        );
    }
}

#[test]
fn an_obstacle_that_nobody_reports_again_is_met_where_it_flies() {
    let settings = Settings {
        surveillance_radius_m: 300.0,
        ..Settings::default()
    };
    let mut avoider = Avoider::new(settings, vehicle()).unwrap();
    let mut blocks = [const { Block::EMPTY }; 1];
    let mut kept = Kept::new(&mut blocks);
    // 25 m/s of closing speed and 30 m of radius: in sight, at 300 m, after 58 s.
    let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
    let comes = Obstacle::straight(7, Vec3::X * 1750.0, Vec3::X * -10.0, volume);
    kept.put(&comes, 0.0).unwrap();
    let seen = (0..=650).find(|k| step(&mut avoider, &mut kept, *k) != State::Cruise);
    let speed_mps = 10.0 + vehicle().airspeed_mps;
    let expected = (1450.0 / speed_mps * 10.0).ceil();
    assert_eq!(seen.map(f64::from), Some(expected));
}

#[test]
fn a_report_replaces_the_one_with_its_identifier_and_a_full_memory_says_so() {
    let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
    let at = |id, x_m| Obstacle::straight(id, Vec3::X * x_m, Vec3::X, volume);
    let mut blocks = vec![Block::EMPTY; 2];
    let mut kept = Kept::new(&mut blocks);
    assert_eq!((kept.capacity(), kept.is_empty()), (32, true));
    for id in 0..32 {
        kept.put(&at(id * 0x0800_0000, 1.0), 5.0).unwrap();
    }
    let full = kept.put(&at(7, 2.0), 5.0).unwrap_err();
    assert_eq!(full, KeptError::Full { capacity: 32 });
    assert_eq!(
        full.to_string(),
        "32 obstacles are kept, there is no room for more"
    );
    // A known one has its room.
    kept.put(&at(0x0800_0000, 9.0), 6.0).unwrap();
    let places = |kept: &Kept<'_>| -> Vec<(u32, f64)> {
        let obstacles = kept.obstacles(8.0);
        obstacles.map(|o| (o.id, o.position_m.x)).collect()
    };
    assert_eq!(places(&kept)[1], (0x0800_0000, 11.0));
    assert_eq!(places(&kept)[2], (0x1000_0000, 4.0));
    assert!(kept.remove(0x1000_0000));
    assert!(!kept.remove(0x1000_0000));
    assert_eq!(kept.len(), 31);
    let broken = kept.put(&at(7, f64::NAN), 5.0).unwrap_err();
    assert_eq!(
        broken.to_string(),
        "obstacle 7 has an unusable number, expected places up to 1e7 m, speeds up to 1e4 m/s and no negative length"
    );
    kept.put(&at(7, 2.0), 8.0).unwrap();
    assert_eq!(places(&kept)[2], (7, 2.0));
    kept.clear();
    assert_eq!((kept.len(), kept.obstacles(8.0).count()), (0, 0));
    kept.put(&at(7, 2.0), 8.0).unwrap();
    assert_eq!(places(&kept), [(7, 2.0)]);
}

#[test]
fn an_obstacle_that_is_removed_is_not_looked_at() {
    let settings = Settings {
        surveillance_radius_m: f64::INFINITY,
        ..Settings::default()
    };
    let mut avoider = Avoider::new(settings, vehicle()).unwrap();
    let mut blocks = vec![Block::EMPTY];
    let mut kept = Kept::new(&mut blocks);
    let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
    let mast = Obstacle::straight(7, Vec3::X * 50_000.0, Vec3::ZERO, volume);
    kept.put(&mast, 0.0).unwrap();
    step(&mut avoider, &mut kept, 0);
    step(&mut avoider, &mut kept, 1);
    assert!(kept.looked() > 0);
    kept.remove(7);
    step(&mut avoider, &mut kept, 2);
    assert_eq!(kept.looked(), 0);
    kept.put(&mast, 0.2).unwrap();
    step(&mut avoider, &mut kept, 3);
    assert!(kept.looked() > 0);
}

#[test]
fn without_memory_nothing_is_kept_and_steps_decide() {
    let mut avoider = Avoider::new(Settings::default(), vehicle()).unwrap();
    let mut kept = Kept::new(&mut []);
    let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
    let mast = Obstacle::straight(7, Vec3::X * 100.0, Vec3::ZERO, volume);
    assert_eq!(kept.put(&mast, 0.0), Err(KeptError::Full { capacity: 0 }));
    assert!(!kept.remove(7));
    assert_eq!(step(&mut avoider, &mut kept, 0), State::Cruise);
}

#[test]
fn the_position_of_an_old_report_is_as_uncertain_as_its_velocity_made_it() {
    let mut blocks = vec![Block::EMPTY];
    let mut kept = Kept::new(&mut blocks);
    let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
    let known = Obstacle {
        uncertainty: Uncertainty {
            position_m: 2.0,
            velocity_mps: 0.5,
        },
        ..Obstacle::straight(1, Vec3::ZERO, Vec3::X, volume)
    };
    kept.put(&known, 10.0).unwrap();
    let resting = Obstacle {
        id: 2,
        movement: Movement::AtRest,
        ..known
    };
    kept.put(&resting, 10.0).unwrap();
    let at = |time_s| -> Vec<(f64, f64)> {
        let obstacles = kept.obstacles(time_s);
        obstacles
            .map(|o| (o.position_m.x, o.uncertainty.position_m))
            .collect()
    };
    assert_eq!(at(14.0), [(4.0, 4.0), (0.0, 4.0)]);
    assert_eq!(at(8.0), [(-2.0, 2.0), (0.0, 2.0)]);
}
