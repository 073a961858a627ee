//! The obstacles of one step, as rows or with one slice per quantity.

use fga_proof::Vec3;
use fga_proof::situation::{Movement, Obstacle, ProtectedVolume, Uncertainty};

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
    /// Names and lengths of the columns that there are.
    fn lengths(&self) -> impl Iterator<Item = (&'static str, usize)> {
        let sigmas = self.uncertainty.unzip();
        let columns = [
            ("x_m", Some(self.x_m)),
            ("y_m", Some(self.y_m)),
            ("z_m", Some(self.z_m)),
            ("vx_mps", Some(self.vx_mps)),
            ("vy_mps", Some(self.vy_mps)),
            ("vz_mps", Some(self.vz_mps)),
            ("radius_m", Some(self.radius_m)),
            ("half_height_m", self.half_height_m),
            ("position uncertainty", sigmas.0),
            ("velocity uncertainty", sigmas.1),
        ];
        let movement = self.movement.map(|movement| ("movement", movement.len()));
        let columns = columns.into_iter();
        let columns = columns.filter_map(|(name, values)| Some((name, values?.len())));
        columns.chain(movement)
    }

    /// Number of obstacles: the length of the shortest column.
    pub fn len(&self) -> usize {
        let lengths = self.lengths().map(|(_, length)| length);
        lengths.fold(self.id.len(), usize::min)
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
        let other = self.lengths().find(|(_, found)| *found != expected);
        other.map_or(Ok(()), |(column, found)| {
            Err(ColumnsError {
                column,
                found,
                expected,
            })
        })
    }

    /// The obstacle at an index.
    pub fn get(&self, place: usize) -> Option<Obstacle> {
        let at = |column: &[f64]| column.get(place).copied();
        let radius_m = at(self.radius_m)?;
        let volume = match self.half_height_m {
            Some(half_heights_m) => ProtectedVolume::Cylinder {
                radius_m,
                half_height_m: at(half_heights_m)?,
            },
            None => ProtectedVolume::Sphere { radius_m },
        };
        let position_m = Vec3::new(at(self.x_m)?, at(self.y_m)?, at(self.z_m)?);
        let velocity_mps = Vec3::new(at(self.vx_mps)?, at(self.vy_mps)?, at(self.vz_mps)?);
        let id = *self.id.get(place)?;
        let mut obstacle = Obstacle::straight(id, position_m, velocity_mps, volume);
        if let Some((positions_m, velocities_mps)) = self.uncertainty {
            obstacle.uncertainty = Uncertainty {
                position_m: at(positions_m)?,
                velocity_mps: at(velocities_mps)?,
            };
        }
        if let Some(movements) = self.movement {
            obstacle.movement = *movements.get(place)?;
        }
        Some(obstacle)
    }
}

/// The obstacles of one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Obstacles<'a> {
    /// One record per obstacle: the natural form for a handful.
    Rows(&'a [Obstacle]),
    /// One slice per quantity: the fast form for thousands.
    Columns(Columns<'a>),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_one_length_are_rows() {
        let columns = Columns {
            id: &[7, 8],
            x_m: &[1.0, 2.0],
            y_m: &[3.0, 4.0],
            z_m: &[5.0, 6.0],
            vx_mps: &[0.1, 0.2],
            vy_mps: &[0.3, 0.4],
            vz_mps: &[0.5, 0.6],
            radius_m: &[30.0, 40.0],
            half_height_m: Some(&[10.0, 20.0]),
            uncertainty: Some((&[1.5, 2.5], &[0.15, 0.25])),
            movement: Some(&[Movement::AtRest, Movement::CREWED]),
        };
        assert_eq!((columns.check(), columns.len()), (Ok(()), 2));
        let volume = ProtectedVolume::Cylinder {
            radius_m: 40.0,
            half_height_m: 20.0,
        };
        let (place_m, velocity_mps) = (Vec3::new(2.0, 4.0, 6.0), Vec3::new(0.2, 0.4, 0.6));
        let mut row = Obstacle::straight(8, place_m, velocity_mps, volume);
        row.uncertainty = Uncertainty {
            position_m: 2.5,
            velocity_mps: 0.25,
        };
        row.movement = Movement::CREWED;
        assert_eq!((columns.get(1), columns.get(2)), (Some(row), None));
        let obstacles = Obstacles::Columns(columns);
        assert_eq!(obstacles.iter().last(), obstacles.get(1));
        // The shortest counts, and is named.
        let short = Columns {
            radius_m: &[30.0],
            ..columns
        };
        assert_eq!(short.len(), 1);
        let error = short.check().unwrap_err();
        assert_eq!(
            (error.column, error.found, error.expected),
            ("radius_m", 1, 2)
        );
    }
}
