//! The ground that a command means, and the facts about it.

use core::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use fga_formats::InputError;
use fga_formats::terrain::{Area, Datum, Given, Terrain, TerrainFile};
use fga_formats::words::counted;
use serde_json::{Value, json};

/// Files of heights, and what their user knows better.
#[derive(Args, Debug)]
pub(crate) struct GroundArgs {
    /// Files of heights: SRTM (.hgt), GeoTIFF (.tif), DTED (.dt0, .dt1, .dt2), ArduPilot's terrain (.DAT); .hgt, DTED and
    /// .DAT also compressed with gzip. Where several know a height, the first one counts.
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    /// What the heights are above, instead of what the files say: egm96, egm2008, navd88 or ellipsoid.
    #[arg(long, value_name = "DATUM", value_parser = datum)]
    datum: Option<Datum>,
    /// Vertical error of the heights, instead of what the files say, metres.
    #[arg(long, value_name = "M", value_parser = metres)]
    vertical_error: Option<f64>,
}

impl GroundArgs {
    /// Reads the files.
    pub(crate) fn read(&self) -> Result<Terrain, InputError> {
        let given = Given {
            datum: self.datum,
            vertical_error_m: self.vertical_error,
        };
        Terrain::read(&self.files, &given)
    }
}

fn datum(text: &str) -> Result<Datum, String> {
    let found = Datum::ALL.into_iter().find(|datum| datum.name() == text);
    found.ok_or_else(|| {
        let names = Datum::ALL.map(Datum::name).join(", ");
        format!("expected one of {names}")
    })
}

/// A length of at least 0 m, as options take it.
pub(crate) fn metres(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|metres| (0.0..=10_000.0).contains(metres))
        .ok_or_else(|| "expected metres from 0 to 10000".to_owned())
}

/// What a file holds.
pub(crate) struct Facts<'a> {
    file: &'a TerrainFile,
    area: Option<Area>,
    /// From post to post: north and east.
    spacing_deg: [f64; 2],
    range_m: Option<[f64; 2]>,
    heights: usize,
    holes: usize,
}

impl<'a> Facts<'a> {
    pub(crate) fn new(file: &'a TerrainFile) -> Self {
        let mut facts = Self {
            file,
            area: file.area(),
            spacing_deg: file.fields.first().map_or([0.0; 2], |field| {
                [field.grid().step_north_deg, field.grid().step_east_deg]
            }),
            range_m: None,
            heights: 0,
            holes: 0,
        };
        for field in &file.fields {
            let (range_m, holes) = field.summary();
            facts.heights += field.grid().rows * field.grid().columns;
            facts.holes += holes;
            facts.range_m = match (facts.range_m, range_m) {
                (Some(a), Some(b)) => Some([a[0].min(b[0]), a[1].max(b[1])]),
                (a, b) => a.or(b),
            };
        }
        facts
    }

    fn spacing_m(&self) -> [f64; 2] {
        let middle_deg = self
            .area
            .map_or(0.0, |area| 0.5 * (area.south_deg + area.north_deg));
        [
            self.spacing_deg[0] * DEGREE_M,
            self.spacing_deg[1] * DEGREE_M * middle_deg.to_radians().cos(),
        ]
    }

    /// The heights in words, as in "3601 x 3601 heights".
    pub(crate) fn counts(&self) -> String {
        match self.file.fields.as_slice() {
            [field] => format!("{} x {} heights", field.grid().rows, field.grid().columns),
            fields => format!(
                "{} in {}, {} without heights",
                counted(self.heights, "height"),
                counted(fields.len(), "block"),
                self.file.empty_blocks
            ),
        }
    }

    pub(crate) fn in_words(&self) -> String {
        let file = self.file;
        let mut text = format!("{}: {}\n", file.path.display(), file.format);
        if let Some(area) = self.area {
            let _ = writeln!(text, "  area      {area}");
        }
        let [north_m, east_m] = self.spacing_m();
        let [north, east] = self.spacing_deg.map(|degrees| degrees * 3600.0);
        let _ = writeln!(
            text,
            "  spacing   {north:.3} x {east:.3} seconds of arc, {north_m:.1} m north x {east_m:.1} m east; {}",
            self.counts()
        );
        let datum = file.datum;
        let _ = writeln!(
            text,
            "  above     {} ({})",
            datum.value.words(),
            datum.source
        );
        let _ = match self.range_m {
            Some([least_m, largest_m]) => {
                writeln!(text, "  heights   {least_m:.1} to {largest_m:.1} m")
            }
            None => writeln!(text, "  heights   none is known"),
        };
        let share = 100.0 * self.holes as f64 / self.heights.max(1) as f64;
        let _ = writeln!(text, "  holes     {} ({share:.2} %)", self.holes);
        let error = file.vertical_error_m;
        let _ = writeln!(text, "  error     {} m ({})", error.value, error.source);
        text
    }

    pub(crate) fn to_json(&self) -> Value {
        let file = self.file;
        json!({
            "file": file.path.display().to_string(),
            "format": file.format,
            "area": self.area.as_ref().map(area_json),
            "spacing_deg": self.spacing_deg,
            "spacing_m": self.spacing_m(),
            "grids": file.fields.len(),
            "empty_blocks": file.empty_blocks,
            "heights": self.heights,
            "holes": self.holes,
            "least_m": self.range_m.map(|range| range[0]),
            "largest_m": self.range_m.map(|range| range[1]),
            "datum": file.datum.value.name(),
            "datum_source": file.datum.source,
            "vertical_error_m": file.vertical_error_m.value,
            "vertical_error_source": file.vertical_error_m.source,
        })
    }
}

pub(crate) fn area_json(area: &Area) -> Value {
    json!({
        "south_deg": area.south_deg,
        "west_deg": area.west_deg,
        "north_deg": area.north_deg,
        "east_deg": area.east_deg,
    })
}

/// Metres of a degree of latitude, for spacings in words.
const DEGREE_M: f64 = 111_320.0;
