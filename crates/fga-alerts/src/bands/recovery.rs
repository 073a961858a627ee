//! Resolutions where every manoeuvre leads into the corrective volume.

use crate::aircraft::State;
use crate::bands::free::Kept;
use crate::bands::guards::{Guard, Guards};
use crate::bands::intervals::Intervals;
use crate::bands::met::meetings;
use crate::bands::picture::{Contribution, Picture};
use crate::bands::pool::{Key, level_key};
use crate::bands::quantity::QuantityBands;
use crate::bands::recovered::Recovery;
use crate::bands::shrinking::{Avoided, Blocking};
use crate::bands::span::Span;
use crate::settings::Settings;
use crate::volume::{Advisory, Cylinder, Volume};
use alloc::vec::Vec;

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
            let past_nmac = self.free_of(picture, span, &painting, Kept::Cylinder(nmac));
            if distances.is_empty() || past_nmac.is_empty() {
                return past_nmac;
            }
        }
        let blocked = self.blocked(picture, span, &painting, &distances);
        for (&kept, shrinkings) in distances.iter().zip(0..).skip(blocked) {
            if !self.is_blocked_at_once(picture, &painting, kept)
                && self.frees_any(picture, span, &painting, kept)
            {
                let (time_s, ways_out) = self.way_back(picture, span, &painting, kept);
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
        let avoided = painting.iter().filter_map(|contribution| {
            contribution.level(picture.settings)?;
            Some(Avoided {
                met: picture.met(contribution.intruder)?,
                horizon_s: contribution.horizon_s,
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

    /// The time after which well clear is possible again, and the values that are free of the cylinder until then
    /// and of each aircraft's own volume afterwards.
    fn way_back(
        &mut self,
        picture: &Picture,
        span: &Span,
        painting: &[Contribution],
        kept: Cylinder,
    ) -> (f64, Intervals) {
        let settings = picture.settings;
        let lines = self.ways.lines();
        let cylinder = Volume::Cylinder(kept);
        let mut aircraft = Vec::new();
        for contribution in painting {
            let intruder = contribution.intruder;
            let level = contribution.level(settings);
            if let (Some(level), Some(met)) = (level, picture.met(intruder)) {
                let key = level_key(settings, contribution.alerter, contribution.level);
                let own = self.pool.ensure(intruder, (&level.volume, key), lines);
                let key = Key::Cylinder(kept);
                let before = self.pool.ensure(intruder, (&cylinder, key), lines);
                let horizon_s = contribution.horizon_s;
                aircraft.push((met, &level.volume, own, before, horizon_s));
            }
        }
        let windows = self.pool.all();
        let known = |place: Option<usize>| windows.get(place?).copied();
        let guards = aircraft
            .iter()
            .map(|(met, volume, own, before, horizon_s)| Guard {
                own: meetings(met, volume, lines, known(*own)),
                cylinder: meetings(met, &cylinder, lines, known(*before)),
                horizon_s: *horizon_s,
            });
        let guards = Guards {
            ways: &self.ways,
            span,
            aircraft: guards.collect(),
        };
        let time_s = guards.recovery_time_s(settings);
        (time_s, guards.free(time_s))
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
