//! The failure of a command.

use std::io;

use fga::avoider::SettingsError;
use fga_campaign::batch::BatchError;
use fga_formats::{InputError, OutputError};

/// The failure of a command, shown as one sentence.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The input or the usage was wrong.
    Input(String),
    /// An output was not writable.
    Output(OutputError),
    /// The reader closed standard output, which is not an error.
    BrokenPipe,
    /// Ctrl-C.
    Interrupted,
}

impl core::fmt::Display for Failure {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Input(message) => f.write_str(message),
            Self::Output(error) => write!(f, "{error}"),
            Self::BrokenPipe => f.write_str("standard output was closed"),
            Self::Interrupted => f.write_str("interrupted"),
        }
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<SettingsError> for Failure {
    fn from(error: SettingsError) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::Output(error)
    }
}

impl From<BatchError<Self>> for Failure {
    fn from(error: BatchError<Self>) -> Self {
        match error {
            BatchError::Sink(failure) => failure,
            other @ (BatchError::Settings(_) | BatchError::Input(_) | BatchError::Wind { .. }) => {
                Self::Input(other.to_string())
            }
        }
    }
}

impl Failure {
    /// The meaning of an error of standard output.
    pub(crate) fn of_stdout(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            Self::BrokenPipe
        } else {
            Self::Output(OutputError::new("standard output", error))
        }
    }
}
