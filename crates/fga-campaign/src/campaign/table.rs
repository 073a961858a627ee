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
use parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int32Type, Int64Type,
};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;
use parquet::schema::types::{ColumnPath, Type};
use serde_json::Value;

use super::metrics::{Access, Field};
use super::{Campaign, CampaignStamp, Row};
use crate::values::{columns, put};

/// The columns before the metrics: each as in the schema, and behind the semicolon its meaning; the unit is in the name where there is one.
pub(super) const BASE: &str = "
    required int64 encounter (INTEGER(64,false)); number in the campaign
    required int64 source_encounter (INTEGER(64,false)); number in the file or folder that it comes from, else the same
    required int64 seed (INTEGER(64,false)); master seed
    required binary source (STRING); cell, file, folder or model
    required binary policy (STRING); as on the command line
    required int32 obstacles; how many
    required boolean threatened; whether holding course and altitude, or the recorded flight, would have entered a volume
    required double held_margin_m; the margin of holding them, m
    required boolean separated; whether no volume was entered
    required boolean caused; whether a volume was entered that holding would not have entered
    required boolean needless; whether there was a maneuver although holding would have stayed clear
    required double min_separation_m; least distance to a centre, m
    required double min_margin_m; least signed distance to a protected volume, m
    optional double start_s; when the first maneuver began, s; empty without one
    optional double clear_s; when the last maneuver ended, s
    optional double rejoined_s; when the aircraft was back on its mission for the last time, s
    required double end_s; when the flight ended, s
    optional double time_away_s; from the first maneuver to being back, or to the end, s
    required double max_cross_track_m; largest distance from the mission, m
    required double extra_path_m; path flown less progress along the mission, m
    optional boolean avoidable; with the oracle: whether any maneuver saves it
    optional double oracle_margin_m; with the oracle: a margin that it keeps, m
    optional binary name (STRING); name of the recording
    required double weight; for how many encounters of its source it stands; 1 without importance sampling
";

/// Names and meanings of all columns, in their order.
fn meanings(fields: &[Field]) -> impl Iterator<Item = (&'static str, &'static str)> {
    let metrics = fields.iter().map(|field| (field.name, field.meaning));
    columns(BASE)
        .map(|(_, name, meaning)| (name, meaning))
        .chain(metrics)
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
    let mut schema = String::from("message campaign {");
    for (column, ..) in columns(BASE) {
        // Writing to a text does not fail.
        let _ = writeln!(schema, "{column};");
    }
    for field in campaign.metric_fields() {
        let (kind, more) = match field.access {
            Access::Real(..) => ("double", ""),
            Access::Flag(..) => ("boolean", ""),
            Access::Failure(..) => ("binary", " (STRING)"),
        };
        let _ = writeln!(schema, "optional {kind} {}{more};", field.name);
    }
    schema.push('}');
    schema
}

/// One column of some rows.
enum TableColumn {
    Long(Vec<Option<i64>>),
    Int(Vec<Option<i32>>),
    Flag(Vec<Option<bool>>),
    Real(Vec<Option<f64>>),
    Text(Vec<Option<ByteArray>>),
}

/// The columns of some rows, in the order of the schema.
fn columns_of(rows: &[Row], campaign: &Campaign) -> Vec<TableColumn> {
    let long = |get: fn(&Row) -> u64| {
        let get = |row| Some(get(row).cast_signed());
        TableColumn::Long(rows.iter().map(get).collect())
    };
    let flag =
        |get: fn(&Row) -> bool| TableColumn::Flag(rows.iter().map(|row| Some(get(row))).collect());
    let real =
        |get: fn(&Row) -> f64| TableColumn::Real(rows.iter().map(|row| Some(get(row))).collect());
    let maybe = |get: fn(&Row) -> Option<f64>| TableColumn::Real(rows.iter().map(get).collect());
    let text = |names: &[String], get: fn(&Row) -> Option<u32>| {
        let names: Vec<ByteArray> = names.iter().map(|name| name.as_str().into()).collect();
        let name_of = |index: u32| names.get(index as usize).cloned().unwrap_or_default();
        TableColumn::Text(rows.iter().map(|row| get(row).map(name_of)).collect())
    };
    let obstacles = |row: &Row| Some(row.obstacles.cast_signed());
    let mut columns = vec![
        long(|row| row.encounter),
        long(|row| row.source_encounter),
        long(|row| row.seed),
        text(campaign.source_names(), |row| Some(row.source)),
        text(&campaign.configuration.policies, |row| Some(row.policy)),
        TableColumn::Int(rows.iter().map(obstacles).collect()),
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
        TableColumn::Flag(rows.iter().map(Row::avoidable).collect()),
        maybe(|row| row.oracle_margin_m),
        text(campaign.encounter_names(), |row| row.name),
        real(|row| row.weight),
    ];
    for field in campaign.metric_fields() {
        let metrics = rows.iter().map(|row| &row.metrics);
        columns.push(match field.access {
            Access::Real(get, _) => TableColumn::Real(metrics.map(get).collect()),
            Access::Flag(get, _) => TableColumn::Flag(metrics.map(get).collect()),
            Access::Failure(get, _) => {
                let word = |metrics| Some(get(metrics)?.name().into());
                TableColumn::Text(metrics.map(word).collect())
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
            match &column {
                TableColumn::Long(values) => put_column::<_, Int64Type>(&mut group, values)?,
                TableColumn::Int(values) => put_column::<_, Int32Type>(&mut group, values)?,
                TableColumn::Flag(values) => put_column::<_, BoolType>(&mut group, values)?,
                TableColumn::Real(values) => put_column::<_, DoubleType>(&mut group, values)?,
                TableColumn::Text(values) => put_column::<_, ByteArrayType>(&mut group, values)?,
            }
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

fn put_column<W: Write + Send, T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: &[Option<T::T>],
) -> Result<(), ParquetError> {
    let levels: Vec<i16> = values.iter().map(|v| i16::from(v.is_some())).collect();
    let present: Vec<T::T> = values.iter().flatten().cloned().collect();
    put::<W, T>(group, &present, Some(&levels))
}

/// Appends a row of the CSV file.
pub fn push_csv(line: &mut Vec<u8>, row: &Row, campaign: &Campaign) {
    let columns = columns_of(core::slice::from_ref(row), campaign);
    for (index, column) in columns.into_iter().enumerate() {
        if index > 0 {
            line.push(b',');
        }
        let words = match column {
            TableColumn::Long(values) => words(values, i64::cast_unsigned),
            TableColumn::Int(values) => words(values, i32::cast_unsigned),
            TableColumn::Flag(values) => words(values, |flag| flag),
            TableColumn::Real(values) => {
                values
                    .iter()
                    .flatten()
                    .for_each(|value| push_fixed(line, *value, 6));
                continue;
            }
            TableColumn::Text(values) => {
                values
                    .iter()
                    .flatten()
                    .for_each(|value| push_csv_field(line, value.data()));
                continue;
            }
        };
        line.extend_from_slice(words.as_bytes());
    }
    line.push(b'\n');
}

/// The values of a column of one row, as text.
fn words<T, S: ToString>(values: Vec<Option<T>>, shown: fn(T) -> S) -> String {
    let values = values.into_iter().flatten();
    values.map(|value| shown(value).to_string()).collect()
}
