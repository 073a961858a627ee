//! Errors of the libraries as exceptions: ValueError for wrong input, OSError for an unwritable path,
//! both with the sentence of the program.

use fga_formats::{InputError, OutputError};
use fga_sim::campaign::CampaignError;
use pyo3::PyErr;
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyValueError};

/// An unusable input.
pub(crate) fn input(error: InputError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// An unwritable output.
pub(crate) fn output(error: OutputError) -> PyErr {
    PyOSError::new_err(error.to_string())
}

/// A campaign that cannot fly.
pub(crate) fn campaign(error: CampaignError) -> PyErr {
    match error {
        CampaignError::Output(error) => output(error),
        CampaignError::Stopped { .. } => PyKeyboardInterrupt::new_err(error.to_string()),
        other => PyValueError::new_err(other.to_string()),
    }
}
