//! The risk ratios of a campaign: `risk.csv`, `summary.json`, and the printed table.

use core::fmt::Write as _;
use std::path::Path;

use fga_campaign::campaign::risk::{LossCount, LossRule, PolicyRisk, RiskClass, Risks};
use fga_campaign::campaign::{Campaign, Tail};
use fga_formats::OutputError;
use fga_formats::atomic;
use serde_json::{Value, json};

use crate::named_rows::{csv, objects, rounded};

/// One row of `risk.csv`.
fn row_of(
    policy: &str,
    class: &str,
    risk: &PolicyRisk,
    loss: LossRule,
    (count, tail): (&LossCount, Option<Tail>),
) -> Vec<(&'static str, Value)> {
    let ratio = count.ratio();
    let bootstrap = ratio.and_then(|ratio| ratio.bootstrap);
    let (nominal_rate, rate) = count.rates(risk.weight);
    let number = |value: Option<f64>| json!(value.map(rounded));
    vec![
        ("policy", json!(policy)),
        ("class", json!(class)),
        ("loss", json!(loss.name())),
        ("encounters", json!(risk.encounters)),
        ("effective_encounters", json!(rounded(risk.effective()))),
        ("nominal", json!(count.nominal)),
        ("flown", json!(count.flown)),
        ("induced", json!(count.induced)),
        ("acted", json!(risk.acted)),
        ("needless", json!(count.needless)),
        ("clear", json!(count.clear)),
        ("nominal_rate", json!(rounded(nominal_rate))),
        ("rate", json!(rounded(rate))),
        ("ratio", number(ratio.map(|ratio| ratio.ratio))),
        ("bootstrap_low", number(bootstrap.map(|i| i.low))),
        ("bootstrap_high", number(bootstrap.map(|i| i.high))),
        ("wilson_low", number(ratio.map(|ratio| ratio.wilson.low))),
        ("wilson_high", number(ratio.map(|ratio| ratio.wilson.high))),
        (
            "effective_losses",
            number(ratio.map(|ratio| ratio.effective)),
        ),
        ("tail_encounters", json!(tail.map(|tail| tail.above))),
        ("tail_ratio", number(tail.map(|tail| tail.ratio))),
        ("tail_low", number(tail.map(|tail| tail.interval.low))),
        ("tail_high", number(tail.map(|tail| tail.interval.high))),
    ]
}

fn rows(campaign: &Campaign, risks: &Risks) -> Vec<Vec<(&'static str, Value)>> {
    let policies = &campaign.configuration.policies;
    let mut rows = Vec::new();
    for (policy, class, risk) in risks.iter() {
        let policy = policies.get(policy as usize).map_or("", String::as_str);
        let tail = (*class == RiskClass::All).then(|| risk.tail()).flatten();
        let class = class.name(campaign.source_names());
        for (count, loss) in risk.losses.iter().zip(LossRule::ALL) {
            let tail = tail.filter(|_| loss == LossRule::Nmac);
            rows.push(row_of(policy, &class, risk, loss, (count, tail)));
        }
    }
    rows
}

/// The rows as objects, for `summary.json`; `null` for a campaign without aircraft.
pub fn document(campaign: &Campaign, risks: &Risks) -> Value {
    if risks.is_empty() {
        return Value::Null;
    }
    objects(rows(campaign, risks))
}

/// For campaigns of aircraft: writes `risk.csv`, and `convergence.csv` with the ratios after growing
/// numbers of encounters.
///
/// # Errors
/// A folder that cannot be written.
pub fn write(folder: &Path, campaign: &Campaign, risks: &Risks) -> Result<(), OutputError> {
    if risks.is_empty() {
        return Ok(());
    }
    let rows = rows(campaign, risks);
    atomic::write(&folder.join("risk.csv"), csv(&rows))?;
    let mut curve = String::from("policy,loss,encounters,ratio,low,high,half_width\n");
    for (policy, class, risk) in risks.iter() {
        if *class != RiskClass::All {
            continue;
        }
        let policies = &campaign.configuration.policies;
        let name = policies.get(policy as usize).map_or("", String::as_str);
        for (count, loss) in risk.losses.iter().zip(LossRule::ALL) {
            for (encounters, ratio) in count.convergence(risk.encounters) {
                let interval = ratio.interval();
                let _ = writeln!(
                    curve,
                    "{name},{},{encounters},{:.6},{:.6},{:.6},{:.6}",
                    loss.name(),
                    ratio.ratio,
                    interval.low,
                    interval.high,
                    interval.half_width()
                );
            }
        }
    }
    atomic::write(&folder.join("convergence.csv"), curve)
}

/// The ratios in words.
pub fn push_words(text: &mut String, campaign: &Campaign, risks: &Risks) {
    if risks.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "{:<28} {:>28} {:>28} {:>9} {:>9}",
        "risk ratio", "NMAC (500 ft, 100 ft)", "LoWC (2,000 ft, 250 ft)", "needless", "induced"
    );
    for (index, name) in (0..).zip(&campaign.configuration.policies) {
        let Some(risk) = risks.of(index) else {
            continue;
        };
        let [nmac, lowc, _] = &risk.losses;
        let _ = writeln!(
            text,
            "{name:<28} {:>28} {:>28} {:>9} {:>9}",
            ratio_words(nmac),
            ratio_words(lowc),
            format!("{}/{}", lowc.needless, lowc.clear),
            format!("{}, {}", nmac.induced, lowc.induced)
        );
        if let Some(tail) = risk.tail() {
            let _ = writeln!(
                text,
                "{:<28} {:>28} extrapolated from the {} nearest encounters",
                "  tail",
                format!(
                    "{:.4} [{:.4}, {:.4}]",
                    tail.ratio, tail.interval.low, tail.interval.high
                ),
                tail.above
            );
        }
    }
    let _ = writeln!(
        text,
        "(left of lost without it, ratio and 95 % interval; needless: acted though well clear; induced: NMAC, LoWC)"
    );
}

fn ratio_words(count: &LossCount) -> String {
    count.ratio().map_or_else(
        || "none lost without".into(),
        |ratio| {
            let interval = ratio.interval();
            format!(
                "{}/{}: {:.3} [{:.3}, {:.3}]",
                count.flown, count.nominal, ratio.ratio, interval.low, interval.high
            )
        },
    )
}
