//! Which values of a quantity are free of conflicts with some aircraft.

use crate::aircraft::State;
use crate::bands::intervals::Intervals;
use crate::bands::meeting::{Guard, Met};
use crate::bands::picture::{Contribution, Picture};
use crate::bands::span::{Quantity, Span};
use crate::bands::ways::Ways;
use crate::settings::Region;
use crate::volume::{Cylinder, Volume};
use alloc::vec::Vec;

/// The manoeuvres of one quantity.
pub(crate) struct Search<'a> {
    pub(super) picture: &'a Picture,
    pub(super) span: &'a Span,
    pub(super) ways: Ways,
}

impl<'a> Search<'a> {
    /// The manoeuvres from a state to the values of a span.
    pub(crate) fn new(picture: &'a Picture, ownship: &State, span: &'a Span) -> Self {
        Self {
            picture,
            span,
            ways: Ways::new(picture, ownship, span),
        }
    }

    /// The aircraft that contributes, and the volume of its level.
    pub(super) fn against(&self, contribution: &Contribution) -> Option<(Met<'a>, &'a Volume)> {
        let (intruder, picture) = (contribution.intruder, self.picture);
        let level = picture.level(intruder, contribution.level)?;
        Some((picture.met(intruder)?, &level.volume))
    }

    /// The values free of conflicts with these aircraft: out of each one's own volume, or of a cylinder instead.
    pub(super) fn free(&self, aircraft: &[Contribution], kept: Option<Cylinder>) -> Intervals {
        let kept = kept.map(Volume::Cylinder);
        self.common(aircraft.iter().filter_map(|contribution| {
            let (met, own) = self.against(contribution)?;
            let meeting = self.ways.meeting(&met, kept.as_ref().unwrap_or(own));
            let guard = Guard::of(&meeting, contribution.horizon_s);
            Some(self.ways.free(&guard, self.span))
        }))
    }

    /// What of the searched values is free of each aircraft.
    pub(super) fn common(&self, free: impl Iterator<Item = Intervals>) -> Intervals {
        let mut common = self.span.whole();
        for free in free {
            common.intersect(&free);
            if common.is_empty() {
                break;
            }
        }
        common
    }

    /// Whether any manoeuvre leads into a volume before a time.
    pub(crate) fn any_conflict(&self, met: &Met<'a>, volume: &'a Volume, until_s: f64) -> bool {
        let meeting = self.ways.meeting(met, volume);
        self.ways.any_conflict(&Guard::of(&meeting, until_s))
    }

    /// Whether every manoeuvre leads into a volume within the horizon.
    pub(crate) fn all_conflict(&self, met: &Met<'a>, volume: &'a Volume) -> bool {
        let meeting = self.ways.meeting(met, volume);
        let until_s = self.picture.settings.lookahead_s;
        self.ways.all_conflict(&Guard::of(&meeting, until_s))
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
            let (met, volume) = self.against(&contribution)?;
            let loss = self.picture.violation(intruder, level)?;
            let is_peripheral = !loss.begins_before(contribution.horizon_s)
                && self.any_conflict(&met, volume, contribution.horizon_s);
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
    met: &Met,
    volume: &Volume,
    until_s: f64,
) -> bool {
    let ownship = &picture.ownship.state;
    let span = Span::of(quantity, &picture.settings, ownship, Some((spread, spread)));
    span.is_some_and(|span| Search::new(picture, ownship, &span).any_conflict(met, volume, until_s))
}
