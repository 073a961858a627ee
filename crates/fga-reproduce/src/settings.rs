//! Tables 3, 4 and 7: settings and the cost table.

use fga_report::report::{Cell, Column, Reading, Section, SectionBlock, Table};
use fga_sim::vehicle_file::VehicleModel;

/// Steps of the grid that Table 7 implies, radians.
const HEADING_STEP_RAD: f64 = 0.1;
const PITCH_STEP_RAD: f64 = 0.03;

/// Coefficients of Table 4.
const HEADING_COST: f64 = 0.2;
const PITCH_COST: f64 = 0.5;

/// The two sections.
pub(crate) fn sections(model: &VehicleModel) -> Vec<Section> {
    vec![table_4(model), tables_3_and_7()]
}

fn table_4(model: &VehicleModel) -> Section {
    let row = |name: &str, paper: &str, used: String| {
        vec![
            Cell::Text(name.into()),
            Cell::Text(paper.into()),
            Cell::Text(used),
        ]
    };
    let vehicle = &model.vehicle;
    let radius_m = vehicle.airspeed_mps / vehicle.course_rate_radps();
    Section {
        title: "Table 4: settings".into(),
        blocks: vec![SectionBlock::Table(Table {
            caption: "The paper's settings and those flown here.".into(),
            columns: ["setting", "paper", "flown"].map(Column::text).into(),
            rows: vec![
                row(
                    "airspeed",
                    "15 m/s",
                    format!("{} m/s", vehicle.airspeed_mps),
                ),
                row("turn radius", "30 m", format!("{radius_m:.1} m")),
                row(
                    "protected radius",
                    "30 m",
                    format!("{} m", model.protection.radius_m()),
                ),
                row(
                    "surveillance radius",
                    "300 m",
                    "none: every obstacle is known from its first-seen distance on".into(),
                ),
                row(
                    "obstacle speed",
                    "0 to 60 m/s",
                    "as each section says".into(),
                ),
                row("heading coefficient", "0.2", HEADING_COST.to_string()),
                row("pitch coefficient", "0.5", PITCH_COST.to_string()),
                row(
                    "climb",
                    "not stated",
                    format!(
                        "{:.0}° to {:.0}° at {} rad/s",
                        vehicle.climb_min_rad.to_degrees(),
                        vehicle.climb_max_rad.to_degrees(),
                        vehicle.climb_rate_radps
                    ),
                ),
            ],
        })],
    }
}

/// The cost of a pair by Algorithm 2, line 20, with absolute deviations.
fn cost(heading_rad: f64, pitch_rad: f64) -> f64 {
    HEADING_COST * heading_rad.abs() + PITCH_COST * pitch_rad.abs()
}

fn tables_3_and_7() -> Section {
    let headings: Vec<f64> = (-3..=3).map(|k| f64::from(k) * HEADING_STEP_RAD).collect();
    let pitches: Vec<f64> = (-3..=3).map(|k| f64::from(k) * PITCH_STEP_RAD).collect();
    let mut columns = vec![Column::text("heading \\ pitch (rad)")];
    columns.extend(
        pitches
            .iter()
            .map(|pitch| Column::number(&format!("{pitch:.2}"))),
    );
    let rows = headings
        .iter()
        .map(|heading| {
            let mut row = vec![Cell::Text(format!("{heading:.1}"))];
            row.extend(
                pitches
                    .iter()
                    .map(|pitch| Cell::Number(cost(*heading, *pitch), 4)),
            );
            row
        })
        .collect();
    Section {
        title: "Tables 3 and 7: the cost of a heading and pitch".into(),
        blocks: vec![
            SectionBlock::Table(Table {
                caption: "Cost about the present direction, in the steps that Table 7 implies.".into(),
                columns,
                rows,
            }),
            SectionBlock::Reading(Reading {
                paper: "Table 7 prints 0.4137, 0.3987 … and 0.4137, 0.3937 …: neighbours differ by 0.015 along the pitch and by 0.02 along the heading.".into(),
                published: "0.5 × 0.03 rad = 0.015 and 0.2 × 0.1 rad = 0.02, with absolute deviations.".into(),
                turn_aware: "The same cost ranks its certified manoeuvres.".into(),
                oracle: "Has no cost: it only asks for the largest margin.".into(),
                reading: "The steps of Table 7 fit absolute deviations, as Algorithm 2 does not print them; its absolute values cannot be checked, because the directions that they count from are not given.".into(),
            }),
        ],
    }
}
