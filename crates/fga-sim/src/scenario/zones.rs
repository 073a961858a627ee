//! The `[[zone]]` tables of a scenario.

use std::path::{Path, PathBuf};

use fga::limit::LARGEST_M;
use fga::zone::ALL_HEIGHTS_M;
use fga::{Vec2, Vec3};
use fga_files::scenario::{ZoneKindName, ZoneTable};
use fga_formats::areas::{self, AreaLimit, AreaOutline, NamedArea, PlaneArea, Reference};
use fga_formats::geodesy::LocalFrame;
use fga_formats::terrain::Terrain;
use fga_formats::words::counted;
use fga_formats::{InputError, zones};
use toml::Spanned;

use super::places::FilePlaces;
use crate::vehicle_file::checks;
use crate::zone::{WorldOutline, WorldZone};

/// Of a file, some zones of which are nearer, those are left out that are farther from the start than this many times the way flown.
const BEYOND: f64 = 2.0;

/// The zones of a file, over ground if it is known, for a start and the length of the flight, metres, and what of their files counts
/// otherwise than it is written.
pub(super) fn all(
    tables: &[Spanned<ZoneTable>],
    places: &FilePlaces<'_>,
    terrain: Option<&Terrain>,
    (start_m, flies_m): (Vec3, f64),
) -> Result<(Vec<WorldZone>, Vec<String>), InputError> {
    let (mut zones, mut notes) = (Vec::new(), Vec::new());
    for (entry, number) in tables.iter().zip(1..) {
        let Some(path) = &entry.get_ref().file else {
            zones.push(zone(entry, number, (places, terrain))?);
            continue;
        };
        let mut file = ZoneFile {
            entry,
            path,
            places,
            terrain,
            keep_in: entry.get_ref().kind == ZoneKindName::KeepIn,
            zones: Vec::new(),
            levels: 0,
            open: 0,
        };
        notes.extend(file.take(number, (start_m, BEYOND * flies_m))?);
        zones.extend(file.zones);
    }
    Ok((zones, notes))
}

/// An outline on the plane, and its holes.
type OutlineAndHoles = (WorldOutline, Vec<Vec<Vec2>>);

/// The zones of a file of areas, each with what else its table says.
struct ZoneFile<'a> {
    entry: &'a Spanned<ZoneTable>,
    path: &'a Spanned<PathBuf>,
    places: &'a FilePlaces<'a>,
    terrain: Option<&'a Terrain>,
    keep_in: bool,
    zones: Vec<WorldZone>,
    /// How many limits are flight levels.
    levels: usize,
    /// How many count without a ceiling, because nothing can place theirs.
    open: usize,
}

impl ZoneFile<'_> {
    /// Takes all zones, and says what counts otherwise than it is written.
    fn take(
        &mut self,
        number: usize,
        (start_m, beyond_m): (Vec3, f64),
    ) -> Result<impl Iterator<Item = String> + use<>, InputError> {
        let (table, text) = (self.entry.get_ref(), &self.places.text);
        let (polygon, other) = (&table.polygon_deg, &table.polygon_m);
        if polygon.is_some() || other.is_some() || table.radius_m.is_some() {
            let message = "a zone has a file and an outline of its own, expected one of these";
            return Err(text.error_at(self.entry, message));
        }
        if let Some(above) = &table.above {
            let message = "a zone has a file and heights above the ground of its own, expected one of these: the file's areas state what theirs are above";
            return Err(text.error_at(above, message));
        }
        let folder = text.path().parent().unwrap_or(Path::new(""));
        let mut file = areas::read(&folder.join(self.path.get_ref()))?;
        let file_notes = core::mem::take(&mut file.notes);
        let count = file.areas.len();
        file.areas.retain(|area| self.keep_in || !area.is_free);
        let free = count - file.areas.len();
        let otherwise = table.name.clone();
        let otherwise = otherwise.unwrap_or_else(|| format!("zone {number}"));
        let alone = count == 1;
        let mut all = Vec::new();
        for (mut area, number) in file.areas.into_iter().zip(1..) {
            let otherwise = || {
                if alone {
                    otherwise.clone()
                } else {
                    format!("{otherwise}, area {number}")
                }
            };
            let name = area.name.take().unwrap_or_else(otherwise);
            let rings = area.check_rings();
            rings.map_err(|error| text.error_at(self.path, format!("{name}: {error}")))?;
            let whole = |outline| {
                let whole = WorldZone::new(name.clone(), false, outline, ALL_HEIGHTS_M);
                whole.map_err(|error| text.error_at(self.path, error.to_string()))
            };
            let found = self.outlines(&name, &area).and_then(|(outlines, by_m)| {
                let parts = outlines.into_iter();
                let parts = parts.map(|(outline, holes)| Ok((whole(outline)?, holes)));
                Ok((parts.collect::<Result<Vec<_>, InputError>>()?, by_m))
            });
            let is_beside = |(parts, _): &(Vec<(WorldZone, _)>, f64)| {
                let mut margins_m = parts.iter().map(|(whole, _)| whole.margin_m(start_m));
                margins_m.any(|margin_m| margin_m <= beyond_m)
            };
            let is_near = self.keeps_in(&area) || found.as_ref().is_ok_and(is_beside);
            all.push((area, found, is_near));
        }
        // A file whose zones are all far away is for another place: it is read as a whole, and a warning says so.
        let count = all.len();
        if all.iter().any(|(.., is_near)| *is_near) {
            all.retain(|(.., is_near)| *is_near);
        }
        let far = count - all.len();
        let timed = all.iter().filter(|(area, ..)| area.is_timed).count();
        let (mut grown, mut grown_m) = (0, 0.0_f64);
        for (area, found, _) in all {
            let (parts, by_m) = found?;
            grown += usize::from(by_m > 0.0);
            grown_m = grown_m.max(by_m);
            for (whole, holes) in parts {
                self.add(&area, &whole, holes)?;
            }
        }
        let with_levels = format!(
            "with a flight level, which the weather moves: counted {} larger",
            "550 m and 12 % of its height"
        );
        let grown_by = format!("with too many corners: outlines moved by at most {grown_m} m");
        let notes = [
            (grown, grown_by.as_str()),
            (self.levels, &with_levels),
            (free, "that restricts nothing (NO_RESTRICTION): left out"),
            (far, "beyond all that the aircraft flies to: left out"),
            (timed, "with times of its own: counted at all times"),
            (
                self.open,
                "with a ceiling above the ground or the ellipsoid, whose height is not known here: counted without a ceiling",
            ),
        ];
        let file = self.path.get_ref().display().to_string();
        let notes = notes.into_iter().filter(|(count, _)| *count > 0);
        let notes = notes.map(|(count, what)| format!("{} {what}", counted(count, "zone")));
        let notes: Vec<String> = notes.collect();
        Ok(file_notes
            .into_iter()
            .chain(notes)
            .map(move |note| format!("{file}: {note}")))
    }

    /// Whether an area is to stay in: what its file says counts before its table.
    fn keeps_in(&self, area: &NamedArea) -> bool {
        area.keep_in.unwrap_or(self.keep_in)
    }

    /// The limits of an area; those above the ground as altitudes, if the ground is known in all of the box around it.
    fn over_ground(&mut self, area: &NamedArea) -> [Option<AreaLimit>; 2] {
        let is_above = |limit: &AreaLimit| limit.above == Reference::Ground;
        let mut limits = area.limits;
        let outwards = if self.keeps_in(area) { -1.0 } else { 1.0 };
        let mut is_level = false;
        for (limit, sign) in limits.iter_mut().zip([-outwards, outwards]) {
            if let Some(level) = limit
                .as_mut()
                .filter(|limit| limit.above == Reference::Pressure)
            {
                level.height_m += sign * level.off_m();
                level.above = Reference::Sea;
                is_level = true;
            }
        }
        self.levels += usize::from(is_level);
        if limits.iter().flatten().any(is_above)
            && let Some(grounds_m) = grounds_m(self.terrain, &area.outline, self.keeps_in(area))
        {
            for (limit, ground_m) in limits.iter_mut().zip(grounds_m) {
                // On the ground itself begins what has no floor.
                if let Some(limit) = limit
                    .as_mut()
                    .filter(|limit| is_above(limit) && limit.height_m > 0.0)
                {
                    limit.above = Reference::Sea;
                    limit.height_m += ground_m;
                }
            }
        }
        limits
    }

    /// The outlines of an area on the plane, each with its holes, and how far they were moved so that they have few corners, metres.
    fn outlines(
        &self,
        name: &str,
        area: &NamedArea,
    ) -> Result<(Vec<OutlineAndHoles>, f64), InputError> {
        let what = format!("a corner of {name}");
        let local = |at: &[f64; 2]| level(self.places, self.path, &what, at);
        let rings = match &area.outline {
            AreaOutline::Circle {
                center_deg,
                radius_m,
            } => {
                let center_m = local(center_deg)?;
                let radius_m = *radius_m;
                let circle = WorldOutline::Circle { center_m, radius_m };
                return Ok((vec![(circle, Vec::new())], 0.0));
            }
            AreaOutline::Polygon(rings) => rings,
        };
        let plane = match &self.places.frame {
            Some(frame) => area.on_plane(frame, self.keeps_in(area)),
            None => PlaneArea::default(),
        };
        let split = |mut rings: Vec<Vec<Vec2>>| {
            let holes = rings.split_off(1.min(rings.len()));
            (
                WorldOutline::Polygon(rings.pop().unwrap_or_default()),
                holes,
            )
        };
        let mut outlines: Vec<_> = plane.polygons.into_iter().map(split).collect();
        // Far from the origin, or without one, a zone is where its corners are, or they have no place.
        if outlines.is_empty() {
            let rings = rings.iter().map(|ring| ring.iter().map(local).collect());
            outlines.push(split(rings.collect::<Result<_, InputError>>()?));
        }
        Ok((outlines, plane.grown_m))
    }

    /// Adds the zone of an area; its holes are free, or, within a zone to stay in, zones to keep out of.
    fn add(
        &mut self,
        area: &NamedArea,
        whole: &WorldZone,
        holes: Vec<Vec<Vec2>>,
    ) -> Result<(), InputError> {
        let (text, name) = (&self.places.text, whole.name());
        let keep_in = self.keeps_in(area);
        let limits = self.over_ground(area);
        let (heights_m, is_open) = heights_m(self.entry, name, limits, self.places)?;
        self.open += usize::from(is_open);
        let wrong = |error| text.error_at(self.path, format!("{name}: {error}"));
        let mut outlines = vec![(name.to_owned(), keep_in, whole.outline().clone())];
        if let WorldOutline::Polygon(outline) = whole.outline() {
            let joined = zones::with_holes(outline.clone(), holes.clone()).map_err(wrong)?;
            if keep_in {
                let holes = holes.into_iter().zip(1..);
                outlines.extend(holes.map(|(hole, number)| {
                    let name = format!("{name}, hole {number}");
                    (name, false, WorldOutline::Polygon(hole))
                }));
            } else {
                outlines = vec![(name.to_owned(), false, WorldOutline::Polygon(joined))];
            }
        }
        for (name, keep_in, outline) in outlines {
            let zone = WorldZone::new(name, keep_in, outline, heights_m);
            self.zones.push(zone.map_err(wrong)?);
        }
        Ok(())
    }
}

/// The altitudes above which a floor and a ceiling above the ground are, metres, if the ground is known in all of the box around an
/// outline: the lowest and the highest place there, so that no zone to keep out of is smaller than it is written, and none to stay in is
/// larger.
fn grounds_m(terrain: Option<&Terrain>, outline: &AreaOutline, keeps_in: bool) -> Option<[f64; 2]> {
    let terrain = terrain?;
    let error_m = terrain.vertical_error_m();
    let [least_m, largest_m] = terrain.range_m(&outline.span()?)?;
    let (low_m, high_m) = (least_m - error_m, largest_m + error_m);
    Some(if keeps_in {
        [high_m, low_m]
    } else {
        [low_m, high_m]
    })
}

/// Beyond these altitudes a limit counts as missing, metres.
const ALTITUDES_M: (f64, f64) = (-1e3, 5e4);

/// Floor and ceiling of a zone of a file, metres, with those of its table for what the file does not state or nothing can place, and
/// whether it has none instead of a ceiling that nothing can place: it keeps out of more, then.
fn heights_m(
    entry: &Spanned<ZoneTable>,
    name: &str,
    limits: [Option<AreaLimit>; 2],
    places: &FilePlaces<'_>,
) -> Result<((f64, f64), bool), InputError> {
    let (table, text) = (entry.get_ref(), &places.text);
    let own = [&table.floor_m, &table.ceiling_m];
    let (own_floor_m, own_ceiling_m) = checks::limits(own, *text)?;
    let origin_m = places
        .frame
        .as_ref()
        .map_or(0.0, |frame| frame.origin().altitude_m);
    let unknown = |limit: AreaLimit, does: &str, key: &str| {
        let above = match limit.above {
            Reference::Ground => "ground",
            Reference::Ellipsoid => "ellipsoid",
            Reference::Sea | Reference::Pressure => "sea",
        };
        let message = format!(
            "{name} {does} {} m above the {above}, whose height is not known here, expected an altitude above the sea (AMSL), or {key} in its [[zone]]",
            limit.height_m
        );
        Err(text.error_at(entry, message))
    };
    let (lowest_m, highest_m) = ALTITUDES_M;
    let z_m = |altitude_m: f64| altitude_m.clamp(lowest_m, highest_m) - origin_m;
    let [floor, ceiling] = limits;
    let is_sea = |limit: AreaLimit| limit.above == Reference::Sea;
    let is_surface = |limit: AreaLimit| limit.above == Reference::Ground && limit.height_m <= 0.0;
    let floor_m = match floor {
        None => own_floor_m,
        Some(limit) if is_sea(limit) => z_m(limit.height_m),
        Some(limit) if is_surface(limit) => f64::NEG_INFINITY,
        Some(_) if own_floor_m.is_finite() => own_floor_m,
        Some(limit) => return unknown(limit, "begins", "floor_m"),
    };
    let (ceiling_m, is_open) = match ceiling {
        None => (own_ceiling_m, false),
        Some(limit) if limit.height_m >= highest_m => (f64::INFINITY, false),
        Some(limit) if is_sea(limit) => (z_m(limit.height_m), false),
        Some(_) if own_ceiling_m.is_finite() => (own_ceiling_m, false),
        Some(_) if table.kind == ZoneKindName::KeepOut => (f64::INFINITY, true),
        Some(limit) => return unknown(limit, "ends", "ceiling_m"),
    };
    Ok(((floor_m, ceiling_m), is_open))
}

/// The zone of a table, which is the file's `number`th.
fn zone(
    entry: &Spanned<ZoneTable>,
    number: usize,
    (places, terrain): (&FilePlaces<'_>, Option<&Terrain>),
) -> Result<WorldZone, InputError> {
    let (table, text) = (entry.get_ref(), &places.text);
    let name = table.name.clone();
    let name = name.unwrap_or_else(|| format!("zone {number}"));
    let outline = match (&table.polygon_m, &table.polygon_deg, &table.radius_m) {
        (Some(corners), None, None) => {
            let corners_m = corners.get_ref().iter().copied().map(Vec2::from_array);
            polygon(corners_m.collect(), &name)
                .map_err(|message| text.error_at(corners, message))?
        }
        (None, Some(corners), None) => {
            let local = |at| level(places, corners, "a corner", at);
            let corners_m: Result<Vec<Vec2>, InputError> =
                corners.get_ref().iter().map(local).collect();
            polygon(corners_m?, &name).map_err(|message| text.error_at(corners, message))?
        }
        (None, None, Some(radius)) => WorldOutline::Circle {
            center_m: center(entry, places)?,
            radius_m: {
                text.positive("radius_m", radius)?;
                text.within("radius_m", radius, (0.0, LARGEST_M))?
            },
        },
        (None, None, None) => {
            let message = format!(
                "{name} has no outline, expected polygon_m, polygon_deg, file, or radius_m with a centre"
            );
            return Err(text.error_at(entry, message));
        }
        _ => {
            let message = format!(
                "{name} has more than one outline, expected one of polygon_m, polygon_deg and radius_m"
            );
            return Err(text.error_at(entry, message));
        }
    };
    let is_circle = matches!(outline, WorldOutline::Circle { .. });
    if !is_circle && (table.center_m.is_some() || table.center_deg.is_some()) {
        let message =
            format!("{name} is a polygon with a centre, expected radius_m beside a centre");
        return Err(text.error_at(entry, message));
    }
    let mut heights_m = checks::limits([&table.floor_m, &table.ceiling_m], *text)?;
    let keep_in = table.kind == ZoneKindName::KeepIn;
    if let Some(above) = &table.above {
        let frame = places.frame.as_ref();
        let known = frame.and_then(|frame| {
            let outline = on_earth(&outline, frame);
            let grounds_m = grounds_m(terrain, &outline, keep_in)?;
            Some(grounds_m.map(|ground_m| ground_m - frame.origin().altitude_m))
        });
        let Some([floor_m, ceiling_m]) = known else {
            let message = format!(
                "{name} is above the ground, expected a [terrain] that knows all of the box around it"
            );
            return Err(text.error_at(above, message));
        };
        heights_m = (heights_m.0 + floor_m, heights_m.1 + ceiling_m);
    }
    WorldZone::new(name.clone(), keep_in, outline, heights_m)
        .map_err(|error| text.error_at(entry, format!("{name}: {error}")))
}

/// An outline by latitudes and longitudes.
fn on_earth(outline: &WorldOutline, frame: &LocalFrame) -> AreaOutline {
    let place_deg = |at_m: &Vec2| {
        let place = frame.to_geodetic(at_m.extend(0.0));
        [place.latitude_deg, place.longitude_deg]
    };
    match outline {
        WorldOutline::Circle { center_m, radius_m } => AreaOutline::Circle {
            center_deg: place_deg(center_m),
            radius_m: *radius_m,
        },
        WorldOutline::Polygon(corners_m) => {
            AreaOutline::Polygon(vec![corners_m.iter().map(place_deg).collect()])
        }
    }
}

fn polygon(corners_m: Vec<Vec2>, name: &str) -> Result<WorldOutline, String> {
    let corners_m = zones::polygon(corners_m).map_err(|error| format!("{name}: {error}"))?;
    Ok(WorldOutline::Polygon(corners_m))
}

fn center(entry: &Spanned<ZoneTable>, places: &FilePlaces<'_>) -> Result<Vec2, InputError> {
    let table = entry.get_ref();
    match (&table.center_m, &table.center_deg) {
        (Some(center), None) => {
            let [east_m, north_m] = *center.get_ref();
            let at = Spanned::new(center.span(), [east_m, north_m, 0.0]);
            Ok(places.local("center_m", &at)?.truncate())
        }
        (None, Some(center)) => level(places, center, "center_deg", center.get_ref()),
        _ => Err(places.text.error_at(
            entry,
            "a circle has no centre of its own, expected one of center_m and center_deg beside radius_m",
        )),
    }
}

/// A place of latitude and longitude at the altitude of the origin.
fn level<T>(
    places: &FilePlaces<'_>,
    near: &Spanned<T>,
    key: &str,
    [latitude_deg, longitude_deg]: &[f64; 2],
) -> Result<Vec2, InputError> {
    let altitude_m = (places.frame.as_ref()).map_or(0.0, |frame| frame.origin().altitude_m);
    let place = [*latitude_deg, *longitude_deg, altitude_m];
    let place = places.geodetic(key, &Spanned::new(near.span(), place));
    place.map(Vec3::truncate)
}
