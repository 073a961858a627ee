//! The height of an aircraft above the same datum as the vehicle.
//!
//! A pressure altitude counts from 1013.25 hPa, wherever that pressure is today: 302 m below the
//! sea at 1050 hPa, 540 m above at 950 hPa. The vehicle's own pressure shows that level here, and
//! pressures compare with pressures. Without it these two bound the level.
//!
//! "Geometric" is a label that senders give to heights above the sea, above the ellipsoid and, wrongly, to pressure
//! altitudes, also with an altimeter setting of their own. Nothing in a report shows which, so the bound contains all
//! four. Where more aircraft are near than a decision takes, the bound contains the datums alone.

use fga::situation::ProtectedVolume;

use super::motion::COARSEST_STEP_M;
use super::report::AltitudeReference;

/// Pressure of the reference level, hectopascals.
const STANDARD_HPA: f64 = 1013.25;
/// The standard atmosphere below 11 km: 288.15 K / 6.5 K/km, metres, and R·L/(g·M).
const SCALE_M: f64 = 44_330.77;
const EXPONENT: f64 = 0.190_263;
/// Possible pressures at sea level, hectopascals: `docs/fly-inputs.md` states them.
const QNH_HPA: [f64; 2] = [950.0, 1050.0];
/// Possible difference of two altimeters at one place, metres: a transponder's 75 ft, and half a step of the coarsest encoder.
const ALTIMETERS_M: f64 = 22.86 + 0.5 * COARSEST_STEP_M;
/// Share of a height by which air of a non-standard temperature misleads.
const TEMPERATURE: f64 = 0.1;
/// Validity of a comparison with the vehicle's pressure, seconds: the weather changes by at most 3 hPa in an hour.
const LIFETIME_S: f64 = 600.0;
/// Share of the difference between two comparisons that counts.
const SMOOTHING: f64 = 0.2;
/// Range of the geoid above the ellipsoid, metres.
const GEOID_M: [f64; 2] = [-107.0, 86.0];
/// A sender's altimeter setting may put its heights this far off, metres: 990 or 1036 hPa instead of the standard
/// pressure, as in ordinary weather.
const SETTING_M: f64 = 195.0;
/// An aircraft of unknown altitude may be this far above or below the vehicle, metres: more than any manoeuvre climbs.
const UNKNOWN_M: f64 = 1_000.0;

/// Altitude in the standard atmosphere, metres above 1013.25 hPa, where the pressure is
/// `pressure_hpa`, hectopascals; `None` outside of 100 to 1100 hPa.
pub fn pressure_altitude_m(pressure_hpa: f64) -> Option<f64> {
    (100.0..=1100.0)
        .contains(&pressure_hpa)
        .then(|| SCALE_M * (1.0 - libm::pow(pressure_hpa / STANDARD_HPA, EXPONENT)))
}

/// The difference between an altitude and the one above mean sea level, metres, and its possible error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shift {
    /// Subtracted, metres.
    pub by_m: f64,
    /// Largest error, metres.
    pub bound_m: f64,
}

/// The datums.
#[derive(Debug, Clone, Copy, Default)]
pub struct DatumLevels {
    /// Pressure altitude less altitude above mean sea level at the vehicle, metres; when, seconds.
    pressure: Option<(f64, f64)>,
    /// Height of the geoid above the ellipsoid at the vehicle, metres.
    geoid_m: Option<f64>,
}

impl DatumLevels {
    /// Takes the vehicle's static pressure, hectopascals, at its altitude above mean sea level.
    pub fn take_pressure(&mut self, pressure_hpa: f64, altitude_m: f64, now_s: f64) {
        let Some(pressure_m) = pressure_altitude_m(pressure_hpa) else {
            return;
        };
        let new_m = pressure_m - altitude_m;
        let [low_m, high_m] = pressure_range_m(altitude_m);
        // A sensor beyond any weather is broken.
        if !(low_m..=high_m).contains(&new_m) {
            return;
        }
        let kept = self.pressure.filter(|(_, at_s)| now_s - at_s < LIFETIME_S);
        let value_m = kept.map_or(new_m, |(old_m, _)| old_m + SMOOTHING * (new_m - old_m));
        self.pressure = Some((value_m, now_s));
    }

    /// Takes altitudes of one place above the ellipsoid and above mean sea level, metres.
    pub fn take_geoid(&mut self, ellipsoid_m: f64, sea_level_m: f64) {
        let geoid_m = ellipsoid_m - sea_level_m;
        if (GEOID_M[0]..=GEOID_M[1]).contains(&geoid_m) {
            self.geoid_m = Some(geoid_m);
        }
    }

    /// Whether the vehicle's pressure is known.
    pub fn knows_pressure(&self, now_s: f64) -> bool {
        self.pressure
            .is_some_and(|(_, at_s)| now_s - at_s < LIFETIME_S)
    }

    /// Whether the height of the geoid is known.
    pub const fn knows_geoid(&self) -> bool {
        self.geoid_m.is_some()
    }

    /// The shift of an altitude that is `above_m` metres above the vehicle.
    pub fn shift(
        &self,
        reference: AltitudeReference,
        altitude_m: f64,
        own_m: f64,
        now_s: f64,
    ) -> Shift {
        match reference {
            AltitudeReference::MeanSeaLevel => Shift {
                by_m: 0.0,
                bound_m: 0.0,
            },
            AltitudeReference::Ellipsoid => self
                .geoid_m
                .map_or(between(GEOID_M), |by_m| Shift { by_m, bound_m: 5.0 }),
            AltitudeReference::Unknown => Shift {
                by_m: altitude_m - own_m,
                bound_m: UNKNOWN_M,
            },
            AltitudeReference::Geometric => self.geometric(altitude_m, own_m, now_s),
            AltitudeReference::Pressure => {
                match self.pressure.filter(|(_, at_s)| now_s - at_s < LIFETIME_S) {
                    Some((by_m, _)) => Shift {
                        by_m,
                        bound_m: ALTIMETERS_M + TEMPERATURE * (altitude_m - by_m - own_m).abs(),
                    },
                    None => between(pressure_range_m(altitude_m)),
                }
            }
        }
    }

    /// The shift of a height that its sender calls geometric: from the sea, from any geoid, from the pressure level here, or
    /// from an altimeter with another setting. The vehicle's own pressure does not show that setting.
    fn geometric(&self, altitude_m: f64, own_m: f64, now_s: f64) -> Shift {
        let [datums_low_m, datums_high_m] = self.datums_m(altitude_m, own_m, now_s);
        between([datums_low_m.min(-SETTING_M), datums_high_m.max(SETTING_M)])
    }

    /// The same without other settings.
    pub(super) fn geometric_by_datums(&self, altitude_m: f64, own_m: f64, now_s: f64) -> Shift {
        between(self.datums_m(altitude_m, own_m, now_s))
    }

    /// The shifts of the sea, of any geoid and, where the vehicle's own pressure shows it, of the pressure level, metres.
    fn datums_m(&self, altitude_m: f64, own_m: f64, now_s: f64) -> [f64; 2] {
        let [low_m, high_m] = GEOID_M;
        if !self.knows_pressure(now_s) {
            return GEOID_M;
        }
        let pressure = self.shift(AltitudeReference::Pressure, altitude_m, own_m, now_s);
        [
            low_m.min(pressure.by_m - pressure.bound_m),
            high_m.max(pressure.by_m + pressure.bound_m),
        ]
    }
}

/// The shift that is anywhere in a range, metres.
fn between([low_m, high_m]: [f64; 2]) -> Shift {
    Shift {
        by_m: 0.5 * (low_m + high_m),
        bound_m: 0.5 * (high_m - low_m),
    }
}

/// Largest excess of a pressure altitude over the true one, metres, at an altitude.
fn pressure_range_m(altitude_m: f64) -> [f64; 2] {
    let at = |hpa| pressure_altitude_m(hpa).unwrap_or(0.0);
    let temperature_m = ALTIMETERS_M + TEMPERATURE * altitude_m.abs();
    let [lowest_hpa, highest_hpa] = QNH_HPA;
    [
        at(highest_hpa) - temperature_m,
        at(lowest_hpa) + temperature_m,
    ]
}

/// The volume that contains `volume` at every height within `bound_m` of its own.
pub fn taller(volume: &ProtectedVolume, bound_m: f64) -> ProtectedVolume {
    if bound_m <= 0.0 {
        return *volume;
    }
    ProtectedVolume::Cylinder {
        radius_m: volume.radius_m(),
        half_height_m: volume.half_height_m() + bound_m,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// U.S. Standard Atmosphere 1976, table I: geometric altitude and pressure.
    #[test]
    fn pressure_altitudes_are_those_of_the_standard_atmosphere() {
        for (altitude_m, hpa) in [(0.0, 1013.25), (1000.0, 898.76), (3000.0, 701.21)] {
            let computed_m = pressure_altitude_m(hpa).unwrap();
            // The table counts geometric metres: 3,000 of them are 2,998.6 geopotential ones.
            assert!((computed_m - altitude_m).abs() < 2.0, "{computed_m}");
        }
        assert_eq!(pressure_altitude_m(f64::NAN), None);
        assert_eq!(pressure_altitude_m(0.0), None);
    }

    #[test]
    fn pressure_compares_with_pressure() {
        let mut levels = DatumLevels::default();
        let unknown = levels.shift(AltitudeReference::Pressure, 100.0, 104.0, 0.0);
        assert!(unknown.by_m - unknown.bound_m < -300.0);
        assert!(unknown.by_m + unknown.bound_m > 540.0);
        // 990 hPa at the sea is a pressure altitude of 195.3 m.
        let pressure_hpa = 990.0 * libm::pow(1.0 - 104.0 / SCALE_M, 1.0 / EXPONENT);
        levels.take_pressure(pressure_hpa, 104.0, 1.0);
        let known = levels.shift(AltitudeReference::Pressure, 300.0, 104.0, 2.0);
        assert!((known.by_m - 195.0).abs() < 2.0, "{known:?}");
        // 75 ft, rounded to 100 ft.
        assert!((38.0..40.0).contains(&known.bound_m), "{known:?}");
        // A blocked port says nothing.
        levels.take_pressure(300.0, 104.0, 2.0);
        assert!(
            (levels
                .shift(AltitudeReference::Pressure, 300.0, 104.0, 2.0)
                .by_m
                - known.by_m)
                .abs()
                < 1e-9
        );
        assert!(
            levels
                .shift(AltitudeReference::Pressure, 300.0, 104.0, 700.0)
                .bound_m
                > 400.0
        );
    }

    /// Any geoid, and other settings of an altimeter: 190 m at 990 hPa, whatever the vehicle's own pressure is.
    #[test]
    fn t3_a_geometric_label_holds_for_every_level_that_it_may_mean() {
        let mut levels = DatumLevels::default();
        for sea_level_hpa in [None, Some(990.0), Some(1013.25), Some(1040.0)] {
            if let Some(hpa) = sea_level_hpa {
                let pressure_hpa = hpa * libm::pow(1.0 - 104.0 / SCALE_M, 1.0 / EXPONENT);
                levels = DatumLevels::default();
                levels.take_pressure(pressure_hpa, 104.0, 1.0);
            }
            let shift = levels.shift(AltitudeReference::Geometric, 300.0, 104.0, 2.0);
            for off_m in [0.0, -100.0, 80.0, 195.0, -195.0] {
                let contains = (off_m - shift.by_m).abs() <= shift.bound_m;
                assert!(contains, "{sea_level_hpa:?} hPa, {off_m} m: {shift:?}");
            }
        }
    }

    #[test]
    fn a_sphere_becomes_a_cylinder_that_holds_it_at_every_height() {
        let sphere = ProtectedVolume::Sphere { radius_m: 60.0 };
        let taller = taller(&sphere, 30.0);
        assert_eq!(taller.radius_m(), 60.0);
        assert_eq!(taller.half_height_m(), 90.0);
    }
}
