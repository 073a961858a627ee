//! Threat levels, the start for a safety score, and the order of many threats
//! (Table 2, §3.3, Eq. 57, 58, §6).

/// How likely a collision is and when to act (Table 2), most urgent first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ThreatLevel {
    /// `t_a` < 0: the time has passed; start immediately.
    Imminent,
    /// `t_a` = `t_c` = 0: the time is now; start at `t_c`.
    Critical,
    /// `t_0` < `t_a` < `t_c`: there is time; start depending on constraints.
    Likely,
}

impl ThreatLevel {
    /// Level of a threat by its critical time, seconds from now (Table 2).
    ///
    /// Times within half a decision period of zero count as now. `None` for a time that is not
    /// finite or a period that is negative.
    pub fn of(critical_s: f64, decision_period_s: f64) -> Option<Self> {
        let usable = critical_s.is_finite() && decision_period_s >= 0.0;
        let half_s = decision_period_s / 2.0;
        usable.then_some(if critical_s < -half_s {
            Self::Imminent
        } else if critical_s <= half_s {
            Self::Critical
        } else {
            Self::Likely
        })
    }
}

/// `t_a` = `C_s` `t_c`: the start of a policy with safety score `C_s`, seconds from now (§3.3).
///
/// 0 (passengers) begins at once, 1 (a natural barrier) at the critical time; a critical time that
/// has passed means at once. `None` for a score outside [0, 1] or a time that is not finite.
pub fn scored_start_s(safety_score: f64, critical_s: f64) -> Option<f64> {
    let usable = (0.0..=1.0).contains(&safety_score) && critical_s.is_finite();
    usable.then(|| safety_score * critical_s.max(0.0))
}

/// The overall critical time of many threats: their least one (Eq. 57; with the `t_k`,
/// Eq. 58). Times that are not a number do not count; `None` without any.
pub fn earliest_critical_s(critical_s: impl IntoIterator<Item = f64>) -> Option<f64> {
    critical_s
        .into_iter()
        .filter(|time| !time.is_nan())
        .reduce(f64::min)
}

/// A threat in the queue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Urgency {
    /// The obstacle's identifier.
    pub id: u32,
    /// Its critical time, seconds from now.
    pub critical_s: f64,
}

/// Puts the most urgent threat first (§6): by critical time, then by identifier.
pub fn order_by_urgency(threats: &mut [Urgency]) {
    threats.sort_unstable_by(|a, b| a.critical_s.total_cmp(&b.critical_s).then(a.id.cmp(&b.id)));
}

/// The first threats of an ordered queue that one manoeuvre must deal with, because each
/// becomes critical within `maneuver_s` of the previous one; later manoeuvres avoid the others, in
/// sequence (§6).
pub fn simultaneous(ordered: &[Urgency], maneuver_s: f64) -> &[Urgency] {
    let later = ordered
        .windows(2)
        .position(|pair| match pair {
            [one, next] => next.critical_s - one.critical_s > maneuver_s,
            _ => false,
        })
        .map_or(ordered.len(), |index| index + 1);
    ordered.get(..later).unwrap_or(ordered)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    #[test]
    fn levels_are_those_of_table_2() {
        assert_eq!(ThreatLevel::of(-0.2, 0.1), Some(ThreatLevel::Imminent));
        assert_eq!(ThreatLevel::of(0.0, 0.0), Some(ThreatLevel::Critical));
        assert_eq!(ThreatLevel::of(0.04, 0.1), Some(ThreatLevel::Critical));
        assert_eq!(ThreatLevel::of(3.0, 0.1), Some(ThreatLevel::Likely));
        assert_eq!(ThreatLevel::of(f64::NAN, 0.1), None);
        assert!(ThreatLevel::Imminent < ThreatLevel::Likely);
    }

    #[test]
    fn the_score_scales_the_start() {
        assert_eq!(scored_start_s(0.0, 12.0), Some(0.0));
        assert_eq!(scored_start_s(0.5, 12.0), Some(6.0));
        assert_eq!(scored_start_s(1.0, 12.0), Some(12.0));
        assert_eq!(scored_start_s(1.0, -3.0), Some(0.0));
        for bad in [-0.1, 1.1, f64::NAN] {
            assert_eq!(scored_start_s(bad, 12.0), None);
        }
        assert_eq!(scored_start_s(0.0, f64::INFINITY), None);
    }

    #[test]
    fn the_most_urgent_comes_first() {
        let threat = |id, critical_s| Urgency { id, critical_s };
        let mut queue = [
            threat(1, 9.0),
            threat(2, -1.0),
            threat(3, 2.0),
            threat(0, 2.0),
        ];
        order_by_urgency(&mut queue);
        assert_eq!(queue.map(|t| t.id), [2, 0, 3, 1]);
        assert_eq!(earliest_critical_s(queue.map(|t| t.critical_s)), Some(-1.0));
        assert_eq!(earliest_critical_s([f64::NAN]), None);
        assert_eq!(simultaneous(&queue, 4.0).len(), 3);
        assert_eq!(simultaneous(&queue, 10.0).len(), 4);
        assert_eq!(simultaneous(&queue, 1.0).len(), 1);
        assert_eq!(simultaneous(&[], 1.0).len(), 0);
    }

    proptest! {
        #[test]
        fn any_numbers_are_put_in_one_order(times in proptest::collection::vec(any::<f64>(), 0..20)) {
            let mut queue: Vec<Urgency> = (0..).zip(&times).map(|(id, t)| Urgency { id, critical_s: *t }).collect();
            let mut reversed: Vec<Urgency> = queue.iter().rev().copied().collect();
            order_by_urgency(&mut queue);
            order_by_urgency(&mut reversed);
            let ids = |q: &[Urgency]| q.iter().map(|t| t.id).collect::<Vec<_>>();
            prop_assert_eq!(ids(&queue), ids(&reversed));
        }
    }
}
