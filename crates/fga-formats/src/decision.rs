//! A decision as JSON: the form that `events.jsonl` and the log of `fga fly` share. Its schema is
//! `docs/schema/decision.schema.json`.

use fga::avoider::{Candidate, Decision, Verdict};
use fga::maneuver::Maneuver;
use fga::situation::Ownship;
use serde_json::{Map, Value, json};

use crate::words::{proof_key, reason_key};

/// A decision with its whole record and the aircraft at that moment. Metres, seconds and radians;
/// `null` is infinite or unknown. `name_of` gives the name of an obstacle.
pub fn to_json(
    decision: &Decision,
    ownship: &Ownship,
    name_of: impl Fn(u32) -> String,
) -> Map<String, Value> {
    let record = &decision.record;
    let threat = record.threat.map(|threat| {
        json!({
            "obstacle": threat.id,
            "name": name_of(threat.id),
            "entry_s": finite(threat.entry_s),
            "closest_s": finite(threat.closest_s),
            "margin_m": finite(threat.margin_m),
        })
    });
    let fields = json!({
        "state": decision.state.name(),
        "reason": reason_key(record.reason),
        "x_m": ownship.position_m.x,
        "y_m": ownship.position_m.y,
        "z_m": ownship.position_m.z,
        "course_rad": ownship.course_rad,
        "climb_rad": ownship.climb_rad,
        "bank_rad": ownship.bank_rad,
        "airspeed_mps": ownship.airspeed_mps,
        "threat": threat,
        "latest_start_s": record.latest_start_s,
        "proof": proof_key(&decision.command),
        "resilience": record.resilience,
        "straight_aircraft": record.straight_aircraft,
        "in_need": record.in_need,
        "clock_set_back": record.clock_set_back,
        "start_s": record.start_s,
        "command": maneuver(&decision.command),
        "chosen": record.chosen.as_ref().map(|it| candidate(&decision.command, it)),
        "alternative": record.alternative.as_ref().map(|(stages, it)| candidate(&stages.to(), it)),
        "tracked": record.work.tracked,
        "threats": record.work.threats,
        "candidates": record.work.candidates,
        "limit_met": record.work.limit_met,
    });
    let Value::Object(mut fields) = fields else {
        return Map::new();
    };
    // Rare, so that the key is as rare.
    if record.work.unusable > 0 {
        fields.insert("unusable".into(), record.work.unusable.into());
    }
    // Only of decisions on beliefs.
    let chances = [
        ("p_loss_hold", record.p_loss_hold),
        ("p_loss", record.p_loss),
        ("proven_share", record.proven_share),
    ];
    for (key, chance) in chances {
        if let Some(chance) = chance {
            fields.insert(key.into(), chance.into());
        }
    }
    fields
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn maneuver(maneuver: &Maneuver) -> Vec<Value> {
    maneuver
        .stages()
        .iter()
        .map(|stage| {
            json!({
                "start_s": finite(stage.start_s),
                "course_rad": stage.course_rad,
                "climb_rad": stage.climb_rad,
                "rate_share": stage.rate_share,
            })
        })
        .collect()
}

fn candidate(stages: &Maneuver, candidate: &Candidate) -> Value {
    json!({
        "maneuver": maneuver(stages),
        "margin_m": finite(candidate.margin_m),
        "cost": finite(candidate.cost),
        "verdict": match candidate.verdict {
            Verdict::Certified => "certified",
            Verdict::Rejected => "rejected",
            Verdict::Chosen => "chosen",
        },
    })
}
