//! Errors of the libraries as exceptions: ValueError for wrong input, OSError for a place that cannot be
//! written, both with the sentence that the program says.

use fga_formats::{InputError, OutputError};
use fga_sim::campaign::CampaignError;
use pyo3::PyErr;
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyValueError};

/// An input that cannot be used.
pub(crate) fn input(error: InputError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// An output that cannot be written.
pub(crate) fn output(error: OutputError) -> PyErr {
    PyOSError::new_err(error.to_string())
}

/// A campaign that cannot be flown.
pub(crate) fn campaign(error: CampaignError) -> PyErr {
    match error {
        CampaignError::Output(error) => output(error),
        CampaignError::Stopped { .. } => PyKeyboardInterrupt::new_err(error.to_string()),
        other => PyValueError::new_err(other.to_string()),
    }
}
