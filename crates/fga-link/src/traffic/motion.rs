//! Which velocity do an aircraft's reported positions show, and does the reported velocity contradict it?
//!
//! The reported velocity carries each position to the next one. Positions less the way flown by the reported
//! velocities stay in one place if both are right; a line through them that moves by more than the positions'
//! own scatter explains is a contradiction.

use fga::Vec3;

use super::report::AltitudeReference;

/// A motion is estimated over this time, seconds, or from the last two positions, and from this time on.
const SHOWN_OVER_S: f64 = 3.5;
const SHOWN_FROM_S: f64 = 0.5;
/// A contradiction is this many σ of the line.
const SIGMAS: f64 = 3.0;
/// Error of the time of a position, seconds: whole seconds are rounded, and a sender's clock may be off all the while. RTCA DO-242A
/// (3.4.3.3.2.2) allows a mean of 0.5 s, which is 0.3 s if it may be any up to that, beside a σ of 0.5 s.
pub(super) const TIME_S: f64 = 0.3;
/// Step of heights by satellites, metres: 25 ft.
const SATELLITE_STEP_M: f64 = 7.62;
/// Step of the coarsest encoders of pressure altitudes, metres: 100 ft. No message that is read says which encoder counted.
pub(crate) const COARSEST_STEP_M: f64 = 30.48;
/// σ of the climb of an aircraft whose altitudes show nothing of it yet, metres per second: 1,000 ft/min.
pub(super) const CLIMB_MPS: f64 = 5.08;
/// Error of the way between two reports in a turn, as a share of the change of velocity times the time between. A turn by
/// 100° makes 0.15: the chord is sin 50°/50° of the arc, the mean of the velocities cos 50° of the speed.
const TURN_SHARE: f64 = 0.15;

/// A reported position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ReportedPlace {
    /// Time of validity, seconds.
    pub valid_s: f64,
    /// Position, metres, local frame; the height above its datum.
    pub position_m: Vec3,
    /// The velocity reported with it, metres per second.
    pub velocity_mps: Vec3,
    /// Datum of the height.
    pub altitude: AltitudeReference,
}

/// The motion that positions show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ShownMotion {
    /// Metres per second.
    pub velocity_mps: Vec3,
    /// σ of the velocity along an axis, metres per second.
    pub sigma_mps: f64,
    /// σ of the positions along an axis, metres.
    position_m: f64,
}

/// The parts of a reported velocity that the positions contradict.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Contradictions {
    pub horizontal: bool,
    pub vertical: bool,
}

/// A straight line through places at times.
#[derive(Debug, Clone, Copy)]
struct StraightFit {
    slope_mps: Vec3,
    /// Σ (t − mean t)², s².
    squares_s2: f64,
    /// Mean square of the distances from the line along each axis, m².
    scatter_m2: Vec3,
}

/// The line of least squares; `None` for a single moment.
fn line(points: &(impl Iterator<Item = (f64, Vec3)> + Clone)) -> Option<StraightFit> {
    let (from_s, from_m) = points.clone().next()?;
    let (mut count, mut mean_s, mut mean_m) = (0.0, 0.0, Vec3::ZERO);
    for (at_s, at_m) in points.clone() {
        count += 1.0;
        mean_s += at_s - from_s;
        mean_m += at_m - from_m;
    }
    (mean_s, mean_m) = (mean_s / count, mean_m / count);
    let centred = || {
        points
            .clone()
            .map(|(s, m)| (s - from_s - mean_s, m - from_m - mean_m))
    };
    let (mut squares_s2, mut products) = (0.0, Vec3::ZERO);
    for (off_s, off_m) in centred() {
        squares_s2 += off_s * off_s;
        products += off_m * off_s;
    }
    let slope_mps = products / squares_s2;
    let mut scatter_m2 = Vec3::ZERO;
    for (off_s, off_m) in centred() {
        let off_m = off_m - slope_mps * off_s;
        scatter_m2 += off_m * off_m / count;
    }
    let usable = slope_mps.is_finite() && squares_s2 >= 0.5 * SHOWN_FROM_S * SHOWN_FROM_S;
    usable.then_some(StraightFit {
        slope_mps,
        squares_s2,
        scatter_m2,
    })
}

/// The newest of `places` within `over_s`, and at least two.
fn newest<P: Iterator<Item = ReportedPlace> + Clone>(
    places: P,
    over_s: f64,
) -> impl Iterator<Item = ReportedPlace> + Clone {
    let count = places.clone().count();
    let newest_s = places.clone().fold(f64::NEG_INFINITY, |newest_s, place| {
        place.valid_s.max(newest_s)
    });
    places
        .enumerate()
        .filter(move |(index, place)| index + 2 >= count || newest_s - place.valid_s <= over_s)
        .map(|(_, place)| place)
}

/// The motion that the newest places show, oldest first; `position_m` is σ of their horizontal position, metres.
pub(super) fn shown<P: Iterator<Item = ReportedPlace> + Clone>(
    places: impl Fn() -> P,
    position_m: f64,
) -> Option<ShownMotion> {
    let recent = newest(places(), SHOWN_OVER_S);
    let last = recent.clone().last()?;
    let level = line(
        &recent
            .clone()
            .map(|place| (place.valid_s, place.position_m)),
    )?;
    // Heights above different datums do not compare.
    let same = recent.filter(|place| place.altitude == last.altitude);
    let climb = line(&same.map(|place| (place.valid_s, place.position_m)));
    let scatter_m2 = level.scatter_m2.x.max(level.scatter_m2.y);
    let position_m = libm::sqrt((position_m * position_m).max(scatter_m2));
    let climb_mps = climb.map_or(0.0, |line| line.slope_mps.z);
    let velocity_mps = Vec3::new(level.slope_mps.x, level.slope_mps.y, climb_mps);
    (velocity_mps.length() < 1000.0).then_some(ShownMotion {
        velocity_mps,
        sigma_mps: position_m / libm::sqrt(level.squares_s2),
        position_m,
    })
}

/// The step in which altitudes count, metres; a whole step counts as σ, because the error lasts as long as the step does.
const fn step_m(altitude: AltitudeReference) -> f64 {
    match altitude {
        AltitudeReference::MeanSeaLevel | AltitudeReference::Ellipsoid => SATELLITE_STEP_M,
        // What is called geometric may be a pressure altitude.
        AltitudeReference::Pressure | AltitudeReference::Geometric | AltitudeReference::Unknown => {
            COARSEST_STEP_M
        }
    }
}

/// The climb that the altitudes of all places show, metres per second; nearer to level while few of them do.
pub(super) fn climb_mps<P: Iterator<Item = ReportedPlace> + Clone>(places: P) -> f64 {
    let altitude = places.clone().last().map(|last| last.altitude);
    let same = places.filter(|place| Some(place.altitude) == altitude);
    let line = line(&same.map(|place| (place.valid_s, place.position_m)));
    line.filter(|_| altitude != Some(AltitudeReference::Unknown))
        .map_or(0.0, |line| {
            let sigma_mps = altitude.map_or(0.0, step_m) / libm::sqrt(line.squares_s2);
            line.slope_mps.z / (1.0 + (sigma_mps / CLIMB_MPS) * (sigma_mps / CLIMB_MPS))
        })
}

/// The parts of the reported velocities that the places contradict, over the last seconds or over all of them.
pub(super) fn contradictions<P: Iterator<Item = ReportedPlace> + Clone>(
    places: impl Fn() -> P,
    shown: &ShownMotion,
) -> Contradictions {
    let mut found = Contradictions {
        horizontal: false,
        vertical: false,
    };
    let speed_mps = shown.velocity_mps.length();
    for over_s in [SHOWN_OVER_S, f64::INFINITY] {
        let recent = newest(places(), over_s);
        let Some(last) = recent.clone().last() else {
            break;
        };
        let turn_m = largest_turn_m(recent.clone());
        let left = left_over(recent.clone());
        if let Some(line) = line(&left.clone().map(|(place, m)| (place.valid_s, m))) {
            let scatter_m2 = line.scatter_m2.x.max(line.scatter_m2.y);
            let sigma_m = libm::hypot(shown.position_m, TIME_S * speed_mps).max(scatter_m2.sqrt());
            let off_mps = libm::hypot(line.slope_mps.x, line.slope_mps.y);
            found.horizontal |= line.exceeds(off_mps, sigma_m + turn_m);
        }
        let same = left.filter(|(place, _)| place.altitude == last.altitude);
        if let Some(line) = line(&same.map(|(place, m)| (place.valid_s, m)))
            && last.altitude != AltitudeReference::Unknown
        {
            let sigma_m = step_m(last.altitude).max(line.scatter_m2.z.sqrt());
            found.vertical |= line.exceeds(line.slope_mps.z.abs(), sigma_m);
        }
    }
    found
}

impl StraightFit {
    /// Whether positions that scatter by `sigma_m` cannot have a slope.
    fn exceeds(&self, slope_mps: f64, sigma_m: f64) -> bool {
        slope_mps > SIGMAS * sigma_m / libm::sqrt(self.squares_s2)
    }
}

/// Largest error of the way between two reports in a turn, metres.
fn largest_turn_m(places: impl Iterator<Item = ReportedPlace> + Clone) -> f64 {
    let pairs = places.clone().zip(places.skip(1));
    pairs
        .map(|(from, to)| {
            let turned_mps = from.velocity_mps.distance(to.velocity_mps);
            TURN_SHARE * turned_mps * (to.valid_s - from.valid_s).abs()
        })
        .fold(0.0, f64::max)
}

/// Each place less the way that the reported velocities lead until then.
fn left_over(
    places: impl Iterator<Item = ReportedPlace> + Clone,
) -> impl Iterator<Item = (ReportedPlace, Vec3)> + Clone {
    places.scan(None, |before: &mut Option<(ReportedPlace, Vec3)>, place| {
        let way_m = before.map_or(Vec3::ZERO, |(last, way_m)| {
            way_m + 0.5 * (last.velocity_mps + place.velocity_mps) * (place.valid_s - last.valid_s)
        });
        *before = Some((place, way_m));
        Some((place, place.position_m - way_m))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reports of a circle flown at this rate, with a claimed velocity each.
    fn circle(
        rate_radps: f64,
        interval_s: f64,
        count: u32,
        claim: impl Fn(Vec3) -> Vec3,
    ) -> Vec<ReportedPlace> {
        let speed_mps = 60.0;
        (0..count)
            .map(|n| {
                let valid_s = f64::from(n) * interval_s;
                let (sin, cos) = libm::sincos(rate_radps * valid_s);
                let position_m = if rate_radps == 0.0 {
                    Vec3::X * speed_mps * valid_s
                } else {
                    Vec3::new(sin, 1.0 - cos, 0.0) * (speed_mps / rate_radps)
                };
                ReportedPlace {
                    valid_s,
                    position_m,
                    velocity_mps: claim(Vec3::new(cos, sin, 0.0) * speed_mps),
                    altitude: AltitudeReference::Pressure,
                }
            })
            .collect()
    }

    fn found(places: &[ReportedPlace]) -> Contradictions {
        let iterate = || places.iter().copied();
        contradictions(iterate, &shown(iterate, 2.0).unwrap())
    }

    #[test]
    fn a_true_velocity_is_never_contradicted_in_any_turn() {
        for rate_degps in [0.0, 1.5, 3.0, 6.0, 12.0, 20.0] {
            for interval_s in [0.1, 0.5, 1.0, 2.0, 5.0] {
                for count in 2..12 {
                    let places = circle(f64::to_radians(rate_degps), interval_s, count, |v| v);
                    if f64::from(count - 1) * interval_s < SHOWN_FROM_S {
                        continue;
                    }
                    let found = found(&places);
                    assert!(
                        !found.horizontal && !found.vertical,
                        "{rate_degps} deg/s, {count} each {interval_s} s"
                    );
                }
            }
        }
    }

    /// Climbs of 0.1 to 10 m/s, seen in steps of the encoder from any height within a step.
    #[test]
    fn an_encoder_of_100_ft_contradicts_no_climb() {
        for climb_mps in [0.1, 0.5, 1.0, 1.5, 2.0, 5.0, 10.0] {
            for (count, interval_s) in [(24, 0.4), (10, 1.0), (5, 2.0)] {
                for phase in 0..31 {
                    let mut places = circle(0.0, interval_s, count, |v| v + Vec3::Z * climb_mps);
                    for place in &mut places {
                        let up_m = f64::from(phase) + climb_mps * place.valid_s;
                        place.position_m.z = (up_m / COARSEST_STEP_M).round() * COARSEST_STEP_M;
                    }
                    let found = found(&places);
                    assert!(
                        !found.vertical,
                        "{climb_mps} m/s, {count} reports from {phase} m"
                    );
                }
            }
        }
    }

    #[test]
    fn t2_a_velocity_wrong_by_sign_angle_or_unit_is_contradicted_within_two_seconds() {
        let claims: [fn(Vec3) -> Vec3; 6] = [
            |v| -v,
            |v| Vec3::new(-v.y, v.x, v.z),
            |v| v * 100.0,
            |v| v * 0.01,
            |v| v * 3.6,
            |v| v + Vec3::Z * 64.0,
        ];
        for (index, claim) in claims.into_iter().enumerate() {
            let found = found(&circle(0.0, 0.5, 5, claim));
            assert!(found.horizontal || found.vertical, "claim {index}");
        }
    }
}
