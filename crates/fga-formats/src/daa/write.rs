//! A recording as a file.

use super::Recording;
use crate::OutputError;
use crate::atomic;
use std::io::Write as _;
use std::path::Path;

/// Writes a recording in Cartesian columns of metres and metres per second, whole or not at all.
///
/// Numbers have as many digits as it takes to read the same numbers back. The parameters come first, as
/// `key = value`. Names may not hold commas, semicolons or line breaks: they become `_`.
///
/// # Errors
/// A file that cannot be written.
pub fn write(path: &Path, recording: &Recording) -> Result<(), OutputError> {
    atomic::write_with(path, |out| {
        for (key, value) in &recording.parameters {
            writeln!(out, "{} = {}", plain(key), plain(value))?;
        }
        out.write_all(
            b"NAME, sx, sy, sz, vx, vy, vz, time\nunitless, [m], [m], [m], [m/s], [m/s], [m/s], [s]\n",
        )?;
        for track in &recording.aircraft {
            let name = plain(&track.name);
            for sample in &track.samples {
                let (p, v, t) = (sample.position_m, sample.velocity_mps, sample.time_s);
                writeln!(
                    out,
                    "{name}, {}, {}, {}, {}, {}, {}, {t}",
                    p.x, p.y, p.z, v.x, v.y, v.z
                )?;
            }
        }
        Ok(())
    })
}

/// A text without the characters that mean something in the format.
fn plain(text: &str) -> String {
    text.replace([',', ';', '\n', '\r', '"', '#', '='], "_")
}
