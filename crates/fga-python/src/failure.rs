//! Errors of the libraries as exceptions: ValueError for wrong input, FileNotFoundError for a file that is not there, OSError
//! for an unwritable path, each with the sentence of the program.

use fga_campaign::campaign::CampaignError;
use fga_formats::{InputError, OutputError};
use pyo3::PyErr;
use pyo3::exceptions::{PyFileNotFoundError, PyKeyboardInterrupt, PyOSError, PyValueError};

/// An unusable input.
pub(crate) fn input(error: InputError) -> PyErr {
    let is_named = !error.path.as_os_str().is_empty();
    if is_named && error.message.starts_with("cannot be read") && !error.path.exists() {
        return PyFileNotFoundError::new_err(error.to_string());
    }
    PyValueError::new_err(error.to_string())
}

/// An unwritable output.
pub(crate) fn output(error: OutputError) -> PyErr {
    PyOSError::new_err(error.to_string())
}

/// A campaign that cannot fly.
pub(crate) fn campaign(error: CampaignError) -> PyErr {
    match error {
        CampaignError::Input(error) => input(error),
        CampaignError::Output(error) => output(error),
        CampaignError::Stopped { .. } => PyKeyboardInterrupt::new_err(error.to_string()),
        other => PyValueError::new_err(other.to_string()),
    }
}
