//! A recording as a file.

use super::Recording;
use crate::OutputError;
use crate::atomic;
use crate::number::push_fixed;
use std::io::Write as _;
use std::path::Path;

/// Writes a recording in Cartesian columns of metres and metres per second, whole or not at all.
///
/// Names may not hold commas, semicolons or line breaks: they become `_`.
///
/// # Errors
/// A file that cannot be written.
pub fn write(path: &Path, recording: &Recording) -> Result<(), OutputError> {
    atomic::write_with(path, |out| {
        out.write_all(
            b"NAME, sx, sy, sz, vx, vy, vz, time\nunitless, [m], [m], [m], [m/s], [m/s], [m/s], [s]\n",
        )?;
        let mut row = Vec::new();
        for track in &recording.aircraft {
            let name = track
                .name
                .replace([',', ';', '\n', '\r', '"', '#', '='], "_");
            for sample in &track.samples {
                row.clear();
                row.extend_from_slice(name.as_bytes());
                let (p, v) = (sample.position_m, sample.velocity_mps);
                for value in [p.x, p.y, p.z, v.x, v.y, v.z, sample.time_s] {
                    row.extend_from_slice(b", ");
                    push_fixed(&mut row, value, 6);
                }
                row.push(b'\n');
                out.write_all(&row)?;
            }
        }
        Ok(())
    })
}
