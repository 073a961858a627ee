//! The local part: climbs from the tree's best leaves on the exact margin.
//!
//! The margin is the least of several functions of six numbers, one for each leg and body, each
//! smooth. Near a point their tangents replace them; the largest least within a box is a linear
//! program; the box grows while the prediction holds and shrinks where it does not.

use super::OracleManeuver;
use super::flight::OracleFlight;
use super::linear::{MarginRow, ROWS, UNKNOWNS, largest_least};
use super::separation::{OracleScene, least_margin, leg_margins};

/// Half the first box: wait, turn, climb, straight, turn, climb (s, rad, rad, s, rad, rad).
const FIRST_BOX: AscentPoint = [0.5, 0.13, 0.1, 0.5, 0.13, 0.1];
/// Steps of the difference quotients: some decimetres of path, far above the half millimetre
/// accuracy of a margin.
const DIFFERENCE: AscentPoint = [0.02, 0.01, 0.01, 0.02, 0.01, 0.01];
/// Iterations for every seed, and for the few that stay in the race.
const SHORT: usize = 6;
const LONG: usize = 60;
/// Seeds with the long treatment.
const FINALISTS: usize = 8;
/// A predicted gain that ends the ascent, metres.
const NO_GAIN_M: f64 = 1e-3;
/// A box this small also ends it.
const LEAST_SCALE: f64 = 2e-4;

type AscentPoint = [f64; UNKNOWNS];

#[derive(Debug, Clone, Copy)]
struct Climber {
    margin: f64,
    point: AscentPoint,
    scale: f64,
    done: bool,
}

pub(super) struct OracleAscent<'a> {
    scene: OracleScene<'a>,
    enough: f64,
    flight: OracleFlight,
    here: Vec<f64>,
    there: Vec<f64>,
    slopes: Vec<MarginRow>,
    /// The best manoeuvre so far and its exact margin.
    pub(super) best: (f64, OracleManeuver),
}

impl<'a> OracleAscent<'a> {
    pub(super) fn new(scene: OracleScene<'a>, enough: f64) -> Self {
        Self {
            scene,
            enough,
            flight: OracleFlight::default(),
            here: Vec::new(),
            there: Vec::new(),
            slopes: Vec::new(),
            best: (f64::NEG_INFINITY, OracleManeuver::default()),
        }
    }

    /// The exact margin of a manoeuvre; keeps the best so far.
    pub(super) fn look(&mut self, maneuver: &OracleManeuver) -> f64 {
        self.scene.fly(maneuver, None, &mut self.flight);
        let margin = least_margin(&self.flight, self.scene.bodies, f64::NEG_INFINITY);
        if margin > self.best.0 {
            self.best = (margin, *maneuver);
        }
        margin
    }

    fn enough(&self) -> bool {
        self.best.0 >= self.enough
    }

    /// Climbs from every seed a little, from the best of them all the way.
    pub(super) fn refine(&mut self, seeds: &[(f64, OracleManeuver)], two: bool) {
        let mut race = Vec::with_capacity(seeds.len());
        for (_, seed) in seeds {
            let margin = self.look(seed);
            if self.enough() {
                return;
            }
            race.push(Climber {
                margin,
                point: seed.to_array(),
                scale: 1.0,
                done: false,
            });
        }
        for (iterations, count) in [(SHORT, race.len()), (LONG, FINALISTS)] {
            race.sort_by(|a, b| b.margin.total_cmp(&a.margin));
            for climber in race.iter_mut().take(count) {
                self.climb(climber, iterations, two);
                if self.enough() {
                    return;
                }
            }
        }
    }

    fn climb(&mut self, climber: &mut Climber, iterations: usize, two: bool) {
        for _ in 0..iterations {
            if climber.done || self.enough() {
                return;
            }
            self.tangents(climber, two);
            let (low, high) = self.limits(climber, two);
            let (step, predicted) = largest_least(&self.slopes, &low, &high);
            let gain = predicted - climber.margin;
            if gain < NO_GAIN_M {
                climber.done = true;
                return;
            }
            let mut next = climber.point;
            for (value, change) in next.iter_mut().zip(step) {
                *value += change;
            }
            if !two {
                next[5] = next[2];
            }
            let margin = self.look(&OracleManeuver::from_array(next));
            let share = (margin - climber.margin) / gain;
            if margin > climber.margin {
                climber.point = next;
                climber.margin = margin;
            }
            climber.scale *= if share > 0.75 {
                2.0
            } else if share > 0.25 {
                1.0
            } else {
                0.35
            };
            climber.scale = climber.scale.min(4.0);
            climber.done = climber.scale < LEAST_SCALE;
        }
    }

    /// The box around a point: as large as trusted, within the flyable range.
    fn limits(&self, climber: &Climber, two: bool) -> (AscentPoint, AscentPoint) {
        let (mut low, mut high) = ([0.0; UNKNOWNS], [0.0; UNKNOWNS]);
        let (vehicle, horizon_s) = (self.scene.vehicle, self.scene.horizon_s);
        let climbs = vehicle.can_climb();
        for (k, (low, high)) in low.iter_mut().zip(&mut high).enumerate() {
            let free = match k {
                0 | 1 => true,
                2 => climbs,
                5 => climbs && two,
                _ => two,
            };
            if !free {
                continue;
            }
            let half = climber.scale * FIRST_BOX[k];
            let (least, most) = match k {
                0 | 3 => (0.0, horizon_s),
                2 | 5 => (vehicle.climb_min_rad, vehicle.climb_max_rad),
                _ => (f64::NEG_INFINITY, f64::INFINITY),
            };
            let at = climber.point[k];
            *low = (-half).max(least - at).min(0.0);
            *high = half.min(most - at).max(0.0);
        }
        (low, high)
    }

    /// Value and gradient of each leg's margin to each body that matters within the box.
    fn tangents(&mut self, climber: &Climber, two: bool) {
        let band = climber.margin + 0.5 + 15.0 * climber.scale.max(0.05);
        let (scene, flight) = (self.scene, &mut self.flight);
        scene.fly(&OracleManeuver::from_array(climber.point), None, flight);
        let mut here = core::mem::take(&mut self.here);
        leg_margins(flight, scene.bodies, band, &mut here);
        self.slopes.clear();
        // The lowest of them, as many as fit.
        let mut lowest: Vec<usize> = (0..here.len()).filter(|&j| here[j] < band).collect();
        lowest.sort_by(|&a, &b| here[a].total_cmp(&here[b]));
        lowest.truncate(ROWS);
        self.slopes.extend(lowest.iter().map(|&j| MarginRow {
            value: here[j],
            gradient: [0.0; UNKNOWNS],
        }));
        let mut there = core::mem::take(&mut self.there);
        let whole = Climber {
            scale: 1.0,
            ..*climber
        };
        let (low, high) = self.limits(&whole, two);
        for k in 0..UNKNOWNS {
            // Away from the nearer limit.
            let change = if high[k] >= DIFFERENCE[k] {
                DIFFERENCE[k]
            } else if low[k] <= -DIFFERENCE[k] {
                -DIFFERENCE[k]
            } else {
                continue;
            };
            let mut beside = climber.point;
            beside[k] += change;
            if !two {
                beside[5] = beside[2];
            }
            let flight = &mut self.flight;
            scene.fly(&OracleManeuver::from_array(beside), None, flight);
            leg_margins(flight, scene.bodies, band + 5.0, &mut there);
            for (slope, &j) in self.slopes.iter_mut().zip(&lowest) {
                slope.gradient[k] = (there[j] - here[j]) / change;
            }
        }
        self.here = here;
        self.there = there;
    }
}
