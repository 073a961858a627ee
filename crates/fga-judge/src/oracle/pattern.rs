//! Climbs on any function of a manoeuvre, by trial.
//!
//! Ridges stop a search along the axes. So each step size tries the axes, the pairs of axes and
//! random directions, in a fixed order from a fixed generator, and halves when none of them climbs.

use super::{OracleManeuver, OracleVehicle};

/// First steps of wait, turn, climb, straight, turn, climb (s, rad, rad, s, rad, rad).
const FIRST_STEPS: [f64; 6] = [0.5, 0.13, 0.1, 0.5, 0.13, 0.1];
/// Halvings for the many, and for the few that stay in the race.
const SHORT_HALVINGS: usize = 3;
const LONG_HALVINGS: usize = 7;
/// Seeds with the full treatment.
const FINALISTS: usize = 4;
/// Random directions at each step size.
const RANDOM_DIRECTIONS: usize = 8;

type PatternPoint = [f64; 6];

/// Climbs on a function of a manoeuvre. The function may return anything up to its second argument
/// once it is sure not to exceed it.
pub(super) struct Refiner<'a, F> {
    vehicle: &'a OracleVehicle,
    horizon_s: f64,
    value: F,
    /// The best manoeuvre so far and its value.
    pub(super) best: (f64, OracleManeuver),
}

impl<'a, F: FnMut(&OracleManeuver, f64) -> f64> Refiner<'a, F> {
    pub(super) fn new(
        vehicle: &'a OracleVehicle,
        horizon_s: f64,
        value: F,
        best: (f64, OracleManeuver),
    ) -> Self {
        Self {
            vehicle,
            horizon_s,
            value,
            best,
        }
    }

    /// Climbs from every seed a little, from the best of them all the way.
    pub(super) fn refine(&mut self, seeds: &[(f64, OracleManeuver)]) {
        let axes: &[usize] = if self.vehicle.can_climb() {
            &[1, 4, 3, 0, 2, 5]
        } else {
            &[1, 4, 3, 0]
        };
        let mut race: Vec<(f64, PatternPoint)> = Vec::with_capacity(seeds.len());
        for (_, seed) in seeds {
            let value = (self.value)(seed, f64::NEG_INFINITY);
            let point = seed.to_array();
            self.keep(value, &point);
            race.push((value, point));
        }
        race.sort_by(|a, b| b.0.total_cmp(&a.0));
        for entry in &mut race {
            self.climb(entry, axes, 1.0, SHORT_HALVINGS);
        }
        race.sort_by(|a, b| b.0.total_cmp(&a.0));
        let scale = 1.0 / f64::from(1_u32 << (SHORT_HALVINGS - 1));
        for entry in race.iter_mut().take(FINALISTS) {
            self.climb(entry, axes, scale, LONG_HALVINGS);
        }
    }

    fn keep(&mut self, value: f64, point: &PatternPoint) {
        if value > self.best.0 {
            self.best = (value, OracleManeuver::from_array(*point));
        }
    }

    fn climb(
        &mut self,
        entry: &mut (f64, PatternPoint),
        axes: &[usize],
        scale: f64,
        halvings: usize,
    ) {
        let mut scale = scale;
        let mut random = Lcg(0x9E37_79B9_7F4A_7C15);
        for _ in 0..halvings {
            // A bound on the sweeps of one size; more than a few are rare.
            for _ in 0..40 {
                let before = entry.0;
                self.sweep(entry, axes, scale, &mut random);
                self.keep(entry.0, &entry.1);
                if entry.0 - before < 1e-4 {
                    break;
                }
            }
            scale *= 0.5;
        }
    }

    fn sweep(
        &mut self,
        entry: &mut (f64, PatternPoint),
        axes: &[usize],
        scale: f64,
        random: &mut Lcg,
    ) {
        for (k, &a) in axes.iter().enumerate() {
            self.try_both(entry, scale, &[(a, 1.0)]);
            for &b in axes.iter().skip(k + 1) {
                self.try_both(entry, scale, &[(a, 1.0), (b, 1.0)]);
                self.try_both(entry, scale, &[(a, 1.0), (b, -1.0)]);
            }
        }
        for _ in 0..RANDOM_DIRECTIONS {
            let mut direction = [(0, 0.0); 6];
            for (slot, &axis) in direction.iter_mut().zip(axes) {
                *slot = (axis, random.next());
            }
            self.try_both(entry, scale, direction.get(..axes.len()).unwrap_or(&[]));
        }
    }

    fn try_both(
        &mut self,
        entry: &mut (f64, PatternPoint),
        scale: f64,
        direction: &[(usize, f64)],
    ) {
        for sign in [1.0, -1.0] {
            let mut improved = false;
            // While it climbs, further.
            for _ in 0..20 {
                let mut point = entry.1;
                for &(axis, share) in direction {
                    if let (Some(value), Some(step)) = (point.get_mut(axis), FIRST_STEPS.get(axis))
                    {
                        *value += sign * share * scale * step;
                    }
                }
                self.confine(&mut point);
                if point == entry.1 {
                    break;
                }
                let value = (self.value)(&OracleManeuver::from_array(point), entry.0);
                if value <= entry.0 {
                    break;
                }
                *entry = (value, point);
                improved = true;
            }
            if improved {
                return;
            }
        }
    }

    fn confine(&self, point: &mut PatternPoint) {
        let [wait, _, climb1, straight, _, climb2] = point;
        *wait = wait.clamp(0.0, self.horizon_s);
        *straight = straight.clamp(0.0, self.horizon_s);
        for climb in [climb1, climb2] {
            *climb = climb.clamp(self.vehicle.climb_min_rad, self.vehicle.climb_max_rad);
        }
    }
}

/// A fixed sequence in [−1, 1).
struct Lcg(u64);

impl Lcg {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 * (2.0 / 9_007_199_254_740_992.0) - 1.0
    }
}
