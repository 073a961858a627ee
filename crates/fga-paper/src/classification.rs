//! Which avoidance module applies: static or dynamic, single or multiple (§3.1); the safety score
//! of an obstacle's kind (§3.3).

use fga::Vec3;
use fga::certificate::Hazard;
use fga::limit::Limit as _;
use fga::situation::ObstacleKind;

/// Whether something moves over the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Motion {
    /// A building, a mast, a tree.
    Static,
    /// An aircraft, a bird.
    Dynamic,
}

/// The number of obstacles.
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

/// Whether a hazard moves over the ground, in an air mass that moves with `wind_mps`: its velocity
/// in the air mass plus the wind, against a threshold for noise, metres per second.
pub fn motion(hazard: &Hazard, wind_mps: Vec3, threshold_mps: f64) -> Motion {
    if (hazard.velocity_mps + wind_mps).length() <= threshold_mps {
        Motion::Static
    } else {
        Motion::Dynamic
    }
}

/// Classifies the threatening obstacles; `None` without any.
pub fn classify<'a>(
    obstacles: impl IntoIterator<Item = &'a Hazard>,
    wind_mps: Vec3,
    threshold_mps: f64,
) -> Option<AvoidanceModule> {
    obstacles
        .into_iter()
        .map(|obstacle| AvoidanceModule {
            motion: motion(obstacle, wind_mps, threshold_mps),
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

/// `C_s` of an obstacle's kind: 0 with passengers, 1 for a natural barrier, `unknown_score` if
/// unknown, clamped to [0, 1] (§3.3). A score that is not a number counts as 0: begin at
/// once.
pub fn safety_score(kind: ObstacleKind, unknown_score: f64) -> f64 {
    match kind {
        ObstacleKind::Passengers => 0.0,
        ObstacleKind::NaturalBarrier => 1.0,
        ObstacleKind::Unknown if unknown_score.is_nan() => 0.0,
        ObstacleKind::Unknown => unknown_score.limited(0.0, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga::situation::ProtectedVolume;

    fn moving(velocity_mps: Vec3) -> Hazard {
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        Hazard::exact(1, Vec3::ZERO, velocity_mps, volume)
    }

    /// In the air mass a building moves against the wind.
    #[test]
    fn a_building_in_the_wind_is_static() {
        let wind = Vec3::new(5.0, -3.0, 0.0);
        assert_eq!(motion(&moving(-wind), wind, 0.1), Motion::Static);
        assert_eq!(motion(&moving(Vec3::ZERO), wind, 0.1), Motion::Dynamic);
        assert_eq!(motion(&moving(Vec3::NAN), wind, 0.1), Motion::Dynamic);
    }

    #[test]
    fn the_module_is_dynamic_as_soon_as_one_moves() {
        let (still, bird) = (moving(Vec3::ZERO), moving(Vec3::X * 12.0));
        let module = |motion, count| Some(AvoidanceModule { motion, count });
        let of = |set: &[Hazard]| classify(set, Vec3::ZERO, 0.5);
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[still]), module(Motion::Static, Count::Single));
        assert_eq!(of(&[bird]), module(Motion::Dynamic, Count::Single));
        assert_eq!(of(&[still, still]), module(Motion::Static, Count::Multiple));
        assert_eq!(of(&[bird, still]), module(Motion::Dynamic, Count::Multiple));
        assert_eq!(of(&[still, bird]), module(Motion::Dynamic, Count::Multiple));
    }

    #[test]
    fn scores_are_those_of_section_3_3() {
        assert_eq!(safety_score(ObstacleKind::Passengers, 0.7), 0.0);
        assert_eq!(safety_score(ObstacleKind::NaturalBarrier, 0.7), 1.0);
        assert_eq!(safety_score(ObstacleKind::Unknown, 0.7), 0.7);
        assert_eq!(safety_score(ObstacleKind::Unknown, 7.0), 1.0);
        assert_eq!(safety_score(ObstacleKind::Unknown, f64::NAN), 0.0);
    }
}
