//! The policy `belief`: what it says happens.

use std::path::Path;

use fga::avoider::belief::BeliefAvoider;
use fga::avoider::{Decision, State};
use fga::pilot::Pilot;
use fga::situation::Situation;
use fga::vehicle::Vehicle;
use fga_campaign::campaign::{Campaign, FlownPath, file, metrics_of};
use fga_sim::engine::Engine;
use fga_sim::policy::PolicyChoice;

use crate::data::data;

/// A pilot that notes the chances of a loss when it first leaves the mission: on the mission, and as it flies.
struct Noting {
    pilot: BeliefAvoider,
    first: Option<[f64; 2]>,
}

impl Pilot for Noting {
    fn step(&mut self, situation: &Situation<'_>) -> Decision {
        let decision = self.pilot.step(situation);
        let record = &decision.record;
        if let (State::Avoiding, Some(hold), Some(flies)) =
            (decision.state, record.p_loss_hold, record.p_loss)
        {
            self.first.get_or_insert([hold, flies]);
        }
        decision
    }

    fn retune(&mut self, vehicle: &Vehicle) {
        self.pilot.retune(vehicle);
    }

    fn restart(&mut self) {
        self.pilot.restart();
    }
}

/// Said and happened, by bins of what was said for the mission when the aircraft left it.
#[test]
fn a_belief_says_what_happens() {
    let Some(model) = data("encounter-models/uncor_1200only_fwse_v1p2.txt") else {
        return;
    };
    let count = (std::env::var("ENCOUNTERS").ok()).map_or(150, |count| count.parse().unwrap());
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let path = root.join("campaigns/low-altitude-adsb.toml");
    let overrides = file::Overrides {
        model: Some(model),
        ..Default::default()
    };
    let campaign = Campaign::new(file::read(&path, &overrides).unwrap(), &path).unwrap();
    let (mut engine, mut flown) = (Engine::new(), FlownPath::default());
    let mut bins = [[0.0; 3]; 6];
    let mut chosen = [0.0; 3];
    for number in 0..count {
        let drawn = campaign.draw(number).unwrap();
        let world = campaign.plan(number).unwrap().world;
        let world = PolicyChoice::Belief.sees(&world).unwrap();
        let settings = &world.settings;
        let pilot = BeliefAvoider::new(settings.avoider, world.vehicle, settings.errors).unwrap();
        let mut pilot = Noting { pilot, first: None };
        flown.clear();
        let outcome = engine.fly(&world, &mut pilot, &mut flown);
        let metrics = metrics_of(&world, &flown, &outcome).unwrap();
        let Some([hold, flies]) = pilot.first else {
            continue;
        };
        let note = |bin: &mut [f64; 3], said: f64, happened: bool| {
            let weight = drawn.weight;
            *bin = [
                bin[0] + weight,
                bin[1] + weight * said,
                bin[2] + weight * f64::from(happened),
            ];
        };
        let edges = [0.1, 0.3, 0.5, 0.7, 0.9];
        let bin = edges.iter().filter(|edge| hold > **edge).count();
        note(&mut bins[bin], hold, metrics.nominal_lowc.unwrap());
        note(&mut chosen, flies, metrics.lowc.unwrap());
    }
    for [weight, said, happened] in bins.iter().chain([&chosen]) {
        eprintln!(
            "{weight:.1}: said {:.3}, happened {:.3}",
            said / weight,
            happened / weight
        );
    }
    let [weight, said, happened] = bins.into_iter().fold([0.0; 3], |sum, bin| {
        [sum[0] + bin[0], sum[1] + bin[1], sum[2] + bin[2]]
    });
    let off = (said - happened) / weight;
    assert!(
        off.abs() < 0.12,
        "said {}, happened {}",
        said / weight,
        happened / weight
    );
}
