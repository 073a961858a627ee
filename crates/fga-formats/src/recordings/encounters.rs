//! What a file or folder of recordings holds.

use super::received::Received;
use crate::daa::Recording;
use crate::tally::Tally;

/// An encounter with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// Name of the file without its ending, and of the pair where the file holds several.
    pub name: String,
    /// The aircraft; the first is the ownship.
    pub recording: Recording,
}

/// The encounters of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Encounters {
    /// The encounters.
    pub named: Vec<Named>,
    /// What became of the file's lines, rows or state vectors.
    pub tally: Tally,
}

/// The content of a file of any kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// Lines of BaseStation, as text: [`sbs::Log`](crate::traffic::sbs::Log) reads them.
    Lines(String),
    /// State vectors.
    States(Received),
    /// One encounter.
    Recording(Recording),
}
