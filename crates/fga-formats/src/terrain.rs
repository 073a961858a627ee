//! Heights of the ground from the files that people have.
//!
//! Which files, how their place, datum and error are known: `docs/how-to-terrain.md`.
//!
//! A [`RequestedBlock`] is ground that a ground station sends over MAVLink. A [`LocalGround`] is ground as a flight takes it.
//!
//! A file becomes one or several [`HeightField`]s, and files together a [`Terrain`]. A hole and what lies outside are
//! unknown ground: never a height, always `None`. Heights count above a [`Datum`]; datum and vertical error have a source.

mod along;
mod ardupilot;
mod area;
mod chunks;
mod dted;
mod field;
mod file;
mod geokeys;
mod geotiff;
mod hgt;
mod local;
mod mosaic;
mod name;
mod projected;
mod reader;
mod requested;
mod tags;
mod write;

pub use along::{Clearance, GroundPoint, Lowest};
pub use area::Area;
pub use field::{HeightField, HeightGrid};
pub use file::{Datum, Given, Stated, TerrainFile};
pub use local::LocalGround;
pub use mosaic::Terrain;
pub use reader::{parse, read};
pub use requested::{RequestedBlock, Taken};
pub use write::Cut;
