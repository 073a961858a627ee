//! A zone of a picture.

use serde::Serialize;

/// A zone; serialized as the replay page reads it.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct DrawnZone {
    /// Its name; any text.
    pub name: String,
    /// Whether the aircraft keeps within it, not out of it.
    #[serde(rename = "in")]
    pub keep_in: bool,
    /// Its outline, metres east and north; the last place is the first one again.
    #[serde(rename = "ring")]
    pub ring_m: Vec<[f64; 2]>,
    /// Its floor, metres, where it has one.
    #[serde(rename = "floor")]
    pub floor_m: Option<f64>,
    /// Its ceiling, metres, where it has one.
    #[serde(rename = "ceiling")]
    pub ceiling_m: Option<f64>,
}
