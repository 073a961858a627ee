//! The memory of bands: M of N, persistence of a conflict band, preferred resolution.

use crate::almost::Closeness::Edge;
use crate::almost::wrapped;
use crate::bands::colors::{Band, Colors, ManeuverSide};
use crate::bands::recovery::Recovery;
use crate::bands::span::BandSpan;
use crate::hysteresis::MOfN;
use crate::settings::{AlertSettings, Region};
use alloc::vec::Vec;

/// The nearest resolution to one side.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Resolution {
    /// No conflict needs one.
    #[default]
    Unneeded,
    /// None exists on this side.
    Unavailable,
    /// The nearest value without conflict, SI unit of the scale.
    Value(f64),
}

impl Resolution {
    fn value(self) -> Option<f64> {
        match self {
            Self::Value(value) => Some(value),
            Self::Unneeded | Self::Unavailable => None,
        }
    }
}

/// The colors seen from a value up to the next one; `None` out of reach.
#[derive(Debug, Clone, PartialEq)]
struct Votes {
    from: f64,
    seen: MOfN<Option<Region>>,
}

/// The memory of the bands of one quantity.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct BandMemory {
    last_s: Option<f64>,
    votes: Vec<Votes>,
    /// The conflict band in which the ownship flies.
    entered: Option<Band>,
    /// Start of the persistence of a conflict band.
    entered_since_s: Option<f64>,
    preferred: ManeuverSide,
    preferred_since_s: Option<f64>,
    /// To the low and to the high side.
    sides: [SideAnswer; 2],
}

/// One side's resolution, present and kept.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct SideAnswer {
    now: Resolution,
    kept: Resolution,
    /// Number of recovery's shrinkings when the kept one was found.
    kept_shrinkings: i32,
}

/// The input of a step to the memory.
pub(crate) struct Step<'a> {
    pub(crate) settings: &'a AlertSettings,
    pub(crate) time_s: f64,
    pub(crate) span: &'a BandSpan,
    pub(crate) recovery: Recovery,
}

impl Step<'_> {
    /// Largest difference that keeps a preferred resolution.
    fn tolerance(&self) -> f64 {
        let tolerances = &self.settings.resolution_persistence;
        tolerances.get(self.span.quantity)
    }

    /// Whether a band leads into the corrective region's conflict or a nearer one.
    fn is_corrective(&self, band: &Band) -> bool {
        let least = self.settings.corrective_region.severity().max(1);
        band.region.is_some_and(|region| region.severity() >= least)
    }

    /// How far a value lies to one side of another.
    fn distance(&self, way: ManeuverSide, of: f64, value: f64) -> f64 {
        let distance = match way {
            ManeuverSide::Low => of - value,
            ManeuverSide::High => value - of,
        };
        wrapped(distance, self.span.modulus)
    }

    /// Whether a value lies to one side of another or counts as the same.
    fn is_ahead(&self, way: ManeuverSide, of: f64, value: f64) -> bool {
        let modulus = self.span.modulus;
        Edge.same(of, value)
            || if modulus > 0.0 {
                Edge.less(self.distance(way, of, value), modulus / 2.0)
            } else {
                self.distance(way, of, value) > 0.0
            }
    }

    /// Whether something that began at a time still persists.
    fn persists(&self, since_s: f64) -> bool {
        self.time_s - since_s < self.settings.hysteresis.persistence_s
    }
}

impl BandMemory {
    pub(crate) fn preferred(&self) -> ManeuverSide {
        self.preferred
    }

    pub(crate) fn resolution(&self, way: ManeuverSide) -> Resolution {
        let [low, high] = self.sides;
        match way {
            ManeuverSide::Low => low.kept,
            ManeuverSide::High => high.kept,
        }
    }

    /// Forgets everything but the last shown resolutions.
    pub(crate) fn forget(&mut self) {
        *self = Self {
            sides: self.sides,
            ..Self::default()
        };
    }

    /// Takes the painted scale and returns the one for the display.
    pub(crate) fn take(&mut self, mut colors: Colors, step: &Step) -> Colors {
        let memory_s = step.settings.hysteresis.memory_s;
        let goes_on = |last_s: f64| step.time_s > last_s && step.time_s - last_s <= memory_s;
        if !self.last_s.is_some_and(goes_on) {
            self.forget();
        }
        self.last_s = Some(step.time_s);
        self.vote(&mut colors, step.settings);
        self.persist(&mut colors, step);
        let shown = colors.shown(step.recovery != Recovery::NotNeeded);
        let here = shown.band_at(step.span.value);
        if self.entered_since_s.is_some() {
            self.entered = here.and_then(|index| shown.conflict_band(index));
            self.entered_since_s = self.entered_since_s.filter(|_| self.entered.is_some());
        }
        self.keep_resolutions(&shown, here, step);
        self.prefer(step);
        shown
    }

    /// Lets M of the last N colors decide, value by value.
    fn vote(&mut self, colors: &mut Colors, settings: &AlertSettings) {
        let (m, n) = (settings.hysteresis.agreeing, settings.hysteresis.remembered);
        if self.votes.is_empty() {
            let votes = colors.bands.iter().map(|band| Votes {
                from: band.low,
                seen: MOfN::new(m, n, band.region, None),
            });
            self.votes = votes.collect();
        }
        for votes in &self.votes {
            colors.split(votes.from);
        }
        for (index, band) in colors.bands.iter().enumerate() {
            let is_known = |votes: &Votes| !Edge.less(band.low, votes.from);
            let below = index.checked_sub(1).and_then(|below| self.votes.get(below));
            if !self.votes.get(index).is_some_and(is_known)
                && let Some(below) = below
            {
                let (from, seen) = (band.low, below.seen.clone());
                self.votes.insert(index, Votes { from, seen });
            }
        }
        for (votes, band) in self.votes.iter_mut().zip(&mut colors.bands) {
            band.region = votes.seen.take(band.region);
        }
        self.votes.dedup_by(|next, votes| next.seen == votes.seen);
    }

    /// Keeps a conflict band for the persistence time after the ownship enters it.
    fn persist(&mut self, colors: &mut Colors, step: &Step) {
        if !step.settings.bands_persist {
            return;
        }
        let Some((entered, region)) = self.entered.and_then(|band| Some((band, band.region?)))
        else {
            self.entered_since_s = Some(step.time_s);
            return;
        };
        let Some(now) = colors.region_at(step.span.value) else {
            return;
        };
        let persists = self
            .entered_since_s
            .is_some_and(|since_s| step.persists(since_s));
        if persists && now < region {
            colors.paint(entered.low, entered.high, region);
        } else if now.is_conflict() && now > region {
            self.entered_since_s = Some(step.time_s);
        }
    }

    /// Keeps the resolutions shown, while they are still ways out and the memory lasts.
    fn keep_resolutions(&mut self, shown: &Colors, here: Option<usize>, step: &Step) {
        self.preferred_since_s = self.preferred_since_s.filter(|_| step.tolerance() > 0.0);
        for (side, way) in self.sides.iter_mut().zip(WAYS) {
            let (now, from) = nearest_way_out(shown, here, way, step);
            side.now = now;
            let stays = |since_s| {
                let (now, kept) = (now.value()?, side.kept.value()?);
                let lasts = step.persists(since_s)
                    || side.kept_shrinkings < step.recovery.shrinkings()
                    || Edge.less(step.distance(way, now, kept), step.tolerance());
                let to = shown.band_at(kept)?;
                // Past bands without conflict alone.
                let mut way_there = shown
                    .walk(from?, self.preferred)
                    .take_while(|(_, band)| band.region.is_some() && !step.is_corrective(band));
                let leads_there = way_there.any(|(at, _)| at == to);
                Some(lasts && step.is_ahead(way, step.span.value, kept) && leads_there)
            };
            if self.preferred_since_s.and_then(stays) != Some(true) {
                side.kept = now;
                side.kept_shrinkings = step.recovery.shrinkings();
            }
        }
    }

    /// Prefers the nearer resolution, unless the other one has been preferred for a short time or is about as near.
    fn prefer(&mut self, step: &Step) {
        let [low, high] = self.sides;
        let (is_held, preferred) = match (low.now.value(), high.now.value()) {
            (None, None) => {
                self.preferred_since_s = None;
                self.preferred = ManeuverSide::Low;
                return;
            }
            (Some(_), None) => (false, ManeuverSide::Low),
            (None, Some(_)) => (false, ManeuverSide::High),
            (Some(low_value), Some(high_value)) => {
                let down = step.distance(ManeuverSide::Low, step.span.value, low_value);
                let up = step.distance(ManeuverSide::High, step.span.value, high_value);
                let nearer = if Edge.at_most(up, down) {
                    ManeuverSide::High
                } else {
                    ManeuverSide::Low
                };
                let Some(since_s) = self.preferred_since_s else {
                    self.preferred = nearer;
                    self.preferred_since_s = Some(step.time_s);
                    return;
                };
                let shrank_less = match self.preferred {
                    ManeuverSide::High => low.kept_shrinkings > high.kept_shrinkings,
                    ManeuverSide::Low => high.kept_shrinkings > low.kept_shrinkings,
                };
                let is_close = (up - down).abs() < step.tolerance();
                (step.persists(since_s) || is_close || shrank_less, nearer)
            }
        };
        if is_held || preferred == self.preferred {
            return;
        }
        self.preferred = preferred;
        self.preferred_since_s = Some(step.time_s);
        for side in &mut self.sides {
            if step.recovery.shrinkings() <= side.kept_shrinkings {
                side.kept = side.now;
            }
        }
    }
}

const WAYS: [ManeuverSide; 2] = [ManeuverSide::Low, ManeuverSide::High];

/// The nearest resolution to one side, and the band at which the walk there ends.
fn nearest_way_out(
    shown: &Colors,
    here: Option<usize>,
    way: ManeuverSide,
    step: &Step,
) -> (Resolution, Option<usize>) {
    let is_corrective =
        |at: &usize| (shown.bands.get(*at)).is_some_and(|band| step.is_corrective(band));
    let Some(start) = here.filter(is_corrective) else {
        return (Resolution::Unneeded, here);
    };
    for (at, band) in shown.walk(start, way) {
        let (near, far) = match way {
            ManeuverSide::Low => (band.high, band.low),
            ManeuverSide::High => (band.low, band.high),
        };
        if !step.is_corrective(band) {
            let value = Resolution::Value(wrapped(near, step.span.modulus));
            let reached = band.region.map_or(Resolution::Unavailable, |_| value);
            return (reached, Some(at));
        }
        if !step.is_ahead(way, step.span.value, far) {
            break;
        }
    }
    (Resolution::Unavailable, None)
}
