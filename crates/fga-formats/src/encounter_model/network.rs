//! A Bayesian network over binned variables, as counts.

/// A network: the dependencies and the count of each case.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Network {
    nodes: Vec<NetworkNode>,
    /// Every variable after its parents.
    order: Vec<usize>,
}

/// One variable.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NetworkNode {
    pub(super) bins: usize,
    /// Ascending.
    pub(super) parents: Vec<usize>,
    /// Counts; the variable's own bin varies fastest, then the parents' in ascending order; empty for a
    /// given variable.
    pub(super) counts: Vec<f64>,
}

impl Network {
    /// The network of these variables; `None` if a variable depends on itself.
    pub(super) fn new(nodes: Vec<NetworkNode>) -> Option<Self> {
        let mut order: Vec<usize> = Vec::with_capacity(nodes.len());
        while order.len() < nodes.len() {
            let next = nodes.iter().enumerate().find(|(index, node)| {
                !order.contains(index) && node.parents.iter().all(|parent| order.contains(parent))
            });
            order.push(next?.0);
        }
        Some(Self { nodes, order })
    }

    pub(super) fn order(&self) -> &[usize] {
        &self.order
    }

    /// Draws the bin of a variable given its parents' bins; `None` for a case without counts.
    pub(super) fn draw(
        &self,
        variable: usize,
        bins: &[usize],
        uniform: &mut impl FnMut() -> f64,
    ) -> Option<usize> {
        let node = self.nodes.get(variable)?;
        let mut first = 0;
        let mut stride = node.bins;
        for parent in &node.parents {
            first += bins.get(*parent)? * stride;
            stride *= self.nodes.get(*parent)?.bins;
        }
        let counts = node.counts.get(first..first + node.bins)?;
        let total: f64 = counts.iter().sum();
        if total <= 0.0 {
            return None;
        }
        let mut left = uniform() * total;
        let mut last = None;
        for (bin, count) in counts.iter().enumerate() {
            if *count > 0.0 {
                last = Some(bin);
                if left < *count {
                    break;
                }
                left -= count;
            }
        }
        last
    }
}
