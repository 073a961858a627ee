//! How near did anybody come?

use fga::Vec3;
use fga::situation::Obstacle;

/// The least separation of a flight, by the reported positions: what is not reported counts for nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastSeparation {
    /// Name of the aircraft or the obstacle.
    pub name: String,
    /// Distance from its position, metres.
    pub distance_m: f64,
    /// Distance from its protected volume, metres; negative inside.
    pub beyond_m: f64,
    /// Time, seconds since the companion began.
    pub at_s: f64,
}

impl LeastSeparation {
    /// A sentence for the operator.
    pub(super) fn words(least: Option<&Self>) -> String {
        let Some(least) = least else {
            return "fga: no usable report of anybody near".to_owned();
        };
        let side = if least.beyond_m < 0.0 {
            "inside"
        } else {
            "outside"
        };
        format!(
            "fga: least separation {:.0} m from {}, {:.0} m {side} its volume",
            least.distance_m,
            least.name,
            least.beyond_m.abs()
        )
    }

    /// Takes the obstacles of a moment, in seconds; the one that comes nearest to its volume counts.
    pub(super) fn watch(
        least: &mut Option<Self>,
        own_m: Vec3,
        at_s: f64,
        obstacles: &[Obstacle],
        name: impl Fn(u32) -> String,
    ) {
        for obstacle in obstacles {
            let offset_m = own_m - obstacle.position_m;
            let beyond_m = obstacle.volume.margin_m(offset_m);
            if least.as_ref().is_none_or(|least| beyond_m < least.beyond_m) {
                *least = Some(Self {
                    name: name(obstacle.id),
                    distance_m: offset_m.length(),
                    beyond_m,
                    at_s,
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use fga::situation::ProtectedVolume;

    use super::*;

    #[test]
    fn the_nearest_to_its_volume_counts_and_is_told() {
        let at = |id, x_m, radius_m| {
            let volume = ProtectedVolume::Sphere { radius_m };
            Obstacle::straight(id, Vec3::X * x_m, Vec3::ZERO, volume)
        };
        let mut least = None;
        assert_eq!(
            LeastSeparation::words(least.as_ref()),
            "fga: no usable report of anybody near"
        );
        let obstacles = [at(1, 300.0, 60.0), at(2, 400.0, 250.0)];
        let name = |id: u32| format!("N{id}");
        LeastSeparation::watch(&mut least, Vec3::ZERO, 1.0, &obstacles, name);
        LeastSeparation::watch(&mut least, Vec3::X * -50.0, 2.0, &obstacles, name);
        assert_eq!(
            LeastSeparation::words(least.as_ref()),
            "fga: least separation 400 m from N2, 150 m outside its volume"
        );
        LeastSeparation::watch(&mut least, Vec3::X * 260.0, 3.0, &obstacles[..1], name);
        assert_eq!(least.as_ref().map(|least| least.at_s), Some(3.0));
        assert_eq!(
            LeastSeparation::words(least.as_ref()),
            "fga: least separation 40 m from N1, 20 m inside its volume"
        );
    }
}
