//! The overview: well formed, deterministic, true to the flight, for runs of any size.

use crate::cases;
use crate::well_formed::assert_well_formed;
use fga_report::overview::{ClosestApproach, Overview};

#[test]
fn every_case_is_well_formed_and_the_same_twice() {
    for (name, overview) in cases::all() {
        let svg = overview.to_svg();
        assert_well_formed(name, &svg);
        assert_eq!(svg, overview.to_svg(), "{name}");
        assert!(svg.len() < 400_000, "{name}: {} bytes", svg.len());
    }
}

#[test]
fn names_are_escaped() {
    let svg = cases::encounter(55.0).to_svg();
    assert!(svg.contains("mast &lt;b&gt;&amp;"));
    assert!(!svg.contains("<b>"));
}

#[test]
fn a_lost_encounter_says_so() {
    assert!(cases::encounter(55.0).to_svg().contains("kept clear"));
    let svg = cases::encounter(20.0).to_svg();
    assert!(svg.contains("Protected volume of mast &lt;b&gt;&amp; entered by 1."));
}

#[test]
fn the_given_closest_approach_is_believed_over_the_samples() {
    let mut overview = cases::encounter(55.0);
    overview.obstacles[0].closest = Some(ClosestApproach {
        time_s: 9.25,
        separation_m: 29.5,
        margin_m: -0.5,
    });
    let svg = overview.to_svg();
    assert!(svg.contains("entered by 0.5 m at 9.2 s") || svg.contains("entered by 0.5 m at 9.3 s"));
}

#[test]
fn numbers_that_are_not_finite_are_left_out() {
    let mut overview = cases::encounter(55.0);
    let middle = overview.samples.len() / 2;
    overview.samples[middle].position_m.x = f64::NAN;
    overview.samples[middle + 1].position_m.z = f64::INFINITY;
    overview.obstacles[0].track[0].position_m.y = f64::NEG_INFINITY;
    overview.moments[0].time_s = f64::NAN;
    assert_well_formed("not finite", &overview.to_svg());
}

#[test]
fn an_obstacle_without_a_track_is_no_obstacle() {
    let mut overview = cases::encounter(55.0);
    for obstacle in &mut overview.obstacles {
        obstacle.track.clear();
    }
    assert!(overview.to_svg().contains("No obstacle."));
    assert!(Overview::default().to_svg().contains("No samples."));
}
