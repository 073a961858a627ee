//! Encounters match their cell, and are the same every time.

use fga::Vec3;
use fga_campaign::encounters::{DrawnThreats, EncounterSource, Family, Range};

const RADIUS_M: f64 = 30.0;

/// Least distance in straight flight by sampling, metres.
fn straight_miss(position: Vec3, velocity: Vec3) -> f64 {
    (0..600_000)
        .map(|k| {
            let t = f64::from(k) * 1e-3;
            (position + (velocity - Vec3::new(15.0, 0.0, 0.0)) * t).length()
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn threats_come_closer_than_their_radius_and_bystanders_do_not() {
    for cell in [
        "threats:2:100-500:0,bystanders",
        "threats:2:100-500:0-15",
        "threats:3:300:45-60,bystanders",
        "threats:3:300:15-30,planar",
        "from-anywhere:3:100-500:0-60,bystanders",
    ] {
        let source = EncounterSource::parse(cell, 11).unwrap();
        let (Family::Threats(threats) | Family::FromAnywhere(threats)) = source.family else {
            panic!("a cell of threats");
        };
        let DrawnThreats {
            count,
            first_seen_m,
            speed_mps,
        } = threats;
        for number in 0..3 {
            let encounter = source.encounter(number).unwrap();
            for obstacle in &encounter.obstacles {
                let miss = straight_miss(obstacle.position_m, obstacle.velocity_mps);
                let is_threat = obstacle.id < count;
                assert_eq!(miss < RADIUS_M + 0.01, is_threat, "{cell} {number}: {miss}");
                if is_threat {
                    let within = |value: f64, Range(from, to): Range| {
                        value > from - 1e-6 && value < to + 1e-6
                    };
                    assert!(within(obstacle.position_m.length(), first_seen_m));
                    assert!(within(obstacle.velocity_mps.length(), speed_mps));
                }
                if source.planar {
                    assert_eq!(obstacle.position_m.z, 0.0);
                    assert_eq!(obstacle.velocity_mps.z, 0.0);
                }
            }
            if source.bystanders.is_some() {
                let share = f64::from(count) / encounter.obstacles.len() as f64;
                assert!((0.2..=0.3).contains(&share), "{share}");
            }
        }
    }
}

#[test]
fn an_encounter_does_not_depend_on_those_before_it() {
    for cell in [
        "threats:3:100-500:0-60",
        "stream:20",
        "wall-gap",
        "overtaking",
    ] {
        let source = EncounterSource::parse(cell, 5).unwrap();
        let forwards: Vec<_> = (0..4).map(|n| source.encounter(n).unwrap()).collect();
        let backwards: Vec<_> = (0..4).rev().map(|n| source.encounter(n).unwrap()).collect();
        assert!(forwards.iter().eq(backwards.iter().rev()));
        assert_ne!(forwards[0].obstacles, forwards[1].obstacles);
        let other = EncounterSource::parse(cell, 6).unwrap();
        assert_ne!(forwards[0], other.encounter(0).unwrap());
    }
}

#[test]
fn a_gap_is_wide_enough_and_a_wall_has_none() {
    for number in 0..50 {
        for (cell, gaps) in [("wall,planar", 0), ("wall-gap,planar", 1)] {
            let wall = EncounterSource::parse(cell, 2)
                .unwrap()
                .encounter(number)
                .unwrap();
            let wide = wall
                .obstacles
                .windows(2)
                .filter(|pair| (pair[1].position_m - pair[0].position_m).length() > 2.0 * RADIUS_M)
                .count();
            assert_eq!(wide, gaps);
        }
    }
}

#[test]
fn a_wrong_cell_names_the_expected_form() {
    for (cell, part) in [
        ("threats:3:300", "expected threats:COUNT:SEEN:SPEED"),
        ("threats:0:300:15", "from 1 to 1000"),
        ("threats:3:500-100:15", "expected FROM not above TO"),
        ("threats:3:far:15", "expected a number or FROM-TO"),
        ("wall,bystanders", "expected planar or bystanders"),
    ] {
        let message = EncounterSource::parse(cell, 0).unwrap_err();
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn a_cell_that_nothing_can_meet_says_so() {
    for cell in [
        "threats:1:5000:5",
        "threats:1:0:5",
        "threats:1:1e18:5",
        "threats:1:300:1e308",
        "from-anywhere:1:5000:5",
        "valley:1:5000:5",
        "head-on:0:5",
        "threats:1:20:0",
    ] {
        let message = EncounterSource::parse(cell, 0).unwrap().encounter(0);
        let message = message.unwrap_err();
        assert!(
            message.contains("expected other distances or speeds"),
            "{cell}: {message}"
        );
    }
}
