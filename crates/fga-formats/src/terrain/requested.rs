//! Ground asked for over MAVLink: a block of ArduPilot's grid, filled piece by piece by `TERRAIN_DATA`.

use super::ardupilot::{COLUMNS, DEGREE_M, PIECE, ROWS, TO_NEXT, grid, scale};
use super::field::{HOLE, HeightField, HeightGrid};

/// All 56 pieces of a block.
const ALL: u64 = (1 << (ROWS * COLUMNS / (PIECE * PIECE))) - 1;

/// Pieces of a row.
const PIECES: usize = COLUMNS / PIECE;

/// Row and column of a post of a piece; row 0 is the northernmost one.
const fn post(piece: usize, index: usize) -> (usize, usize) {
    let from_south = piece / PIECES * PIECE + index / PIECE;
    let column = piece % PIECES * PIECE + index % PIECE;
    (ROWS.saturating_sub(1 + from_south), column)
}

/// What a piece is to a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Taken {
    /// Not of this block.
    Other,
    /// Heights that are no ground; they are left out.
    NoGround,
    /// A piece that was missing.
    New,
    /// A piece that was known. Where it differs from what was known the higher height counts.
    Again {
        /// The largest difference, metres, positive where the new heights are higher.
        higher_m: i16,
    },
}

/// A block of 28 × 32 heights that is asked for with `TERRAIN_REQUEST` and comes in pieces of 4 × 4 heights.
///
/// ```
/// use fga_formats::terrain::{RequestedBlock, Taken};
///
/// let mut block = RequestedBlock::around([46.05, 9.1], 100).expect("a place");
/// assert_eq!(block.mask().count_ones(), 56);
/// assert_eq!(block.take(block.corner_e7(), 100, 0, &[500; 16]), Taken::New);
/// assert_eq!(block.mask().count_ones(), 55);
/// let field = block.field().expect("heights of ground");
/// assert_eq!(field.summary(), (Some([500.0, 500.0]), 880));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RequestedBlock {
    grid: HeightGrid,
    corner_e7: [i32; 2],
    spacing_m: u16,
    filled: u64,
    /// From the north-west.
    heights: Vec<i16>,
}

impl RequestedBlock {
    /// The block that holds a place, latitude and longitude in degrees, where ArduPilot puts it; `None` for a place that is not
    /// on the earth, a pole, or a spacing beyond 1 to 2000 m.
    pub fn around([latitude_deg, longitude_deg]: [f64; 2], spacing_m: u16) -> Option<Self> {
        let is_place = latitude_deg.abs() < 89.0 && (-180.0..180.0).contains(&longitude_deg);
        if !is_place || !(1..=2000).contains(&spacing_m) {
            return None;
        }
        let spacing = f64::from(spacing_m);
        let degree = [libm::floor(latitude_deg), libm::floor(longitude_deg)];
        let north_m = (latitude_deg - degree[0]) * DEGREE_M;
        let east_m =
            (longitude_deg - degree[1]) * DEGREE_M * scale(0.5 * (degree[0] + latitude_deg));
        let index = [
            libm::floor(libm::floor(north_m / spacing) / TO_NEXT[0]),
            libm::floor(libm::floor(east_m / spacing) / TO_NEXT[1]),
        ];
        let south_deg = degree[0] + index[0] * TO_NEXT[0] * spacing / DEGREE_M;
        let west_deg = degree[1]
            + index[1] * TO_NEXT[1] * spacing / DEGREE_M / scale(0.5 * (degree[0] + south_deg));
        #[expect(clippy::cast_possible_truncation, reason = "degrees of the earth")]
        let corner_e7 = [south_deg, west_deg].map(|degrees| libm::rint(degrees * 1e7) as i32);
        Some(Self {
            grid: grid(spacing, index, degree, [south_deg, west_deg]).ok()?,
            corner_e7,
            spacing_m,
            filled: 0,
            heights: vec![HOLE; ROWS * COLUMNS],
        })
    }

    /// South-west corner for `TERRAIN_REQUEST`: latitude and longitude, 10⁻⁷ degrees.
    pub const fn corner_e7(&self) -> [i32; 2] {
        self.corner_e7
    }

    /// Pieces that are missing, for `TERRAIN_REQUEST`: bit by bit, to the east first.
    pub const fn mask(&self) -> u64 {
        ALL & !self.filled
    }

    /// Every piece is missing again; the next heights of a piece replace those that were known.
    pub const fn ask_again(&mut self) {
        self.filled = 0;
    }

    /// Latitudes and longitudes of the posts of a piece, 10⁻⁷ degrees, in the order of its heights in `TERRAIN_DATA`.
    pub fn posts_e7(&self, piece: u8) -> [[i32; 2]; PIECE * PIECE] {
        core::array::from_fn(|index| {
            let (row, column) = post(usize::from(piece), index);
            let place = [self.grid.latitude_deg(row), self.grid.longitude_deg(column)];
            #[expect(clippy::cast_possible_truncation, reason = "degrees of the earth")]
            place.map(|degrees| libm::rint(degrees * 1e7) as i32)
        })
    }

    /// Takes the content of a `TERRAIN_DATA`: corner of the request, spacing, number of the piece, heights from its
    /// south-west corner, to the east first.
    pub fn take(
        &mut self,
        corner_e7: [i32; 2],
        spacing_m: u16,
        piece: u8,
        heights_m: &[i16; PIECE * PIECE],
    ) -> Taken {
        // A sender may have rounded the corner otherwise: two centimetres.
        let mut sides = self.corner_e7.iter().zip(corner_e7);
        let is_corner = sides.all(|(own, other)| own.abs_diff(other) <= 2);
        let is_ground = heights_m.iter().all(|m| m.unsigned_abs() <= 9_000);
        let piece = usize::from(piece);
        if !is_corner || spacing_m != self.spacing_m {
            return Taken::Other;
        }
        if !is_ground || piece >= ROWS / PIECE * PIECES {
            return Taken::NoGround;
        }
        let is_known = self.filled & (1 << piece) != 0;
        let mut higher_m = 0_i16;
        for (index, height) in heights_m.iter().enumerate() {
            let (row, column) = post(piece, index);
            if let Some(post) = self.heights.get_mut(row * COLUMNS + column) {
                let more_m = height.saturating_sub(*post);
                if is_known && more_m.unsigned_abs() > higher_m.unsigned_abs() {
                    higher_m = more_m;
                }
                *post = if is_known { *height.max(post) } else { *height };
            }
        }
        self.filled |= 1 << piece;
        if is_known {
            Taken::Again { higher_m }
        } else {
            Taken::New
        }
    }

    /// What is known so far; pieces that were never known are holes. `None` before the first piece, or if the heights cannot be ground.
    pub fn field(&self) -> Option<HeightField> {
        let is_known = self.heights.iter().any(|height| *height != HOLE);
        let field = HeightField::new(self.grid, self.heights.clone()).ok();
        field.filter(|_| is_known)
    }
}
