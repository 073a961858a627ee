//! A belief is as good as it says.

mod support;

use fga_belief::{Belief, Estimate, Report};
use fga_proof::Vec3;
use fga_proof::situation::MovementBounds;
use support::{Draw, Moment, Motion, Sight, flown};

/// Squared errors in units of their variances: position, velocity, climb rate, altitude; and how often.
#[derive(Debug, Default, Clone, Copy)]
struct Squares {
    sums: [f64; 4],
    count: f64,
}

impl Squares {
    fn note(&mut self, estimate: &Estimate, truth: &Moment) {
        let off = estimate.position_m - truth.position_m;
        let off_mps = estimate.velocity_mps - truth.velocity_mps;
        let flat = |v: Vec3| 0.5 * (v.x * v.x + v.y * v.y);
        let [p, v] = estimate.horizontal_variance;
        let [z, w] = estimate.vertical_variance;
        let now = [
            flat(off) / p,
            flat(off_mps) / v,
            off_mps.z * off_mps.z / w,
            off.z * off.z / z,
        ];
        for (sum, now) in self.sums.iter_mut().zip(now) {
            *sum += now;
        }
        self.count += 1.0;
    }

    fn means(&self) -> [f64; 4] {
        self.sums.map(|sum| sum / self.count)
    }
}

/// Errors on tracks of a moment each 0.1 s, from the fifth second on, each half second.
fn squares(tracks: &[Vec<Moment>], sight: &Sight, seed: u64) -> Squares {
    let mut squares = Squares::default();
    for (track, stream) in tracks.iter().zip(0..) {
        let mut draw = Draw::new(seed, stream);
        let mut belief: Option<Belief> = None;
        for (step, truth) in track.iter().enumerate() {
            if step % sight.every == 0
                && let Some(report) = sight.report(truth, &mut draw)
            {
                match &mut belief {
                    Some(belief) => belief.update(&report),
                    None => belief = Some(Belief::new(&report, &MovementBounds::CREWED)),
                }
            }
            if step >= 50
                && step % 5 == 0
                && let Some(belief) = &belief
            {
                squares.note(&belief.at(truth.time_s), truth);
            }
        }
    }
    squares
}

/// Some aircraft, each for two minutes.
fn drawn(motion: Motion) -> Vec<Vec<Moment>> {
    (0..40)
        .map(|stream| flown(motion, 120.0, &mut Draw::new(3, stream)))
        .collect()
}

/// Squared errors over said variances, on average: of position, velocity, climb rate, altitude.
fn judged(name: &str, tracks: &[Vec<Moment>], least: [f64; 4], most: f64) {
    for every in [1, 10] {
        for (sigma_m, arriving) in [(1.0, 1.0), (5.0, 0.7), (15.0, 1.0), (40.0, 0.7)] {
            let sight = Sight {
                arriving,
                ..Sight::of(sigma_m, every)
            };
            let means = squares(tracks, &sight, 3).means();
            eprintln!("{name}, {every}/10 s, {sigma_m} m, {arriving}: {means:.2?}");
            for (mean, least) in means.iter().zip(least) {
                assert!((least..=most).contains(mean), "{name}: {means:?}");
            }
        }
    }
}

/// Turns, climbs, level-offs and speed changes at random, which the filter does not know.
#[test]
fn what_manoeuvres_is_as_far_off_as_the_belief_says() {
    judged("mixed", &drawn(Motion::Mixed), [0.8, 0.65, 0.6, 0.8], 1.3);
}

/// The flights that the National Research Council of Canada recorded.
#[test]
fn what_was_flown_is_as_far_off_as_the_belief_says() {
    let tracks: Vec<_> = support::recorded().into_iter().step_by(4).collect();
    if !tracks.is_empty() {
        judged("recorded", &tracks, [0.8, 0.8, 0.7, 0.8], 1.3);
    }
}

/// A turn that does not end, and flight that stays straight, are better known than the belief says: it allows for an end, or a
/// turn, that does not come.
#[test]
fn what_stays_as_it_is_is_no_farther_off_than_the_belief_says() {
    judged(
        "turning",
        &drawn(Motion::Turning),
        [0.8, 0.6, 0.2, 0.8],
        1.3,
    );
    judged(
        "straight",
        &drawn(Motion::Straight),
        [0.75, 0.3, 0.2, 0.8],
        1.3,
    );
}

/// A position that the sender has carried on is off by what its velocity is off, for two seconds.
#[test]
fn what_was_carried_on_is_as_far_off_as_the_belief_says() {
    let tracks = drawn(Motion::Mixed);
    for (position_m, velocity_mps) in [(1.2, 1.2), (1.2, 4.1), (37.8, 4.1)] {
        let sight = Sight {
            altitude_m: 2.2,
            velocity_mps,
            carried_s: 2.0,
            ..Sight::of(position_m, 10)
        };
        let means = squares(&tracks, &sight, 3).means();
        eprintln!("carried on, {position_m} m, {velocity_mps} m/s: {means:.2?}");
        assert!(means.iter().all(|mean| *mean < 1.3), "{means:?}");
    }
}

/// A small aircraft hovers, and gains 15 m/s in five seconds.
#[test]
fn what_hovers_and_flies_off_is_followed() {
    let sight = Sight {
        velocity_mps: 1.0,
        ..Sight::of(2.0, 10)
    };
    let mut squares = Squares::default();
    for stream in 0..40 {
        let mut draw = Draw::new(7, stream);
        let mut belief: Option<Belief> = None;
        for second in 0..40 {
            let time_s = f64::from(second);
            let faster_s = (time_s - 30.0).clamp(0.0, 5.0);
            let later_s = (time_s - 35.0).max(0.0);
            let off_m = 1.5 * faster_s * faster_s + 15.0 * later_s;
            let truth = Moment {
                time_s,
                position_m: Vec3::new(off_m, 0.0, 100.0),
                velocity_mps: Vec3::new(3.0 * faster_s, 0.0, 0.0),
            };
            let report = sight.report(&truth, &mut draw).unwrap();
            match &mut belief {
                Some(belief) => belief.update(&report),
                None => belief = Some(Belief::new(&report, &MovementBounds::SMALL_UAS)),
            }
            if second > 30 {
                squares.note(&belief.unwrap().at(time_s), &truth);
            }
        }
    }
    let means = squares.means();
    eprintln!("flies off: {means:.2?}");
    assert!(means.iter().all(|mean| *mean < 3.0), "{means:?}");
}

/// One report in fifty is a kilometre off.
#[test]
fn false_reports_hardly_matter() {
    let tracks = drawn(Motion::Mixed);
    let sight = Sight {
        is_false: 0.02,
        ..Sight::of(10.0, 10)
    };
    let means = squares(&tracks, &sight, 3).means();
    eprintln!("one in fifty false: {means:.2?}");
    assert!(means.iter().all(|mean| *mean < 1.5), "{means:?}");
}

/// From a second report elsewhere on, the belief is there.
#[test]
fn an_aircraft_that_jumps_is_followed_at_its_second_report() {
    let sight = Sight::of(10.0, 10);
    let mut draw = Draw::new(1, 1);
    let track = flown(Motion::Straight, 40.0, &mut draw);
    let jump = Vec3::new(3000.0, 0.0, 0.0);
    let mut belief: Option<Belief> = None;
    for (step, moment) in track.iter().enumerate().step_by(10) {
        let mut truth = *moment;
        truth.position_m += jump * f64::from(step >= 200);
        let report = sight.report(&truth, &mut draw).unwrap();
        match &mut belief {
            Some(belief) => belief.update(&report),
            None => belief = Some(Belief::new(&report, &MovementBounds::CREWED)),
        }
        let off_m = belief
            .unwrap()
            .at(truth.time_s)
            .position_m
            .distance(truth.position_m);
        assert!(step == 200 || off_m < 60.0, "{step}: {off_m}");
    }
}

/// Reports without velocities, three seconds apart.
#[test]
fn velocities_follow_from_positions() {
    let sight = Sight::of(5.0, 30);
    let mut off_mps = 0.0;
    for stream in 0..20 {
        let mut draw = Draw::new(5, stream);
        let track = flown(Motion::Straight, 40.0, &mut draw);
        let mut belief: Option<Belief> = None;
        for moment in track.iter().step_by(30) {
            let report = Report {
                velocity_mps: None,
                ..sight.report(moment, &mut draw).unwrap()
            };
            match &mut belief {
                Some(belief) => belief.update(&report),
                None => belief = Some(Belief::new(&report, &MovementBounds::CREWED)),
            }
        }
        let last = track[390];
        let velocity_mps = belief.unwrap().at(last.time_s).velocity_mps;
        off_mps += velocity_mps.distance(last.velocity_mps) / 20.0;
    }
    assert!(off_mps < 1.5, "{off_mps}");
}

/// Not a number, late, or twice: nothing changes. Sixteen beliefs are within 12 kB.
#[test]
fn what_is_no_report_changes_nothing() {
    assert!(
        16 * size_of::<Belief>() <= 12_000,
        "{}",
        size_of::<Belief>()
    );
    let sight = Sight::of(5.0, 10);
    let mut draw = Draw::new(5, 5);
    let track = flown(Motion::Straight, 10.0, &mut draw);
    let report = |moment: &Moment, draw: &mut Draw| sight.report(moment, draw).unwrap();
    let mut belief = Belief::new(&report(&track[50], &mut draw), &MovementBounds::CREWED);
    let before = belief;
    belief.update(&report(&track[50], &mut draw));
    belief.update(&report(&track[10], &mut draw));
    let mut nan = report(&track[60], &mut draw);
    nan.position_m.x = f64::NAN;
    belief.update(&nan);
    assert_eq!(belief, before);
    belief.update(&report(&track[60], &mut draw));
    assert_ne!(belief, before);
}
