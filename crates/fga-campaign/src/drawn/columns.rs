//! Columns of a Parquet file by name, whatever program wrote it.

use std::collections::HashMap;
use std::path::Path;

use bytes::Bytes;
use fga_formats::InputError;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};

use crate::corrupt::guarded;
use crate::values;

/// Whether these are the bytes of a Parquet file.
pub(super) fn is_parquet(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PAR1")
}

/// An open file.
pub(super) struct ColumnTable<'a> {
    reader: SerializedFileReader<Bytes>,
    places: HashMap<String, usize>,
    path: &'a Path,
}

/// One group of rows of it.
pub(super) struct ColumnGroup<'a> {
    reader: Box<dyn RowGroupReader + 'a>,
    places: &'a HashMap<String, usize>,
    path: &'a Path,
    /// Number of its rows.
    pub(super) count: usize,
}

impl<'a> ColumnTable<'a> {
    pub(super) fn open(bytes: Vec<u8>, path: &'a Path) -> Result<Self, InputError> {
        let reader =
            SerializedFileReader::new(Bytes::from(bytes)).map_err(|error| damaged(path, &error))?;
        let schema = reader.metadata().file_metadata().schema_descr();
        let places = schema
            .columns()
            .iter()
            .map(|column| column.name().to_owned())
            .zip(0..)
            .collect();
        Ok(Self {
            reader,
            places,
            path,
        })
    }

    /// Whether it has a column.
    pub(super) fn has(&self, name: &str) -> bool {
        self.places.contains_key(name)
    }

    /// Its groups of rows.
    pub(super) fn groups(&self) -> impl Iterator<Item = Result<ColumnGroup<'_>, InputError>> {
        (0..self.reader.num_row_groups()).map(|index| {
            let reader = self
                .reader
                .get_row_group(index)
                .map_err(|error| damaged(self.path, &error))?;
            let count = usize::try_from(reader.metadata().num_rows()).unwrap_or(0);
            Ok(ColumnGroup {
                reader,
                places: &self.places,
                path: self.path,
                count,
            })
        })
    }
}

/// Runs a reader of a file; a panic of the crate `parquet` is an error about the file.
pub(super) fn reading<T>(
    path: &Path,
    read: impl FnOnce() -> Result<T, InputError>,
) -> Result<T, InputError> {
    guarded(read, |words| {
        damaged(path, &ParquetError::General(words.to_owned()))
    })
}

fn damaged(path: &Path, error: &ParquetError) -> InputError {
    let reason = values::reason(error);
    InputError::in_file(path, format!("is no readable Parquet file: {reason}"))
}

impl ColumnGroup<'_> {
    /// A column of finite numbers.
    pub(super) fn numbers(&self, name: &str) -> Result<Vec<f64>, InputError> {
        let numbers: Vec<f64> = match self.column(name)? {
            ColumnReader::DoubleColumnReader(column) => self.all(name, column)?,
            ColumnReader::FloatColumnReader(column) => {
                let values = self.all(name, column)?;
                values.into_iter().map(f64::from).collect()
            }
            ColumnReader::Int32ColumnReader(column) => {
                let values = self.all(name, column)?;
                values.into_iter().map(f64::from).collect()
            }
            ColumnReader::Int64ColumnReader(column) => {
                let values = self.all(name, column)?;
                values.into_iter().map(|value| value as f64).collect()
            }
            _ => return Err(self.wrong(name, "numbers")),
        };
        self.expect_finite(name, &numbers)?;
        Ok(numbers)
    }

    /// A column of finite numbers with empty fields.
    pub(super) fn maybe_numbers(&self, name: &str) -> Result<Vec<Option<f64>>, InputError> {
        let ColumnReader::DoubleColumnReader(column) = self.column(name)? else {
            return Err(self.wrong(name, "numbers of 64 bits"));
        };
        let (values, mut levels) = self.records(column)?;
        self.expect_finite(name, &values)?;
        // A column that may not be empty has no levels.
        if levels.is_empty() {
            levels.resize(values.len(), 1);
        }
        let found = values::with_gaps(values, &levels);
        self.expect_one_a_row(name, found.len(), "fields")?;
        Ok(found)
    }

    /// A column of whole numbers from 0.
    pub(super) fn wholes(&self, name: &str) -> Result<Vec<u64>, InputError> {
        match self.column(name)? {
            ColumnReader::Int64ColumnReader(column) => {
                let values = self.all(name, column)?;
                Ok(values.into_iter().map(i64::cast_unsigned).collect())
            }
            ColumnReader::Int32ColumnReader(column) => {
                let values = self.all(name, column)?;
                let whole = |value: i32| u64::from(value.cast_unsigned());
                Ok(values.into_iter().map(whole).collect())
            }
            _ => Err(self.wrong(name, "whole numbers")),
        }
    }

    /// A column of texts.
    pub(super) fn texts(&self, name: &str) -> Result<Vec<String>, InputError> {
        match self.column(name)? {
            ColumnReader::ByteArrayColumnReader(column) => {
                let values = self.all(name, column)?;
                let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
                Ok(values.iter().map(|value| text(value.data())).collect())
            }
            _ => Err(self.wrong(name, "texts")),
        }
    }

    fn column(&self, name: &str) -> Result<ColumnReader, InputError> {
        let Some(&place) = self.places.get(name) else {
            return Err(self.error(format!("has no column {name}, expected one")));
        };
        self.reader
            .get_column_reader(place)
            .map_err(|error| damaged(self.path, &error))
    }

    /// All values of a column without gaps.
    fn all<T: DataType>(
        &self,
        name: &str,
        column: ColumnReaderImpl<T>,
    ) -> Result<Vec<T::T>, InputError> {
        let (values, _) = self.records(column)?;
        self.expect_one_a_row(name, values.len(), "values")?;
        Ok(values)
    }

    /// The values of a column, and the fields that have one; without the latter where none may be empty.
    fn records<T: DataType>(
        &self,
        column: ColumnReaderImpl<T>,
    ) -> Result<(Vec<T::T>, Vec<i16>), InputError> {
        values::read(column, self.count).map_err(|error| damaged(self.path, &error))
    }

    fn expect_finite(&self, name: &str, numbers: &[f64]) -> Result<(), InputError> {
        match numbers.iter().find(|number| !number.is_finite()) {
            None => Ok(()),
            Some(number) => Err(self.error(format!(
                "column {name} holds {number}, expected finite numbers"
            ))),
        }
    }

    fn expect_one_a_row(&self, name: &str, found: usize, what: &str) -> Result<(), InputError> {
        if found == self.count {
            return Ok(());
        }
        Err(self.error(format!(
            "column {name} has {found} {what} in {} rows, expected one in each row",
            self.count
        )))
    }

    fn wrong(&self, name: &str, expected: &str) -> InputError {
        self.error(format!(
            "column {name} holds another kind of value, expected {expected}"
        ))
    }

    fn error(&self, message: String) -> InputError {
        InputError::in_file(self.path, message)
    }
}
