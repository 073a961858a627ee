//! Futures happen as often as they say.

mod support;

use fga_belief::future::Spread;
use fga_belief::{Belief, FUTURES, Futures};
use fga_proof::Vec3;
use fga_proof::situation::MovementBounds;
use support::{Draw, Moment, Motion, Sight, flown};

/// The chance that the aircraft comes within a distance of a place between two times, by its futures.
fn said(futures: &Futures, place: Vec3, (radius_m, half_m): (f32, f32), seconds: u8) -> f32 {
    let off = futures.origin_m - place;
    #[expect(clippy::cast_possible_truncation, reason = "metres")]
    let [x, y, z] = [off.x as f32, off.y as f32, off.z as f32];
    let [beside_m2, above_m2] = futures.lasting_m2;
    let one = |future: fga_belief::Future| {
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        let (mut least_m, mut at_s) = (f32::INFINITY, 0.0);
        for quarter in 0..=4 * u16::from(seconds) {
            let time_s = 0.25 * f32::from(quarter);
            let [dx, dy, dz] = future.position_m(time_s);
            let away_m = (dx + x).hypot(dy + y);
            if away_m < least_m {
                (least_m, at_s) = (away_m, time_s);
            }
            let sigma_m = (future.beside.variance(time_s) + beside_m2).sqrt();
            if away_m < radius_m + 2.0 * sigma_m {
                (low, high) = (low.min(dz + z), high.max(dz + z));
            }
        }
        if low > high {
            return 0.0;
        }
        let within = |other_m: [f32; 2]| {
            let sigma_m = |spread: &Spread, lasting_m2: f32, other_m: f32| {
                (spread.variance(at_s) + lasting_m2 + other_m * other_m).sqrt()
            };
            let beside_m = sigma_m(&future.beside, beside_m2, other_m[0]);
            let above_m = sigma_m(&future.above, above_m2, other_m[1]);
            Futures::comes_within(least_m, least_m, radius_m, beside_m)
                * Futures::comes_within(low, high, half_m, above_m)
        };
        let otherwise = &futures.otherwise;
        let other = within(otherwise.off_m(at_s));
        future.weight * ((1.0 - otherwise.share) * within([0.0; 2]) + otherwise.share * other)
    };
    futures.each().map(one).sum()
}

fn happened(track: &[Moment], place: Vec3, (radius_m, half_m): (f32, f32)) -> bool {
    track.iter().step_by(10).any(|moment| {
        let off = moment.position_m - place;
        off.x.hypot(off.y) < f64::from(radius_m) && off.z.abs() < f64::from(half_m)
    })
}

/// Places near where the aircraft would be after half a minute if it went on, and how often it came there.
#[test]
fn what_is_said_is_what_happens() {
    let mut bins = [(0.0, 0.0, 0.0); 5];
    let sight = Sight {
        lasting_altitude_m: 19.4,
        ..Sight::of(30.0, 10)
    };
    for stream in 0..1500 {
        let mut draw = Draw::new(11, stream);
        let track = flown(Motion::Mixed, 110.0, &mut draw);
        let lasting = Vec3::new(0.0, 0.0, draw.gaussian() * 19.4);
        let mut belief: Option<Belief> = None;
        for moment in track.iter().step_by(10).take(46) {
            let mut report = sight.report(moment, &mut draw).unwrap();
            report.position_m += lasting;
            match &mut belief {
                Some(belief) => belief.update(&report),
                None => belief = Some(Belief::new(&report, &MovementBounds::CREWED)),
            }
        }
        let now = track[455];
        let futures = belief.unwrap().futures(now.time_s);
        for _ in 0..4 {
            let place = now.position_m
                + now.velocity_mps * draw.between(15.0, 40.0)
                + draw.vector(700.0, 60.0);
            let volume = (609.6, 76.2);
            let said = f64::from(said(&futures, place, volume, 60));
            let bin = [0.1, 0.3, 0.6, 0.85]
                .iter()
                .filter(|edge| said > **edge)
                .count();
            bins[bin].0 += 1.0;
            bins[bin].1 += said;
            bins[bin].2 += f64::from(happened(&track[455..1056], place, volume));
        }
    }
    for (count, said, happened) in bins {
        eprintln!(
            "{count}: said {:.3}, happened {:.3}",
            said / count,
            happened / count
        );
    }
    for (count, said, happened) in bins {
        let (said, happened) = (said / count, happened / count);
        // Places of one aircraft are alike: as if there were half as many.
        let error = (2.0 * said * (1.0 - said) / count).sqrt();
        assert!(
            (said - happened).abs() < 0.05 + 3.0 * error,
            "{said} {happened}"
        );
    }
}

/// A small aircraft that hovers may fly off: after 20 s a place 150 m beside it is within two σ of what it may do.
#[test]
fn what_hovers_may_fly_off() {
    let sight = Sight {
        velocity_mps: 0.3,
        ..Sight::of(2.0, 10)
    };
    let mut draw = Draw::new(4, 4);
    let mut truth = Moment {
        time_s: 0.0,
        position_m: Vec3::ZERO,
        velocity_mps: Vec3::ZERO,
    };
    let report = sight.report(&truth, &mut draw).unwrap();
    let mut belief = Belief::new(&report, &MovementBounds::SMALL_UAS);
    for second in 1..=30 {
        truth.time_s = f64::from(second);
        belief.update(&sight.report(&truth, &mut draw).unwrap());
    }
    let [beside_m, _] = belief.futures(30.0).otherwise.off_m(20.0);
    assert!(beside_m > 75.0, "{beside_m}");
}

#[test]
fn weights_add_up_and_the_same_belief_has_the_same_futures() {
    let mut draw = Draw::new(2, 2);
    let track = flown(Motion::Mixed, 60.0, &mut draw);
    let sight = Sight::of(10.0, 10);
    let mut belief = Belief::new(
        &sight.report(&track[0], &mut draw).unwrap(),
        &MovementBounds::CREWED,
    );
    for moment in track.iter().step_by(10).skip(1) {
        belief.update(&sight.report(moment, &mut draw).unwrap());
    }
    let futures = belief.futures(60.0);
    assert_eq!(futures, belief.futures(60.0));
    assert_eq!(futures.each().count(), FUTURES);
    let sum: f32 = futures.each().map(|future| future.weight).sum();
    assert!((sum - 1.0).abs() < 1e-5);
    // Where they begin is where the belief is.
    let estimate = belief.at(60.0);
    let drawn = futures.each();
    let drawn = drawn.map(|future| (future.position_m(0.0), future.weight));
    let mean = drawn.fold([0.0; 3], |sum, (at, weight)| {
        [0, 1, 2].map(|k| sum[k] + at[k] * weight)
    });
    let mean = futures.origin_m + Vec3::from(mean.map(f64::from));
    assert!(
        mean.distance(estimate.position_m) < 2.0,
        "{mean} {estimate:?}"
    );
}

/// Bounds that make no sense give futures that make none; they end no program.
#[test]
fn no_bounds_end_a_program() {
    let mut draw = Draw::new(3, 3);
    let track = flown(Motion::Mixed, 20.0, &mut draw);
    let sight = Sight::of(10.0, 10);
    for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 0.0, 1e300] {
        let bounds = MovementBounds {
            turn_rate_radps: odd,
            brief_turn_rate_radps: odd,
            turn_rad: odd,
            climb_change_mps: odd,
            acceleration_mps2: odd,
        };
        let report = sight.report(&track[0], &mut draw).unwrap();
        let mut belief = Belief::new(&report, &bounds);
        for moment in track.iter().step_by(10).skip(1) {
            belief.update(&sight.report(moment, &mut draw).unwrap());
        }
        assert_eq!(belief.futures(20.0).each().count(), FUTURES);
    }
}

/// Where recorded aircraft are after some seconds, by the quantiles of what was said along their way, across it and above: 2 of 100 lie beyond
/// the outer ones.
#[test]
fn recorded_flights_are_where_their_futures_say() {
    let below = |off_m: f64, variance_m2: f32| {
        0.5 * libm::erfc(-off_m / f64::from(2.0 * variance_m2.max(1e-4)).sqrt())
    };
    for sigma_m in [5.0, 15.0, 40.0] {
        let sight = Sight::of(sigma_m, 10);
        let mut ranks = [5_u8, 10, 20, 30].map(|ahead_s| (ahead_s, [vec![], vec![], vec![]]));
        for (stream, track) in (0..).zip(support::recorded()) {
            let mut draw = Draw::new(17, stream);
            let mut belief: Option<Belief> = None;
            for (n, moment) in track.iter().enumerate().step_by(10) {
                let report = sight.report(moment, &mut draw).unwrap();
                let belief =
                    belief.get_or_insert_with(|| Belief::new(&report, &MovementBounds::CREWED));
                belief.update(&report);
                if n < 200 || n % 50 != 0 {
                    continue;
                }
                let futures = belief.futures(moment.time_s);
                let along = moment.velocity_mps.truncate().normalize();
                for (ahead_s, ranks) in &mut ranks {
                    let Some(later) = track.get(n + 10 * usize::from(*ahead_s)) else {
                        continue;
                    };
                    let mut said = [0.0; 3];
                    for future in futures.each() {
                        let at = future.position_m(f32::from(*ahead_s)).map(f64::from);
                        let off = later.position_m - futures.origin_m - Vec3::from(at);
                        let after_s = f32::from(*ahead_s);
                        let (share, other_m) =
                            (futures.otherwise.share, futures.otherwise.off_m(after_s));
                        for (share, [beside_m, above_m]) in
                            [(1.0 - share, [0.0; 2]), (share, other_m)]
                        {
                            let spread = |spread: &Spread, lasting_m2: f32, other_m: f32| {
                                spread.variance(after_s) + lasting_m2 + other_m * other_m
                            };
                            let [lasting_m2, above_m2] = futures.lasting_m2;
                            let beside_m2 = spread(&future.beside, lasting_m2, beside_m);
                            let above_m2 = spread(&future.above, above_m2, above_m);
                            let parts = [
                                below(along.dot(off.truncate()), beside_m2),
                                below(along.perp_dot(off.truncate()), beside_m2),
                                below(off.z, above_m2),
                            ];
                            for (said, part) in said.iter_mut().zip(parts) {
                                *said += f64::from(future.weight * share) * part;
                            }
                        }
                    }
                    for (ranks, said) in ranks.iter_mut().zip(said) {
                        ranks.push(said);
                    }
                }
            }
        }
        for (ahead_s, ranks) in &ranks {
            for (name, ranks) in ["along", "across", "above"].iter().zip(ranks) {
                let beyond = |edge: f64| {
                    let far = ranks
                        .iter()
                        .filter(|rank| (**rank - 0.5).abs() > 0.5 - edge);
                    far.count() as f64 / ranks.len() as f64
                };
                let shares = [0.01, 0.25].map(beyond);
                eprintln!("sigma {sigma_m} m, {ahead_s} s, {name}: {shares:.3?}");
                assert!(ranks.is_empty() || shares[0] < 0.04, "{name} {shares:?}");
            }
        }
    }
}

/// A report may say any speed: what it costs to look at the futures does not grow with it.
#[test]
fn a_future_has_few_chords_whatever_a_report_says() {
    for speed_mps in [0.0, 60.0, 1e4, 1e9, 1e15] {
        let report = fga_belief::Report {
            time_s: 0.0,
            position_m: Vec3::ZERO,
            velocity_mps: Some(Vec3::new(speed_mps, 0.0, 0.0)),
            carried_s: 0.0,
            errors: fga_belief::Errors::of_adsb(8, 1),
        };
        let belief = Belief::new(&report, &MovementBounds::SMALL_UAS);
        for future in belief.futures(1.0).each() {
            assert!(future.chords(60.0).count() <= 63, "{speed_mps}");
        }
    }
}
