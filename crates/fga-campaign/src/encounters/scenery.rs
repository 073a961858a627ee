//! Ground and zones around drawn encounters.
//!
//! The mission itself keeps clear of them. Lengths are those of the aircraft of Table 4; they grow with its airspeed, or with the
//! protected radius where that grows more. The ground is fractal: ridged waves of any direction, each shorter and lower than the
//! one before. Intruders fly level, whatever the ground.

use alloc::sync::Arc;

use fga::Vec2;
use fga::zone::ALL_HEIGHTS_M;
use fga_sim::world::{World, WorldGround, WorldOutline, WorldZone};

use super::family::{Landscape, Range};
use super::{EncounterSource, Family, Random};

/// Ground and zones of an encounter.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scenery {
    /// The ground.
    pub ground: Option<Arc<WorldGround>>,
    /// The zones.
    pub zones: Vec<WorldZone>,
}

impl Scenery {
    /// Puts it into a world, in place of what is there.
    pub fn place(&self, world: &mut World) {
        world.ground.clone_from(&self.ground);
        world.zones.clone_from(&self.zones);
    }
}

/// Posts of the ground along and across.
const POSTS: u32 = 161;

/// Distance between two posts, metres.
const POST_M: f64 = 25.0;

/// Highest ground below the mission, metres.
const BELOW_M: f64 = -30.0;

/// Vertical error and clearance, metres.
const ASKED_M: (f64, f64) = (5.0, 20.0);

/// Highest ground, metres.
const HIGHEST_M: f64 = 300.0;

/// Waves of the fractal.
const WAVES: usize = 6;

/// What the master seed of the surroundings differs by from that of the obstacles.
const OTHER_STREAM: u64 = 0x6772_6f75_6e64;

impl EncounterSource {
    /// Whether its encounters have ground or zones.
    pub const fn has_surroundings(&self) -> bool {
        matches!(self.family, Family::Among(..))
    }

    /// Ground and zones of the encounter with this number; none for a family without them.
    pub fn scenery(&self, number: u64) -> Scenery {
        let Family::Among(place, _) = self.family else {
            return Scenery::default();
        };
        let mut random = Random::new(self.seed ^ OTHER_STREAM, number);
        let table_4 = Self::table_4(self.family, false, 0);
        let scale =
            (self.airspeed_mps / table_4.airspeed_mps).max(self.radius_m / table_4.radius_m);
        if place == Landscape::Corridor {
            return Scenery {
                ground: None,
                zones: corridor(&mut random, scale),
            };
        }
        Scenery {
            ground: Relief::draw(place, &mut random)
                .ground(&mut random, scale)
                .map(Arc::new),
            zones: Vec::new(),
        }
    }
}

/// The shape of the ground.
struct Relief {
    place: Landscape,
    /// Height of the lowest ground, metres.
    floor_m: f64,
    /// Right and left of the mission: how far off it rises, metres, and how steeply.
    sides: [(f64, f64); 2],
    /// Where ridges or walls stand along the mission, how broad and how high they are, metres, and their slant.
    crests: Vec<[f64; 4]>,
    /// Waves: per metre east and north, and phase.
    waves: [[f64; 3]; WAVES],
}

impl Relief {
    fn draw(place: Landscape, random: &mut Random) -> Self {
        let mut side = || {
            (
                random.within(Range(30.0, 200.0)),
                random.within(Range(0.2, 3.0)),
            )
        };
        let sides = [side(), side()];
        let mut crests = Vec::new();
        match place {
            Landscape::Ridges => {
                let mut along_m = random.within(Range(50.0, 250.0));
                while along_m < 1500.0 {
                    let slant = random.within(Range(-0.7, 0.7));
                    let broad_m = random.within(Range(40.0, 120.0));
                    crests.push([along_m, broad_m, random.within(Range(50.0, 250.0)), slant]);
                    along_m += random.within(Range(150.0, 450.0));
                }
            }
            Landscape::GroundWall => {
                let slant = random.within(Range(-0.3, 0.3));
                let broad_m = random.within(Range(100.0, 400.0));
                crests.push([
                    random.within(Range(250.0, 600.0)),
                    broad_m,
                    HIGHEST_M,
                    slant,
                ]);
            }
            Landscape::Valley | Landscape::Corridor => {}
        }
        let mut per_m = core::f64::consts::TAU / random.within(Range(300.0, 600.0));
        let waves = [(); WAVES].map(|()| {
            let (sin, cos) = libm::sincos(core::f64::consts::TAU * random.unit());
            let wave = [
                per_m * cos,
                per_m * sin,
                core::f64::consts::TAU * random.unit(),
            ];
            per_m *= 2.0;
            wave
        });
        Self {
            place,
            floor_m: random.within(Range(-90.0, -40.0)),
            sides,
            crests,
            waves,
        }
    }

    /// From 0 to 1, about.
    fn fractal(&self, at: Vec2) -> f64 {
        let mut share = 0.5;
        let mut sum = 0.0;
        for [east, north, phase] in self.waves {
            sum += share * (1.0 - libm::sin(east * at.x + north * at.y + phase).abs());
            share *= 0.5;
        }
        sum
    }

    /// The height at a place, metres, at the lengths of Table 4.
    fn height_m(&self, at: Vec2) -> f64 {
        let (wide_m, steep) = self.sides[usize::from(at.y > 0.0)];
        let rough = self.fractal(at);
        let off_m = at.y.abs();
        let up_m = match self.place {
            // Spurs lead down into it.
            Landscape::Valley | Landscape::Corridor => {
                steep * (off_m - wide_m * (0.4 + 1.2 * rough)).max(0.0)
            }
            Landscape::Ridges => {
                let crest_m = |&[along_m, broad_m, high_m, slant]: &[f64; 4]| {
                    let across = (at.x - along_m - slant * at.y) / broad_m;
                    let rises = (off_m / (2.0 * wide_m)).min(1.0);
                    high_m * rises * (1.0 - across * across).max(0.0) * (0.6 + 0.8 * rough)
                };
                self.crests.iter().map(crest_m).fold(0.0, f64::max)
            }
            Landscape::GroundWall => {
                let is_wall = |&[along_m, broad_m, _, slant]: &[f64; 4]| {
                    (0.0..=broad_m).contains(&(at.x - along_m - slant * at.y))
                };
                let is_wall = self.crests.iter().any(is_wall) && off_m > 0.5 * wide_m + 25.0;
                if is_wall { HIGHEST_M } else { 0.0 }
            }
        };
        let height_m = self.floor_m + 25.0 * rough + up_m;
        height_m.min(if off_m < 30.0 { BELOW_M } else { HIGHEST_M })
    }

    fn ground(&self, random: &mut Random, scale: f64) -> Option<WorldGround> {
        let corner = Vec2::splat(-0.5 * POST_M * f64::from(POSTS - 1));
        let mut heights_m = Vec::with_capacity((POSTS * POSTS) as usize);
        for row in 0..POSTS {
            for column in 0..POSTS {
                let at = corner + POST_M * Vec2::new(f64::from(column), f64::from(row));
                let is_hole = random.unit() < 0.002 && at.y.abs() > 60.0;
                let height_m = if is_hole {
                    f64::NAN
                } else {
                    scale * self.height_m(at)
                };
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "heights to less than a millimetre"
                )]
                heights_m.push(height_m as f32);
            }
        }
        let place = (scale * corner, Vec2::splat(scale * POST_M));
        let asked_m = (scale * ASKED_M.0, scale * ASKED_M.1);
        WorldGround::new(place, POSTS as usize, heights_m, asked_m).ok()
    }
}

/// A fence 40 to 300 m off the mission, and two zones within it.
fn corridor(random: &mut Random, scale: f64) -> Vec<WorldZone> {
    let least_m = random.within(Range(40.0, 200.0));
    let edge = |random: &mut Random, side: f64| -> Vec<Vec2> {
        let off_m = |random: &mut Random| side * random.within(Range(least_m, least_m + 100.0));
        let mut corners: Vec<Vec2> = (0..22)
            .map(|index| Vec2::new(-600.0 + 150.0 * f64::from(index), off_m(random)))
            .collect();
        corners.push(Vec2::new(1e5, side * least_m));
        corners
    };
    let mut fence = edge(random, -1.0);
    fence.extend(edge(random, 1.0).into_iter().rev());
    let mut zones = vec![zone("fence", true, &fence, scale)];
    for name in ["one", "other"] {
        let size_m = random.within(Range(5.0, 80.0));
        let off_m = random.sign() * (size_m + random.within(Range(2.0, 80.0)));
        let center = Vec2::new(random.within(Range(100.0, 1200.0)), off_m);
        let count = random.count(3, 11);
        let corners: Vec<Vec2> = (0..count)
            .map(|corner| {
                let turns = (f64::from(corner) + 0.8 * random.unit()) / f64::from(count);
                let direction = super::random::level(turns).truncate();
                center + random.within(Range(0.3, 1.0)) * size_m * direction
            })
            .collect();
        zones.push(zone(name, false, &corners, scale));
    }
    zones
}

fn zone(name: &str, keep_in: bool, corners: &[Vec2], scale: f64) -> WorldZone {
    let outline = corners.iter().map(|corner| scale * *corner).collect();
    WorldZone::new(
        name.into(),
        keep_in,
        WorldOutline::Polygon(outline),
        ALL_HEIGHTS_M,
    )
    .unwrap_or_else(|_| unreachable!("without floor and ceiling"))
}
