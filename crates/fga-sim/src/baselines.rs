//! Alternatives to fga: the paper's baselines and the peers of the field.
//!
//! Each method turns a situation into a velocity that it would like to fly; [`BaselinePilot`]
//! applies the vehicle's limits in the same way for all: the aircraft flies at its airspeed into the
//! direction of that velocity, within its turn and climb limits, and where the method sees no danger
//! it follows the mission by the guidance of the core. `docs/baselines.md` has the assumptions and the
//! best settings.
//! | method | idea |
//! |---|---|
//! | [`PotentialField`] | the mission attracts, obstacles near by repel |
//! | [`Waypoints`] | sub-waypoints on cubes: the best clear one at a time, or the shortest clear path over all of them |
//! | [`Orca`] | half-spaces of velocities that stay clear, without reciprocity |
//! | [`VoltagePotential`] | the predicted closest approach pushed out of the protected volume |
//! | [`VelocityObstacles`] | the flyable direction nearest to the wanted one outside every cone |
//! | [`Operator`] | the direction bands of a display, followed after a delay |
//! | [`RightOfWay`] | the rules of the air, with perfect knowledge or by a pilot's sight |
//! | [`VerticalAdvisories`] | climbs and descents in the manner of TCAS II |
//! | [`ArduPlaneRules`] | the documented rules of ArduPlane's avoidance |
//!
//! All of them know spheres; a sphere that contains it replaces a cylinder.

mod advisories;
mod arduplane;
mod operator;
mod orca;
mod pilot;
mod potential;
mod rules;
mod velocity;
mod view;
mod voltage;
mod waypoints;

pub use advisories::VerticalAdvisories;
pub use arduplane::ArduPlaneRules;
pub use operator::{Display, Operator};
pub use orca::Orca;
pub use pilot::{BaselinePilot, Steering};
pub(crate) use pilot::{avoiding, returning};
pub use potential::PotentialField;
pub use rules::{Eyes, RightOfWay};
pub use velocity::VelocityObstacles;
pub use view::{RelativeRoute, Sphere, View};
pub use voltage::VoltagePotential;
pub use waypoints::{Cube, Waypoints};

use fga::avoider::{Settings, SettingsError};
use fga::vehicle::Vehicle;

use crate::policy_pilot::PolicyPilot;

/// The baselines and peers by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Baseline {
    /// Artificial potential field.
    PotentialField,
    /// Waypoint generation, one sub-waypoint after the other ("Optimal 1").
    WaypointGreedy,
    /// Waypoint generation, the shortest of all clear paths ("Optimal 2").
    WaypointOptimal,
    /// Optimal reciprocal collision avoidance, all responsibility on the aircraft.
    Orca,
    /// Modified voltage potential.
    VoltagePotential,
    /// Three-dimensional velocity obstacles.
    VelocityObstacles,
    /// An operator who follows direction bands.
    Operator(Display),
    /// The rules of the air.
    RightOfWay,
    /// A pilot who looks out of the window and follows the rules of the air.
    SeeAndAvoid,
    /// Vertical advisories in the manner of TCAS II.
    VerticalAdvisories,
    /// The documented rules of ArduPlane's avoidance.
    ArduPlaneRules,
}

impl Baseline {
    /// All that use the vehicle file's volume.
    pub const ALL: [Self; 6] = [
        Self::PotentialField,
        Self::WaypointGreedy,
        Self::WaypointOptimal,
        Self::Orca,
        Self::VoltagePotential,
        Self::VelocityObstacles,
    ];

    /// Those that use the volumes of a standard, and those that others fly by: pilots, traffic advisories, an autopilot.
    pub const OTHERS: [Self; 6] = [
        Self::Operator(Display::F3442),
        Self::Operator(Display::Do365),
        Self::RightOfWay,
        Self::SeeAndAvoid,
        Self::VerticalAdvisories,
        Self::ArduPlaneRules,
    ];

    /// The name on the command line and in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::PotentialField => "potential-field",
            Self::WaypointGreedy => "waypoint-greedy",
            Self::WaypointOptimal => "waypoint-optimal",
            Self::Orca => "orca",
            Self::VoltagePotential => "mvp",
            Self::VelocityObstacles => "velocity-obstacles",
            Self::Operator(Display::F3442) => "operator-f3442",
            Self::Operator(Display::Do365) => "operator-do365",
            Self::RightOfWay => "right-of-way",
            Self::SeeAndAvoid => "see-and-avoid",
            Self::VerticalAdvisories => "tcas-like",
            Self::ArduPlaneRules => "arduplane-rules",
        }
    }

    /// Every one of them.
    pub fn every() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().chain(Self::OTHERS)
    }

    /// The method of this name.
    pub fn parse(name: &str) -> Option<Self> {
        Self::every().find(|method| method.name() == name)
    }

    /// A pilot of this method with the best settings.
    ///
    /// # Errors
    /// Settings or limits that the core's guidance refuses.
    pub fn pilot(
        self,
        settings: &Settings,
        vehicle: &Vehicle,
    ) -> Result<Box<dyn PolicyPilot + Send>, SettingsError> {
        match self {
            Self::PotentialField => boxed(PotentialField::default(), settings, vehicle),
            Self::WaypointGreedy => boxed(Waypoints::greedy(), settings, vehicle),
            Self::WaypointOptimal => boxed(Waypoints::optimal(), settings, vehicle),
            Self::Orca => boxed(Orca::default(), settings, vehicle),
            Self::VoltagePotential => boxed(VoltagePotential::default(), settings, vehicle),
            Self::VelocityObstacles => boxed(VelocityObstacles::default(), settings, vehicle),
            Self::Operator(display) => boxed(Operator::new(display), settings, vehicle),
            Self::RightOfWay => boxed(RightOfWay::default(), settings, vehicle),
            Self::SeeAndAvoid => boxed(RightOfWay::by_sight(Eyes::OF_A_PILOT), settings, vehicle),
            Self::VerticalAdvisories => boxed(VerticalAdvisories::default(), settings, vehicle),
            Self::ArduPlaneRules => boxed(ArduPlaneRules::default(), settings, vehicle),
        }
    }
}

fn boxed(
    method: impl Steering + Send + 'static,
    settings: &Settings,
    vehicle: &Vehicle,
) -> Result<Box<dyn PolicyPilot + Send>, SettingsError> {
    Ok(Box::new(BaselinePilot::new(method, settings, *vehicle)?))
}

#[cfg(test)]
mod tests;
