//! Outgoing reports: texts, collision messages, values, and the decision log.

use fga::Vec3;
use fga::avoider::Decision;
use fga::situation::Obstacle;
use fga_formats::decision;
use mavlink::dialects::ardupilotmega::{
    COLLISION_DATA, HEARTBEAT_DATA, MavAutopilot, MavCollisionAction, MavCollisionSrc,
    MavCollisionThreatLevel, MavMessage, MavModeFlag, MavSeverity, MavState, MavType,
    NAMED_VALUE_FLOAT_DATA, STATUSTEXT_DATA,
};
use serde_json::Value;

use crate::authority::{Authority, Severity};
use crate::number::single;
use crate::ownship::OwnState;

/// Longest text of one message.
const LONGEST_TEXT: usize = 50;

/// A text for the operator's screen; cut to the length of one message.
pub fn text(severity: Severity, words: &str) -> MavMessage {
    let severity = match severity {
        Severity::Critical => MavSeverity::MAV_SEVERITY_CRITICAL,
        Severity::Warning => MavSeverity::MAV_SEVERITY_WARNING,
        Severity::Notice => MavSeverity::MAV_SEVERITY_NOTICE,
        Severity::Info => MavSeverity::MAV_SEVERITY_INFO,
    };
    let fitting: String = words
        .chars()
        .filter(char::is_ascii)
        .take(LONGEST_TEXT)
        .collect();
    MavMessage::STATUSTEXT(STATUSTEXT_DATA {
        severity,
        text: fitting.as_str().into(),
        ..STATUSTEXT_DATA::DEFAULT
    })
}

/// The heartbeat of a component that is no autopilot.
pub fn heartbeat(mavtype: MavType) -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        mavtype,
        autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
        base_mode: MavModeFlag::empty(),
        system_status: MavState::MAV_STATE_ACTIVE,
        mavlink_version: 3,
        ..HEARTBEAT_DATA::DEFAULT
    })
}

/// A named number; names have ten characters at most.
pub fn value(name: &str, value: f64, time_boot_ms: u32) -> MavMessage {
    MavMessage::NAMED_VALUE_FLOAT(NAMED_VALUE_FLOAT_DATA {
        time_boot_ms,
        value: single(value),
        name: name.into(),
    })
}

/// The `COLLISION` message about an obstacle: time of the closest approach, seconds, and where it is then, metres from the aircraft.
pub fn collision(
    id: u32,
    (closest_s, offset_m): (f64, Vec3),
    action: MavCollisionAction,
    is_urgent: bool,
) -> MavMessage {
    MavMessage::COLLISION(COLLISION_DATA {
        id,
        time_to_minimum_delta: single(closest_s),
        altitude_minimum_delta: single(offset_m.z.abs()),
        horizontal_minimum_delta: single(libm::hypot(offset_m.x, offset_m.y)),
        src: MavCollisionSrc::MAV_COLLISION_SRC_ADSB,
        action,
        threat_level: if is_urgent {
            MavCollisionThreatLevel::MAV_COLLISION_THREAT_LEVEL_HIGH
        } else {
            MavCollisionThreatLevel::MAV_COLLISION_THREAT_LEVEL_LOW
        },
    })
}

/// The `COLLISION` message for the threat of a decision.
pub fn collision_of(
    decision: &Decision,
    obstacles: &[Obstacle],
    own: &OwnState,
    engaged: bool,
    id: u32,
) -> Option<MavMessage> {
    let threat = decision.record.threat?;
    let obstacle = obstacles.iter().find(|obstacle| obstacle.id == threat.id)?;
    // Their positions on straight lines at the closest approach.
    let own_then_m = own.ownship.position_m + own.ground_velocity_mps * threat.closest_s;
    let offset_m = obstacle.position_after_m(threat.closest_s) - own_then_m;
    let mut stages = decision.command.stages().iter();
    let climbs = stages.any(|stage| stage.climb_rad.abs() > 0.02);
    let action = match (engaged, climbs) {
        (false, _) => MavCollisionAction::MAV_COLLISION_ACTION_REPORT,
        (true, true) => MavCollisionAction::MAV_COLLISION_ACTION_MOVE_PERPENDICULAR,
        (true, false) => MavCollisionAction::MAV_COLLISION_ACTION_MOVE_HORIZONTALLY,
    };
    let is_urgent = engaged || threat.entry_s < 15.0;
    Some(collision(
        id,
        (threat.closest_s, offset_m),
        action,
        is_urgent,
    ))
}

/// Three decimals: enough for a log.
fn round(value: &mut Value) {
    match value {
        Value::Number(number) if number.is_f64() => {
            let rounded = number.as_f64().map(|exact| (exact * 1e3).round() / 1e3);
            *value = rounded.into();
        }
        Value::Array(items) => items.iter_mut().for_each(round),
        Value::Object(fields) => fields.values_mut().for_each(round),
        _ => (),
    }
}

/// One line of the decision log.
pub fn decision_line(
    time_s: f64,
    decision: &Decision,
    own: &OwnState,
    authority: &Authority,
    above_ground_m: Option<f64>,
    names: impl Fn(u32) -> String,
) -> Value {
    let mut line = decision::to_json(decision, &own.ownship, names);
    line.insert("kind".into(), "decision".into());
    line.insert("t_s".into(), time_s.into());
    line.insert("authority".into(), authority.name().into());
    if let Some(above_ground_m) = above_ground_m {
        line.insert("above_ground_m".into(), above_ground_m.into());
    }
    let mut line = Value::Object(line);
    round(&mut line);
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_texts_are_cut_and_foreign_letters_left_out() {
        let MavMessage::STATUSTEXT(data) = text(Severity::Info, &"é".repeat(3)) else {
            panic!("another message")
        };
        assert_eq!(data.text.to_str().unwrap(), "");
        let MavMessage::STATUSTEXT(data) = text(Severity::Info, &"x".repeat(80)) else {
            panic!("another message")
        };
        assert_eq!(data.text.to_str().unwrap().len(), 50);
    }
}
