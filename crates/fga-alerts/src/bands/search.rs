//! Which values of a quantity are free of conflicts with some aircraft.

use crate::aircraft::{Pair, State};
use crate::bands::intervals::Intervals;
use crate::bands::meeting::{Guard, Met};
use crate::bands::picture::{Contribution, Picture};
use crate::bands::span::{Quantity, Span};
use crate::bands::ways::Ways;
use crate::settings::{AlertLevel, Region};
use crate::volume::{Cylinder, Volume};
use alloc::vec::Vec;

/// The manoeuvres of one quantity.
pub(crate) struct Search<'a> {
    pub(super) picture: &'a Picture<'a>,
    pub(super) span: &'a Span,
    pub(super) ways: Ways,
}

impl<'a> Search<'a> {
    /// The manoeuvres from a state to the values of a span.
    pub(crate) fn new(picture: &'a Picture<'a>, ownship: &State, span: &'a Span) -> Self {
        Self {
            picture,
            span,
            ways: Ways::new(picture, ownship, span),
        }
    }

    /// The level by which an aircraft contributes, and the aircraft.
    pub(super) fn against(&self, contribution: &Contribution) -> Option<(&'a AlertLevel, Met<'a>)> {
        let alerter = self.picture.settings.alerters.get(contribution.alerter)?;
        let level = alerter.level(contribution.level)?;
        Some((level, self.picture.met(contribution.intruder)?))
    }

    /// The values free of conflicts with these aircraft: out of each one's own volume, or of a cylinder instead.
    pub(super) fn free(&self, aircraft: &[Contribution], kept: Option<Cylinder>) -> Intervals {
        let kept = kept.map(Volume::Cylinder);
        let mut free = self.span.whole();
        for contribution in aircraft {
            let Some((level, met)) = self.against(contribution) else {
                continue;
            };
            let meeting = self
                .ways
                .meeting(&met, kept.as_ref().unwrap_or(&level.volume));
            let guard = Guard::of(&meeting, contribution.horizon_s);
            free.intersect(&self.ways.free(&guard, self.span));
            if free.is_empty() {
                break;
            }
        }
        free
    }

    /// The values free of all of these conflicts.
    pub(super) fn free_of_all<'g>(&self, guards: impl Iterator<Item = Guard<'g>>) -> Intervals {
        let mut free = self.span.whole();
        for guard in guards {
            free.intersect(&self.ways.free(&guard, self.span));
            if free.is_empty() {
                break;
            }
        }
        free
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
        let settings = self.picture.settings;
        let contribution = |(intruder, alerter): (usize, &Option<usize>)| {
            let alerter = (*alerter)?;
            let level = settings.alerters.get(alerter)?.level_for(region)?;
            let mut contribution = Contribution {
                intruder,
                alerter,
                level,
                horizon_s: 0.0,
            };
            let (level, met) = self.against(&contribution)?;
            contribution.horizon_s = settings.lookahead_s.min(level.alerting_s);
            let pair = Pair {
                ownship: self.picture.ownship.state,
                intruder: met.intruder,
                deviation: met.deviation,
            };
            let loss = level.volume.violation(&pair, 0.0, settings.lookahead_s);
            let is_peripheral = !loss.begins_before(contribution.horizon_s)
                && self.any_conflict(&met, &level.volume, contribution.horizon_s);
            is_peripheral.then_some(contribution)
        };
        let alerters = self.picture.alerters.iter().enumerate();
        alerters.filter_map(contribution).collect()
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
    let span = Span::of(quantity, picture.settings, ownship, Some((spread, spread)));
    span.is_some_and(|span| Search::new(picture, ownship, &span).any_conflict(met, volume, until_s))
}
