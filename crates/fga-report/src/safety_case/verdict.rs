//! Whether risk ratios meet quoted thresholds.

use core::fmt::Write as _;

use super::{LOWC_THRESHOLDS, Lost, NMAC_THRESHOLDS, PolicyCase, Threshold};
use crate::interval::Estimate;
use crate::report::{Block, Cell};

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

/// The verdicts on a loss, one cell for each threshold.
pub(super) fn verdicts(lost: &Lost, thresholds: &[Threshold]) -> Vec<Cell> {
    thresholds
        .iter()
        .map(|threshold| {
            lost.ratio.map_or(Cell::Empty, |ratio| {
                Cell::Text(verdict(&ratio, threshold).into())
            })
        })
        .collect()
}

/// The result of a policy in one paragraph.
pub(super) fn result(policy: &PolicyCase) -> Block {
    let losses = [
        ("NMAC", &policy.nmac, &NMAC_THRESHOLDS),
        ("LoWC", &policy.lowc, &LOWC_THRESHOLDS),
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
            for threshold in thresholds {
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
    Block::Paragraph(sentences.join(" "))
}
