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
    let one = |future: &fga_belief::Future| {
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
        let sigma_m =
            |spread: &Spread, lasting_m2: f32| (spread.variance(at_s) + lasting_m2).sqrt();
        let (beside_m, above_m) = (
            sigma_m(&future.beside, beside_m2),
            sigma_m(&future.above, above_m2),
        );
        future.weight
            * Futures::comes_within(least_m, least_m, radius_m, beside_m)
            * Futures::comes_within(low, high, half_m, above_m)
    };
    futures.all.iter().map(one).sum()
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
    assert_eq!(futures.all.len(), FUTURES);
    let sum: f32 = futures.all.iter().map(|future| future.weight).sum();
    assert!((sum - 1.0).abs() < 1e-5);
    // Where they begin is where the belief is.
    let estimate = belief.at(60.0);
    let drawn = futures.all.iter().map(|future| future.position_m(0.0));
    let mean = drawn.fold([0.0; 3], |sum, at| [0, 1, 2].map(|k| sum[k] + at[k] / 32.0));
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
        assert_eq!(belief.futures(20.0).all.len(), FUTURES);
    }
}
