//! A decision that says *certified* holds what the certificate made.

// The encounters of the benchmarks.
#[path = "../../fga-bench/src/cycles.rs"]
#[expect(dead_code, unreachable_pub, reason = "the benchmark uses the rest")]
mod cycles;

use cycles::{BenchAircraft, BenchEncounter};
use fga::avoider::Verdict;

#[test]
fn s1_every_certified_decision_holds_a_certificate() {
    let (mut certified, mut open) = (0, 0);
    for aircraft in BenchAircraft::ALL {
        for number in 0..12 {
            BenchEncounter::threats(aircraft, 1 + number % 4, u64::from(number)).fly(
                |_, _, decision| {
                    let record = &decision.record;
                    let chosen = record.chosen.map(|chosen| chosen.verdict);
                    assert_eq!(
                        decision.command.proof().is_some(),
                        chosen == Some(Verdict::Chosen),
                        "{record:?}"
                    );
                    if let Some(proof) = decision.command.certified() {
                        assert!(proof.margin_m() >= proof.target_m() && proof.target_m() > 0.0);
                        assert!(proof.horizon_s() > 0.0);
                        certified += 1;
                    } else if chosen.is_some() {
                        open += 1;
                    }
                    false
                },
            );
        }
    }
    assert!(certified > 1000 && open > 10, "{certified} and {open}");
}
