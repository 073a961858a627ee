//! What a stress test tests.

use fga::situation::MovementBounds;
use fga_sim::policy::PolicyChoice;
use fga_sim::vehicle_file::VehicleModel;

use super::motion::{GUST, MOTION};

/// The most intruders.
pub const MOST_INTRUDERS: usize = 4;

/// What is tested.
#[derive(Debug, Clone)]
pub struct Stress {
    /// The aircraft.
    pub model: VehicleModel,
    /// The policy.
    pub policy: PolicyChoice,
    /// The bounds of the intruders, which the policy knows.
    pub bounds: MovementBounds,
    /// Intruders, 1 to [`MOST_INTRUDERS`].
    pub intruders: usize,
    /// Standard deviation of each component of a gust, metres per second; 0 for no gusts.
    pub gust_mps: f64,
    /// Flights, besides those that simplify failures.
    pub flights: usize,
    /// Master seed.
    pub seed: u64,
}

impl Stress {
    /// A test of a policy: one intruder, the gusts that the vehicle file knows of.
    pub fn of(model: VehicleModel, policy: PolicyChoice, bounds: MovementBounds) -> Self {
        Self {
            gust_mps: model.settings.avoider.drift_mps,
            model,
            policy,
            bounds,
            intruders: 1,
            flights: 2000,
            seed: 0,
        }
    }

    pub(super) fn has_gusts(&self) -> bool {
        self.gust_mps > 0.0
    }

    /// The parameters of a flight in their order: name, usual distribution. Those of a second intruder and on have its number.
    pub fn parameters(&self) -> Vec<(String, &'static str)> {
        let motions = (1..=self.intruders).flat_map(|number| {
            MOTION.iter().map(move |&(name, usually)| match number {
                1 => (name.to_owned(), usually),
                _ => (format!("{name}_{number}"), usually),
            })
        });
        let gust = GUST.iter().filter(|_| self.has_gusts());
        let gust = gust.map(|&(name, usually)| (name.to_owned(), usually));
        motions.chain(gust).collect()
    }

    pub(super) fn dimensions(&self) -> usize {
        let gust = if self.has_gusts() { GUST.len() } else { 0 };
        self.intruders * MOTION.len() + gust
    }
}
