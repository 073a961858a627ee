//! What kind of aircraft is it, so how much room does it get?

use fga::situation::{Movement, ProtectedVolume};
use mavlink::dialects::ardupilotmega::AdsbEmitterType;

/// A class of aircraft; one that does not say what it is counts as crewed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AircraftClass {
    /// People may be aboard.
    #[default]
    Crewed,
    /// A small unmanned aircraft.
    SmallUnmanned,
    /// A glider, a balloon, an airship or a parachute: people aboard, and an envelope, lines or a circling flight.
    GliderBalloon,
}

impl AircraftClass {
    /// The class of an emitter category of ADS-B (DO-260B, 2.2.3.2.5.2).
    pub const fn of(emitter: AdsbEmitterType) -> Self {
        match emitter {
            AdsbEmitterType::ADSB_EMITTER_TYPE_UAV => Self::SmallUnmanned,
            AdsbEmitterType::ADSB_EMITTER_TYPE_GLIDER
            | AdsbEmitterType::ADSB_EMITTER_TYPE_LIGHTER_AIR
            | AdsbEmitterType::ADSB_EMITTER_TYPE_PARACHUTE => Self::GliderBalloon,
            _ => Self::Crewed,
        }
    }

    /// How such an aircraft may move.
    pub const fn movement(self) -> Movement {
        match self {
            Self::SmallUnmanned => Movement::SMALL_UAS,
            Self::Crewed | Self::GliderBalloon => Movement::CREWED,
        }
    }
}

/// The protected volume about each class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volumes {
    /// About crewed aircraft and those of unknown class.
    pub crewed: ProtectedVolume,
    /// About small unmanned aircraft.
    pub small_unmanned: ProtectedVolume,
    /// About gliders, balloons, airships and parachutes.
    pub glider_balloon: ProtectedVolume,
}

impl Volumes {
    /// The volume about an aircraft of a class.
    pub const fn of(&self, class: AircraftClass) -> &ProtectedVolume {
        match class {
            AircraftClass::Crewed => &self.crewed,
            AircraftClass::SmallUnmanned => &self.small_unmanned,
            AircraftClass::GliderBalloon => &self.glider_balloon,
        }
    }
}

/// A cylinder, or a sphere without a half height; metres.
pub(crate) const fn volume_of(radius_m: f64, half_height_m: Option<f64>) -> ProtectedVolume {
    match half_height_m {
        Some(half_height_m) => ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        },
        None => ProtectedVolume::Sphere { radius_m },
    }
}
