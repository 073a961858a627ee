//! The intruders and the gust of a flight.

use fga_sim::plant::Gust;

use super::Stress;
use super::motion::{GUST, MOTION, StressMotion, gust_in_words, gust_of};

/// The intruders and the gust of a flight.
#[derive(Debug, Clone, PartialEq)]
pub struct StressCase {
    /// The motion of each intruder.
    pub motions: Vec<StressMotion>,
    /// The gust, where gusts are searched.
    pub gust: Option<Gust>,
}

impl StressCase {
    /// The case at a point of the standard normal distribution: the intruders' parameters, then the gust's.
    pub(super) fn of(point: &[f64], stress: &Stress) -> Self {
        // The gust's parameters are left over: a gust has fewer than a motion.
        let (motions, rest) = point.as_chunks::<{ MOTION.len() }>();
        let model = &stress.model;
        let of = |point| StressMotion::of(point, &stress.bounds, &model.vehicle, &model.protection);
        let gust = rest.first_chunk::<{ GUST.len() }>();
        Self {
            motions: motions.iter().map(of).collect(),
            gust: gust.map(|point| gust_of(point, stress.gust_mps)),
        }
    }

    /// The values of the parameters, in the order of [`Stress::parameters`].
    pub fn values(&self) -> impl Iterator<Item = f64> {
        let motions = self.motions.iter().flat_map(|motion| motion.values);
        motions.chain(self.gust.into_iter().flat_map(|gust| {
            let [x, y, z] = gust.velocity_mps.to_array();
            [gust.start_s, gust.duration_s, x, y, z]
        }))
    }

    /// In one sentence.
    pub fn in_words(&self) -> String {
        let mut words: Vec<String> = match &self.motions[..] {
            [one] => vec![one.in_words()],
            several => (1..)
                .zip(several)
                .map(|(number, motion)| format!("intruder {number} {}", motion.in_words()))
                .collect(),
        };
        let gust = self.gust.filter(|gust| gust.velocity_mps.length() > 0.0);
        words.extend(gust.as_ref().map(gust_in_words));
        words.join("; ")
    }
}
