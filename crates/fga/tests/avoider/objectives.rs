//! The purpose of the objectives of section 3.3: less deviation, less path.

use fga::Vec3;
use fga::avoider::{Settings, Start, State};
use fga::search::Objective;

use crate::flight::{sphere, vehicle};
use crate::policies::{avoider, settings};

/// Largest distance from the mission and path beyond it, metres, past one crossing obstacle.
fn flown(objective: Objective, at_m: Vec3, velocity_mps: Vec3) -> (f64, f64) {
    let settings = Settings {
        objective,
        ..settings(Start::Free)
    };
    let mut flight = avoider(settings, vehicle());
    let mut obstacles = [sphere(1, at_m, velocity_mps, 30.0)];
    let mut largest_m = 0.0_f64;
    let mut acted = false;
    for _ in 0..900 {
        let state = flight.cycle(&mut obstacles).state;
        let at = flight.own.position_m;
        largest_m = largest_m.max(at.y.hypot(at.z));
        acted |= state == State::Avoiding;
        if acted && state == State::Cruise && at.y.hypot(at.z) < 0.1 {
            let extra_m = 15.0 * flight.time_s - at.x;
            return (largest_m, extra_m);
        }
    }
    panic!("never back from {at_m} {velocity_mps}");
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn each_objective_gives_less_of_what_it_is_for() {
    let objectives = [
        Objective::PaperCost,
        Objective::LeastDeviation,
        Objective::ShortestPath,
    ];
    let medians = objectives.map(|objective| {
        let flights = (0..24).map(|k| {
            let k = f64::from(k);
            let at = Vec3::new(150.0 + 4.0 * k, 12.0 - k, 0.8 * k - 9.0);
            flown(objective, at, Vec3::new(0.5 * k - 9.0, 0.0, 0.0))
        });
        let (deviations, extras) = flights.unzip();
        (median(deviations), median(extras))
    });
    let [paper, deviation, path] = medians;
    // The cheapest turn of the paper's cost is often the one with the least deviation.
    assert!(deviation.0 <= paper.0, "{medians:?}");
    assert!(path.1 < paper.1, "{medians:?}");
}
