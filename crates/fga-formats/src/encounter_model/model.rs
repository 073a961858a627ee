//! The networks of a model, and how a state is drawn from them.

use super::network::Network;

/// A model from [`read`](super::read()).
#[derive(Debug, Clone, PartialEq)]
pub struct EncounterModel {
    pub(super) variables: Vec<Variable>,
    pub(super) initial: Network,
    pub(super) transition: Network,
    /// For each variable of the next second: the present variable that it becomes.
    pub(super) becomes: Vec<usize>,
}

/// A variable of the initial network.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Its name in the file, such as `\dot h`.
    pub label: String,
    /// Number of bins.
    pub bins: usize,
    /// The bins' edges, one more than bins; `None` for a category.
    pub boundaries: Option<Vec<f64>>,
    /// Chance each second that the sampler draws a new value within the same bin.
    pub resample_per_s: f64,
}

/// The variables' values at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelState {
    /// The bin of each variable, from 0.
    pub(super) bins: Vec<usize>,
    pub(super) values: Vec<f64>,
}

impl ModelState {
    /// The bin of each variable, from 0, in the model's order.
    pub fn bins(&self) -> &[usize] {
        &self.bins
    }

    /// The value of each variable, in the model's order and units; categories count from 1.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

impl Variable {
    /// A value in a bin: uniform between its edges, 0 if it spans 0, its number for a category.
    fn value_in(&self, bin: usize, uniform: &mut impl FnMut() -> f64) -> f64 {
        let edges = self.boundaries.as_deref();
        match edges.and_then(|edges| Some((*edges.get(bin)?, *edges.get(bin + 1)?))) {
            Some((low, high)) if low < 0.0 && high > 0.0 => 0.0,
            Some((low, high)) => low + (high - low) * uniform(),
            None => (bin + 1) as f64,
        }
    }

    /// The bin of a value; values beyond the edges belong to the outermost bins.
    pub fn bin_of(&self, value: f64) -> usize {
        let inner = self
            .boundaries
            .as_deref()
            .and_then(|edges| edges.get(1..edges.len().saturating_sub(1)));
        inner.map_or_else(
            || {
                let last = self.bins.saturating_sub(1);
                (0..last)
                    .find(|bin| value <= (bin + 1) as f64)
                    .unwrap_or(last)
            },
            |inner| inner.partition_point(|edge| *edge <= value),
        )
    }
}

impl EncounterModel {
    /// The variables of the initial network, in the order of values.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// Which variable has this label.
    pub fn index_of(&self, label: &str) -> Option<usize> {
        self.variables.iter().position(|v| v.label == label)
    }

    /// Draws the state at the start. `uniform` gives independent numbers in [0, 1).
    pub fn start(&self, uniform: &mut impl FnMut() -> f64) -> ModelState {
        let mut bins = vec![0; self.variables.len()];
        for variable in self.initial.order() {
            let drawn = self.initial.draw(*variable, &bins, uniform);
            if let Some(bin) = bins.get_mut(*variable) {
                // A case without counts: any bin.
                *bin = drawn.unwrap_or_else(|| {
                    let count = self.variables.get(*variable).map_or(1, |v| v.bins);
                    let place = uniform() * count as f64;
                    (0..count)
                        .rev()
                        .find(|bin| *bin as f64 <= place)
                        .unwrap_or(0)
                });
            }
        }
        let values = self
            .variables
            .iter()
            .zip(&bins)
            .map(|(variable, bin)| variable.value_in(*bin, uniform))
            .collect();
        ModelState { bins, values }
    }

    /// Advances by a second: draws the rates of the next second from the present state.
    pub fn step(&self, state: &mut ModelState, uniform: &mut impl FnMut() -> f64) {
        let now = self.variables.len();
        let mut bins = state.bins.clone();
        // A case without counts keeps its bin.
        bins.extend(
            self.becomes
                .iter()
                .map(|of| state.bins.get(*of).copied().unwrap_or(0)),
        );
        for variable in self.transition.order() {
            if *variable < now {
                continue;
            }
            let drawn = self.transition.draw(*variable, &bins, uniform);
            if let (Some(bin), Some(drawn)) = (bins.get_mut(*variable), drawn) {
                *bin = drawn;
            }
        }
        for (of, bin) in self.becomes.iter().zip(bins.get(now..).unwrap_or_default()) {
            let (Some(variable), Some(old), Some(value)) = (
                self.variables.get(*of),
                state.bins.get_mut(*of),
                state.values.get_mut(*of),
            ) else {
                continue;
            };
            if *old != *bin || uniform() < variable.resample_per_s {
                *value = variable.value_in(*bin, uniform);
            }
            *old = *bin;
        }
    }

    /// Sets a variable that the flight itself changes, such as airspeed or altitude layer.
    pub fn set(&self, state: &mut ModelState, index: usize, value: f64) {
        if let (Some(variable), Some(bin), Some(old)) = (
            self.variables.get(index),
            state.bins.get_mut(index),
            state.values.get_mut(index),
        ) {
            *bin = variable.bin_of(value);
            *old = value;
        }
    }
}
