//! Clearance and profile of straight paths over the ground, exact between posts.
//!
//! A path that is straight in the local frame is cut into pieces of at most a kilometre, each straight in latitude and
//! longitude within two centimetres. In a cell of the grid the height along such a piece is a quadratic, whose least clearance is in closed form.

use super::field::ON_LINE;
use super::mosaic::Terrain;
use crate::geodesy::{Geodetic, LocalFrame};
use glam::DVec3;

/// Longest piece, metres.
const PIECE_M: f64 = 1_000.0;
/// Step over unknown ground, metres.
const UNKNOWN_STEP_M: f64 = 5.0;
/// So far ahead the cell is looked up, share of a piece.
const AHEAD: f64 = 1e-6;

/// Where a path is nearest to the ground below it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lowest {
    /// The place of the path.
    pub place: Geodetic,
    /// The ground below, metres.
    pub ground_m: f64,
    /// Altitude above the ground, metres.
    pub clearance_m: f64,
    /// Distance from the beginning of the path, metres.
    pub along_m: f64,
}

/// The clearance of a path.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Clearance {
    /// Its least one over known ground; `None` where none is known.
    pub lowest: Option<Lowest>,
    /// Length over unknown ground, metres; known ground of less than 5 m between unknown may count as unknown.
    pub unknown_m: f64,
    /// The first place over unknown ground.
    pub unknown_at: Option<Geodetic>,
}

/// A point of a path with the ground below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundPoint {
    /// Distance from the beginning of the path, metres.
    pub along_m: f64,
    /// Altitude of the path, metres.
    pub path_m: f64,
    /// The ground, metres; `None` where it is not known.
    pub ground_m: Option<f64>,
}

/// A part of a path over one cell, or over unknown ground: shares of the path, and the ground at both ends and in the middle.
struct Stretch {
    from: f64,
    to: f64,
    ground_m: Option<[f64; 3]>,
}

impl Terrain {
    /// The clearance of the straight path between two places of a frame, metres; altitudes of the frame count above the
    /// terrain's datum.
    pub fn clearance(&self, frame: &LocalFrame, from_m: DVec3, to_m: DVec3) -> Clearance {
        let mut found = Clearance::default();
        let length_m = across_m(from_m, to_m);
        self.walk(frame, from_m, to_m, &mut |stretch| {
            let at = |share: f64| frame.to_geodetic(from_m.lerp(to_m, share));
            let Some(ground_m) = stretch.ground_m else {
                found.unknown_m += (stretch.to - stretch.from) * length_m;
                found.unknown_at.get_or_insert_with(|| at(stretch.from));
                return;
            };
            let (share, clearance_m) = least(&stretch, ground_m, |share| at(share).altitude_m);
            if found
                .lowest
                .is_none_or(|lowest| clearance_m < lowest.clearance_m)
            {
                let place = at(share);
                found.lowest = Some(Lowest {
                    place,
                    ground_m: place.altitude_m - clearance_m,
                    clearance_m,
                    along_m: share * length_m,
                });
            }
        });
        found
    }

    /// The ground below the straight path between two places of a frame, with a point at each crossing of a line of posts.
    pub fn profile(&self, frame: &LocalFrame, from_m: DVec3, to_m: DVec3) -> Vec<GroundPoint> {
        let length_m = across_m(from_m, to_m);
        let mut points = Vec::new();
        self.walk(frame, from_m, to_m, &mut |stretch| {
            let mut take = |share: f64, ground_m: Option<f64>| {
                points.push(GroundPoint {
                    along_m: share * length_m,
                    path_m: from_m.lerp(to_m, share).z + frame.origin().altitude_m,
                    ground_m,
                });
            };
            take(stretch.from, stretch.ground_m.map(|ground_m| ground_m[0]));
            take(stretch.to, stretch.ground_m.map(|ground_m| ground_m[2]));
        });
        points
    }

    fn walk(
        &self,
        frame: &LocalFrame,
        from_m: DVec3,
        to_m: DVec3,
        visit: &mut impl FnMut(Stretch),
    ) {
        let pieces = libm::ceil(across_m(from_m, to_m) / PIECE_M).clamp(1.0, 1e6);
        let mut piece = 0.0;
        let mut begin = frame.to_geodetic(from_m);
        while piece < pieces {
            let [from, to] = [piece / pieces, (piece + 1.0) / pieces];
            let end = frame.to_geodetic(from_m.lerp(to_m, to));
            let length_m = across_m(from_m, to_m) / pieces;
            self.walk_piece(begin, end, length_m, &mut |stretch| {
                visit(Stretch {
                    from: from + stretch.from / pieces,
                    to: from + stretch.to / pieces,
                    ..stretch
                });
            });
            begin = end;
            piece += 1.0;
        }
    }

    fn walk_piece(
        &self,
        begin: Geodetic,
        end: Geodetic,
        length_m: f64,
        visit: &mut impl FnMut(Stretch),
    ) {
        let north_deg = end.latitude_deg - begin.latitude_deg;
        let east_deg = libm::remainder(end.longitude_deg - begin.longitude_deg, 360.0);
        let mut share = 0.0;
        let cell_at = |share: f64| {
            self.cell(
                begin.latitude_deg + share * north_deg,
                begin.longitude_deg + share * east_deg,
            )
        };
        while share < 1.0 {
            let ahead = (share + AHEAD).min(1.0);
            let Some((field, steps, cell)) = cell_at(ahead) else {
                let mut to = (share + UNKNOWN_STEP_M / length_m.max(UNKNOWN_STEP_M)).min(1.0);
                if cell_at(to).is_some() {
                    // Where the known ground begins, to a millimetre.
                    let mut unknown = share;
                    for _ in 0..13 {
                        let middle = 0.5 * (unknown + to);
                        if cell_at(middle).is_some() {
                            to = middle;
                        } else {
                            unknown = middle;
                        }
                    }
                }
                visit(Stretch {
                    from: share,
                    to,
                    ground_m: None,
                });
                share = to;
                continue;
            };
            let rates = [
                north_deg / field.grid().step_north_deg,
                east_deg / field.grid().step_east_deg,
            ];
            // As far beyond a line as still counts as on it: a path along a line of posts leaves neither cell.
            let leaves = |rate: f64, step: f64, corner: f64| {
                if rate > 0.0 {
                    (corner + 1.0 + ON_LINE - step) / rate
                } else if rate < 0.0 {
                    (corner - ON_LINE - step) / rate
                } else {
                    f64::INFINITY
                }
            };
            let stays = leaves(rates[0], steps[0], cell.corner[0]).min(leaves(
                rates[1],
                steps[1],
                cell.corner[1],
            ));
            let to = (ahead + stays.max(AHEAD)).min(1.0);
            let ground = |at: f64| {
                cell.height_m([
                    steps[0] + rates[0] * (at - ahead),
                    steps[1] + rates[1] * (at - ahead),
                ])
            };
            let ground_m = match (ground(share), ground(0.5 * (share + to)), ground(to)) {
                (Some(first), Some(middle), Some(last)) => Some([first, middle, last]),
                _ => None,
            };
            visit(Stretch {
                from: share,
                to,
                ground_m,
            });
            share = to;
        }
    }
}

fn across_m(from_m: DVec3, to_m: DVec3) -> f64 {
    libm::hypot(to_m.x - from_m.x, to_m.y - from_m.y)
}

/// Share of the path and the least of a quadratic through three clearances.
fn least(stretch: &Stretch, ground_m: [f64; 3], altitude_m: impl Fn(f64) -> f64) -> (f64, f64) {
    let middle = 0.5 * (stretch.from + stretch.to);
    let [first, half, last] = [
        altitude_m(stretch.from) - ground_m[0],
        altitude_m(middle) - ground_m[1],
        altitude_m(stretch.to) - ground_m[2],
    ];
    let curve = 2.0 * (first + last - 2.0 * half);
    let slope = 4.0 * half - 3.0 * first - last;
    let mut least = if first <= last {
        (0.0, first)
    } else {
        (1.0, last)
    };
    let vertex = -slope / (2.0 * curve);
    if curve > 0.0 && (0.0..1.0).contains(&vertex) {
        let value = first + vertex * (slope + vertex * curve);
        if value < least.1 {
            least = (vertex, value);
        }
    }
    (
        stretch.from + least.0 * (stretch.to - stretch.from),
        least.1,
    )
}
