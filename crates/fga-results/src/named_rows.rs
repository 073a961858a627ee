//! Rows of named values, as CSV and as JSON: the summaries of campaigns.

use fga_formats::words::push_csv_field;
use serde_json::{Map, Value};

/// A row: names and values in order.
pub(crate) type NamedRow<N> = Vec<(N, Value)>;

/// Six decimals.
pub(crate) fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

/// The rows as CSV, under the names of the first.
pub(crate) fn csv<N: AsRef<str>>(rows: &[NamedRow<N>]) -> Vec<u8> {
    let mut csv = Vec::new();
    let mut push = |fields: &mut dyn Iterator<Item = String>| {
        for (index, field) in fields.enumerate() {
            if index > 0 {
                csv.push(b',');
            }
            push_csv_field(&mut csv, field.as_bytes());
        }
        csv.push(b'\n');
    };
    if let Some(first) = rows.first() {
        push(&mut first.iter().map(|(name, _)| name.as_ref().to_owned()));
    }
    for row in rows {
        push(&mut row.iter().map(|(_, value)| match value {
            Value::Null => String::new(),
            Value::String(text) => text.clone(),
            other => other.to_string(),
        }));
    }
    csv
}

/// The rows as JSON objects.
pub(crate) fn objects<N: Into<String>>(rows: Vec<NamedRow<N>>) -> Value {
    rows.into_iter()
        .map(|row| {
            let named = row.into_iter().map(|(name, value)| (name.into(), value));
            Value::Object(named.collect::<Map<_, _>>())
        })
        .collect()
}
