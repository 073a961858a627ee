//! Which manoeuvre, and when it begins.

use crate::avoider::{Candidate, Start, Verdict};
use crate::maneuver::Maneuver;
use crate::search::{Effort, Found, Proof, Search};

/// The result of a search.
#[derive(Default)]
pub(super) struct Choice {
    /// The manoeuvre in both forms, with its certificate.
    pub(super) chosen: Option<(Found, Maneuver, Proof)>,
    /// Latest start of a certified one, seconds from now, if searched.
    pub(super) latest_s: Option<f64>,
    /// The best one to the other side, if searched.
    pub(super) alternative: Option<Candidate>,
}

impl Choice {
    /// Before any search.
    pub(super) const NONE: Self = Self {
        chosen: None,
        latest_s: None,
        alternative: None,
    };

    pub(super) const fn is_certified(&self) -> bool {
        matches!(self.chosen, Some((_, _, Proof::Certified(_))))
    }
}

/// The manoeuvre and its start: certified if there is one, else, with `or_best`, the best available. After
/// searches that met the limit it begins with others.
pub(super) fn choose(
    search: &mut Search<'_>,
    start: Start,
    (entry_s, period_s): (f64, f64),
    (cut, or_best): (u32, bool),
) -> Choice {
    let (mut latest_s, mut other) = (None, None);
    let found = match start {
        Start::AtDetection => search.cheapest(0.0),
        Start::Free => {
            let [found, other_side] = search.least_departure(entry_s);
            other = other_side;
            found
        }
        Start::Latest | Start::Score(_) => {
            let score = if let Start::Score(score) = start {
                score
            } else {
                1.0
            };
            latest_s = search.latest_start_s(entry_s);
            latest_s.and_then(|latest_s| {
                let mut wait_s = score * (latest_s - period_s).max(0.0);
                loop {
                    let found = search.cheapest(wait_s);
                    if found.is_some() || wait_s <= 0.0 {
                        return found;
                    }
                    wait_s = if wait_s > period_s { 0.8 * wait_s } else { 0.0 };
                }
            })
        }
    };
    let found = found
        .and_then(|found| search.proven(found))
        .or_else(|| or_best.then(|| search.best(None, Effort::WHOLE, cut))?);
    Choice {
        chosen: found.map(|(found, proof)| (found, as_maneuver(search, &found), proof)),
        latest_s,
        alternative: other.and_then(|other| {
            search.prove(&other)?;
            Some(Candidate {
                maneuver: as_maneuver(search, &other),
                margin_m: other.margin_m,
                cost: other.cost,
                verdict: Verdict::Certified,
            })
        }),
    }
}

pub(super) fn as_maneuver(search: &Search<'_>, found: &Found) -> Maneuver {
    search.maneuver(&found.turns, &search.departure(found.turns.wait_s))
}
