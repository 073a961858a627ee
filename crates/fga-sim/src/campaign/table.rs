//! Rows as a Parquet table and as CSV.
//!
//! A file holds one row group for each block. Its metadata has `fga.version`, `fga.commit`, `fga.target`,
//! `fga.configuration_hash`, `fga.seeds`, `fga.configuration`, `fga.columns`, and `fga.left_out` where recordings
//! or parts of them were left out, but no time of day and no duration.

use alloc::sync::Arc;
use core::fmt::Write as _;
use std::io::Write;
use std::sync::OnceLock;

use fga_formats::number::push_fixed;
use fga_formats::words::push_csv_field;
use parquet::basic::{Compression, Encoding};
use parquet::column::writer::ColumnWriterImpl;
use parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int32Type, Int64Type,
};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use parquet::schema::types::{ColumnPath, Type};
use serde_json::Value;

use super::metrics::{Access, Field};
use super::{Campaign, CampaignStamp, Row};

const BASE: &str = "
    required int64 encounter (INTEGER(64,false));
    required int64 source_encounter (INTEGER(64,false));
    required int64 seed (INTEGER(64,false));
    required binary source (STRING);
    required binary policy (STRING);
    required int32 obstacles;
    required boolean threatened;
    required double held_margin_m;
    required boolean separated;
    required boolean caused;
    required boolean needless;
    required double min_separation_m;
    required double min_margin_m;
    optional double start_s;
    optional double clear_s;
    optional double rejoined_s;
    required double end_s;
    optional double time_away_s;
    required double max_cross_track_m;
    required double extra_path_m;
    optional boolean avoidable;
    optional double oracle_margin_m;
    optional binary name (STRING);
    required double weight;
";

/// Columns before the metrics, with their meanings; the unit is in the name where there is one.
const MEANINGS: &[(&str, &str)] = &[
    ("encounter", "number in the campaign"),
    (
        "source_encounter",
        "number in the file or folder that it comes from, else the same",
    ),
    ("seed", "master seed"),
    ("source", "cell, file, folder or model"),
    ("policy", "as on the command line"),
    ("obstacles", "how many"),
    (
        "threatened",
        "whether holding course and altitude, or the recorded flight, would have entered a volume",
    ),
    ("held_margin_m", "the margin of holding them, m"),
    ("separated", "whether no volume was entered"),
    (
        "caused",
        "whether a volume was entered that holding would not have entered",
    ),
    (
        "needless",
        "whether there was a maneuver although holding would have stayed clear",
    ),
    ("min_separation_m", "least distance to a centre, m"),
    (
        "min_margin_m",
        "least signed distance to a protected volume, m",
    ),
    (
        "start_s",
        "when the first maneuver began, s; empty without one",
    ),
    ("clear_s", "when the last maneuver ended, s"),
    (
        "rejoined_s",
        "when the aircraft was back on its mission for the last time, s",
    ),
    ("end_s", "when the flight ended, s"),
    (
        "time_away_s",
        "from the first maneuver to being back, or to the end, s",
    ),
    ("max_cross_track_m", "largest distance from the mission, m"),
    (
        "extra_path_m",
        "path flown less progress along the mission, m",
    ),
    (
        "avoidable",
        "with the oracle: whether any maneuver saves it",
    ),
    (
        "oracle_margin_m",
        "with the oracle: a margin that it keeps, m",
    ),
    ("name", "name of the recording"),
    (
        "weight",
        "for how many encounters of its source it stands; 1 without importance sampling",
    ),
];

/// Number of columns before the metrics.
pub(super) const BEFORE: usize = MEANINGS.len();

/// Names and meanings of all columns, in their order.
fn meanings(fields: &[Field]) -> impl Iterator<Item = (&'static str, &'static str)> {
    let metrics = fields.iter().map(|field| (field.name, field.meaning));
    MEANINGS.iter().copied().chain(metrics)
}

/// Names of the columns as the first line of the CSV file.
pub fn csv_columns(campaign: &Campaign) -> String {
    meanings(campaign.metric_fields())
        .map(|(name, _)| name)
        .collect::<Vec<_>>()
        .join(",")
}

/// The schema of the Parquet file. It is the same for every block, and reading it takes longer than some blocks.
pub(super) fn schema(campaign: &Campaign) -> Result<Arc<Type>, ParquetError> {
    static SCHEMAS: [OnceLock<Arc<Type>>; 2] = [const { OnceLock::new() }; 2];
    let known = &SCHEMAS[usize::from(campaign.has_surroundings())];
    if let Some(schema) = known.get() {
        return Ok(Arc::clone(schema));
    }
    let schema = Arc::new(parse_message_type(&schema_in_words(campaign))?);
    Ok(Arc::clone(known.get_or_init(|| schema)))
}

fn schema_in_words(campaign: &Campaign) -> String {
    let mut schema = format!("message campaign {{{BASE}");
    for field in campaign.metric_fields() {
        let kind = match field.access {
            Access::Real(..) => "double",
            Access::Flag(..) => "boolean",
            Access::Failure(..) => {
                // Writing to a text does not fail.
                let _ = writeln!(schema, "    optional binary {} (STRING);", field.name);
                continue;
            }
        };
        let _ = writeln!(schema, "    optional {kind} {};", field.name);
    }
    schema.push('}');
    schema
}

/// One column of some rows.
enum TableColumn {
    Long(Vec<i64>),
    Int(Vec<i32>),
    Flag(Vec<bool>),
    Real(Vec<f64>),
    MaybeFlag(Vec<Option<bool>>),
    MaybeReal(Vec<Option<f64>>),
    Text(Vec<ByteArray>),
    MaybeText(Vec<Option<ByteArray>>),
}

/// The columns of some rows, in the order of the schema.
fn columns_of(rows: &[Row], campaign: &Campaign) -> Vec<TableColumn> {
    let long = |get: fn(&Row) -> u64| {
        TableColumn::Long(rows.iter().map(|row| get(row).cast_signed()).collect())
    };
    let flag = |get: fn(&Row) -> bool| TableColumn::Flag(rows.iter().map(get).collect());
    let real = |get: fn(&Row) -> f64| TableColumn::Real(rows.iter().map(get).collect());
    let maybe =
        |get: fn(&Row) -> Option<f64>| TableColumn::MaybeReal(rows.iter().map(get).collect());
    let text = |names: &[String], get: fn(&Row) -> u32| {
        let names: Vec<ByteArray> = names
            .iter()
            .map(|name| ByteArray::from(name.as_str()))
            .collect();
        let name_of = |row: &Row| names.get(get(row) as usize).cloned().unwrap_or_default();
        TableColumn::Text(rows.iter().map(name_of).collect())
    };
    let names = campaign.encounter_names();
    let name_of = |row: &Row| Some(ByteArray::from(names.get(row.name? as usize)?.as_str()));
    let mut columns = vec![
        long(|row| row.encounter),
        long(|row| row.source_encounter),
        long(|row| row.seed),
        text(campaign.source_names(), |row| row.source),
        text(&campaign.configuration.policies, |row| row.policy),
        TableColumn::Int(rows.iter().map(|row| row.obstacles.cast_signed()).collect()),
        flag(Row::threatened),
        real(|row| row.held_margin_m),
        flag(|row| row.separated),
        flag(|row| row.caused),
        flag(Row::needless),
        real(|row| row.min_separation_m),
        real(|row| row.min_margin_m),
        maybe(|row| row.start_s),
        maybe(|row| row.clear_s),
        maybe(|row| row.rejoined_s),
        real(|row| row.end_s),
        maybe(Row::time_away_s),
        real(|row| row.max_cross_track_m),
        real(|row| row.extra_path_m),
        TableColumn::MaybeFlag(rows.iter().map(Row::avoidable).collect()),
        maybe(|row| row.oracle_margin_m),
        TableColumn::MaybeText(rows.iter().map(name_of).collect()),
        real(|row| row.weight),
    ];
    for field in campaign.metric_fields() {
        columns.push(match field.access {
            Access::Real(get, _) => {
                TableColumn::MaybeReal(rows.iter().map(|row| get(&row.metrics)).collect())
            }
            Access::Flag(get, _) => {
                TableColumn::MaybeFlag(rows.iter().map(|row| get(&row.metrics)).collect())
            }
            Access::Failure(get, _) => {
                let word = |row: &Row| Some(get(&row.metrics)?.name().into());
                TableColumn::MaybeText(rows.iter().map(word).collect())
            }
        });
    }
    columns
}

/// Writes rows, one row group a call.
pub struct TableWriter<W: Write + Send>(SerializedFileWriter<W>);

impl<W: Write + Send> TableWriter<W> {
    /// Begins a file.
    ///
    /// # Errors
    /// Errors of the output.
    pub fn new(
        output: W,
        campaign: &Campaign,
        stamp: &CampaignStamp,
    ) -> Result<Self, ParquetError> {
        let configuration = &campaign.configuration;
        let seeds: Vec<String> = configuration.seeds.iter().map(u64::to_string).collect();
        let entries = [
            ("fga.version", configuration.version.clone()),
            ("fga.commit", stamp.commit.clone()),
            ("fga.target", stamp.target.clone()),
            ("fga.configuration_hash", campaign.hash.clone()),
            ("fga.seeds", seeds.join(",")),
            (
                "fga.configuration",
                campaign.configuration.placeless().to_json(),
            ),
            ("fga.columns", columns_in_words(campaign)),
        ];
        let mut entries: Vec<(&str, String)> = entries.into();
        let left_out = configuration.left_out();
        if !left_out.is_empty() {
            entries.push(("fga.left_out", Value::Object(left_out).to_string()));
        }
        let entries = entries
            .into_iter()
            .map(|(key, value)| KeyValue::new(key.to_owned(), value));
        let mut properties = WriterProperties::builder()
            .set_created_by(format!("fga {}", configuration.version))
            .set_compression(Compression::SNAPPY)
            .set_dictionary_enabled(false)
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .set_offset_index_disabled(true)
            .set_key_value_metadata(Some(entries.collect()));
        for name in ["seed", "source", "policy", "name"] {
            properties = properties.set_column_dictionary_enabled(ColumnPath::from(name), true);
        }
        for name in ["encounter", "source_encounter"] {
            properties = properties
                .set_column_encoding(ColumnPath::from(name), Encoding::DELTA_BINARY_PACKED);
        }
        SerializedFileWriter::new(output, schema(campaign)?, Arc::new(properties.build())).map(Self)
    }

    /// Writes one row group.
    ///
    /// # Errors
    /// Errors of the output.
    pub fn write(&mut self, rows: &[Row], campaign: &Campaign) -> Result<(), ParquetError> {
        let mut group = self.0.next_row_group()?;
        for column in columns_of(rows, campaign) {
            let Some(mut writer) = group.next_column()? else {
                break;
            };
            match &column {
                TableColumn::Long(values) => put(writer.typed::<Int64Type>(), values)?,
                TableColumn::Int(values) => put(writer.typed::<Int32Type>(), values)?,
                TableColumn::Flag(values) => put(writer.typed::<BoolType>(), values)?,
                TableColumn::Real(values) => put(writer.typed::<DoubleType>(), values)?,
                TableColumn::Text(values) => put(writer.typed::<ByteArrayType>(), values)?,
                TableColumn::MaybeFlag(values) => put_maybe(writer.typed::<BoolType>(), values)?,
                TableColumn::MaybeReal(values) => put_maybe(writer.typed::<DoubleType>(), values)?,
                TableColumn::MaybeText(values) => {
                    put_maybe(writer.typed::<ByteArrayType>(), values)?;
                }
            }
            writer.close()?;
        }
        group.close()?;
        Ok(())
    }

    /// Finishes the file and returns the output.
    ///
    /// # Errors
    /// Errors of the output.
    pub fn finish(self) -> Result<W, ParquetError> {
        self.0.into_inner()
    }
}

/// The meaning of the columns, as JSON.
fn columns_in_words(campaign: &Campaign) -> String {
    let words: serde_json::Map<_, _> = meanings(campaign.metric_fields())
        .map(|(name, meaning)| (name.to_owned(), meaning.into()))
        .collect();
    serde_json::Value::Object(words).to_string()
}

fn put<T: DataType>(
    writer: &mut ColumnWriterImpl<'_, T>,
    values: &[T::T],
) -> Result<(), ParquetError> {
    writer.write_batch(values, None, None).map(drop)
}

fn put_maybe<T: DataType>(
    writer: &mut ColumnWriterImpl<'_, T>,
    values: &[Option<T::T>],
) -> Result<(), ParquetError>
where
    T::T: Clone,
{
    let levels: Vec<i16> = values
        .iter()
        .map(|value| i16::from(value.is_some()))
        .collect();
    let present: Vec<T::T> = values.iter().flatten().cloned().collect();
    writer.write_batch(&present, Some(&levels), None).map(drop)
}

/// Appends a row of the CSV file.
pub fn push_csv(line: &mut Vec<u8>, row: &Row, campaign: &Campaign) {
    for (index, column) in columns_of(core::slice::from_ref(row), campaign)
        .iter()
        .enumerate()
    {
        if index > 0 {
            line.push(b',');
        }
        let shown = match column {
            TableColumn::Long(values) => values.first().map(|v| v.cast_unsigned().to_string()),
            TableColumn::Int(values) => values.first().map(i32::to_string),
            TableColumn::Flag(values) => values.first().map(bool::to_string),
            TableColumn::MaybeFlag(values) => values.iter().flatten().next().map(bool::to_string),
            TableColumn::Real(values) => {
                if let Some(value) = values.first() {
                    push_fixed(line, *value, 6);
                }
                None
            }
            TableColumn::MaybeReal(values) => {
                if let Some(value) = values.iter().flatten().next() {
                    push_fixed(line, *value, 6);
                }
                None
            }
            TableColumn::Text(values) => {
                if let Some(value) = values.first() {
                    push_csv_field(line, value.data());
                }
                None
            }
            TableColumn::MaybeText(values) => {
                if let Some(value) = values.iter().flatten().next() {
                    push_csv_field(line, value.data());
                }
                None
            }
        };
        line.extend_from_slice(shown.unwrap_or_default().as_bytes());
    }
    line.push(b'\n');
}
