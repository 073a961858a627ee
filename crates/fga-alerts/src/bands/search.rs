//! Which values of a quantity are free of conflicts with some aircraft.

use crate::aircraft::{AircraftState, Pair};
use crate::bands::colors::Colors;
use crate::bands::guard::Guard;
use crate::bands::span::BandSpan;
use crate::bands::ways::Ways;
use crate::picture::{Contribution, Picture};
use crate::quantity::Quantity;
use crate::settings::Region;
use crate::volume::{Cylinder, Volume};
use alloc::vec::Vec;

/// The manoeuvres of one quantity.
pub(crate) struct BandSearch<'a> {
    pub(super) picture: &'a Picture,
    pub(super) span: &'a BandSpan,
    pub(super) ways: Ways,
}

impl<'a> BandSearch<'a> {
    /// The manoeuvres from a state to the values of a span.
    pub(crate) fn new(picture: &'a Picture, ownship: &AircraftState, span: &'a BandSpan) -> Self {
        Self {
            picture,
            span,
            ways: Ways::new(&picture.settings, ownship, span),
        }
    }

    /// The aircraft that contributes, and the volume of its level.
    pub(super) fn against(&self, contribution: &Contribution) -> Option<(Pair, &'a Volume)> {
        let (intruder, picture) = (contribution.intruder, self.picture);
        let level = picture.level(intruder, contribution.level)?;
        Some((picture.pair(intruder)?, &level.volume))
    }

    /// The scale, near where a value leads into conflict with one of these aircraft: into its own volume, before a
    /// time into a cylinder instead. Values without conflict are free where two neighbours are.
    pub(super) fn conflicts(
        &self,
        aircraft: &[Contribution],
        kept: Option<(Cylinder, f64)>,
    ) -> Colors {
        let settings = &self.picture.settings;
        let kept = kept.map(|(cylinder, change_s)| (Volume::Cylinder(cylinder), change_s));
        let mut all = Colors::of(self.span, self.span.searched);
        for contribution in aircraft {
            let Some((pair, own)) = self.against(contribution) else {
                continue;
            };
            let horizon_s = contribution.horizon_s;
            let guard = Guard::new(settings, &pair, own, kept.as_ref(), horizon_s);
            let free = self.ways.free_values(&guard, Some(1.0));
            let values: Vec<(f64, bool)> = self.span.values().zip(free).collect();
            let mut theirs = Colors::closed(self.span);
            for run in values.chunk_by(|a, b| a.1 == b.1) {
                if let [(low, true), .., (high, _)] = run {
                    theirs.paint(*low, *high, Region::Recovery);
                }
            }
            all.paint_where(&theirs, Region::Near, Region::Near);
            if all.is_closed() {
                break;
            }
        }
        all
    }

    /// Whether a manoeuvre to any value leads into a volume before a time, or on the way beyond it.
    pub(crate) fn any_conflict(&self, pair: &Pair, volume: &Volume, until_s: f64) -> bool {
        let guard = Guard::new(&self.picture.settings, pair, volume, None, until_s);
        let free = self.ways.free_values(&guard, None);
        free.contains(&false)
    }

    /// Whether no manoeuvre leads past a volume within the horizon.
    pub(crate) fn all_conflict(&self, pair: &Pair, volume: &Volume) -> bool {
        let settings = &self.picture.settings;
        let guard = Guard::new(settings, pair, volume, None, settings.lookahead_s);
        let free = self.ways.free_values(&guard, Some(0.0));
        !free.contains(&true)
    }

    /// The aircraft that only a manoeuvre brings into a region's conflict.
    pub(super) fn peripheral(&self, region: Region) -> Vec<Contribution> {
        let settings = &self.picture.settings;
        let contribution = |intruder| {
            let level = self.picture.level_for(intruder, region)?;
            let alerting_s = self.picture.level(intruder, level)?.alerting_s;
            let contribution = Contribution {
                intruder,
                level,
                horizon_s: settings.lookahead_s.min(alerting_s),
            };
            let (pair, volume) = self.against(&contribution)?;
            let loss = self.picture.violation(intruder, level)?;
            let is_peripheral = !loss.begins_before(contribution.horizon_s)
                && self.any_conflict(&pair, volume, contribution.horizon_s);
            is_peripheral.then_some(contribution)
        };
        (0..self.picture.traffic.len())
            .filter_map(contribution)
            .collect()
    }
}

/// Whether manoeuvres of a quantity within a spread lead into a volume before a time.
pub(crate) fn meets_within_spread(
    picture: &Picture,
    quantity: Quantity,
    spread: f64,
    pair: &Pair,
    volume: &Volume,
    until_s: f64,
) -> bool {
    let ownship = &picture.ownship.state;
    let span = BandSpan::of(quantity, picture, Some((spread, spread)));
    span.is_some_and(|span| {
        BandSearch::new(picture, ownship, &span).any_conflict(pair, volume, until_s)
    })
}
