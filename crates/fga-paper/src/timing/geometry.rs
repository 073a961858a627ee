//! The three lengths behind the times.

use crate::conflict::Relative;
use fga::situation::ProtectedVolume;

/// An encounter as in Fig. 4: distance ahead, miss distance, size, speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometry {
    /// `r_0` cos `θ_t0`, metres: distance along `V_r` to the closest point; positive when closing.
    pub along_m: f64,
    /// s = `r_0` |sin `θ_t0`|, metres: distance of the obstacle from the line along `V_r`.
    pub across_m: f64,
    /// ‖`V_r`‖, metres per second, positive.
    pub closing_mps: f64,
    /// `d_m`, metres, positive.
    pub radius_m: f64,
}

impl Geometry {
    fn new(relative: &Relative, radius_m: f64) -> Option<Self> {
        let closing_mps = relative.speed_mps();
        let usable = closing_mps > 0.0 && radius_m.is_finite() && radius_m > 0.0;
        usable.then(|| Self {
            along_m: relative.along_m(),
            across_m: relative.across_m(),
            closing_mps,
            radius_m,
        })
    }

    /// In the plane of r and `V_r`, as in the paper's 3D formulas: exact for a turn in that plane.
    ///
    /// `None` for `V_r` = 0 or a radius that is not positive.
    pub fn spatial(relative: &Relative, radius_m: f64) -> Option<Self> {
        Self::new(relative, radius_m)
    }

    /// From above: exact for a level turn past an upright cylinder, conservative for a sphere
    /// (the cylinder about it counts).
    ///
    /// `None` for no horizontal relative motion or a radius that is not positive.
    pub fn horizontal(relative: &Relative, radius_m: f64) -> Option<Self> {
        let level = |mut v: fga::Vec3| {
            v.z = 0.0;
            v
        };
        let relative = Relative::new(level(relative.position_m()), level(relative.velocity_mps()))?;
        Self::new(&relative, radius_m)
    }

    /// The level section of a sphere at the aircraft's height: exact for a level turn past a sphere
    /// that keeps its height. Its radius is √(`d_m²` − Δz²).
    ///
    /// `None` where the section is empty, or without horizontal relative motion.
    pub fn level_section(relative: &Relative, radius_m: f64) -> Option<Self> {
        let height_m = relative.position_m().z;
        let squared = radius_m * radius_m - height_m * height_m;
        (squared > 0.0).then(|| Self::horizontal(relative, libm::sqrt(squared)))?
    }

    /// The natural one for a volume: [`Self::spatial`] for a sphere, as published;
    /// [`Self::horizontal`] for a cylinder.
    pub fn of(relative: &Relative, volume: &ProtectedVolume) -> Option<Self> {
        match *volume {
            ProtectedVolume::Sphere { radius_m } => Self::spatial(relative, radius_m),
            ProtectedVolume::Cylinder { radius_m, .. } => Self::horizontal(relative, radius_m),
        }
    }

    /// Whether the line along `V_r` cuts the volume ahead: s < `d_m` and closing.
    pub fn is_threat(&self) -> bool {
        self.along_m > 0.0 && self.across_m < self.radius_m
    }
}
