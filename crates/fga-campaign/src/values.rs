//! Values of the columns of Parquet files.

use std::io::Write;

use parquet::column::reader::ColumnReaderImpl;
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::writer::SerializedRowGroupWriter;

/// The columns of a table: each as in the schema, its name and its meaning. A line of the table has the first and the last,
/// separated by a semicolon.
pub(crate) fn columns(
    table: &'static str,
) -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    let lines = table.lines().filter_map(|line| line.split_once("; "));
    lines.filter_map(|(column, meaning)| Some((column, column.split_whitespace().nth(2)?, meaning)))
}

/// The values of a column, and for each of its `rows` whether it has one; without the latter where none may be empty.
pub(crate) fn read<T: DataType>(
    mut column: ColumnReaderImpl<T>,
    rows: usize,
) -> Result<(Vec<T::T>, Vec<i16>), ParquetError> {
    // The file says how many rows it has, and that may be wrong.
    let (mut values, mut levels) = (Vec::with_capacity(rows.min(65_536)), Vec::new());
    while column
        .read_records(rows, Some(&mut levels), None, &mut values)?
        .0
        > 0
    {}
    Ok((values, levels))
}

/// One value or none for each level.
pub(crate) fn with_gaps<T>(values: Vec<T>, levels: &[i16]) -> Vec<Option<T>> {
    let mut values = values.into_iter();
    let each = levels.iter();
    each.map(|level| if *level > 0 { values.next() } else { None })
        .collect()
}

/// Writes the next column of a group; levels say which rows of one that may be empty have a value.
pub(crate) fn put<W: Write + Send, T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: &[T::T],
    levels: Option<&[i16]>,
) -> Result<(), ParquetError> {
    let Some(mut column) = group.next_column()? else {
        return Err(ParquetError::General("has too few columns".into()));
    };
    column.typed::<T>().write_batch(values, levels, None)?;
    column.close()
}

/// What the reader of a file says is wrong, without its prefix where this crate says it.
pub(crate) fn reason(error: &ParquetError) -> String {
    match error {
        ParquetError::General(message) => message.clone(),
        other => other.to_string(),
    }
}
