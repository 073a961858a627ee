//! Rows of named values, as CSV and as JSON: the summaries of campaigns.

use serde_json::{Map, Value};

/// A row: names and values in order.
pub(crate) type Row<N> = Vec<(N, Value)>;

/// Six decimals.
pub(crate) fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

/// The rows as CSV, under the names of the first.
pub(crate) fn csv<N: AsRef<str>>(rows: &[Row<N>]) -> String {
    let mut csv = String::new();
    if let Some(first) = rows.first() {
        let names: Vec<&str> = first.iter().map(|(name, _)| name.as_ref()).collect();
        csv.push_str(&names.join(","));
        csv.push('\n');
    }
    for row in rows {
        let fields: Vec<String> = row.iter().map(|(_, value)| field(value)).collect();
        csv.push_str(&fields.join(","));
        csv.push('\n');
    }
    csv
}

/// The rows as JSON objects.
pub(crate) fn objects<N: Into<String>>(rows: Vec<Row<N>>) -> Value {
    rows.into_iter()
        .map(|row| {
            let named = row.into_iter().map(|(name, value)| (name.into(), value));
            Value::Object(named.collect::<Map<_, _>>())
        })
        .collect()
}

/// A value as a CSV field.
fn field(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) if text.contains([',', '"', '\n', '\r']) => {
            format!("\"{}\"", text.replace('"', "\"\""))
        }
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}
