//! Encounters drawn from models: the geometry at the closest approach, weights, limits.
#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use std::path::Path;

use fga::Vec3;
use fga_campaign::encounters::modeled::{ModelSource, OwnshipFlight, Pairing};
use fga_formats::daa::Recording;
use fga_formats::encounter_model::{self, EncounterModel};

/// An uncorrelated model without dependencies except of rates on themselves.
const UNCORRELATED: &str = include_str!("../models/uncorrelated.txt");

/// A correlated model without dependencies.
const CORRELATED: &str = include_str!("../models/correlated.txt");

fn model(text: &str) -> EncounterModel {
    encounter_model::parse(text, Path::new("m.txt")).unwrap()
}

fn source(text: &str, pairing: Pairing) -> ModelSource {
    ModelSource::new(model(text), pairing, 40.0, 7).unwrap()
}

/// Offset of the intruder and relative velocity in a second.
fn relative(recording: &Recording, second: usize) -> (Vec3, Vec3) {
    let [own, its] = [0, 1].map(|i: usize| recording.aircraft[i].samples[second]);
    (
        its.position_m - own.position_m,
        its.velocity_mps - own.velocity_mps,
    )
}

fn level(v: Vec3) -> Vec3 {
    Vec3::new(v.x, v.y, 0.0)
}

#[test]
fn the_closest_approach_is_where_it_was_put() {
    for (text, ownship) in [
        (UNCORRELATED, OwnshipFlight::Vehicle),
        (UNCORRELATED, OwnshipFlight::Model),
        (CORRELATED, OwnshipFlight::Vehicle),
    ] {
        let pairing = Pairing {
            ownship,
            cpa_s: 40,
            duration_s: 60,
            ..Pairing::default()
        };
        let [horizontal_m, vertical_m] = pairing.cylinder_m;
        let source = source(text, pairing);
        for number in 0..100 {
            let drawn = source.encounter(number).unwrap();
            let (offset_m, velocity_mps) = relative(&drawn.recording, 40);
            let (across_m, along_mps) = (level(offset_m), level(velocity_mps));
            assert!(
                across_m.dot(along_mps).abs()
                    < 1e-6 * (1.0 + across_m.length() * along_mps.length())
            );
            if text == UNCORRELATED {
                assert!(across_m.length() <= horizontal_m && offset_m.z.abs() <= vertical_m);
            }
            assert!(drawn.weight > 0.0 && drawn.weight.is_finite());
            for aircraft in &drawn.recording.aircraft {
                assert_eq!(aircraft.samples.len(), 61);
                assert!(aircraft.samples.iter().all(|s| s.position_m.z >= 0.0));
            }
            assert_eq!(drawn, source.encounter(number).unwrap());
        }
    }
}

#[test]
fn no_encounter_begins_with_its_loss() {
    // Slow pairs fly side by side for longer than the 12 s until they meet.
    let pairing = Pairing {
        ownship: OwnshipFlight::Model,
        cpa_s: 12,
        duration_s: 20,
        ..Pairing::default()
    };
    for text in [UNCORRELATED, CORRELATED] {
        let source = source(text, pairing.clone());
        for number in 0..500 {
            let drawn = source.encounter(number).unwrap();
            let (offset_m, _) = relative(&drawn.recording, 0);
            assert!(
                level(offset_m).length() >= 609.6 || offset_m.z.abs() >= 76.2,
                "{number}: {offset_m}"
            );
        }
    }
}

#[test]
fn a_correlated_pair_has_its_approach_angle_and_side() {
    let pairing = Pairing {
        cpa_s: 30,
        duration_s: 40,
        aimed_share: 0.0,
        ..Pairing::default()
    };
    let source = source(CORRELATED, pairing);
    let mut ahead = 0;
    for number in 0..300 {
        let drawn = source.encounter(number).unwrap();
        let [own, its] = [0, 1].map(|i: usize| drawn.recording.aircraft[i].samples[30]);
        // The model has approach angles of 90° to 180° only, clockwise.
        let (a, b) = (own.velocity_mps, its.velocity_mps);
        let clockwise = -libm::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y);
        assert!(
            (90.0..=180.0).contains(&clockwise.to_degrees()),
            "{clockwise}"
        );
        let offset_m = its.position_m - own.position_m;
        ahead += i32::from(level(offset_m).dot(level(a)) > 0.0);
        // 0 to 1 nmi and 0 to 1,000 ft.
        assert!(level(offset_m).length() <= 1852.0 + 1e-6 && offset_m.z.abs() <= 304.8 + 1e-6);
    }
    // The model has \chi 1 in three of four cases: 225 ± 7.5.
    assert!((187..=262).contains(&ahead), "{ahead}");
}

/// Weighted share of near misses and its standard deviation, and the mean weight.
fn near_misses(text: &str, aimed_share: f64, count: u64) -> (f64, f64, f64) {
    let pairing = Pairing {
        cpa_s: 20,
        duration_s: 30,
        cylinder_m: [800.0, 200.0],
        aimed_m: [300.0, 80.0],
        aimed_share,
        ..Pairing::default()
    };
    let source = source(text, pairing);
    let drawn: Vec<(f64, f64)> = (0..count)
        .map(|number| {
            let drawn = source.encounter(number).unwrap();
            let near = (0..=30).any(|second| {
                let (offset_m, _) = relative(&drawn.recording, second);
                level(offset_m).length() < 150.0 && offset_m.z.abs() < 50.0
            });
            (drawn.weight, f64::from(u8::from(near)))
        })
        .collect();
    let weight: f64 = drawn.iter().map(|(w, _)| w).sum();
    let share = drawn.iter().map(|(w, near)| w * near).sum::<f64>() / weight;
    let variance = drawn
        .iter()
        .map(|(w, near)| (w * (near - share)).powi(2))
        .sum::<f64>()
        / (weight * weight);
    (share, variance.sqrt(), weight / count as f64)
}

#[test]
fn weights_reproduce_the_uniform_result() {
    for (text, count) in [(UNCORRELATED, 6000), (CORRELATED, 6000)] {
        let (uniform, its_deviation, _) = near_misses(text, 0.0, count);
        let (aimed, deviation, weight) = near_misses(text, 0.7, count);
        let both = its_deviation.hypot(deviation);
        assert!(
            (uniform - aimed).abs() < 4.0 * both,
            "{uniform} {aimed} {both}"
        );
        // Weights are ratios of densities: their mean is 1, or near it where bends count.
        assert!((weight - 1.0).abs() < 0.1, "{weight}");
        // That is what it is for.
        assert!(
            deviation < 0.8 * its_deviation,
            "{deviation} {its_deviation}"
        );
    }
}

#[test]
fn limits_are_kept_or_said() {
    let pairing = Pairing {
        altitude_m: Some([300.0, 500.0]),
        intruder_speed_mps: Some([40.0, 50.0]),
        ..Pairing::default()
    };
    let source_within = source(UNCORRELATED, pairing);
    for number in 0..50 {
        let drawn = source_within.encounter(number).unwrap();
        let [own, its] = [0, 1].map(|i: usize| drawn.recording.aircraft[i].samples[90]);
        assert!((300.0..=500.0).contains(&own.position_m.z));
        assert!((40.0..=50.0).contains(&its.velocity_mps.length()));
    }
    let never = Pairing {
        cpa_s: 5,
        duration_s: 6,
        intruder_speed_mps: Some([400.0, 500.0]),
        ..Pairing::default()
    };
    let error = source(UNCORRELATED, never).encounter(0).unwrap_err();
    assert!(error.starts_with("none of 100000 draws suits"), "{error}");
    for (pairing, message) in [
        (
            Pairing {
                aimed_share: 1.0,
                ..Pairing::default()
            },
            "aimed_share is 1, expected 0 to 0.99",
        ),
        (
            Pairing {
                cpa_s: 120,
                ..Pairing::default()
            },
            "cpa_s is 120, expected 1 to 119",
        ),
        (
            Pairing {
                cylinder_m: [0.0, 1.0],
                ..Pairing::default()
            },
            "cylinder_m is [0.0, 1.0], expected two lengths above 0",
        ),
        (
            Pairing {
                altitude_m: Some([5.0, 5.0]),
                ..Pairing::default()
            },
            "altitude_m is [5.0, 5.0], expected [least, most]",
        ),
    ] {
        let error = ModelSource::new(model(UNCORRELATED), pairing, 40.0, 0).unwrap_err();
        assert!(error.starts_with(message), "{error}");
    }
    let neither = UNCORRELATED.replace("\"v\"", "\"u\"");
    let error = ModelSource::new(model(&neither), Pairing::default(), 40.0, 0).unwrap_err();
    assert!(
        error.starts_with("has variables neither of an uncorrelated model"),
        "{error}"
    );
}
