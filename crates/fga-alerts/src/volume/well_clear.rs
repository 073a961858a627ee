//! Well clear in distance and time.
//!
//! Violated while both hold: horizontally closer than `DMOD`, or the modified tau within `τ`
//! and the closest approach within `HMD = DMOD`; vertically closer than `ZTHR`, or co-altitude
//! within `TCOA`. Sources: RTCA DO-365B; Muñoz, Narkawicz, Chamberlain, Consiglio, Upchurch, "A
//! Family of Well-Clear Boundary Models", AIAA 2014-2412.

use crate::aircraft::Pair;
use crate::almost::Closeness;
use crate::loss::Loss;
use crate::plane::{
    Crossing, circle_crossing_s, circle_crossings, modified_tau_s, room, time_to_closest_s,
};
use crate::units::{FOOT_M, NAUTICAL_MILE_M};
use crate::volume::cylinder::slab_crossing_s;
use glam::DVec2;

/// The time that warns of an approach before the distance does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum HorizontalTime {
    /// Modified tau, as in DO-365.
    #[default]
    ModifiedTau,
    /// Time to the closest approach.
    ClosestApproach,
    /// Time to the entry into the distance.
    Entry,
}

/// The time that warns of co-altitude before the height does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VerticalTime {
    /// Time to co-altitude, as in DO-365.
    #[default]
    Coaltitude,
    /// A height that grows with the closing climb rate.
    RelativeClimb,
}

/// Thresholds of well clear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WellClear {
    /// Horizontal distance (`DMOD` and `HMD`), metres.
    pub distance_m: f64,
    /// Horizontal time (`τ_mod`), seconds.
    pub tau_s: f64,
    /// Vertical distance (`ZTHR`), metres.
    pub height_m: f64,
    /// Vertical time (`TCOA`), seconds.
    pub coaltitude_s: f64,
    /// The kind of horizontal time.
    pub horizontal_time: HorizontalTime,
    /// The kind of vertical time.
    pub vertical_time: VerticalTime,
}

impl WellClear {
    /// En route (DO-365B phase 1): 0.66 nmi, 35 s, 450 ft.
    pub const EN_ROUTE: Self = Self::do_365(0.66 * NAUTICAL_MILE_M, 35.0, 450.0 * FOOT_M, 0.0);
    /// En route, preventive: 0.66 nmi, 35 s, 700 ft.
    pub const EN_ROUTE_PREVENTIVE: Self =
        Self::do_365(0.66 * NAUTICAL_MILE_M, 35.0, 700.0 * FOOT_M, 0.0);
    /// Terminal area (DO-365B phase 2): 1,500 ft, 450 ft.
    pub const TERMINAL: Self = Self::do_365(1500.0 * FOOT_M, 0.0, 450.0 * FOOT_M, 0.0);
    /// Against aircraft without transponder: 2,200 ft, 450 ft.
    pub const NON_COOPERATIVE: Self = Self::do_365(2200.0 * FOOT_M, 0.0, 450.0 * FOOT_M, 0.0);

    /// Thresholds of DO-365: modified tau and time to co-altitude.
    pub const fn do_365(distance_m: f64, tau_s: f64, height_m: f64, coaltitude_s: f64) -> Self {
        Self {
            distance_m,
            tau_s,
            height_m,
            coaltitude_s,
            horizontal_time: HorizontalTime::ModifiedTau,
            vertical_time: VerticalTime::Coaltitude,
        }
    }

    /// Whether well clear is lost now.
    pub fn is_violated(&self, pair: &Pair) -> bool {
        let (s, v) = pair.plane();
        let (height_m, climb_mps) = pair.vertical();
        self.is_violated_in_plane(s, v) && self.is_violated_vertically(height_m, climb_mps)
    }

    pub(super) fn is_violated_in_plane(&self, s: DVec2, v: DVec2) -> bool {
        if s.length() <= self.distance_m {
            return true;
        }
        let Some(closest_s) = time_to_closest_s(s, v) else {
            return false;
        };
        let miss = s + v * closest_s;
        if miss.length() > self.distance_m {
            return false;
        }
        let time_s = match self.horizontal_time {
            HorizontalTime::ModifiedTau => modified_tau_s(s, v, self.distance_m),
            HorizontalTime::ClosestApproach => Some(closest_s),
            HorizontalTime::Entry => circle_crossing_s(s, v, self.distance_m, Crossing::Entry),
        };
        time_s.is_some_and(|time_s| (0.0..=self.tau_s).contains(&time_s))
    }

    pub(super) fn is_violated_vertically(&self, height_m: f64, climb_mps: f64) -> bool {
        let window = self.vertical_window(height_m, climb_mps);
        window.entry_s <= 0.0 && 0.0 <= window.exit_s
    }

    /// The whole violation in the plane, seconds from now.
    fn plane_window(&self, s: DVec2, v: DVec2) -> Loss {
        let reach_m2 = self.distance_m * self.distance_m;
        let (square_m2, closing, speed2) = (s.length_squared(), s.dot(v), v.length_squared());
        if square_m2 > reach_m2 && (closing > 0.0 || speed2 == 0.0) {
            return Loss::NEVER;
        }
        let at_rest = Closeness::Rounding.same(speed2, 0.0);
        let crossings = circle_crossings(s, v, self.distance_m);
        let exit_s = crossings.map_or(f64::NEG_INFINITY, |loss| loss.exit_s);
        if square_m2 <= reach_m2 {
            return if at_rest {
                Loss::ALWAYS
            } else {
                Loss::new(f64::NEG_INFINITY, exit_s)
            };
        }
        let crosses = room(s, v, self.distance_m) >= 0.0;
        let entry_s = match self.horizontal_time {
            HorizontalTime::ModifiedTau => {
                let b = 2.0 * closing + self.tau_s * speed2;
                let c = square_m2 + self.tau_s * closing - reach_m2;
                let discriminant = b * b - 4.0 * speed2 * c;
                if closing == 0.0 || discriminant < 0.0 || !crosses {
                    return Loss::NEVER;
                }
                (-b - libm::sqrt(discriminant)) / (2.0 * speed2)
            }
            HorizontalTime::Entry => match crossings {
                Some(loss) if !at_rest && crosses => loss.entry_s - self.tau_s,
                _ => return Loss::NEVER,
            },
            HorizontalTime::ClosestApproach => {
                let closest_s = -closing / speed2;
                let miss = s + v * closest_s;
                if at_rest || miss.length() > self.distance_m {
                    return Loss::NEVER;
                }
                if !crosses {
                    return Loss::new(closest_s - self.tau_s, closest_s);
                }
                let entry_s = crossings.map_or(closest_s, |loss| loss.entry_s);
                entry_s.min(closest_s - self.tau_s)
            }
        };
        Loss::new(entry_s, exit_s)
    }

    /// The violation in the plane within `[0, to_s]`.
    pub(super) fn plane_violation(&self, to_s: f64, s: DVec2, v: DVec2) -> Loss {
        self.plane_window(s, v)
            .and(Loss::new(0.0, to_s))
            .if_lasting()
    }

    /// The whole vertical violation, seconds from now.
    fn vertical_window(&self, height_m: f64, climb_mps: f64) -> Loss {
        if Closeness::Rounding.same(climb_mps, 0.0) {
            return if height_m.abs() <= self.height_m {
                Loss::ALWAYS
            } else {
                Loss::NEVER
            };
        }
        let entry_height_m = match self.vertical_time {
            VerticalTime::Coaltitude => self.height_m.max(climb_mps.abs() * self.coaltitude_s),
            VerticalTime::RelativeClimb => {
                let diverging = if height_m * climb_mps >= 0.0 {
                    1.0
                } else {
                    -1.0
                };
                let grown_m = self.height_m - diverging * climb_mps.abs() * self.coaltitude_s;
                self.height_m.max(grown_m)
            }
        };
        Loss::new(
            slab_crossing_s(height_m, climb_mps, entry_height_m, Crossing::Entry),
            slab_crossing_s(height_m, climb_mps, self.height_m, Crossing::Exit),
        )
    }

    /// The vertical violation within `[from_s, to_s]`, which may be a moment.
    pub(super) fn vertical_violation(
        &self,
        from_s: f64,
        to_s: f64,
        height_m: f64,
        climb_mps: f64,
    ) -> Loss {
        self.vertical_window(height_m, climb_mps)
            .and(Loss::new(from_s, to_s))
    }

    pub(super) fn violation(&self, pair: &Pair, from_s: f64, to_s: f64) -> Loss {
        let (s, v) = pair.plane();
        let (height_m, climb_mps) = pair.vertical();
        let vertical = self.vertical_violation(from_s, to_s, height_m, climb_mps);
        if !vertical.is_conflict() {
            return Loss::NEVER;
        }
        let at_entry = s + v * vertical.entry_s;
        let plane = self.plane_violation(vertical.exit_s - vertical.entry_s, at_entry, v);
        Loss::new(
            plane.entry_s + vertical.entry_s,
            plane.exit_s + vertical.entry_s,
        )
    }
}
