//! The distance of a flight from the volumes, in continuous time.
//!
//! On a straight piece the relative motion is a straight line: closed form for a sphere, a convex
//! function of time for a cylinder. A curved piece deviates from its chord by at most A·h²/8 with
//! the bound A of its acceleration; where that could matter the piece is halved until the bound is
//! below half a millimetre.

use alloc::sync::Arc;

use fga_proof::Vec3;
use fga_proof::situation::ProtectedVolume;

use super::airspace::{COARSE_M, EXACT_M, OracleAirspace};
use super::flight::{FlightNode, OracleFlight, hermite};
use crate::separation::{bounding_m, margin_m};

use super::{OracleManeuver, OracleObstacle, OracleStart, OracleTrack, OracleVehicle};

/// Accepted deviation of a curved piece from its chord, metres.
const RESOLUTION_M: f64 = 5e-4;

/// A straight piece of an obstacle's motion; it exists at no other time.
#[derive(Debug, Clone, Copy)]
struct StraightPiece {
    from_s: f64,
    to_s: f64,
    /// Its position at time 0, if it moved like this from there.
    position: Vec3,
    velocity: Vec3,
}

/// The motion of an obstacle.
#[derive(Clone)]
enum BodyMotion {
    Straight(StraightPiece),
    /// Pieces in the order of time.
    Pieces(Vec<StraightPiece>),
    /// No obstacle, but what bounds the flight.
    Bounds(Arc<OracleAirspace>),
}

/// An obstacle with precomputed values for the loops.
#[derive(Clone)]
pub(super) struct OracleBody {
    motion: BodyMotion,
    volume: ProtectedVolume,
    bounding_m: f64,
}

impl OracleBody {
    pub(super) fn new(obstacle: &OracleObstacle) -> Self {
        let always = StraightPiece {
            from_s: f64::NEG_INFINITY,
            to_s: f64::INFINITY,
            position: obstacle.position_m,
            velocity: obstacle.velocity_mps,
        };
        Self::with(&obstacle.volume, BodyMotion::Straight(always))
    }

    /// An aircraft on a track.
    pub(super) fn on_track(track: &OracleTrack) -> Self {
        let pieces = track.points_m.windows(2).map(|pair| {
            let ((from_s, from), (to_s, to)) = (pair[0], pair[1]);
            let velocity = (to - from) / (to_s - from_s);
            StraightPiece {
                from_s,
                to_s,
                position: from - velocity * from_s,
                velocity,
            }
        });
        Self::with(&track.volume, BodyMotion::Pieces(pieces.collect()))
    }

    /// Ground, zones and altitude limits around an aircraft that begins at a place.
    pub(super) fn bounds(airspace: OracleAirspace, start_m: Vec3) -> Self {
        let airspace = airspace.seen_from(start_m);
        let nothing = ProtectedVolume::Sphere { radius_m: 0.0 };
        Self::with(&nothing, BodyMotion::Bounds(Arc::new(airspace)))
    }

    /// Whether it is no obstacle, but what bounds the flight.
    pub(super) const fn is_bounds(&self) -> bool {
        matches!(self.motion, BodyMotion::Bounds(_))
    }

    fn with(volume: &ProtectedVolume, motion: BodyMotion) -> Self {
        Self {
            motion,
            volume: *volume,
            bounding_m: bounding_m(volume),
        }
    }

    /// The pieces that begin by `to_s` and do not end before `from_s`.
    #[inline]
    fn pieces(&self, from_s: f64, to_s: f64) -> &[StraightPiece] {
        match &self.motion {
            BodyMotion::Straight(piece) => core::slice::from_ref(piece),
            BodyMotion::Pieces(pieces) => {
                let first = pieces.partition_point(|piece| piece.to_s < from_s);
                let after = pieces.partition_point(|piece| piece.from_s <= to_s);
                pieces.get(first..after).unwrap_or_default()
            }
            BodyMotion::Bounds(_) => &[],
        }
    }

    /// Signed distance of `own` to the volume at `time_s`, metres; infinite while it is absent.
    pub(super) fn margin(&self, own: Vec3, time_s: f64) -> f64 {
        if let BodyMotion::Bounds(airspace) = &self.motion {
            return airspace.margin_m(own, time_s);
        }
        self.pieces(time_s, time_s)
            .iter()
            .map(|piece| margin_m(&self.volume, own - piece.position - piece.velocity * time_s))
            .fold(f64::INFINITY, f64::min)
    }

    /// The lesser of `running` and the margin on the straight line flown from `p0` at `t0` to
    /// `p1` at `t1`.
    #[inline]
    pub(super) fn chord(&self, t0: f64, p0: Vec3, t1: f64, p1: Vec3, running: f64) -> f64 {
        match &self.motion {
            BodyMotion::Straight(piece) => {
                return self.beside(piece, (t0, p0), (t1, p1), running);
            }
            BodyMotion::Bounds(airspace) => {
                let place = |s: f64| (t0 + (t1 - t0) * s, p0 + (p1 - p0) * s);
                return airspace.least_m((p0.distance(p1), COARSE_M), place, running);
            }
            BodyMotion::Pieces(_) => {}
        }
        let mut running = running;
        let along = |time_s: f64| p0 + (p1 - p0) * ((time_s - t0) / (t1 - t0).max(1e-9));
        for piece in self.pieces(t0, t1) {
            let from = if piece.from_s > t0 {
                (piece.from_s, along(piece.from_s))
            } else {
                (t0, p0)
            };
            let to = if piece.to_s < t1 {
                (piece.to_s, along(piece.to_s))
            } else {
                (t1, p1)
            };
            running = self.beside(piece, from, to, running);
        }
        running
    }

    /// The same while the obstacle flies one piece.
    #[inline]
    fn beside(
        &self,
        piece: &StraightPiece,
        (t0, p0): (f64, Vec3),
        (t1, p1): (f64, Vec3),
        running: f64,
    ) -> f64 {
        let a = p0 - piece.position - piece.velocity * t0;
        let b = p1 - piece.position - piece.velocity * t1;
        let d = b - a;
        let (dd, ad) = (d.dot(d), a.dot(d));
        let square = if ad >= 0.0 {
            a.dot(a)
        } else if -ad >= dd {
            b.dot(b)
        } else {
            a.dot(a) - ad * ad / dd
        };
        let limit = self.bounding_m + running;
        if limit <= 0.0 || square >= limit * limit {
            return running;
        }
        if let ProtectedVolume::Sphere { radius_m } = self.volume {
            return (libm::sqrt(square.max(0.0)) - radius_m).min(running);
        }
        self.golden(a, d).min(running)
    }

    /// Least distance on a line: the signed distance to a convex volume is convex along it.
    fn golden(&self, a: Vec3, d: Vec3) -> f64 {
        const RATIO: f64 = 0.618_033_988_749_894_9;
        let length = libm::sqrt(d.dot(d));
        let at = |s: f64| margin_m(&self.volume, a + d * s);
        let (mut low, mut high) = (0.0, 1.0);
        let (mut s1, mut s2) = (1.0 - RATIO, RATIO);
        let (mut f1, mut f2) = (at(s1), at(s2));
        let mut best = at(0.0).min(at(1.0)).min(f1).min(f2);
        while (high - low) * length > 1e-4 {
            if f1 <= f2 {
                high = s2;
                (s2, f2) = (s1, f1);
                s1 = high - RATIO * (high - low);
                f1 = at(s1);
                best = best.min(f1);
            } else {
                low = s1;
                (s1, f1) = (s2, f2);
                s2 = low + RATIO * (high - low);
                f2 = at(s2);
                best = best.min(f2);
            }
        }
        best
    }

    /// As [`OracleBody::chord`] for a curved piece between two nodes, never more than the truth and at
    /// most [`RESOLUTION_M`] below it.
    fn curve(&self, a: &FlightNode, b: &FlightNode, acceleration: f64, running: f64) -> f64 {
        let span = b.time_s - a.time_s;
        let deviation = acceleration * span * span / 8.0;
        let chord = self.chord(
            a.time_s,
            a.position_m,
            b.time_s,
            b.position_m,
            running + deviation,
        );
        if chord >= running + deviation {
            return running;
        }
        if deviation <= RESOLUTION_M {
            return running.min(chord - deviation);
        }
        let middle = FlightNode {
            time_s: 0.5 * (a.time_s + b.time_s),
            position_m: hermite(a, b, 0.5),
            // The derivative of the cubic at its middle.
            velocity_mps: (b.position_m - a.position_m) * (1.5 / span)
                - (a.velocity_mps + b.velocity_mps) * 0.25,
            ..*a
        };
        let running = self.curve(a, &middle, acceleration, running);
        self.curve(&middle, b, acceleration, running)
    }

    /// The lesser of `running` and the margin on the piece of a flight between two nodes.
    fn piece(&self, a: &FlightNode, b: &FlightNode, acceleration: f64, running: f64) -> f64 {
        if let BodyMotion::Bounds(airspace) = &self.motion {
            let length_m = a.velocity_mps.length() * (b.time_s - a.time_s);
            let place = |s: f64| (a.time_s + (b.time_s - a.time_s) * s, hermite(a, b, s));
            airspace.least_m((length_m, EXACT_M), place, running)
        } else if a.straight {
            self.chord(a.time_s, a.position_m, b.time_s, b.position_m, running)
        } else {
            self.curve(a, b, acceleration, running)
        }
    }
}

impl OracleFlight {
    /// The least signed distance to any protected volume over the flight, metres: never above the
    /// truth and within a millimetre of it; infinite without obstacles.
    pub fn least_margin_m(&self, obstacles: &[OracleObstacle]) -> f64 {
        let bodies: Vec<OracleBody> = obstacles.iter().map(OracleBody::new).collect();
        least_margin(self, &bodies, f64::NEG_INFINITY)
    }
}

/// Who flies among what, and for how long.
#[derive(Clone, Copy)]
pub(super) struct OracleScene<'a> {
    pub(super) start: &'a OracleStart,
    pub(super) vehicle: &'a OracleVehicle,
    pub(super) bodies: &'a [OracleBody],
    pub(super) horizon_s: f64,
}

impl OracleScene<'_> {
    /// Flies a manoeuvre, and back to the start's course from a time on.
    pub(super) fn fly(
        &self,
        maneuver: &OracleManeuver,
        back_s: Option<f64>,
        flight: &mut OracleFlight,
    ) {
        flight.fly(self.start, self.vehicle, maneuver, self.horizon_s, back_s);
    }
}

/// The least margin of a flight to all bodies, metres; infinite without bodies. Once it falls to
/// `stop_below` or less the function stops.
pub(super) fn least_margin(flight: &OracleFlight, bodies: &[OracleBody], stop_below: f64) -> f64 {
    let mut running = f64::INFINITY;
    let nodes = flight.nodes();
    if let Some(first) = nodes.first() {
        for body in bodies {
            running = running.min(body.margin(first.position_m, first.time_s));
        }
    }
    for pair in nodes.windows(2) {
        let [a, b] = pair else { continue };
        for body in bodies {
            running = body.piece(a, b, flight.acceleration_mps2(), running);
        }
        if running <= stop_below {
            return running;
        }
    }
    running
}

/// The least margin of each leg to each body, leg by leg, capped at `cutoff`.
pub(super) fn leg_margins(
    flight: &OracleFlight,
    bodies: &[OracleBody],
    cutoff: f64,
    margins: &mut Vec<f64>,
) {
    margins.clear();
    for leg in flight.legs() {
        for body in bodies {
            let mut running = cutoff;
            for pair in leg.windows(2) {
                let [a, b] = pair else { continue };
                running = body.piece(a, b, flight.acceleration_mps2(), running);
            }
            margins.push(running);
        }
    }
}
