//! Rows of named values as a Parquet table.

use alloc::sync::Arc;
use core::fmt::Write as _;

use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use serde_json::Value;

use crate::named_rows::NamedRow;

/// The type of a column: of its first value; numbers where it has none.
fn kind(rows: &[NamedRow<String>], column: usize) -> &'static str {
    let values = rows.iter().filter_map(|row| Some(&row.get(column)?.1));
    let mut kinds = values.filter(|value| !value.is_null());
    match kinds.next() {
        Some(Value::String(_)) => "binary",
        Some(Value::Number(number)) if !number.is_f64() => "int64",
        _ => "double",
    }
}

/// The rows as one Parquet file, under the names of the first; its bytes depend on nothing but the rows.
///
/// # Errors
/// Errors of the writer.
pub(crate) fn parquet(rows: &[NamedRow<String>], version: &str) -> Result<Vec<u8>, ParquetError> {
    let names = rows.first().map_or(&[][..], |first| first.as_slice());
    let kinds: Vec<&str> = (0..names.len()).map(|column| kind(rows, column)).collect();
    let mut schema = String::from("message rows {");
    for ((name, _), kind) in names.iter().zip(&kinds) {
        let annotation = if *kind == "binary" { " (STRING)" } else { "" };
        // Writing to a text does not fail.
        let _ = write!(schema, "optional {kind} {name}{annotation}; ");
    }
    schema.push('}');
    let properties = WriterProperties::builder().set_created_by(format!("fga {version}"));
    let mut writer = SerializedFileWriter::new(
        Vec::new(),
        Arc::new(parse_message_type(&schema)?),
        Arc::new(properties.build()),
    )?;
    let mut group = writer.next_row_group()?;
    for (column, kind) in kinds.iter().enumerate() {
        let Some(mut writer) = group.next_column()? else {
            break;
        };
        let values: Vec<&Value> = rows.iter().map(|row| &row[column].1).collect();
        let levels: Vec<i16> = values
            .iter()
            .map(|value| i16::from(!value.is_null()))
            .collect();
        let there = values.iter().filter(|value| !value.is_null());
        match *kind {
            "binary" => {
                let texts: Vec<ByteArray> = there
                    .map(|value| value.as_str().unwrap_or_default().into())
                    .collect();
                writer
                    .typed::<ByteArrayType>()
                    .write_batch(&texts, Some(&levels), None)?;
            }
            "int64" => {
                let numbers: Vec<i64> = there
                    .map(|value| value.as_i64().unwrap_or_default())
                    .collect();
                writer
                    .typed::<Int64Type>()
                    .write_batch(&numbers, Some(&levels), None)?;
            }
            _ => {
                let numbers: Vec<f64> = there
                    .map(|value| value.as_f64().unwrap_or_default())
                    .collect();
                writer
                    .typed::<DoubleType>()
                    .write_batch(&numbers, Some(&levels), None)?;
            }
        }
        writer.close()?;
    }
    group.close()?;
    writer.into_inner()
}
