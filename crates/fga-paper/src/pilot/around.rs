//! The obstacles of one step for the paper's rules: known exactly, in the air mass.

use fga::avoider::MAX_TRACKED;
use fga::certificate::Hazard;
use fga::situation::{Obstacle, ObstacleKind, Situation};

/// The obstacles within the surveillance radius that the aircraft could meet within the horizon.
#[derive(Debug, Clone)]
pub(super) struct Around {
    hazards: [Hazard; MAX_TRACKED],
    kinds: [ObstacleKind; MAX_TRACKED],
    len: usize,
    seen: u32,
}

impl Around {
    pub(super) const fn new() -> Self {
        Self {
            hazards: [Hazard::NONE; MAX_TRACKED],
            kinds: [ObstacleKind::Unknown; MAX_TRACKED],
            len: 0,
            seen: 0,
        }
    }

    pub(super) fn clear(&mut self) {
        (self.len, self.seen) = (0, 0);
    }

    pub(super) fn hazards(&self) -> &[Hazard] {
        self.hazards.get(..self.len).unwrap_or(&[])
    }

    /// The hazards, each with the kind of its obstacle.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&Hazard, ObstacleKind)> {
        self.hazards().iter().zip(self.kinds)
    }

    /// Number of obstacles within the surveillance radius.
    pub(super) const fn seen(&self) -> u32 {
        self.seen
    }

    pub(super) fn load(
        &mut self,
        situation: &Situation<'_>,
        surveillance_radius_m: f64,
        horizon_s: f64,
    ) {
        self.clear();
        let own_m = situation.ownship.position_m;
        let squared_m2 = surveillance_radius_m * surveillance_radius_m;
        for obstacle in situation.obstacles.iter() {
            let beyond = (obstacle.position_m - own_m).length_squared() > squared_m2;
            if beyond || !obstacle.is_valid() {
                continue;
            }
            self.seen += 1;
            if !situation.is_out_of_reach(&obstacle, horizon_s) {
                self.keep(&obstacle, situation);
            }
        }
    }

    /// Keeps an obstacle; without room it replaces the farthest one.
    fn keep(&mut self, obstacle: &Obstacle, situation: &Situation<'_>) {
        let own_m = situation.ownship.position_m;
        let hazard = Hazard::new(obstacle, situation.wind_mps, 0.0);
        let mut place = self.len;
        if place >= MAX_TRACKED {
            let margin_m = |hazard: &Hazard| hazard.margin_m(own_m, 0.0);
            let farthest = self
                .hazards
                .iter()
                .enumerate()
                .max_by(|a, b| margin_m(a.1).total_cmp(&margin_m(b.1)));
            match farthest {
                Some((index, known)) if margin_m(known) > margin_m(&hazard) => place = index,
                _ => return,
            }
        } else {
            self.len += 1;
        }
        if let (Some(row), Some(kind)) = (self.hazards.get_mut(place), self.kinds.get_mut(place)) {
            (*row, *kind) = (hazard, obstacle.kind);
        }
    }
}
