//! The conflicts of a flight: each from the first threat until the aircraft is back on its mission.

use fga::avoider::State;

use super::DecisionLog;
use crate::progress::progress_of;
use crate::world::World;

/// One conflict. Times in seconds since the start.
#[derive(Debug, Clone, PartialEq)]
pub struct RunConflict {
    /// First threat.
    pub threat_s: f64,
    /// Start of the first manoeuvre; `None` if the threat went away before.
    pub start_s: Option<f64>,
    /// End of the last manoeuvre.
    pub clear_s: Option<f64>,
    /// Return to the mission; `None` if the flight ended before.
    pub rejoined_s: Option<f64>,
    /// Identifiers of the most urgent threats, in order.
    pub obstacles: Vec<u32>,
}

/// The conflicts in the decisions of a flight, in time order. The aircraft is back once its track is.
pub(super) fn of(decisions: &[DecisionLog], world: &World) -> Vec<RunConflict> {
    let mut conflicts: Vec<RunConflict> = Vec::new();
    let mut last = State::Cruise;
    let mut progress = progress_of(world);
    for moment in decisions {
        let (time_s, now) = (moment.time_s, moment.decision.state);
        progress.follow(time_s, moment.ownship.position_m, None, || {
            moment.ownship.velocity_mps() + world.wind_mps
        });
        let was_away = last.is_away();
        let on_route = !now.is_away();
        if let Some(conflict) = conflicts.last_mut() {
            if last == State::Avoiding && now != State::Avoiding {
                conflict.clear_s = Some(time_s);
            }
            let is_waiting = conflict.clear_s.is_some() && conflict.rejoined_s.is_none();
            if on_route && is_waiting && progress.is_on_line() {
                conflict.rejoined_s = Some(time_s);
            }
        }
        if now != State::Cruise && (last == State::Cruise || (was_away && on_route)) {
            conflicts.push(RunConflict {
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
