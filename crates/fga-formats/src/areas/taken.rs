//! The areas of a file as its reader takes them, and what each must be.

use alloc::collections::BTreeMap;
use core::fmt::Display;
use std::path::Path;

use serde::de::DeserializeOwned;

use super::area::{AreaFile, AreaOutline, EdgeLine, LARGEST_M, NamedArea};
use super::mended::mended;
use crate::error::InputError;
use crate::words::counted;

/// Places nearer than this are one corner, degrees: a centimetre.
const SAME_DEG: f64 = 1e-7;

fn is_same(one: [f64; 2], other: [f64; 2]) -> bool {
    let (north_deg, east_deg) = (one[0] - other[0], one[1] - other[1]);
    north_deg.abs() < SAME_DEG && east_deg.abs() < SAME_DEG
}

/// Lets the longitudes of a ring go on beyond 180° where an edge is longer than half a turn, from near the longitude of a corner; whether
/// there is such an edge. An edge of a whole turn is one round the earth.
fn go_on(corners_deg: &mut [[f64; 2]], [_, mut before_deg]: [f64; 2]) -> bool {
    let (mut is_over, mut turned_deg) = (false, 0.0);
    for [_, longitude_deg] in corners_deg {
        let apart_deg = before_deg - *longitude_deg;
        before_deg = *longitude_deg;
        if apart_deg.abs() > 180.0 && apart_deg.abs() < 360.0 {
            turned_deg += 360.0_f64.copysign(apart_deg);
            is_over = true;
        }
        *longitude_deg += turned_deg;
    }
    is_over
}

/// The areas of a file so far.
pub(super) struct Areas<'a> {
    pub(super) path: &'a Path,
    /// What the file says of the next one.
    pub(super) like: NamedArea,
    pub(super) all: Vec<NamedArea>,
    pub(super) notes: Vec<String>,
    /// How often what is no area stands beside areas, by its kind.
    pub(super) others: BTreeMap<String, usize>,
}

impl Areas<'_> {
    /// The areas, and what else the file holds.
    pub(super) fn finish(mut self) -> Result<AreaFile, InputError> {
        let others = self.others.iter().map(|(what, count)| {
            let (first, rest) = what.split_once(' ').unwrap_or((what, ""));
            let space = if rest.is_empty() { "" } else { " " };
            format!("{}{space}{rest} left out", counted(*count, first))
        });
        let others: Vec<String> = others.collect();
        if self.all.is_empty() {
            let beside = others.iter().map(|other| format!("{other}, "));
            let beside: String = beside.collect();
            let message = format!("has no area, {beside}expected at least one");
            return Err(InputError::in_file(self.path, message));
        }
        self.notes.extend(others);
        let Self {
            all: areas, notes, ..
        } = self;
        Ok(AreaFile { areas, notes })
    }

    /// Counts what is no area.
    pub(super) fn leave_out(&mut self, what: &str) {
        let what = Self::name(what).unwrap_or_default();
        *self.others.entry(what).or_default() += 1;
    }

    /// Notes something about the next area.
    pub(super) fn note(&mut self, message: &str) {
        self.notes.push(self.about_next(message));
    }

    fn about_next(&self, message: impl Display) -> String {
        let number = self.all.len() + 1;
        let name = self.like.name.as_ref();
        let name = name.map_or_else(String::new, |name| format!(" ({name})"));
        format!("area {number}{name} {message}")
    }

    pub(super) fn json<T: DeserializeOwned>(
        &self,
        text: &str,
        kind: &str,
    ) -> Result<T, InputError> {
        serde_json::from_str(text).map_err(|error| InputError::json(self.path, kind, &error))
    }

    pub(super) fn refuse<T>(&self, message: impl Display) -> Result<T, InputError> {
        Err(InputError::in_file(self.path, self.about_next(message)))
    }

    /// Takes a polygon by its rings, the first of which is its outline.
    pub(super) fn take(&mut self, rings: &[Vec<Vec<f64>>]) -> Result<(), InputError> {
        let mut rings_deg: Vec<Vec<[f64; 2]>> = Vec::new();
        let (mut is_open, mut is_over) = (false, false);
        for ring in rings {
            let corners = ring.iter().zip(1..);
            let corners =
                corners.map(|(at, number)| self.place(at, format_args!("corner {number}")));
            let mut corners_deg = corners.collect::<Result<Vec<_>, _>>()?;
            if corners_deg.is_empty() {
                return self.refuse("has no corners, expected a ring");
            }
            if self.like.edges == EdgeLine::Degrees {
                let first = rings_deg.first().unwrap_or(&corners_deg).first().copied();
                is_over |= go_on(&mut corners_deg, first.unwrap_or_default());
            }
            is_open |= corners_deg.len() == 1 || corners_deg.first() != corners_deg.last();
            // Published outlines repeat a corner, and an arc ends at the next one.
            corners_deg.dedup_by(|one, other| is_same(*one, *other));
            if let [first, _, .., last] = corners_deg[..]
                && is_same(first, last)
            {
                corners_deg.pop();
            }
            rings_deg.push(corners_deg);
        }
        if rings_deg.is_empty() {
            return self.refuse("has no corners, expected a ring");
        }
        if rings_deg.first().is_some_and(|outline| outline.len() < 3) {
            self.leave_out("area with fewer than 3 corners");
            return Ok(());
        }
        if is_open {
            self.note("is not closed: its last corner is joined to its first one");
        }
        if is_over {
            self.note("is not cut at the antimeridian: it is taken to lie on both sides of it");
        }
        let outlines = mended(&rings_deg);
        if let Some(outlines) = &outlines {
            let parts = counted(outlines.len(), "polygon");
            self.note(&format!(
                "crosses or touches itself: all that its edges surround is taken, as {parts}"
            ));
        }
        for rings in outlines.unwrap_or_else(|| vec![rings_deg]) {
            self.push(AreaOutline::Polygon(rings));
        }
        Ok(())
    }

    pub(super) fn take_circle(&mut self, center: &[f64], radius_m: f64) -> Result<(), InputError> {
        let center_deg = self.place(center, "its centre")?;
        if !(radius_m > 0.0 && radius_m <= LARGEST_M) {
            return self.refuse(format_args!(
                "has a radius of {radius_m} m, expected more than 0, up to 10,000 km"
            ));
        }
        self.push(AreaOutline::Circle {
            center_deg,
            radius_m,
        });
        Ok(())
    }

    /// A name as one line, unless it is empty.
    pub(super) fn name(text: &str) -> Option<String> {
        let words = text.split(|each: char| each.is_whitespace() || each.is_control());
        let words: Vec<_> = words.filter(|word| !word.is_empty()).collect();
        (!words.is_empty()).then(|| words.join(" "))
    }

    pub(super) fn push(&mut self, outline: AreaOutline) {
        let mut like = self.like.clone();
        // Authorities write 0 to 0 for a zone of all heights.
        if let [Some(floor), Some(ceiling)] = like.limits
            && floor == ceiling
        {
            let height_m = floor.height_m;
            self.note(&format!(
                "has its floor and its ceiling at {height_m} m: the ceiling counts as unknown"
            ));
            like.limits[1] = None;
        }
        self.all.push(NamedArea { outline, ..like });
    }

    /// Latitude and longitude of a place, degrees.
    pub(super) fn place(&self, at: &[f64], what: impl Display) -> Result<[f64; 2], InputError> {
        let is_place = |latitude_deg: f64, longitude_deg: f64| {
            latitude_deg.abs() <= 90.0 && longitude_deg.abs() <= 180.0
        };
        match *at {
            [longitude_deg, latitude_deg, ..] if is_place(latitude_deg, longitude_deg) => {
                Ok([latitude_deg, longitude_deg])
            }
            [one, other, ..] if is_place(one, other) => self.refuse(format_args!(
                "has {what} out of range: latitude and longitude look exchanged, expected the longitude first"
            )),
            _ => self.refuse(format_args!(
                "has {what} out of range, expected longitude from -180 to 180 and latitude from -90 to 90"
            )),
        }
    }
}
