//! Whether risk ratios meet quoted thresholds.

use core::fmt::Write as _;

use super::{LOWC_THRESHOLDS, Lost, NMAC_THRESHOLDS, PolicyCase, Threshold};
use crate::interval::Estimate;
use crate::report::{Cell, SectionBlock};

/// Whether a ratio meets a threshold.
pub(super) fn verdict(ratio: &Estimate, threshold: &Threshold) -> &'static str {
    if ratio.high <= threshold.ratio {
        "met"
    } else if ratio.low > threshold.ratio {
        "not met"
    } else {
        "not shown"
    }
}

/// The verdict as a cell; encounters that stand for no airspace give none.
pub(super) fn judged(ratio: &Estimate, threshold: &Threshold, is_stress: bool) -> Cell {
    let verdict = if is_stress {
        "stress set"
    } else {
        verdict(ratio, threshold)
    };
    Cell::Text(verdict.into())
}

/// The verdicts on a loss, one cell for each threshold.
pub(super) fn verdicts(lost: &Lost, thresholds: &[Threshold], is_stress: bool) -> Vec<Cell> {
    let judge = |threshold: &Threshold| {
        (lost.ratio).map_or(Cell::Empty, |ratio| judged(&ratio, threshold, is_stress))
    };
    thresholds.iter().map(judge).collect()
}

/// The result of a policy in one paragraph.
pub(super) fn result(policy: &PolicyCase, is_stress: bool) -> SectionBlock {
    let losses = [
        ("NMAC", &policy.nmac, &NMAC_THRESHOLDS[..]),
        ("LoWC (ASTM F3442)", &policy.lowc, &LOWC_THRESHOLDS),
        ("LoWC of DO-365B en route", &policy.do365, &[]),
    ];
    let sentences = losses.map(|(loss, lost, thresholds)| {
        let mut text = format!(
            "{} of {} {loss} are left with {}",
            lost.flown, lost.nominal, policy.policy
        );
        if let Some(ratio) = &lost.ratio {
            let _ = write!(
                text,
                ": a risk ratio of {:.3} (95 % interval {:.3} to {:.3})",
                ratio.value, ratio.low, ratio.high
            );
            for threshold in thresholds.iter().filter(|_| !is_stress) {
                let _ = write!(
                    text,
                    ", {} for the quoted {:.2} of {} intruders",
                    verdict(ratio, threshold),
                    threshold.ratio,
                    threshold.intruders
                );
            }
        }
        text + "."
    });
    SectionBlock::Paragraph(sentences.join(" "))
}
