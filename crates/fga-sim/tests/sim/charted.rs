//! What stands on a chart is not widened by what a receiver sees badly.

use std::path::Path;

use fga_files::TomlText;
use fga_sim::policy::PolicyChoice;
use fga_sim::{run, scenario};

/// A mast of 40 m, 5 m beside the leg, and a receiver with 10 m of noise once a second.
const MAST: &str = "name = 'mast'\nduration_s = 120\n[mission]\nwaypoints_m = [[0, 0, 100], [1500, 0, 100]]\n\
    [noise]\nposition_m = 10\nvelocity_mps = 1\n[sensor]\nupdate_rate_hz = 1\nrange_m = 8000\n\
    [[obstacle]]\nname = 'mast'\nposition_m = [800, 5, 60]\nradius_m = 40\nhalf_height_m = 60\n";

#[test]
fn d7_a_mast_on_the_chart_is_passed_as_near_as_without_a_receiver() {
    let fly = |text: &str| {
        let plan = scenario::parse(TomlText::new(Path::new("mast.toml"), text), None).unwrap();
        run::fly(plan, &PolicyChoice::default(), &mut |_| ()).unwrap()
    };
    let still = MAST.to_owned() + "movement = 'still'\n";
    let quiet = still.replace("position_m = 10\nvelocity_mps = 1\n", "");
    let (noisy, quiet) = (fly(&still).outcome, fly(&quiet).outcome);
    assert_eq!(noisy, quiet);
    assert!(
        noisy.min_margin_m >= 0.0 && noisy.max_cross_track_m < 60.0,
        "{noisy:?}"
    );
    // An error of the chart widens it.
    let coarse = fly(&(still + "chart_error_m = 5\n")).outcome;
    assert!(coarse.min_margin_m >= 0.0, "{coarse:?}");
    assert!(
        coarse.max_cross_track_m > noisy.max_cross_track_m,
        "{coarse:?}"
    );
}
