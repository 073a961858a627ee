//! Words in files and answers: a decision (the threat, the manoeuvre and the reason), counted things, and texts as CSV fields.

use fga::angle::wrap_pi;
use fga::avoider::{Candidate, Decision, Reason, Record, State};
use fga::command::{Command, Proof};
use fga::maneuver::Maneuver;
use fga::situation::Ownship;

/// The reason of a decision as a phrase.
pub const fn reason_words(reason: Reason) -> &'static str {
    key_and_words(reason).1
}

/// The reason of a decision as a key in files.
pub const fn reason_key(reason: Reason) -> &'static str {
    key_and_words(reason).0
}

const fn key_and_words(reason: Reason) -> (&'static str, &'static str) {
    match reason {
        Reason::Clear => ("clear", "nothing comes too close on the mission"),
        Reason::InvalidInput => (
            "invalid-input",
            "the input is not usable, course and climb angle are held",
        ),
        Reason::WaitingForStart => ("waiting-for-start", "a manoeuvre is known and begins later"),
        Reason::ManeuverChosen => ("maneuver-chosen", "a certified manoeuvre begins"),
        Reason::ManeuverKept => ("maneuver-kept", "the manoeuvre is kept"),
        Reason::ManeuverReplaced => ("maneuver-replaced", "another manoeuvre replaces it"),
        Reason::BestAvailable => (
            "best-available",
            "no manoeuvre is certified, the manoeuvre that keeps farthest away is flown",
        ),
        Reason::InsideVolume => (
            "inside-volume",
            "inside a protected volume or a zone, leaving it",
        ),
        Reason::RejoinChosen => ("rejoin-chosen", "a way back to the mission begins"),
        Reason::RejoinKept => ("rejoin-kept", "the way back is flown"),
        Reason::Rejoined => ("rejoined", "back on the mission"),
        Reason::MissionComplete => (
            "mission-complete",
            "the last waypoint was passed, course and altitude are held",
        ),
        Reason::WindTooStrong => (
            "wind-too-strong",
            "the wind is too strong to reach any waypoint ahead",
        ),
        Reason::WaypointGivenUp => (
            "waypoint-given-up",
            "the waypoint ahead cannot be reached: on to the next one",
        ),
    }
}

/// What is proven about a command, as a key in files: it keeps clear of everything, or leads out of what the aircraft is in.
pub const fn proof_key(command: &Command) -> Option<&'static str> {
    match command.proof() {
        Some(Proof::Certified(_)) => Some("certified"),
        Some(Proof::Leaving(_)) => Some("leaving"),
        None => None,
    }
}

/// The first turn and climb of a manoeuvre, such as "turn left 38° and climb 5°".
pub fn maneuver_words(maneuver: &Maneuver, ownship: &Ownship) -> String {
    let changed = |stage: &&fga::maneuver::Stage| {
        (stage.course_rad - ownship.course_rad).abs() > 1e-3
            || (stage.climb_rad - ownship.climb_rad).abs() > 1e-3
    };
    let Some(stage) = maneuver.stages().iter().find(changed) else {
        return "hold course and altitude".into();
    };
    let turn_rad = stage.course_rad - ownship.course_rad;
    let turn = if turn_rad.abs() > 1e-3 {
        // A turn of more than half a circle keeps its flown sense.
        let shown = if turn_rad.abs() <= core::f64::consts::TAU {
            turn_rad
        } else {
            wrap_pi(turn_rad)
        };
        let side = if shown > 0.0 { "left" } else { "right" };
        Some(format!("turn {side} {:.0}°", shown.abs().to_degrees()))
    } else {
        None
    };
    let climb_deg = stage.climb_rad.to_degrees();
    let climb = if (stage.climb_rad - ownship.climb_rad).abs() <= 1e-3 {
        None
    } else if climb_deg > 0.05 {
        Some(format!("climb at {climb_deg:.0}°"))
    } else if climb_deg < -0.05 {
        Some(format!("descend at {:.0}°", -climb_deg))
    } else {
        Some("level off".into())
    };
    let when = if stage.start_s > 0.05 {
        format!(" in {:.1} s", stage.start_s)
    } else {
        String::new()
    };
    let parts: Vec<String> = turn.into_iter().chain(climb).collect();
    format!("{}{when}", parts.join(" and "))
}

/// A decision as one line, such as "threat: N2 in 4.1 s, 12.0 m inside; latest safe start in 1.6 s;
/// turn left 38°, least margin 4.2 m".
pub fn decision_words(
    decision: &Decision,
    ownship: &Ownship,
    name_of: impl Fn(u32) -> String,
) -> String {
    let record = &decision.record;
    // A pilot that only waits has begun nothing.
    let has_no_way = record.reason == Reason::BestAvailable && decision.state == State::Threatened;
    let leaves = matches!(decision.command.proof(), Some(Proof::Leaving(_)));
    let reason = if leaves && record.reason == Reason::ManeuverChosen {
        "a manoeuvre begins that leads out of what the aircraft is in"
    } else if has_no_way {
        "no way round keeps the protected volume: the mission is flown on"
    } else {
        match (record.reason, record.p_loss) {
            (Reason::BestAvailable, Some(_)) => {
                "no manoeuvre is certified, the one of the least expected cost is flown"
            }
            (Reason::ManeuverReplaced, Some(_)) => "another manoeuvre costs less and replaces it",
            (reason, _) => reason_words(reason),
        }
    };
    let mut parts = vec![reason.to_string()];
    if let Some(threat) = &record.threat {
        let name = name_of(threat.id);
        parts.push(if threat.margin_m < 0.0 {
            format!(
                "threat: {name} in {:.1} s, {:.1} m inside",
                threat.entry_s.max(0.0),
                -threat.margin_m
            )
        } else {
            format!(
                "threat: {name}, closest in {:.1} s at {:.1} m",
                threat.closest_s.max(0.0),
                threat.margin_m
            )
        });
    }
    parts.extend(loss_words(record));
    if let Some(latest_s) = record.latest_start_s {
        parts.push(format!("latest safe start in {latest_s:.1} s"));
    }
    let candidate_words = |maneuver: &Maneuver, candidate: &Candidate| {
        let words = maneuver_words(maneuver, ownship);
        if candidate.margin_m.is_finite() {
            format!("{words}, least margin {:.1} m", candidate.margin_m)
        } else {
            words
        }
    };
    let chosen = record.chosen.as_ref();
    parts.extend(chosen.map(|chosen| candidate_words(&decision.command, chosen)));
    if let Some((maneuver, other)) = &record.alternative {
        let words = candidate_words(&maneuver.to(), other);
        parts.push(format!("to the other side: {words}"));
    }
    if record.straight_aircraft > 0 {
        parts.push(format!(
            "turns of {} aircraft not considered",
            record.straight_aircraft
        ));
    }
    parts.join("; ")
}

/// The chances of a loss where a decision on beliefs says them, such as "3 in 10 to enter a protected volume on the mission, 1 in 100 as it
/// flies".
pub fn loss_words(record: &Record) -> Option<String> {
    let (hold, flies) = (record.p_loss_hold?, record.p_loss?);
    Some(format!(
        "{} to enter a protected volume on the mission, {} as it flies",
        chance_words(hold),
        chance_words(flies)
    ))
}

/// Smaller chances are not to be trusted.
pub const LEAST_CHANCE: f64 = 0.01;

/// A chance in words, such as "3 in 10".
pub fn chance_words(chance: f64) -> String {
    match chance {
        0.95.. => format!("{:.0} in 100", (100.0 * chance).min(99.0)),
        0.095.. => format!("{:.0} in 10", 10.0 * chance),
        LEAST_CHANCE.. => format!("{:.0} in 100", 100.0 * chance),
        _ => "less than 1 in 100".into(),
    }
}

/// A rate, per second, with the decimals that a slow one needs.
///
/// ```
/// use fga_formats::words::per_second;
///
/// assert_eq!(per_second(1234.5), "1234");
/// assert_eq!(per_second(4.26), "4.3");
/// assert_eq!(per_second(0.0123), "0.012");
/// ```
pub fn per_second(rate: f64) -> String {
    match rate {
        10.0.. => format!("{rate:.0}"),
        1.0.. => format!("{rate:.1}"),
        _ => format!("{rate:.3}"),
    }
}

/// A number of things in words, with the plural in "s", or "ies" in the place of a "y".
///
/// ```
/// use fga_formats::words::counted;
///
/// assert_eq!(counted(1_u64, "source"), "1 source");
/// assert_eq!(counted(0_u64, "source"), "0 sources");
/// assert_eq!(counted(2_u64, "policy"), "2 policies");
/// ```
pub fn counted(number: impl TryInto<u64>, thing: &str) -> String {
    let number = number.try_into().unwrap_or(u64::MAX);
    match (number, thing.strip_suffix('y')) {
        (1, _) => format!("1 {thing}"),
        (_, Some(stem)) => format!("{number} {stem}ies"),
        (_, None) => format!("{number} {thing}s"),
    }
}

/// A text as a CSV field; quoted where it has to be.
pub fn push_csv_field(line: &mut Vec<u8>, text: &[u8]) {
    if !text
        .iter()
        .any(|byte| matches!(byte, b',' | b'"' | b'\n' | b'\r'))
    {
        line.extend_from_slice(text);
        return;
    }
    line.push(b'"');
    for &byte in text {
        if byte == b'"' {
            line.push(b'"');
        }
        line.push(byte);
    }
    line.push(b'"');
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga::Vec3;
    use fga::avoider::{Threat, Verdict};

    #[test]
    fn the_schema_of_decisions_names_every_reason() {
        let schema = include_str!("../../../docs/schema/decision.schema.json");
        let schema: serde_json::Value = serde_json::from_str(schema).unwrap();
        let named = &schema["properties"]["reason"]["enum"];
        assert_eq!(*named, serde_json::json!(Reason::ALL.map(reason_key)));
    }

    /// In level flight on a course.
    fn level(course_rad: f64) -> Ownship {
        Ownship {
            position_m: Vec3::ZERO,
            course_rad,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: 15.0,
        }
    }

    #[test]
    fn d4_aircraft_that_count_as_straight_are_named() {
        let ownship = level(0.0);
        let mut decision = Decision::new(State::Cruise, &Maneuver::hold(), Reason::Clear);
        let words = |decision: &Decision| decision_words(decision, &ownship, |_| String::new());
        assert!(!words(&decision).contains("not considered"));
        decision.record.straight_aircraft = 3;
        let found = words(&decision);
        assert!(
            found.ends_with("; turns of 3 aircraft not considered"),
            "{found}"
        );
    }

    #[test]
    fn the_chances_of_a_loss_are_said_where_they_are_known() {
        let words = |hold, flies| {
            loss_words(&Record {
                p_loss_hold: hold,
                p_loss: flies,
                ..Record::default()
            })
        };
        assert_eq!(words(None, None), None);
        let said = "3 in 10 to enter a protected volume on the mission, 1 in 100 as it flies";
        assert_eq!(words(Some(0.31), Some(0.012)).as_deref(), Some(said));
        let sure = words(Some(1.0), Some(0.0)).unwrap();
        assert!(sure.starts_with("99 in 100 to enter"), "{sure}");
        assert!(sure.ends_with("less than 1 in 100 as it flies"), "{sure}");
    }

    #[test]
    fn a_decision_reads_as_a_sentence() {
        let ownship = level(1.0);
        let maneuver = Maneuver::turn(0.0, 1.0 + 38.0_f64.to_radians(), 0.1);
        let decision = Decision {
            state: State::Avoiding,
            command: maneuver.into(),
            record: Record {
                reason: Reason::ManeuverChosen,
                threat: Some(Threat {
                    id: 3,
                    entry_s: 4.1,
                    closest_s: 5.0,
                    margin_m: -12.0,
                }),
                latest_start_s: Some(1.62),
                chosen: Some(Candidate {
                    margin_m: 4.2,
                    cost: 0.1,
                    verdict: Verdict::Chosen,
                }),
                ..Record::default()
            },
        };
        assert_eq!(
            decision_words(&decision, &ownship, |id| format!("N{id}")),
            "a certified manoeuvre begins; threat: N3 in 4.1 s, 12.0 m inside; latest safe start \
             in 1.6 s; turn left 38° and climb at 6°, least margin 4.2 m"
        );
    }
}
