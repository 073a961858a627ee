//! Tables out and in through the Arrow C stream, without copies.

use std::sync::Arc;

use arrow_array::ffi_stream::{FFI_ArrowArrayStream, RecordBatchStreamReader};
use arrow_array::{
    Array as _, ArrayRef, BooleanArray, Float64Array, RecordBatch, RecordBatchIterator,
    RecordBatchReader, StringArray, UInt64Array,
};
use arrow_schema::{ArrowError, Field, Schema};
use numpy::PyArray1;
use pyo3::exceptions::{PyKeyError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyCapsule, PyDict, PyList};

/// The name of a stream in the Arrow PyCapsule interface.
const STREAM: &core::ffi::CStr = c"arrow_array_stream";

/// One column.
pub(crate) enum ArrayColumn {
    Whole(Vec<u64>),
    Flag(Vec<bool>),
    MaybeFlag(Vec<Option<bool>>),
    Real(Vec<f64>),
    MaybeReal(Vec<Option<f64>>),
    Text(Vec<String>),
    MaybeText(Vec<Option<String>>),
}

impl ArrayColumn {
    fn array(self) -> (ArrayRef, bool) {
        match self {
            Self::Whole(values) => (Arc::new(UInt64Array::from(values)), false),
            Self::Flag(values) => (Arc::new(BooleanArray::from(values)), false),
            Self::MaybeFlag(values) => (Arc::new(BooleanArray::from(values)), true),
            Self::Real(values) => (Arc::new(Float64Array::from(values)), false),
            Self::MaybeReal(values) => (Arc::new(Float64Array::from(values)), true),
            Self::MaybeText(values) => (Arc::new(StringArray::from(values)), true),
            Self::Text(values) => (Arc::new(StringArray::from(values)), false),
        }
    }
}

/// A table that every library with the Arrow PyCapsule interface takes without copying:
/// `polars.DataFrame(table)`, `pyarrow.table(table)`, `pandas.DataFrame.from_arrow(table)`, duckdb.
#[pyclass(name = "Table", frozen, module = "fga")]
#[derive(Debug)]
pub(crate) struct PyTable {
    batch: RecordBatch,
    csv: Option<Vec<u8>>,
}

impl PyTable {
    /// A table of these columns.
    pub(crate) fn of(columns: Vec<(&str, ArrayColumn)>) -> PyResult<Self> {
        let mut fields = Vec::with_capacity(columns.len());
        let mut arrays = Vec::with_capacity(columns.len());
        for (name, column) in columns {
            let (array, nullable) = column.array();
            fields.push(Field::new(name, array.data_type().clone(), nullable));
            arrays.push(array);
        }
        let batch = RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays)
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(Self { batch, csv: None })
    }

    /// The same with the file of the program.
    pub(crate) fn with_csv(self, csv: Vec<u8>) -> Self {
        Self {
            csv: Some(csv),
            ..self
        }
    }
}

#[pymethods]
impl PyTable {
    /// The Arrow PyCapsule interface.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // Another schema is a wish that we may ignore.
        let _ = requested_schema;
        let schema = self.batch.schema();
        let batches = [Ok::<_, ArrowError>(self.batch.clone())];
        let reader = RecordBatchIterator::new(batches, schema);
        PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(reader)), STREAM)
    }

    /// Names of the columns, as `column_names`.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.column_names()
    }

    /// Numbers of rows and columns.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.batch.num_rows(), self.batch.num_columns())
    }

    /// A column by its name: an array of numpy. A missing number is NaN, a missing word or flag None in an array of objects.
    ///
    /// Raises KeyError for a column that the table does not have.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let Some(column) = self.batch.column_by_name(name) else {
            return Err(PyKeyError::new_err(format!(
                "column {name:?}, expected one of {}",
                self.column_names().join(", ")
            )));
        };
        values(py, column)
    }

    fn __contains__(&self, name: &str) -> bool {
        self.batch.column_by_name(name).is_some()
    }

    /// The table as `polars.DataFrame`. Raises ImportError without polars.
    fn to_polars<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("polars")?.call_method1("DataFrame", (slf,))
    }

    /// The table as `pandas.DataFrame`. Raises ImportError without pandas.
    fn to_pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let pandas = py.import("pandas")?;
        let columns = PyDict::new(py);
        for (name, column) in self.column_names().iter().zip(self.batch.columns()) {
            columns.set_item(name, values(py, column)?)?;
        }
        pandas.call_method1("DataFrame", (columns,))
    }

    /// Names of the columns.
    #[getter]
    fn column_names(&self) -> Vec<String> {
        let schema = self.batch.schema();
        schema
            .fields()
            .iter()
            .map(|field| field.name().clone())
            .collect()
    }

    fn __len__(&self) -> usize {
        self.batch.num_rows()
    }

    /// The bytes of the program's file with the same content.
    ///
    /// Raises ValueError for a table that the program does not write as CSV.
    fn to_csv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.csv
            .as_ref()
            .map(|csv| PyBytes::new(py, csv))
            .ok_or_else(|| {
                PyValueError::new_err(
                    "the program writes no CSV of this table, expected one of batch or oracle",
                )
            })
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "a Table cannot be pickled: send its to_csv(), or a table of pyarrow or polars made of it",
        ))
    }

    fn __repr__(&self) -> String {
        format!(
            "Table({} rows, columns {})",
            self.batch.num_rows(),
            self.column_names().join(", ")
        )
    }
}

/// A column as an array of numpy.
fn values<'py>(py: Python<'py>, column: &ArrayRef) -> PyResult<Bound<'py, PyAny>> {
    let any = column.as_any();
    if let Some(whole) = any.downcast_ref::<UInt64Array>() {
        return Ok(PyArray1::from_iter(py, whole.values().iter().copied()).into_any());
    }
    if let Some(real) = any.downcast_ref::<Float64Array>() {
        let reals = real.iter().map(|value| value.unwrap_or(f64::NAN));
        return Ok(PyArray1::from_iter(py, reals).into_any());
    }
    let objects = match (
        any.downcast_ref::<BooleanArray>(),
        any.downcast_ref::<StringArray>(),
    ) {
        (Some(flags), _) if flags.null_count() == 0 => {
            let flags = flags.iter().map(Option::unwrap_or_default);
            return Ok(PyArray1::from_iter(py, flags).into_any());
        }
        (Some(flags), _) => PyList::new(py, flags.iter().collect::<Vec<_>>())?,
        (_, Some(words)) => PyList::new(py, words.iter().collect::<Vec<_>>())?,
        _ => {
            let kind = column.data_type();
            let message = format!("a column of {kind}, expected numbers, flags or words");
            return Err(PyTypeError::new_err(message));
        }
    };
    let kind = PyDict::new(py);
    kind.set_item("dtype", "object")?;
    py.import("numpy")?
        .call_method("array", (objects,), Some(&kind))
}

/// The batches of anything that has the Arrow PyCapsule interface.
#[expect(
    unsafe_code,
    reason = "the interface hands a C structure over by its address"
)]
pub(crate) fn batches_of(object: &Bound<'_, PyAny>) -> PyResult<Vec<RecordBatch>> {
    let capsule = object.call_method0("__arrow_c_stream__")?;
    let capsule = capsule.cast::<PyCapsule>().map_err(|_| {
        PyTypeError::new_err("__arrow_c_stream__ gives no capsule, expected one of a stream")
    })?;
    let stream = capsule
        .pointer_checked(Some(STREAM))?
        .cast::<FFI_ArrowArrayStream>();
    // SAFETY: a capsule of this name holds such a structure, by the Arrow PyCapsule interface; the
    // structure is moved out, and the rest is marked as released.
    let reader = unsafe { RecordBatchStreamReader::from_raw(stream.as_ptr()) };
    let wrong =
        |error: ArrowError| PyValueError::new_err(format!("the table cannot be read: {error}"));
    let reader = reader.map_err(wrong)?;
    let _ = reader.schema();
    reader.map(|batch| batch.map_err(wrong)).collect()
}
