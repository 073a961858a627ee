//! A recording as a file.

use super::{Recording, TrackSample};
use crate::OutputError;
use crate::atomic;
use crate::geodesy::compass_from_course_deg;
use fga_alerts::Deviation;
use std::io::Write;
use std::path::Path;

/// Writes a recording in Cartesian columns of metres and metres per second, whole or not at all.
///
/// Numbers have as many digits as it takes to read the same numbers back. Velocities through the air and
/// deviations are columns if the recording has any. The parameters come first, as
/// `key = value`. Names may not hold commas, semicolons or line breaks: they become `_`.
///
/// # Errors
/// A file that cannot be written.
pub fn write(path: &Path, recording: &Recording) -> Result<(), OutputError> {
    atomic::write_with(path, |out| {
        for (key, value) in &recording.parameters {
            writeln!(out, "{} = {}", plain(key), plain(value))?;
        }
        let mut samples = recording.aircraft.iter().flat_map(|track| &track.samples);
        let has_air = samples.clone().any(|sample| sample.air_mps.is_some());
        let has_deviation = samples.any(|sample| sample.deviation != Deviation::default());
        let columns = |always, air, deviation| {
            let air = if has_air { air } else { "" };
            let deviation = if has_deviation { deviation } else { "" };
            format!("{always}{air}{deviation}\n")
        };
        let names = columns(
            "NAME, sx, sy, sz, vx, vy, vz, time",
            ", air_vx, air_vy, heading, airspeed",
            ", s_EW_std, s_NS_std, s_EN_std, sz_std, v_EW_std, v_NS_std, v_EN_std, vz_std",
        );
        let units = columns(
            "unitless, [m], [m], [m], [m/s], [m/s], [m/s], [s]",
            ", [m/s], [m/s], [deg], [m/s]",
            ", [m], [m], [m], [m], [m/s], [m/s], [m/s], [m/s]",
        );
        out.write_all(names.as_bytes())?;
        out.write_all(units.as_bytes())?;
        for track in &recording.aircraft {
            let name = plain(&track.name);
            for sample in &track.samples {
                let (p, v, t) = (sample.position_m, sample.velocity_mps, sample.time_s);
                write!(
                    out,
                    "{name}, {}, {}, {}, {}, {}, {}, {t}",
                    p.x, p.y, p.z, v.x, v.y, v.z
                )?;
                if has_air {
                    write_air(out, sample)?;
                }
                if has_deviation {
                    for value in sample.deviation.to_array() {
                        write!(out, ", {value}")?;
                    }
                }
                writeln!(out)?;
            }
        }
        Ok(())
    })
}

/// The velocity through the air, to the last digit and as other programs read it.
fn write_air(out: &mut impl Write, sample: &TrackSample) -> std::io::Result<()> {
    let Some(air_mps) = sample.air_mps else {
        return write!(out, ", -, -, -, -");
    };
    let (east, north) = (air_mps.x, air_mps.y);
    let heading_deg = compass_from_course_deg(libm::atan2(north, east));
    let airspeed_mps = libm::hypot(east, north);
    write!(out, ", {east}, {north}, {heading_deg}, {airspeed_mps}")
}

/// A text without the characters that mean something in the format.
fn plain(text: &str) -> String {
    text.replace([',', ';', '\n', '\r', '"', '#', '='], "_")
}
