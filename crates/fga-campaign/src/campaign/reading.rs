//! Reads the Parquet table of a campaign back.

use alloc::sync::Arc;
use std::path::Path;

use fga_formats::InputError;
use fga_formats::error::shown;
use fga_sim::own::FailureKind;
use parquet::column::reader::get_typed_column_reader;
use parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int32Type, Int64Type,
};
use parquet::errors::ParquetError;
use parquet::file::reader::{ChunkReader, FileReader, RowGroupReader, SerializedFileReader};
use parquet::schema::types::Type;

use super::metrics::Access;
use super::table::{BASE, schema};
use super::{Campaign, Row};
use crate::corrupt::guarded;
use crate::values::{columns, reason, with_gaps};

/// Reads the rows of a file back, one row group a call of `take`.
///
/// # Errors
/// A file that is not such a table, or the first error of `take`.
pub fn read<R: ChunkReader + 'static, E: From<ParquetError>>(
    input: R,
    campaign: &Campaign,
    mut take: impl FnMut(Vec<Row>) -> Result<(), E>,
) -> Result<(), E> {
    let corrupt = |words: &str| ParquetError::General(words.to_owned());
    let reader = guarded(|| SerializedFileReader::new(input), corrupt)?;
    let expected = schema(campaign)?;
    let found = reader.metadata().file_metadata().schema();
    if found != expected.as_ref() {
        return Err(ParquetError::General(other_columns(found, &expected)).into());
    }
    for index in 0..reader.num_row_groups() {
        let group = || read_group(reader.get_row_group(index)?.as_ref(), campaign);
        take(guarded(group, corrupt)?)?;
    }
    Ok(())
}

/// What is wrong with a table.
pub(super) fn unusable(path: &Path, error: &ParquetError) -> InputError {
    InputError::in_file(path, format!("cannot be used: {}", reason(error)))
}

/// The first column that differs from those of a campaign.
fn other_columns(found: &Type, expected: &Type) -> String {
    let name = |column: Option<&Arc<Type>>| {
        column.map_or_else(|| "none".to_owned(), |column| shown(column.name()))
    };
    let (there, wanted) = (found.get_fields(), expected.get_fields());
    let at = (0..wanted.len().max(there.len()))
        .find(|at| there.get(*at) != wanted.get(*at))
        .unwrap_or(0);
    let (is, should_be) = (name(there.get(at)), name(wanted.get(at)));
    if is == should_be {
        return format!("has a column {is} of another type than the one of a campaign");
    }
    format!(
        "has other columns: column {} is {is}, expected {should_be} as a campaign has it",
        at + 1
    )
}

fn read_group(group: &dyn RowGroupReader, campaign: &Campaign) -> Result<Vec<Row>, ParquetError> {
    let count = usize::try_from(group.metadata().num_rows())
        .map_err(|_| ParquetError::General("a row group has no size".into()))?;
    let whole = |column: usize| {
        let values = all::<Int64Type>(group, column, count)?;
        Ok::<_, ParquetError>(values.into_iter().map(i64::cast_unsigned))
    };
    // The group may say another number of rows than it has: the first column is checked before there are rows.
    let encounters = whole(0)?;
    let mut rows = vec![Row::default(); encounters.len()];
    macro_rules! take {
        ($($field:ident = $values:expr;)*) => {
            $(for (row, value) in rows.iter_mut().zip($values) {
                row.$field = value;
            })*
        };
    }
    let names = maybe::<ByteArrayType>(group, 22, count)?.into_iter();
    let index = |name: ByteArray| index_of(&name, campaign.encounter_names());
    let obstacles = all::<Int32Type>(group, 5, count)?.into_iter();
    take! {
        encounter = encounters;
        source_encounter = whole(1)?;
        seed = whole(2)?;
        source = indices(group, 3, count, campaign.source_names())?;
        policy = indices(group, 4, count, &campaign.configuration.policies)?;
        obstacles = obstacles.map(i32::cast_unsigned);
        held_margin_m = all::<DoubleType>(group, 7, count)?;
        separated = all::<BoolType>(group, 8, count)?;
        caused = all::<BoolType>(group, 9, count)?;
        min_separation_m = all::<DoubleType>(group, 11, count)?;
        min_margin_m = all::<DoubleType>(group, 12, count)?;
        start_s = maybe::<DoubleType>(group, 13, count)?;
        clear_s = maybe::<DoubleType>(group, 14, count)?;
        rejoined_s = maybe::<DoubleType>(group, 15, count)?;
        end_s = all::<DoubleType>(group, 16, count)?;
        max_cross_track_m = all::<DoubleType>(group, 18, count)?;
        extra_path_m = all::<DoubleType>(group, 19, count)?;
        oracle_margin_m = maybe::<DoubleType>(group, 21, count)?;
        name = names.map(|name| name.map(index).transpose()).collect::<Result<Vec<_>, _>>()?;
        weight = all::<DoubleType>(group, 23, count)?;
    }
    for (column, field) in (columns(BASE).count()..).zip(campaign.metric_fields()) {
        let metrics = rows.iter_mut().map(|row| &mut row.metrics);
        match field.access {
            Access::Real(_, set) => {
                let values = maybe::<DoubleType>(group, column, count)?;
                metrics.zip(values).for_each(|(m, v)| set(m, v));
            }
            Access::Flag(_, set) => {
                let values = maybe::<BoolType>(group, column, count)?;
                metrics.zip(values).for_each(|(m, v)| set(m, v));
            }
            Access::Failure(_, set) => {
                for (m, word) in metrics.zip(maybe::<ByteArrayType>(group, column, count)?) {
                    set(m, word.map(|word| failure_of(&word)).transpose()?);
                }
            }
        }
    }
    Ok(rows)
}

/// The values of a column, and the rows that have one.
fn values<T: DataType>(
    group: &dyn RowGroupReader,
    column: usize,
    count: usize,
) -> Result<(Vec<T::T>, Vec<i16>), ParquetError> {
    let reader = get_typed_column_reader::<T>(group.get_column_reader(column)?);
    crate::values::read(reader, count)
}

fn all<T: DataType>(
    group: &dyn RowGroupReader,
    column: usize,
    count: usize,
) -> Result<Vec<T::T>, ParquetError> {
    let (values, _) = values::<T>(group, column, count)?;
    if values.len() == count {
        Ok(values)
    } else {
        Err(ParquetError::General(format!(
            "column {column} has {} values, expected {count}",
            values.len()
        )))
    }
}

fn maybe<T: DataType>(
    group: &dyn RowGroupReader,
    column: usize,
    count: usize,
) -> Result<Vec<Option<T::T>>, ParquetError> {
    let (values, levels) = values::<T>(group, column, count)?;
    let rows = with_gaps(values, &levels);
    if rows.len() == count {
        Ok(rows)
    } else {
        Err(ParquetError::General(format!(
            "column {column} has {} rows, expected {count}",
            rows.len()
        )))
    }
}

/// A column of names as indices.
fn indices(
    group: &dyn RowGroupReader,
    column: usize,
    count: usize,
    names: &[String],
) -> Result<Vec<u32>, ParquetError> {
    all::<ByteArrayType>(group, column, count)?
        .iter()
        .map(|name| index_of(name, names))
        .collect()
}

/// The failure of a word.
fn failure_of(word: &ByteArray) -> Result<FailureKind, ParquetError> {
    let word = String::from_utf8_lossy(word.data());
    FailureKind::parse(&word).ok_or_else(|| {
        ParquetError::General(format!(
            "holds {}, expected a failure of a policy",
            shown(&word)
        ))
    })
}

/// The index of a name.
fn index_of(name: &ByteArray, names: &[String]) -> Result<u32, ParquetError> {
    (0..)
        .zip(names)
        .find(|(_, known)| known.as_bytes() == name.data())
        .map(|(index, _)| index)
        .ok_or_else(|| {
            ParquetError::General(format!(
                "holds {}, expected one of {}",
                shown(&String::from_utf8_lossy(name.data())),
                names.join(", ")
            ))
        })
}
