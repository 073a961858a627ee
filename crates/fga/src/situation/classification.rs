//! Which avoidance module applies: static or dynamic, single or multiple (§3.1); the safety score
//! of an obstacle's kind (§3.3).

use super::{Obstacle, ObstacleKind};
use crate::Vec3;
use crate::limit::Limit as _;

/// Whether something moves over the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Motion {
    /// A building, a mast, a tree.
    Static,
    /// An aircraft, a bird.
    Dynamic,
}

/// How many there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Count {
    /// One.
    Single,
    /// More than one.
    Multiple,
}

/// The avoidance module of a set of obstacles (§3.1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct AvoidanceModule {
    /// Dynamic as soon as one of them moves.
    pub motion: Motion,
    /// One or several.
    pub count: Count,
}

impl Obstacle {
    /// Whether it moves over the ground, in an air mass that moves with `wind_mps`: its velocity in
    /// the air mass plus the wind, against a threshold for noise, metres per second.
    pub fn motion(&self, wind_mps: Vec3, threshold_mps: f64) -> Motion {
        if (self.velocity_mps + wind_mps).length() <= threshold_mps {
            Motion::Static
        } else {
            Motion::Dynamic
        }
    }
}

/// Classifies the obstacles that matter, those that were found to be threats; `None` without any.
pub fn classify<'a>(
    obstacles: impl IntoIterator<Item = &'a Obstacle>,
    wind_mps: Vec3,
    threshold_mps: f64,
) -> Option<AvoidanceModule> {
    obstacles
        .into_iter()
        .map(|obstacle| AvoidanceModule {
            motion: obstacle.motion(wind_mps, threshold_mps),
            count: Count::Single,
        })
        .reduce(|all, one| AvoidanceModule {
            motion: if one.motion == Motion::Dynamic {
                Motion::Dynamic
            } else {
                all.motion
            },
            count: Count::Multiple,
        })
}

impl ObstacleKind {
    /// `C_s`: 0 with passengers, 1 for a natural barrier, `unknown_score` where nothing is known,
    /// held within [0, 1] (§3.3). A score that is not a number counts as 0: begin at once.
    pub fn safety_score(self, unknown_score: f64) -> f64 {
        match self {
            Self::Passengers => 0.0,
            Self::NaturalBarrier => 1.0,
            Self::Unknown if unknown_score.is_nan() => 0.0,
            Self::Unknown => unknown_score.limited(0.0, 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::situation::ProtectedVolume;

    fn moving(velocity_mps: Vec3) -> Obstacle {
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        Obstacle::new(1, Vec3::ZERO, velocity_mps, volume)
    }

    /// In the air mass a building moves against the wind.
    #[test]
    fn a_building_in_the_wind_is_static() {
        let wind = Vec3::new(5.0, -3.0, 0.0);
        assert_eq!(moving(-wind).motion(wind, 0.1), Motion::Static);
        assert_eq!(moving(Vec3::ZERO).motion(wind, 0.1), Motion::Dynamic);
        assert_eq!(moving(Vec3::NAN).motion(wind, 0.1), Motion::Dynamic);
    }

    #[test]
    fn the_module_is_dynamic_as_soon_as_one_moves() {
        let (still, bird) = (moving(Vec3::ZERO), moving(Vec3::X * 12.0));
        let module = |motion, count| Some(AvoidanceModule { motion, count });
        let of = |set: &[Obstacle]| classify(set, Vec3::ZERO, 0.5);
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[still]), module(Motion::Static, Count::Single));
        assert_eq!(of(&[bird]), module(Motion::Dynamic, Count::Single));
        assert_eq!(of(&[still, still]), module(Motion::Static, Count::Multiple));
        assert_eq!(of(&[bird, still]), module(Motion::Dynamic, Count::Multiple));
        assert_eq!(of(&[still, bird]), module(Motion::Dynamic, Count::Multiple));
    }

    #[test]
    fn scores_are_those_of_section_3_3() {
        assert_eq!(ObstacleKind::Passengers.safety_score(0.7), 0.0);
        assert_eq!(ObstacleKind::NaturalBarrier.safety_score(0.7), 1.0);
        assert_eq!(ObstacleKind::Unknown.safety_score(0.7), 0.7);
        assert_eq!(ObstacleKind::Unknown.safety_score(7.0), 1.0);
        assert_eq!(ObstacleKind::Unknown.safety_score(f64::NAN), 0.0);
    }
}
