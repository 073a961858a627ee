//! The futures that a choice weighs, as they are logged.

use fga::Vec3;
use fga::avoider::belief::Beliefs;
use fga_belief::Belief;
use fga_choice::chooser::MOST_WEIGHED;

/// What an aircraft may do from a moment on.
#[derive(Debug, Clone, PartialEq)]
pub struct AircraftFutures {
    /// The obstacle's identifier.
    pub obstacle: u32,
    /// Its futures; their weights add up to one.
    pub ways: Vec<FutureWay>,
}

/// A future of an aircraft.
#[derive(Debug, Clone, PartialEq)]
pub struct FutureWay {
    /// Its weight.
    pub weight: f32,
    /// Its positions now and each 5 s up to a minute, metres.
    pub points_m: Vec<Vec3>,
}

impl AircraftFutures {
    /// Of the aircraft that are believed to be nearest to a place now, the nearest first.
    pub fn nearest(beliefs: &Beliefs, own_m: Vec3, time_s: f64) -> Vec<Self> {
        let away_m = |belief: &Belief| belief.at(time_s).position_m.distance(own_m);
        let mut around: Vec<_> = (beliefs.each())
            .map(|(id, _, belief)| (away_m(belief), id, belief))
            .collect();
        around.sort_by(|a, b| a.0.total_cmp(&b.0));
        let nearest = around.iter().take(MOST_WEIGHED);
        nearest
            .map(|(_, obstacle, belief)| Self {
                obstacle: *obstacle,
                ways: ways(belief, time_s),
            })
            .collect()
    }
}

fn ways(belief: &Belief, time_s: f64) -> Vec<FutureWay> {
    let futures = belief.futures(time_s);
    let points_s = || (0_u8..=60).step_by(5).map(f32::from);
    (futures.each())
        .map(|future| FutureWay {
            weight: future.weight,
            points_m: points_s()
                .map(|after_s| {
                    let off_m = future.position_m(after_s).map(f64::from);
                    futures.origin_m + Vec3::from_array(off_m)
                })
                .collect(),
        })
        .collect()
}
