//! Obstacles with one slice per quantity.

use crate::situation::{Movement, Obstacle, ObstacleKind, Obstacles, ProtectedVolume, Uncertainty};
use fga_proof::Vec3;

/// Obstacles with one slice per quantity, all of one length; units as in [`Obstacle`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Columns<'a> {
    /// Identifiers.
    pub id: &'a [u32],
    /// East, metres.
    pub x_m: &'a [f64],
    /// North, metres.
    pub y_m: &'a [f64],
    /// Up, metres.
    pub z_m: &'a [f64],
    /// Velocity to the east over the ground, metres per second.
    pub vx_mps: &'a [f64],
    /// Velocity to the north over the ground, metres per second.
    pub vy_mps: &'a [f64],
    /// Velocity upwards, metres per second.
    pub vz_mps: &'a [f64],
    /// Radius of the volume, metres.
    pub radius_m: &'a [f64],
    /// Half height of the cylinders, metres; `None` for spheres.
    pub half_height_m: Option<&'a [f64]>,
    /// Standard deviations of position (metres) and velocity (metres per second); `None` if the
    /// obstacles are known exactly.
    pub uncertainty: Option<(&'a [f64], &'a [f64])>,
    /// Possible motion of each; `None` if all keep their velocity.
    pub movement: Option<&'a [Movement]>,
}

/// Columns of different lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ColumnsError {
    /// The column's name.
    pub column: &'static str,
    /// Its length.
    pub found: usize,
    /// The length of the identifiers.
    pub expected: usize,
}

impl core::fmt::Display for ColumnsError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self {
            column,
            found,
            expected,
        } = self;
        write!(
            f,
            "column {column} has {found} values, expected {expected} as there are identifiers"
        )
    }
}

impl core::error::Error for ColumnsError {}

impl Columns<'_> {
    /// Number of obstacles: the length of the shortest column.
    pub fn len(&self) -> usize {
        let of = |column: Option<&[f64]>| column.map_or(usize::MAX, <[f64]>::len);
        [
            self.x_m,
            self.y_m,
            self.z_m,
            self.vx_mps,
            self.vy_mps,
            self.vz_mps,
            self.radius_m,
        ]
        .iter()
        .map(|column| column.len())
        .chain([of(self.half_height_m)])
        .chain([
            of(self.uncertainty.map(|(p, _)| p)),
            of(self.uncertainty.map(|(_, v)| v)),
            self.movement.map_or(usize::MAX, <[Movement]>::len),
        ])
        .fold(self.id.len(), usize::min)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Checks that the columns have one length; a longer one would be cut.
    ///
    /// # Errors
    /// The first column whose length differs from the identifiers'.
    pub fn check(&self) -> Result<(), ColumnsError> {
        let expected = self.id.len();
        let columns = [
            ("x_m", Some(self.x_m)),
            ("y_m", Some(self.y_m)),
            ("z_m", Some(self.z_m)),
            ("vx_mps", Some(self.vx_mps)),
            ("vy_mps", Some(self.vy_mps)),
            ("vz_mps", Some(self.vz_mps)),
            ("radius_m", Some(self.radius_m)),
            ("half_height_m", self.half_height_m),
            (
                "position uncertainty",
                self.uncertainty.map(|(position, _)| position),
            ),
            (
                "velocity uncertainty",
                self.uncertainty.map(|(_, velocity)| velocity),
            ),
        ];
        for (column, values) in columns {
            if let Some(values) = values
                && values.len() != expected
            {
                return Err(ColumnsError {
                    column,
                    found: values.len(),
                    expected,
                });
            }
        }
        if let Some(movement) = self.movement
            && movement.len() != expected
        {
            return Err(ColumnsError {
                column: "movement",
                found: movement.len(),
                expected,
            });
        }
        Ok(())
    }

    /// The obstacle at an index.
    pub fn get(&self, place: usize) -> Option<Obstacle> {
        let radius_m = *self.radius_m.get(place)?;
        let volume = match self.half_height_m {
            Some(half_heights) => ProtectedVolume::Cylinder {
                radius_m,
                half_height_m: *half_heights.get(place)?,
            },
            None => ProtectedVolume::Sphere { radius_m },
        };
        let uncertainty = match self.uncertainty {
            Some((position, velocity)) => Uncertainty {
                position_m: *position.get(place)?,
                velocity_mps: *velocity.get(place)?,
            },
            None => Uncertainty::default(),
        };
        Some(Obstacle {
            id: *self.id.get(place)?,
            position_m: Vec3::new(
                *self.x_m.get(place)?,
                *self.y_m.get(place)?,
                *self.z_m.get(place)?,
            ),
            velocity_mps: Vec3::new(
                *self.vx_mps.get(place)?,
                *self.vy_mps.get(place)?,
                *self.vz_mps.get(place)?,
            ),
            volume,
            kind: ObstacleKind::Unknown,
            uncertainty,
            movement: match self.movement {
                Some(movements) => *movements.get(place)?,
                None => Movement::default(),
            },
            age_s: 0.0,
        })
    }
}

impl<'a> Obstacles<'a> {
    /// Their number.
    pub fn len(&self) -> usize {
        match self {
            Self::Rows(rows) => rows.len(),
            Self::Columns(columns) => columns.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The obstacle at an index.
    pub fn get(&self, place: usize) -> Option<Obstacle> {
        match self {
            Self::Rows(rows) => rows.get(place).copied(),
            Self::Columns(columns) => columns.get(place),
        }
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = Obstacle> + use<'a> {
        let obstacles = *self;
        (0..obstacles.len()).filter_map(move |place| obstacles.get(place))
    }
}
