//! Tables 5 and 6: computing time of a case, all methods in one run.

use core::fmt::Write as _;

use fga_formats::atomic;
use fga_report::interval::Estimate;
use fga_report::report::{Cell, Column, Reading, Section, SectionBlock, Table};

use crate::ReproduceError;
use crate::Setting;
use crate::flights::{FlightTimes, Flights, METHODS, method};

/// Seconds per case that the paper states: for FGA with static and moving obstacles, and in Table 6.
fn stated(method: &str) -> [Option<f64>; 2] {
    match method {
        "published --start tc" => [Some(0.028), Some(0.030)],
        "potential-field" => [Some(0.082); 2],
        "waypoint-greedy" => [Some(0.18); 2],
        "waypoint-optimal" => [Some(0.3); 2],
        _ => [None; 2],
    }
}

fn times(flights: &Flights, method: usize) -> FlightTimes {
    flights.times.get(method).copied().unwrap_or_default()
}

/// Times and shares of all methods.
pub(crate) fn section(
    setting: &Setting<'_>,
    still: &Flights,
    moving: &Flights,
) -> Result<Section, ReproduceError> {
    let mut csv = String::from(
        "method,static_ms,moving_ms,static_decision_us,moving_decision_us,static_longest_us,moving_longest_us\n",
    );
    let mut rows = Vec::new();
    for (index, method) in METHODS.iter().enumerate() {
        let (at_rest, in_motion) = (times(still, index), times(moving, index));
        let _ = writeln!(
            csv,
            "{method},{:.6},{:.6},{:.3},{:.3},{:.3},{:.3}",
            at_rest.flight_s * 1e3,
            in_motion.flight_s * 1e3,
            at_rest.median_s * 1e6,
            in_motion.median_s * 1e6,
            at_rest.longest_s * 1e6,
            in_motion.longest_s * 1e6
        );
        let saved = |flights: &Flights| {
            let totals = flights
                .summary
                .policies()
                .nth(index)
                .map(|(_, totals)| totals);
            totals
                .and_then(|t| Estimate::wilson(t.saved_of_avoidable, t.avoidable))
                .map_or(Cell::Empty, Cell::Share)
        };
        let [stated_still, stated_moving] =
            stated(method).map(|s| s.map_or(Cell::Empty, |s| Cell::Number(s * 1000.0, 0)));
        rows.push(vec![
            Cell::Text((*method).into()),
            stated_still,
            Cell::Number(at_rest.flight_s * 1e3, 3),
            stated_moving,
            Cell::Number(in_motion.flight_s * 1e3, 3),
            Cell::Number(in_motion.median_s * 1e6, 2),
            Cell::Number(in_motion.longest_s * 1e6, 0),
            saved(still),
            saved(moving),
        ]);
    }
    atomic::write(&setting.data().join("tables-5-6.csv"), csv)?;
    Ok(Section {
        title: "Tables 5 and 6: computing time of a case".into(),
        blocks: vec![
            SectionBlock::Table(Table {
                caption: "Mean wall-clock time of a whole closed-loop flight (one to three threats \
                     first seen at 300 m; moving: 0 to 60 m/s), plant and measuring included, all methods \
                     on identical encounters; its median and its longest decision, means over the flights; \
                     and the share saved of what the oracle can save."
                    .into(),
                columns: vec![
                    Column::text("method"),
                    Column::number("paper, static (ms)"),
                    Column::number("static (ms)"),
                    Column::number("paper, moving (ms)"),
                    Column::number("moving (ms)"),
                    Column::number("moving: median decision (µs)"),
                    Column::number("moving: longest decision (µs)"),
                    Column::number("saved, static (%)"),
                    Column::number("saved, moving (%)"),
                ],
                rows,
            }),
            SectionBlock::Reading(reading(still, moving)),
            SectionBlock::Files(vec![("data/tables-5-6.csv".into(), "the times".into())]),
        ],
    })
}

fn reading(still: &Flights, moving: &Flights) -> Reading {
    let ms = |name: &str| {
        format!(
            "{:.3} ms static, {:.3} ms moving",
            times(still, method(name)).flight_s * 1e3,
            times(moving, method(name)).flight_s * 1e3
        )
    };
    let ratio = |name: &str, of: fn(&FlightTimes) -> f64| {
        of(&times(moving, method(name))) / of(&times(moving, method("published --start tc")))
    };
    let ratios = |of: fn(&FlightTimes) -> f64| {
        [
            "potential-field",
            "waypoint-greedy",
            "waypoint-optimal",
            "turn-aware",
        ]
        .map(|name| format!("{:.2}", ratio(name, of)))
        .join(", ")
    };
    let slower = ["potential-field", "waypoint-greedy", "waypoint-optimal"]
        .iter()
        .filter(|name| ratio(name, |t| t.flight_s) > 1.0)
        .count();
    Reading {
                paper: "0.028 s a static and 0.030 s a moving case; 0.082 s for a potential field, 0.18 s and 0.30 s for two waypoint planners (Matlab, machine not stated).".into(),
                published: ms("published --start tc"),
                turn_aware: ms("turn-aware"),
                oracle: "Not timed: it is a yardstick, not for flight.".into(),
                reading: format!(
                    "Relative to the published algorithm the potential field, the two waypoint planners \
                     and turn-aware take {} times as long a moving case (paper: 2.73, 6.0, 10.0), and {} \
                     times for the longest decision of a flight; {slower} of the paper's 3 baselines are \
                     slower than it here. Wall-clock times depend on the machine and its load, and the \
                     planners are this project's reading of one sentence, in compiled code.",
                    ratios(|t| t.flight_s),
                    ratios(|t| t.longest_s)
                ),
            }
}
