//! Which manoeuvre, and when it begins.

use crate::avoider::{Candidate, Start, Verdict};
use crate::maneuver::StageList;
use crate::search::{Found, Search};

/// Share of a wait after which no manoeuvre is certified that is tried next.
const SOONER: f64 = 0.8;

/// The cheapest certified manoeuvre of a start, up to the entry and by the decision period, seconds. Also the latest start of a
/// certified one, seconds from now, and the best one to the other side, where these are searched.
pub(super) fn choose(
    search: &mut Search<'_>,
    start: Start,
    (entry_s, period_s): (f64, f64),
    (latest_s, other): (&mut Option<f64>, &mut Option<(StageList<8>, Candidate)>),
) -> Option<Found> {
    let score = match start {
        Start::AtDetection => return search.cheapest(0.0),
        Start::Free => {
            let [found, beside] = search.least_departure(entry_s);
            show(search, beside, other);
            return found;
        }
        Start::Latest => 1.0,
        Start::Score(score) => score,
    };
    *latest_s = search.latest_start_s(entry_s);
    let mut wait_s = score * ((*latest_s)? - period_s).max(0.0);
    loop {
        let found = search.cheapest(wait_s);
        if found.is_some() || wait_s <= 0.0 {
            return found;
        }
        wait_s = if wait_s > period_s {
            SOONER * wait_s
        } else {
            0.0
        };
    }
}

/// Puts a manoeuvre on record if it is certified.
#[inline(never)]
fn show(
    search: &mut Search<'_>,
    found: Option<Found>,
    other: &mut Option<(StageList<8>, Candidate)>,
) {
    *other = None;
    let Some(found) = found.filter(|found| search.prove(found)) else {
        return;
    };
    if search.maneuver().certified().is_none() {
        return;
    }
    let worth = Candidate {
        margin_m: found.margin_m,
        cost: found.cost,
        verdict: Verdict::Certified,
    };
    let shown = search.maneuver().to();
    *other = shown.is_whole().then_some((shown, worth));
}

#[cfg(test)]
mod tests {
    use super::super::tests::{among, sphere};
    use super::*;
    use crate::avoider::demand::WANTED;
    use crate::maneuver::Maneuver;

    /// The wait of the manoeuvre that is chosen past a sphere 400 m ahead, and the latest start, seconds.
    fn wait_s(start: Start) -> (f64, Option<f64>) {
        among(&[sphere(1, (400.0, 5.0), (0.0, 0.0))], |avoider, _, now| {
            let demand = avoider.demand_of(WANTED);
            let (mut latest_s, mut other) = (None, None);
            let nominal = Maneuver::turn(0.0, 0.0, 0.0);
            let found = avoider.search(&nominal, now, &demand, |search| {
                choose(search, start, (18.0, 0.1), (&mut latest_s, &mut other))
            });
            assert_eq!(other.is_some(), start == Start::Free);
            (found.unwrap().turns.wait_s, latest_s)
        })
    }

    #[test]
    fn a_start_is_at_once_at_the_latest_moment_or_at_a_share_of_it() {
        assert_eq!(wait_s(Start::AtDetection), (0.0, None));
        let (latest_s, bound_s) = wait_s(Start::Latest);
        let bound_s = bound_s.unwrap();
        assert!(
            latest_s > 10.0 && latest_s <= bound_s - 0.1,
            "{latest_s} {bound_s}"
        );
        let (share_s, _) = wait_s(Start::Score(0.5));
        assert!((share_s - 0.5 * (bound_s - 0.1)).abs() < 1e-9, "{share_s}");
    }
}
