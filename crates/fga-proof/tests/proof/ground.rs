//! The ground against code of this test: the certificate is never above what a flight keeps.
//!
//! The flights are integrated here in steps of a millisecond, the ground is looked up here, at each step that can be too low.
//! 40,000 flights by default; `FGA_GROUND_CASES` sets another number, `FGA_FIRST_CASE` draws others.

use core::f64::consts::TAU;

use crate::flown::{Flown, INTEGRATED_M, STEP_S, drawn, number};
use crate::random::Random;
use fga_proof::assumptions::Assumptions;
use fga_proof::certificate::{Line, STEEPEST, Status, Zones, certify_set};
use fga_proof::ground::{Binding, Ground};
use fga_proof::meter::Meter;
use fga_proof::prediction::{FlightPath, Flyer, MotionState};
use fga_proof::situation::Mission;
use fga_proof::{Vec2, Vec3};

/// What the certificate may ask for beyond the target, metres.
const SLACK_M: f64 = 0.01;

/// A grid of heights and its peaks.
struct Grid {
    corner: Vec2,
    spacing: Vec2,
    columns: usize,
    heights: Vec<f32>,
    peaks: Vec<f32>,
    /// Places of unknown posts, from the corner.
    holes: Vec<Vec2>,
}

impl Grid {
    fn new(corner: Vec2, spacing: Vec2, columns: usize, heights: Vec<f32>) -> Self {
        let mut peaks = vec![0.0; Ground::peak_count(columns, heights.len())];
        Ground::fill_peaks(columns, &heights, &mut peaks);
        let holes = (0..heights.len()).filter(|index| heights[*index].is_nan());
        let holes = holes
            .map(|index| Vec2::new((index % columns) as f64, (index / columns) as f64) * spacing);
        Self {
            holes: holes.collect(),
            corner,
            spacing,
            columns,
            heights,
            peaks,
        }
    }

    fn ground(&self, error_m: f64, clearance_m: f64) -> Ground<'_> {
        let slices = (self.heights.as_slice(), self.peaks.as_slice());
        let errors = (error_m, clearance_m);
        Ground::new((self.corner, self.spacing), self.columns, slices, errors).unwrap()
    }

    /// The ground at a place; `None` where it is unknown.
    fn height(&self, at: Vec2) -> Option<f64> {
        let rows = self.heights.len() / self.columns;
        let x = (at.x - self.corner.x) / self.spacing.x;
        let y = (at.y - self.corner.y) / self.spacing.y;
        if x < 0.0 || y < 0.0 || x > (self.columns - 1) as f64 || y > (rows - 1) as f64 {
            return None;
        }
        let (column, row) = (
            (x as usize).min(self.columns - 2),
            (y as usize).min(rows - 2),
        );
        let post = |right: usize, up: usize| {
            f64::from(self.heights[(row + up) * self.columns + column + right])
        };
        let (u, v) = (x - column as f64, y - row as f64);
        let height = (1.0 - u) * (1.0 - v) * post(0, 0)
            + u * (1.0 - v) * post(1, 0)
            + (1.0 - u) * v * post(0, 1)
            + u * v * post(1, 1);
        (!height.is_nan()).then_some(height)
    }

    /// The highest ground of a square; infinite where something is unknown.
    fn highest(&self, at: Vec2, beside: f64) -> f64 {
        let within = |at: f64, corner: f64, spacing: f64| {
            let first = ((at - beside - corner) / spacing).ceil() as i64;
            let last = ((at + beside - corner) / spacing).floor() as i64;
            let lines = (first..=last).map(move |line| corner + line as f64 * spacing);
            lines.chain([at - beside, at + beside])
        };
        let mut highest = f64::NEG_INFINITY;
        for x in within(at.x, self.corner.x, self.spacing.x) {
            for y in within(at.y, self.corner.y, self.spacing.y) {
                let height = self.height(Vec2::new(x, y)).unwrap_or(f64::INFINITY);
                highest = highest.max(height);
            }
        }
        highest
    }

    /// At least so far off is what is unknown.
    fn known_m(&self, at: Vec2) -> f64 {
        let rows = self.heights.len() / self.columns;
        let end = Vec2::new((self.columns - 1) as f64, (rows - 1) as f64) * self.spacing;
        let inside = (at - self.corner).min(self.corner + end - at).min_element();
        let holes = self
            .holes
            .iter()
            .map(|hole| ((at - self.corner - *hole).abs() - self.spacing).max_element());
        holes.fold(inside, f64::min)
    }

    /// The steepest slope between two neighbours.
    fn steepest(&self) -> f64 {
        let mut most = 0.0_f64;
        for (index, here) in self.heights.iter().enumerate() {
            let beside = self
                .heights
                .get(index + 1)
                .filter(|_| (index + 1) % self.columns > 0);
            let above = self.heights.get(index + self.columns);
            for (other, spacing) in [(beside, self.spacing.x), (above, self.spacing.y)] {
                let rise = other.map_or(0.0, |other| f64::from((other - here).abs()) / spacing);
                most = if rise > most { rise } else { most };
            }
        }
        most
    }
}

impl Random {
    /// Fractal ground, cliffs or plateaus around a place, as high as that at some place, or holes in it.
    fn grid(&mut self, center: Vec3) -> Grid {
        let count = |random: &mut Self| random.within(2.0, 70.0) as usize;
        let (columns, rows) = (count(self), count(self));
        let spacing = Vec2::new(self.within(5.0, 120.0), self.within(5.0, 120.0));
        let corner = center.truncate()
            - Vec2::new(
                self.within(0.2, 0.8) * spacing.x * columns as f64,
                self.within(0.2, 0.8) * spacing.y * rows as f64,
            );
        let rough = if self.chance(0.05) {
            9000.0
        } else {
            self.within(0.0, 150.0)
        };
        let kind = self.unit();
        // Waves of ever shorter length; cliffs and plateaus are the same, cut into steps.
        let waves: Vec<_> = (0..7)
            .map(|octave| {
                let along = 0.05 * f64::from(1 << octave) * Vec2::from_angle(self.within(0.0, TAU));
                let high = rough * self.within(0.2, 1.0) / f64::from(1 << octave);
                let begin = self.within(0.0, TAU);
                let angles = |first: f64, step: f64, count: usize| -> Vec<Vec2> {
                    let angle = |index| Vec2::from_angle(first + step * index as f64);
                    (0..count).map(angle).collect()
                };
                let across = angles(begin, along.x, columns);
                (high, across, angles(0.0, along.y, rows))
            })
            .collect();
        let step = self.within(0.2, 1.0) * rough;
        let mut heights: Vec<f32> = (0..columns * rows)
            .map(|index| {
                let (column, row) = (index % columns, index / columns);
                let high: f64 = waves
                    .iter()
                    .map(|(high, x, y)| high * x[column].rotate(y[row]).y)
                    .sum();
                let cut = if kind < 0.4 || step <= 0.0 {
                    high
                } else if kind < 0.7 {
                    (high / step).floor() * step
                } else {
                    high.clamp(-0.3 * step, 0.3 * step)
                };
                cut as f32
            })
            .collect();
        let place = (self.unit() * heights.len() as f64) as usize;
        let lift = center.z as f32 - heights[place] - self.within(-20.0, 60.0) as f32;
        for height in &mut heights {
            *height = (*height + lift).clamp(-9000.0, 9000.0);
        }
        if self.chance(0.15) {
            for _ in 0..=(self.unit() * 4.0) as usize {
                let hole = (self.unit() * heights.len() as f64) as usize;
                heights[hole] = f32::NAN;
            }
        }
        Grid::new(corner, spacing, columns, heights)
    }
}

#[test]
fn no_ground_is_nearer_than_certified() {
    let cases = number("FGA_GROUND_CASES", 40_000);
    let (mut clear, mut entered, mut certified, mut most_work, mut open) = (0, 0, 0, 0, 0);
    for case in drawn(cases) {
        let random = &mut Random(0x6a0d_0000 + case);
        let vehicle = random.vehicle();
        let maneuver = random.maneuver();
        let wind = random.wind_mps(vehicle.airspeed_mps);
        let horizon_s = random.within(2.0, 20.0);
        let flyer = Flyer::new(&vehicle);
        let mut path = FlightPath::new();
        path.predict(&flyer, &MotionState::ahead(0.0), &maneuver, horizon_s);
        let near_s = random.within(0.0, horizon_s);
        // A steep roll may need more nodes than there are.
        if !path.is_complete() {
            continue;
        }
        let Some(near) = path.state_at(&flyer, near_s) else {
            continue;
        };
        let grid = random.grid(near.position_m + wind * near_s);
        let (error_m, clearance_m) = (random.within(0.0, 16.0), random.within(0.0, 20.0));
        let ground = grid.ground(error_m, clearance_m);
        let needed_m = error_m + clearance_m;
        let mut zones = Zones::NONE;
        zones.clear(wind, f64::INFINITY);
        let meter = Meter::unlimited();
        let mission = Mission {
            ground: Some(&ground),
            ..Mission::NONE
        };
        let around = Assumptions::new(&[], &zones, &mission);
        let asked = (horizon_s, f64::MIN, 1e3);
        let found = certify_set(&flyer, &path, &around, asked, &meter);
        // Beside cliffs the looks along a line may end before it is known how deep it comes: then it counts as deepest.
        let steepest = grid.steepest();
        let is_open = found.margin_m == f64::NEG_INFINITY && steepest > 10.0;
        open += u64::from(is_open);
        let is_known = found.status == Status::Proven || is_open;
        assert!(is_known, "{case} {found:?} {steepest} {:?}", grid.spacing);
        let target_m = random.within(0.0, 15.0);
        let before = meter.done();
        let asked = (horizon_s, target_m, target_m);
        let proven = crate::proven((&flyer, &mut path), &maneuver, &around, asked, &meter);
        most_work = most_work.max(meter.done() - before);
        certified += u64::from(proven.is_some());
        let bound_m = found
            .margin_m
            .max(proven.map_or(f64::MIN, |proven| proven.bound().margin_m));
        let speed_mps = vehicle.airspeed_mps + wind.length();
        let asked_m = target_m + path.remainder_m() + SLACK_M + STEP_S * speed_mps;
        // Within so much the certificate looks at the posts themselves.
        let is_fine = asked_m < grid.spacing.min_element();
        // Its height above the ground falls no faster.
        let falls_mps = speed_mps * (1.0 + 1.5 * steepest);
        let mut flown = Flown::new(&vehicle, &maneuver, wind);
        // A flight keeps a certified margin. The certificate splits no piece shorter than a centimetre, so it certifies a margin that a
        // flight keeps by more than that.
        let beside_m = [(bound_m - INTEGRATED_M).max(0.0), asked_m];
        let least_m = [-INTEGRATED_M * (1.0 + steepest), 0.02 + 0.03 * steepest];
        let is_judged = [bound_m >= 0.0, is_fine && proven.is_none()];
        let mut look_s = is_judged.map(|judged| if judged { 0.0 } else { f64::INFINITY });
        let mut kept = is_judged;
        while flown.time_s <= horizon_s && look_s[0].min(look_s[1]) <= horizon_s {
            for which in 0..2 {
                if flown.time_s >= look_s[which] {
                    let (at, beside_m) = (flown.at.truncate(), beside_m[which]);
                    let needed_m = needed_m + beside_m + least_m[which];
                    let above_m = flown.at.z - needed_m - grid.highest(at, beside_m);
                    kept[which] = above_m >= 0.0;
                    let known_s = (grid.known_m(at) - beside_m) / speed_mps;
                    look_s[which] = if kept[which] {
                        flown.time_s + known_s.min(above_m / falls_mps)
                    } else {
                        f64::INFINITY
                    };
                }
            }
            flown.step();
        }
        if bound_m >= 0.0 {
            clear += 1;
            assert!(kept[0], "{case}: {bound_m} is not kept");
        } else {
            entered += 1;
            assert!(proven.is_none(), "{case}");
        }
        assert!(!kept[1], "{case}: {target_m} is not found");
    }
    println!(
        "{clear} clear, {entered} not, {certified} certified, {open} open, most work {most_work}"
    );
    assert!(open <= 1 + cases / 100_000, "{open}");
    assert!(clear > cases / 5 && entered > cases / 5 && certified > cases / 5);
}

/// Posts 10 m apart from the origin on, by a height for each.
fn posts(columns: usize, rows: usize, height: impl Fn(f64, f64) -> f64) -> Grid {
    let heights = (0..columns * rows).map(|index| {
        let (column, row) = (index % columns, index / columns);
        height(10.0 * column as f64, 10.0 * row as f64) as f32
    });
    let heights = heights.collect();
    Grid::new(Vec2::ZERO, Vec2::splat(10.0), columns, heights)
}

/// Whether a line clears ground, 30 m of error and clearance beside, by a margin.
fn clears(grid: &Grid, (from, to): ([f64; 3], [f64; 3]), margin_m: f64) -> bool {
    let line = Line::between(Vec3::from_array(from), Vec3::from_array(to));
    let meter = Meter::unlimited();
    let found = (grid.ground(10.0, 20.0)).least_on_line(&line, margin_m, Binding::ALL, &meter);
    // A margin that is not kept is known to a part, from below.
    assert!(found.is_none_or(|(found_m, _)| found_m < margin_m));
    found.is_none()
}

#[test]
fn over_level_ground_the_margin_is_the_height() {
    let grid = posts(20, 20, |_, _| 100.0);
    let line = ([30.0, 40.0, 142.0], [150.0, 90.0, 160.0]);
    assert!(clears(&grid, line, 11.98) && !clears(&grid, line, 12.02));
    let low = ([30.0, 40.0, 160.0], [150.0, 90.0, 129.0]);
    assert!(!clears(&grid, low, 0.0));
    // The depth is known to 0.1 m, at the moment at which it is lowest.
    let line = Line::between(Vec3::from_array(low.0), Vec3::from_array(low.1));
    let ground = grid.ground(10.0, 20.0);
    let found = ground.deepest(&line, Binding::ALL, &Meter::unlimited());
    let (depth_m, at_s) = found;
    assert!((-1.2..=-1.0).contains(&depth_m) && at_s == 1.0, "{found:?}");
}

/// An earlier version stopped where the flight came too low first, so that no ground was deeper than another.
#[test]
fn a_flight_into_a_ridge_is_as_deep_as_at_its_crest() {
    let grid = posts(60, 20, |x, _| (100.0 - (x - 250.0).abs()).max(0.0));
    let (from_m, to_m) = (Vec3::new(60.0, 90.0, 90.0), Vec3::new(460.0, 90.0, 90.0));
    let (line, meter) = (Line::between(from_m, to_m), Meter::unlimited());
    let ground = grid.ground(10.0, 20.0);
    let mission = Mission {
        ground: Some(&ground),
        ..Mission::new(&[])
    };
    let mut zones = Zones::NONE;
    zones.clear(Vec3::ZERO, 60.0);
    let (fixed, clear) = (Assumptions::new(&[], &zones, &mission).fixed, (5.0, 0.0));
    // 40 m below what clears the crest, 190 m after the start; what clears it may be as near as steep ground allows.
    let depth = ground.least_on_line(&line, 5.0, Binding::ALL, &meter);
    let away = fixed.lower(&line, clear, -100.0, &meter);
    for ((depth_m, at_s), share) in [(depth.unwrap(), 1.0), (away, STEEPEST)] {
        let depth_m = depth_m * share;
        assert!((-40.2..=-40.0).contains(&depth_m), "{depth_m} m");
        assert!((at_s - 190.0 / 400.0).abs() < 0.01, "{at_s} s");
    }
    // Below a floor any depth will do.
    let stopped_m = fixed.lower(&line, clear, -10.0, &meter).0 * STEEPEST;
    assert!((-40.2..-10.0).contains(&stopped_m), "{stopped_m} m");
}

/// Within m to the side the slope of 1 in 2 rises by m / 2: 45 m above, less 30 m, leave 10 m.
#[test]
fn over_a_slope_the_margin_counts_to_the_side_too() {
    let grid = posts(40, 20, |x, _| 0.5 * x);
    let along = ([100.0, 60.0, 95.0], [100.0, 130.0, 95.0]);
    assert!(clears(&grid, along, 9.98) && !clears(&grid, along, 10.02));
    let up = ([100.0, 100.0, 95.0], [200.0, 100.0, 145.0]);
    assert!(clears(&grid, up, 9.98) && !clears(&grid, up, 10.02));
}

/// From one corner to the other the ground is highest in the middle, 25 m.
#[test]
fn between_the_posts_the_ground_bends() {
    let grid = posts(2, 2, |x, y| x * y);
    let along = |z| ([1.0, 9.0, z], [9.0, 1.0, z]);
    assert!(clears(&grid, along(55.1), 0.0) && !clears(&grid, along(54.99), 0.0));
    let across = |z| ([1.0, 1.0, z - 80.0], [9.0, 9.0, z]);
    // Its ends are 1 m and 81 m high, and it sags between them.
    assert!(clears(&grid, across(111.1), 0.0) && !clears(&grid, across(110.99), 0.0));
}

#[test]
fn beside_a_cliff_the_margin_is_the_distance() {
    // It rises from 190 to 200 m.
    let grid = posts(60, 20, |x, _| if x < 195.0 { 0.0 } else { 500.0 });
    let beside = ([180.0, 40.0, 142.0], [180.0, 90.0, 142.0]);
    // 12 m to the side it is 100 m high, and 30 m below this the flight may sink by 12 m.
    assert!(clears(&grid, beside, 11.98) && !clears(&grid, beside, 12.02));
}

#[test]
fn unknown_ground_is_clear_only_where_it_does_not_bind() {
    let hole = |x: f64, y: f64| {
        if (x, y) == (50.0, 50.0) {
            f64::NAN
        } else {
            0.0
        }
    };
    let grid = posts(20, 20, hole);
    let ground = grid.ground(10.0, 20.0);
    let over = |x, z, spares_unknown| {
        let line = Line::between(Vec3::new(x, 20.0, z), Vec3::new(x, 90.0, z));
        let binding = Binding {
            lowered_m: 0.0,
            spares_unknown,
        };
        (ground.least_on_line(&line, 5.0, binding, &Meter::unlimited()))
            .map(|(margin_m, _)| margin_m)
    };
    assert_eq!(over(70.0, 100.0, false), None);
    let barely = |found: Option<f64>| found.is_some_and(|found_m| (-0.2..0.0).contains(&found_m));
    assert!(barely(over(45.0, 100.0, false)));
    assert_eq!(over(45.0, 100.0, true), None);
    // What is known beside it binds all the same.
    assert!(over(45.0, 20.0, true).is_some_and(|found_m| found_m <= -10.0));
    // Outside too.
    assert!(barely(over(-30.0, 100.0, false)));
    assert_eq!(over(-30.0, 100.0, true), None);
}

#[test]
fn what_is_far_above_takes_one_look() {
    let spike = |x: f64, y: f64| {
        if (x, y) == (1230.0, 450.0) {
            800.0
        } else {
            0.0
        }
    };
    let grid = posts(200, 90, spike);
    let ground = grid.ground(0.0, 0.0);
    let looks = |z| {
        let meter = Meter::unlimited();
        let line = Line::between(Vec3::new(60.0, 60.0, z), Vec3::new(1900.0, 800.0, z));
        let found = ground.least_on_line(&line, 25.0, Binding::ALL, &meter);
        (found.is_none(), meter.done())
    };
    let (is_clear, work) = looks(851.0);
    assert!(is_clear && work <= 6, "{work}");
    // Past the spike, of whose cells it flies over none.
    let (is_clear, work) = looks(200.0);
    assert!(is_clear && work < 2000, "{work}");
    // Without the work, nothing is clear.
    let line = Line::between(
        Vec3::new(60.0, 60.0, 200.0),
        Vec3::new(1900.0, 800.0, 200.0),
    );
    let found = ground.least_on_line(&line, 50.0, Binding::ALL, &Meter::new(10, 10));
    assert_eq!(found, Some((f64::NEG_INFINITY, 0.0)));
}

#[test]
fn a_grid_that_cannot_be_right_is_refused() {
    let (corner, spacing) = (Vec2::ZERO, Vec2::splat(30.0));
    let made = |spacing, columns, heights: &[f32], peaks: &[f32], errors| {
        Ground::new((corner, spacing), columns, (heights, peaks), errors).is_ok()
    };
    let heights = [0.0_f32; 36];
    assert_eq!(Ground::peak_count(6, 36), 4);
    assert!(made(spacing, 6, &heights, &[0.0; 4], (1.0, 2.0)));
    assert!(!made(spacing, 6, &heights, &[0.0; 3], (1.0, 2.0)));
    assert!(!made(spacing, 0, &heights, &[], (1.0, 2.0)));
    assert!(!made(spacing, 36, &heights, &[], (1.0, 2.0)));
    assert!(!made(-spacing, 6, &heights, &[0.0; 4], (1.0, 2.0)));
    assert!(!made(spacing, 6, &heights, &[0.0; 4], (f64::NAN, 2.0)));
    assert!(!made(spacing, 6, &heights, &[0.0; 4], (1.0, -2.0)));
}
