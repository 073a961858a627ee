//! What a file of heights holds.

use std::path::PathBuf;

use super::area::Area;
use super::field::HeightField;

/// A file may hold this many bytes, decompressed too: ten times a degree with a post each second of arc as 32-bit numbers.
pub(super) const MOST_BYTES: usize = 512 << 20;

/// SRTM's absolute vertical accuracy, metres: 90 % of the heights are nearer.
pub(super) const SRTM_ERROR: Stated<f64> = Stated {
    value: 16.0,
    source: "the specification of SRTM, 90 %",
};

/// What heights are above.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Datum {
    /// Mean sea level by the geoid EGM96.
    Egm96,
    /// Mean sea level by the geoid EGM2008.
    Egm2008,
    /// Mean sea level of North America, NAVD88.
    Navd88,
    /// The ellipsoid WGS84, as a satellite receiver without a geoid gives it.
    Ellipsoid,
}

impl Datum {
    /// Every datum.
    pub const ALL: [Self; 4] = [Self::Egm96, Self::Egm2008, Self::Navd88, Self::Ellipsoid];

    /// Its name, as `--datum` takes it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Egm96 => "egm96",
            Self::Egm2008 => "egm2008",
            Self::Navd88 => "navd88",
            Self::Ellipsoid => "ellipsoid",
        }
    }

    /// What it is, in words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Egm96 => "mean sea level (EGM96)",
            Self::Egm2008 => "mean sea level (EGM2008)",
            Self::Navd88 => "mean sea level (NAVD88)",
            Self::Ellipsoid => "the ellipsoid (WGS84)",
        }
    }

    /// Whether it is mean sea level, as altitudes of missions are.
    pub const fn is_sea_level(self) -> bool {
        !matches!(self, Self::Ellipsoid)
    }
}

/// A value and how it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stated<T> {
    /// The value.
    pub value: T,
    /// How it is known, in words.
    pub source: &'static str,
}

/// What the user knows better than a file.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Given {
    /// The datum.
    pub datum: Option<Datum>,
    /// The vertical error, metres.
    pub vertical_error_m: Option<f64>,
}

impl<T> Stated<T> {
    pub(super) const fn given(value: T) -> Self {
        let source = "given by the user";
        Self { value, source }
    }
}

/// A file of heights.
#[derive(Debug, Clone, PartialEq)]
pub struct TerrainFile {
    /// The file, as the user named it.
    pub path: PathBuf,
    /// Its format, in words.
    pub format: &'static str,
    /// Its grids, at least one; all with about the same spacing.
    pub fields: Vec<HeightField>,
    /// What its heights are above.
    pub datum: Stated<Datum>,
    /// Vertical error of its heights, metres.
    pub vertical_error_m: Stated<f64>,
    /// Blocks without any height.
    pub empty_blocks: usize,
}

impl TerrainFile {
    /// A file of one format, without its path. A file that states no vertical error has that of SRTM.
    pub(super) fn new(
        format: &'static str,
        fields: Vec<HeightField>,
        datum: Stated<Datum>,
        error: Option<Stated<f64>>,
    ) -> Self {
        let source = "assumed, as of SRTM: the file does not say";
        let assumed = Stated {
            source,
            ..SRTM_ERROR
        };
        Self {
            path: PathBuf::new(),
            format,
            fields,
            datum,
            vertical_error_m: error.unwrap_or(assumed),
            empty_blocks: 0,
        }
    }

    /// The smallest area around its grids.
    pub fn area(&self) -> Option<Area> {
        let areas = self.fields.iter().map(|field| field.grid().area());
        areas.reduce(|all, area| all.with(&area))
    }
}
