//! The zones and the ground that the caller lends for a call.

use core::mem::MaybeUninit;

use fga::Vec2;
use fga::ground::Ground;
use fga::limit::{LARGEST_M, SettingsError};
use fga::zone::{Outline, Zone};

use crate::floating::by_default;
use crate::growable::Growable;
use crate::memory::{LentSpan, apart, given, list};
use crate::status::{Refused, fga_status};

/// Most zones of a situation.
pub const FGA_ZONES_MOST: usize = 32;

/// Most corners of a zone.
pub const FGA_ZONE_CORNERS_MOST: u32 = 256;

/// Most posts of a ground in a row, and most rows.
pub const FGA_GROUND_POSTS_MOST: u32 = 32_768;

/// A place over the ground, or a distance east and north.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct fga_place {
    /// East, metres.
    pub east_m: f64,
    /// North, metres.
    pub north_m: f64,
}

const _: () = {
    assert!(size_of::<fga_place>() == size_of::<Vec2>());
    assert!(align_of::<fga_place>() == align_of::<Vec2>());
};

impl fga_place {
    const fn vector(self) -> Vec2 {
        Vec2::new(self.east_m, self.north_m)
    }
}

/// Room for the zones of a call, which nobody writes before there are some.
pub(crate) type ZoneRoom<'a> = [MaybeUninit<Zone<'a>>; FGA_ZONES_MOST];

/// What a zone is for.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum fga_zone_kind {
    /// The aircraft keeps out of it.
    KeepOut = 0,
    /// The aircraft keeps within it.
    KeepIn = 1,
}

/// A zone: what is above a polygon or a circle between two altitudes. What an odd number of the edges of a polygon surrounds is
/// inside.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_zone {
    /// What it is for: an `fga_zone_kind`.
    pub kind: u32,
    /// Number of corners of a polygon: 3 to `FGA_ZONE_CORNERS_MOST`; 0 for a circle.
    pub corner_count: u32,
    /// The corners of a polygon in order, either way round; they are read during the call only.
    pub corners: *const fga_place,
    /// Centre of a circle.
    pub center: fga_place,
    /// Radius of a circle, metres, above 0.
    pub radius_m: f64,
    /// Its floor, metres up; `-INFINITY` without one.
    pub floor_m: f64,
    /// Its ceiling, metres up; `INFINITY` without one.
    pub ceiling_m: f64,
}

/// Heights of the ground on a regular grid, bilinear in between. Outside of it, and where a height is not a number, the ground is
/// unknown: no manoeuvre leads there by choice.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_ground {
    /// `sizeof(fga_ground)`.
    pub size: u32,
    /// Posts in a row, from the west to the east: 2 to `FGA_GROUND_POSTS_MOST`.
    pub columns: u32,
    /// Rows, from the south to the north: 2 to `FGA_GROUND_POSTS_MOST`.
    pub rows: u32,
    /// The south-west post.
    pub corner: fga_place,
    /// Distance from post to post, metres, above 0.
    pub spacing: fga_place,
    /// Heights of the posts, metres up, row by row; they are read during the call only.
    pub heights_m: *const f32,
    /// The largest heights of blocks, which `fga_ground_fill_peaks` has filled in from these heights: `fga_ground_peak_count` of
    /// them. Others make the ground another one.
    pub peaks_m: *const f32,
    /// Vertical error of the heights, metres.
    pub error_m: f64,
    /// Height above the ground that is asked for, metres, beyond the error.
    pub clearance_m: f64,
}

// SAFETY: `repr(C)`, the size first, then numbers and pointers that may be null.
unsafe impl Growable for fga_ground {}

const GRID: &str = "2 to FGA_GROUND_POSTS_MOST";

/// Posts in a row and in all.
fn posts(columns: u32, rows: u32) -> Result<(usize, u32), Refused> {
    for (field, count) in [("columns", columns), ("rows", rows)] {
        if !(2..=FGA_GROUND_POSTS_MOST).contains(&count) {
            return Err(Refused::out_of_range(field, f64::from(count), GRID));
        }
    }
    Ok((columns as usize, columns * rows))
}

fn peaks(columns: u32, rows: u32) -> Result<u32, Refused> {
    let (columns, posts) = posts(columns, rows)?;
    let peaks = Ground::peak_count(columns, posts as usize);
    u32::try_from(peaks).map_err(|_| fga_status::TooMany.into())
}

/// A zone of the caller, apart from what the call writes.
///
/// # Safety
/// As [`list`] of its corners.
unsafe fn zone<'a>(given: &fga_zone, written: &[LentSpan]) -> Result<Zone<'a>, Refused> {
    let keep_in = match given.kind {
        kind if kind == fga_zone_kind::KeepOut as u32 => false,
        kind if kind == fga_zone_kind::KeepIn as u32 => true,
        other => return Err(Refused::unknown("kind", other, "an fga_zone_kind")),
    };
    let heights_m = (given.floor_m, given.ceiling_m);
    let below = "a number below ceiling_m, -INFINITY without a floor";
    SettingsError::unless(heights_m.0 < heights_m.1, "floor_m", heights_m.0, below)?;
    let count = given.corner_count;
    let outline = if count == 0 {
        usable("center", given.center)?;
        let radius_m = given.radius_m;
        let is_radius = radius_m > 0.0 && radius_m <= LARGEST_M;
        SettingsError::unless(is_radius, "radius_m", radius_m, "above 0, up to 1e7")?;
        Outline::Circle(given.center.vector(), radius_m)
    } else {
        if !(3..=FGA_ZONE_CORNERS_MOST).contains(&count) {
            let expected = "0, or 3 to FGA_ZONE_CORNERS_MOST";
            let count = f64::from(count);
            return Err(Refused::out_of_range("corner_count", count, expected));
        }
        // SAFETY: as this function.
        let (corners, span) = unsafe { list(given.corners, count) }?;
        apart_from(&[span], written)?;
        for corner in corners {
            usable("corners", *corner)?;
        }
        // SAFETY: both are two numbers of 64 bits in the order of C, as large and aligned as each other.
        let corners =
            unsafe { core::slice::from_raw_parts(corners.as_ptr().cast(), corners.len()) };
        Outline::Polygon(corners)
    };
    Ok(Zone {
        keep_in,
        outline,
        heights_m,
    })
}

fn usable(field: &'static str, place: fga_place) -> Result<(), Refused> {
    for value in [place.east_m, place.north_m] {
        let expected = "finite numbers up to 1e7";
        SettingsError::unless(value.abs() <= LARGEST_M, field, value, expected)?;
    }
    Ok(())
}

/// The zones of a situation, apart from what the call writes.
///
/// # Safety
/// As [`list`], of the zones and of the corners of each.
pub(crate) unsafe fn zones<'r, 'a>(
    (zones, count): (*const fga_zone, u32),
    written: &[LentSpan],
    room: &'r mut ZoneRoom<'a>,
) -> Result<&'r [Zone<'a>], Refused> {
    if count as usize > FGA_ZONES_MOST {
        let expected = "at most FGA_ZONES_MOST";
        return Err(Refused::too_many("zone_count", count, expected));
    }
    // SAFETY: as this function.
    let (zones, span) = unsafe { list(zones, count) }?;
    apart_from(&[span], written)?;
    for (index, (given, slot)) in zones.iter().zip(room.iter_mut()).enumerate() {
        // SAFETY: as this function.
        slot.write(unsafe { zone(given, written) }.map_err(|refused| refused.at(index))?);
    }
    // SAFETY: as many are written just now.
    Ok(unsafe { core::slice::from_raw_parts(room.as_ptr().cast(), zones.len()) })
}

/// Refuses what the caller lends where it overlaps what the call writes.
fn apart_from(lent: &[LentSpan], written: &[LentSpan]) -> Result<(), Refused> {
    for one in lent {
        for other in written {
            apart(&[*one, *other])?;
        }
    }
    Ok(())
}

/// The ground of a situation, apart from what the call writes, if there is one.
///
/// # Safety
/// As [`given`], and as [`list`] of its heights and peaks.
pub(crate) unsafe fn ground<'a>(
    pointer: *const fga_ground,
    written: &[LentSpan],
) -> Result<Option<Ground<'a>>, Refused> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: as this function.
    let (ground, span) = unsafe { given(pointer) }?;
    let (columns, posts) = posts(ground.columns, ground.rows)?;
    let peaks = peaks(ground.columns, ground.rows)?;
    // SAFETY: as this function.
    let (heights_m, of) = unsafe { list(ground.heights_m, posts) }?;
    // SAFETY: as this function.
    let (peaks_m, of_peaks) = unsafe { list(ground.peaks_m, peaks) }?;
    apart_from(&[span, of, of_peaks], written)?;
    let place = (ground.corner.vector(), ground.spacing.vector());
    let asked_m = (ground.error_m, ground.clearance_m);
    usable("corner", ground.corner)?;
    usable("spacing", ground.spacing)?;
    let made = Ground::new(place, columns, (heights_m, peaks_m), asked_m)?;
    Ok(Some(made))
}

/// Number of the largest heights of blocks of a ground; 0 where its posts are too few or too many.
#[unsafe(no_mangle)]
pub extern "C" fn fga_ground_peak_count(columns: u32, rows: u32) -> u32 {
    peaks(columns, rows).unwrap_or(0)
}

/// Fills in the largest heights of blocks of a ground, `fga_ground_peak_count` of them, once for heights that stay.
///
/// Refuses `NULL`, `MISALIGNED`, `ALIASED`, `OUT_OF_RANGE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fga_ground_fill_peaks(
    columns: u32,
    rows: u32,
    heights_m: *const f32,
    peaks_m: *mut f32,
) -> fga_status {
    let fill = || -> Result<(), Refused> {
        let (row, posts) = posts(columns, rows)?;
        let count = peaks(columns, rows)?;
        // SAFETY: the caller's word, in the header.
        let (heights_m, of) = unsafe { list(heights_m, posts) }?;
        if count > 0 {
            apart(&[of, LentSpan::of(peaks_m.cast_const(), count as usize)?])?;
            // SAFETY: the caller's word, in the header; a float lies there, whatever its bits, and nobody else refers to it.
            let peaks_m = unsafe { core::slice::from_raw_parts_mut(peaks_m, count as usize) };
            Ground::fill_peaks(row, heights_m, peaks_m);
        }
        Ok(())
    };
    by_default(fill).map_or_else(|refused| refused.status, |()| fga_status::Ok)
}
