//! The conflicts of a flight: each from the moment at which something threatens until the aircraft
//! is back on its mission.

use fga::avoider::State;

use super::DecisionLog;

/// One conflict. Times in seconds since the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Conflict {
    /// When something threatened.
    pub threat_s: f64,
    /// When the first maneuver began; `None` where the threat went away before.
    pub start_s: Option<f64>,
    /// When the last maneuver ended.
    pub clear_s: Option<f64>,
    /// When the aircraft was back on its mission; `None` where the flight ended before.
    pub rejoined_s: Option<f64>,
    /// Identifiers of the obstacles that were the most urgent threat, in that order.
    pub obstacles: Vec<u32>,
}

/// The conflicts that the decisions of a flight tell, in order of time.
pub(super) fn of(decisions: &[DecisionLog]) -> Vec<Conflict> {
    let mut conflicts: Vec<Conflict> = Vec::new();
    let mut last = State::Cruise;
    for moment in decisions {
        let (time_s, now) = (moment.time_s, moment.decision.state);
        let was_away = matches!(last, State::Avoiding | State::Recovering);
        let on_route = matches!(now, State::Cruise | State::Threatened);
        if let Some(conflict) = conflicts.last_mut() {
            if last == State::Avoiding && now != State::Avoiding {
                conflict.clear_s = Some(time_s);
            }
            if was_away && on_route {
                conflict.rejoined_s = Some(time_s);
            }
        }
        if now != State::Cruise && (last == State::Cruise || (was_away && on_route)) {
            conflicts.push(Conflict {
                threat_s: time_s,
                start_s: None,
                clear_s: None,
                rejoined_s: None,
                obstacles: Vec::new(),
            });
        }
        if now != State::Cruise
            && let Some(conflict) = conflicts.last_mut()
        {
            if now == State::Avoiding {
                conflict.start_s.get_or_insert(time_s);
                if last != State::Avoiding {
                    conflict.clear_s = None;
                }
            }
            if let Some(threat) = moment.decision.record.threat
                && !conflict.obstacles.contains(&threat.id)
            {
                conflict.obstacles.push(threat.id);
            }
        }
        last = now;
    }
    conflicts
}
