//! Fleets: several aircraft that meet, each straight and level, for encounters in which all fly the same policy.
//!
//! Three to six aircraft at 45 to 65 m/s, from any direction, pass a common point within 600 m across and 75 m in altitude, 75 to 105 s after
//! the start; the flights end at 180 s. None begins within the well-clear volume of another one (ASTM F3442). One row a second.

use fga::Vec3;
use fga_formats::daa::{Recording, Track, TrackSample};
use fga_formats::tally::Tally;

use super::{Random, Range};

/// Well clear of ASTM F3442: horizontally 2,000 ft, vertically 250 ft, metres.
const WELL_CLEAR_M: (f64, f64) = (609.6, 76.2);

/// Length of the flights, seconds.
const DURATION_S: u32 = 180;

/// Altitude of the common point, metres.
const ALTITUDE_M: f64 = 600.0;

/// Place at the start and velocity of an aircraft.
type FleetLine = (Vec3, Vec3);

/// The fleet with this number.
pub fn fleet(seed: u64, number: u64) -> Recording {
    let mut random = Random::new(seed, number);
    let count = random.count(3, 6) as usize;
    let mut lines: Vec<FleetLine> = Vec::new();
    while lines.len() < count {
        let line = one(&mut random);
        if lines.iter().all(|other| begin_well_clear(other, &line)) {
            lines.push(line);
        }
    }
    let track = |(place, (start_m, velocity_mps)): (usize, &FleetLine)| Track {
        name: format!("aircraft {}", place + 1),
        samples: (0..=DURATION_S)
            .map(|second| {
                let time_s = f64::from(second);
                TrackSample::new(time_s, *start_m + *velocity_mps * time_s, *velocity_mps)
            })
            .collect(),
    };
    Recording {
        aircraft: lines.iter().enumerate().map(track).collect(),
        frame: None,
        parameters: Vec::new(),
        tally: Tally::default(),
    }
}

fn one(random: &mut Random) -> FleetLine {
    let velocity_mps = random.direction(true) * random.within(Range(45.0, 65.0));
    let across_m = random.direction(true) * (600.0 * libm::sqrt(random.unit()));
    let up_m = Vec3::Z * (ALTITUDE_M + random.within(Range(-75.0, 75.0)));
    let passes_s = random.within(Range(75.0, 105.0));
    (across_m + up_m - velocity_mps * passes_s, velocity_mps)
}

fn begin_well_clear((a, _): &FleetLine, (b, _): &FleetLine) -> bool {
    let offset = *a - *b;
    libm::hypot(offset.x, offset.y) > WELL_CLEAR_M.0 || offset.z.abs() > WELL_CLEAR_M.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fleet_meets_begins_well_clear_and_is_the_same_again() {
        let mut counts = [0; 7];
        for number in 0..200 {
            let drawn = fleet(1, number);
            assert_eq!(drawn, fleet(1, number));
            counts[drawn.aircraft.len()] += 1;
            for (place, track) in drawn.aircraft.iter().enumerate() {
                let nearest = track.samples.iter().map(|row| row.position_m);
                let nearest_m = nearest.map(|at| libm::hypot(at.x, at.y));
                // Within 600 m, and half a second of flight.
                assert!(nearest_m.fold(f64::INFINITY, f64::min) < 600.0 + 33.0);
                for other in &drawn.aircraft[..place] {
                    let first = Recording::separation(&track.samples[0], &other.samples[0]);
                    assert!(first.horizontal_m > 609.6 || first.vertical_m > 76.2);
                }
            }
        }
        assert!(counts[3..].iter().all(|count| *count > 20), "{counts:?}");
        assert_ne!(fleet(1, 0), fleet(2, 0));
    }
}
