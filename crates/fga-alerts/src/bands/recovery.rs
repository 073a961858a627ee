//! Resolutions where every manoeuvre leads into the corrective volume.

use crate::aircraft::State;
use crate::bands::free::Instead;
use crate::bands::intervals::Intervals;
use crate::bands::shrinking::{Avoided, Blocking};
use crate::bands::span::Span;
use crate::bands::{Contribution, Picture, QuantityBands};
use crate::settings::Settings;
use crate::volume::{Advisory, Cylinder};
use alloc::vec::Vec;

/// The result of recovery bands, where every manoeuvre leads into the corrective volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Recovery {
    /// A free manoeuvre exists; no search for recovery.
    NotNeeded,
    /// Not even the NMAC volume is avoidable.
    Impossible {
        /// Number of shrinkings of its distances.
        shrinkings: i32,
    },
    /// Well clear again after a time, at a distance.
    Found {
        /// Time until well clear again, seconds.
        time_s: f64,
        /// Horizontal distance kept meanwhile, metres.
        distance_m: f64,
        /// Vertical distance kept meanwhile, metres.
        height_m: f64,
        /// Number of shrinkings of the distances.
        shrinkings: i32,
    },
}

impl Recovery {
    /// Number of shrinkings; −1 without a search for recovery.
    pub const fn shrinkings(self) -> i32 {
        match self {
            Self::NotNeeded => -1,
            Self::Impossible { shrinkings } | Self::Found { shrinkings, .. } => shrinkings,
        }
    }
}

/// The outcome of the search.
pub(super) enum WaysOut {
    /// No search for recovery.
    NotLookedFor,
    /// A free interval is a resolution.
    Same,
    /// The resolutions that replace the free values of the corrective region.
    Other(Intervals),
}

/// At the default factor this many shrinkings reach the NMAC volume from any distance.
const MOST_SHRINKINGS: usize = 1000;

impl QuantityBands {
    /// Searches resolutions of a certain conflict.
    pub(super) fn recover(
        &mut self,
        picture: &Picture,
        span: &Span,
        corrective: usize,
    ) -> Intervals {
        let settings = picture.settings;
        let painting = self.painting(picture, corrective);
        let nmac = Cylinder::new(settings.nmac_distance_m, settings.nmac_height_m);
        self.recovery = Recovery::Impossible { shrinkings: 0 };
        if self.is_blocked_at_once(picture, &painting, nmac) {
            return Intervals::default();
        }
        let distances = distances(settings, &picture.ownship.state);
        if distances.is_empty() || !self.surely_frees_any(picture, span, &painting, nmac) {
            let past_nmac = self.free_of(picture, span, &painting, Instead::Cylinder(nmac));
            if distances.is_empty() || past_nmac.is_empty() {
                return past_nmac;
            }
        }
        let blocked = self.blocked(picture, span, &painting, &distances);
        for (&kept, shrinkings) in distances.iter().zip(0..).skip(blocked) {
            if !self.is_blocked_at_once(picture, &painting, kept)
                && self.frees_any(picture, span, &painting, Instead::Cylinder(kept))
            {
                let time_s = self.recovery_time_s(picture, span, &painting, kept);
                let ways_out = self.free_of(picture, span, &painting, Instead::Until(kept, time_s));
                if !ways_out.is_empty() {
                    self.recovery = Recovery::Found {
                        time_s,
                        distance_m: kept.radius_m,
                        height_m: kept.half_height_m,
                        shrinkings,
                    };
                    return ways_out;
                }
            }
        }
        if settings.shrinks_recovery {
            let shrinkings = i32::try_from(distances.len()).unwrap_or(i32::MAX);
            self.recovery = Recovery::Impossible { shrinkings };
        }
        Intervals::default()
    }

    /// How many of the distances, from the largest, surely block every maneuver.
    fn blocked(
        &mut self,
        picture: &Picture,
        span: &Span,
        painting: &[Contribution],
        distances: &[Cylinder],
    ) -> usize {
        let grows = distances.windows(2).any(|pair| match pair {
            [a, b] => b.radius_m > a.radius_m || b.half_height_m > a.half_height_m,
            _ => false,
        });
        if grows || (painting.len() > 1 && !span.tells_steps_apart()) {
            return 0;
        }
        let lines = self.ways.lines();
        let mut places = Vec::new();
        for contribution in painting {
            let level = contribution.level(picture.settings);
            if let (Some(_), Some(met)) = (level, picture.met(contribution.intruder)) {
                let place = self.pool.approached(contribution.intruder, &met, lines);
                places.push((place, met, contribution.horizon_s));
            }
        }
        let avoided = places.into_iter().filter_map(|(place, met, horizon_s)| {
            Some(Avoided {
                met,
                approaches: self.pool.approaches(place)?,
                horizon_s,
            })
        });
        let aircraft: Vec<Avoided> = avoided.collect();
        Blocking {
            settings: picture.settings,
            aircraft: &aircraft,
            distances,
        }
        .count(&self.ways)
    }

    /// The earliest time, to half a second, after which well clear is possible again.
    fn recovery_time_s(
        &mut self,
        picture: &Picture,
        span: &Span,
        painting: &[Contribution],
        kept: Cylinder,
    ) -> f64 {
        let lookahead_s = picture.settings.lookahead_s;
        let (mut blocked_s, mut open_s) = (0.0, lookahead_s + 1.0);
        let mut tried_s = open_s - 1.0;
        while open_s - blocked_s > 0.5 {
            if self.frees_any(picture, span, painting, Instead::Until(kept, tried_s)) {
                open_s = tried_s;
            } else {
                blocked_s = tried_s;
            }
            tried_s = f64::midpoint(blocked_s, open_s);
        }
        if open_s <= lookahead_s {
            lookahead_s.min(open_s + picture.settings.recovery_stability_s)
        } else {
            blocked_s
        }
    }
}

/// The distances of recovery, as they shrink down to the NMAC volume.
fn distances(settings: &Settings, ownship: &State) -> Vec<Cylinder> {
    let nmac = Cylinder::new(settings.nmac_distance_m, settings.nmac_height_m);
    let factor = 1.0 - settings.recovery_shrinking;
    let mut kept = least_recovery(settings, ownship);
    let mut distances = Vec::new();
    // Shrinking by a factor of zero never ends by itself.
    let most = if settings.shrinks_recovery {
        MOST_SHRINKINGS
    } else {
        1
    };
    while (kept.radius_m > nmac.radius_m || kept.half_height_m > nmac.half_height_m)
        && distances.len() < most
    {
        distances.push(kept);
        kept = Cylinder::new(
            nmac.radius_m.max(kept.radius_m * factor),
            nmac.half_height_m.max(kept.half_height_m * factor),
        );
    }
    distances
}

/// The first distances of recovery.
fn least_recovery(settings: &Settings, ownship: &State) -> Cylinder {
    // Below the third sensitivity level there are no resolution advisories.
    let table = || {
        let resolution = Advisory::resolution();
        let altitude_m = ownship.position_m.z.max(LOWEST_ADVISORY_M);
        resolution.at(altitude_m).copied()
    };
    let or_table = |value_m: f64, pick: fn(&crate::volume::Sensitivity) -> f64| {
        if value_m > 0.0 {
            value_m
        } else {
            table().as_ref().map_or(0.0, pick)
        }
    };
    Cylinder::new(
        or_table(settings.recovery_distance_m, |level| level.miss_distance_m),
        or_table(settings.recovery_height_m, |level| level.height_m),
    )
}

/// An altitude in the lowest level that has resolution advisories, metres.
const LOWEST_ADVISORY_M: f64 = 1001.0 * 0.3048;
