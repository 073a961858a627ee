//! Kinds of encounters.

/// A range; equal ends are a fixed value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range(pub f64, pub f64);

/// The surroundings of an encounter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Landscape {
    /// A valley along the mission, with walls on both sides.
    Valley,
    /// Ridges across the mission, which passes over them where they are low.
    Ridges,
    /// Ground across the mission as high as a wall, with a gap through which mission and intruders lead.
    GroundWall,
    /// A fence around the mission, and zones to keep out of beside it.
    Corridor,
}

impl Landscape {
    /// Those with a name as a family.
    pub(super) fn named(name: &str) -> Option<Self> {
        match name {
            "valley" => Some(Self::Valley),
            "ridges" => Some(Self::Ridges),
            "ground-wall" => Some(Self::GroundWall),
            "corridor" => Some(Self::Corridor),
            _ => None,
        }
    }
}

/// Threats that are first seen at a distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnThreats {
    /// Their number.
    pub count: u32,
    /// Distance at the start, metres.
    pub first_seen_m: Range,
    /// Speed, metres per second; (0, 0) is static and lies ahead.
    pub speed_mps: Range,
}

/// A kind of encounter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Family {
    /// Table 4 and §2.3 (5): `count` threats first seen at a distance, with any bearing and course from
    /// 0° to 360°: level traffic at the aircraft's altitude, which is the hardest case. (With this draw
    /// the avoidable shares agree with those that others found for these cells; with threats from
    /// anywhere, or above and below, far more is avoidable.) Static ones lie in the way ahead.
    Threats(DrawnThreats),
    /// The same threats among ground or zones.
    Among(Landscape, DrawnThreats),
    /// Threats from any direction in space, with any climb or descent.
    FromAnywhere(DrawnThreats),
    /// One obstacle on the reciprocal course, or nearly so.
    HeadOn {
        /// Distance at the start, metres.
        first_seen_m: Range,
        /// Speed, metres per second.
        speed_mps: Range,
    },
    /// A slow one ahead on the aircraft's course and a fast one from behind.
    Overtaking,
    /// Static spheres across the course, closer together than their diameters.
    Wall {
        /// Whether two of them leave a gap that the aircraft fits through.
        gap: bool,
    },
    /// Movers that cross the course one after the other.
    Stream {
        /// Their number.
        count: u32,
    },
    /// Fast movers that arrive together, such that no single turn escapes but two turns do.
    Pincer {
        /// Their number.
        count: u32,
    },
}
