//! Rows of the results.

use fga::avoider::SettingsError;
use fga_formats::InputError;
use fga_formats::number::push_fixed;
use fga_formats::words::push_csv_field;
use fga_sim::engine::{Engine, Observer, Outcome, Sample};
use fga_sim::own::FailureKind;
use fga_sim::policy::PolicyPilot;
use fga_sim::world::World;

/// Encounters between two writes; it bounds the memory.
pub(super) const BLOCK: usize = 512;

/// Columns of `results.csv`.
pub const RESULT_COLUMNS: &str = "encounter,separated,min_separation_m,min_margin_m,start_s,clear_s,max_cross_track_m,extra_path_m,waypoints_missed";

/// The columns after them for encounters among ground or zones.
pub const SURROUNDINGS_COLUMNS: &str = "min_terrain_clearance_m,min_zone_margin_m";

/// The column after them for a policy of one's own.
pub const FAILURE_COLUMN: &str = "policy_failure";

/// The column after all others for encounters with names.
pub const NAME_COLUMN: &str = "name";

/// What `results.csv` has besides [`RESULT_COLUMNS`].
#[derive(Debug, Clone, Copy, Default)]
pub struct MoreColumns {
    /// The encounters are among ground or zones.
    pub is_bounded: bool,
    /// The policy is one of one's own.
    pub is_own: bool,
    /// The encounters have names.
    pub is_named: bool,
}

/// The first line of `results.csv`.
pub fn result_columns(more: MoreColumns) -> String {
    let mut columns = RESULT_COLUMNS.to_owned();
    let more = [
        (more.is_bounded, SURROUNDINGS_COLUMNS),
        (more.is_own, FAILURE_COLUMN),
        (more.is_named, NAME_COLUMN),
    ];
    for (_, name) in more.into_iter().filter(|(is_there, _)| *is_there) {
        columns.push(',');
        columns.push_str(name);
    }
    columns
}

/// Columns of `timing.csv`.
pub const TIMING_COLUMNS: &str = "encounter,decision_median_us,decision_max_us";

/// Columns of `tracks.csv`.
pub const TRACK_COLUMNS: &str = "encounter,t_s,x_m,y_m,z_m,course_rad,climb_rad,bank_rad";

/// One flown encounter.
#[derive(Debug, Clone, PartialEq)]
pub struct BatchRow {
    /// The encounter's number.
    pub encounter: u64,
    /// The result of the flight.
    pub outcome: Outcome,
    /// Median time of a decision, nanoseconds.
    pub decision_median_ns: u64,
    /// Longest time of a decision, nanoseconds.
    pub decision_max_ns: u64,
    /// Number of decisions.
    pub decisions: usize,
    /// How the policy failed.
    pub failure: Option<FailureKind>,
    /// Its rows of `tracks.csv`; empty without `tracks`.
    pub track_rows: Vec<u8>,
}

/// Reasons why a batch cannot fly.
#[derive(Debug, thiserror::Error)]
pub enum BatchError<E> {
    /// Settings or limits that the core refuses.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The wind is too strong to hold the line.
    #[error(
        "wind of {wind_mps} m/s across or against an airspeed of {airspeed_mps} m/s, expected less: the line cannot be flown"
    )]
    Wind {
        /// Its speed, metres per second.
        wind_mps: f64,
        /// The vehicle's airspeed, metres per second.
        airspeed_mps: f64,
    },
    /// A file that cannot be read any more.
    #[error(transparent)]
    Input(#[from] InputError),
    /// `take` refused a row.
    #[error(transparent)]
    Sink(E),
}

/// The result of a flight with the durations of its decisions, nanoseconds in any order.
pub(crate) fn timed(encounter: u64, outcome: Outcome, elapsed_ns: &mut [u64]) -> BatchRow {
    let decisions = elapsed_ns.len();
    let decision_max_ns = elapsed_ns.iter().copied().max().unwrap_or(0);
    let decision_median_ns = match decisions {
        0 => 0,
        count => *elapsed_ns.select_nth_unstable(count / 2).1,
    };
    BatchRow {
        encounter,
        outcome,
        decision_median_ns,
        decision_max_ns,
        decisions,
        failure: None,
        track_rows: Vec::new(),
    }
}

/// Flies an encounter with this number, with its rows of `tracks.csv` where they are asked for.
pub(super) fn row_of(
    engine: &mut Engine,
    world: &World,
    pilot: &mut dyn PolicyPilot,
    (encounter, tracks): (u64, bool),
) -> BatchRow {
    let mut rows = TrackRows {
        encounter,
        rows: Vec::new(),
    };
    let outcome = if tracks {
        engine.fly(world, pilot, &mut rows)
    } else {
        engine.fly(world, pilot, &mut ())
    };
    BatchRow {
        track_rows: rows.rows,
        failure: pilot.failure(),
        ..timed(encounter, outcome, engine.elapsed_ns())
    }
}

/// Collects the rows of `tracks.csv`.
struct TrackRows {
    encounter: u64,
    rows: Vec<u8>,
}

impl Observer for TrackRows {
    fn sample(&mut self, sample: &Sample) {
        self.rows
            .extend_from_slice(self.encounter.to_string().as_bytes());
        self.rows.push(b',');
        push_sample(&mut self.rows, sample);
        self.rows.push(b'\n');
    }
}

/// Appends `t_s,x_m,y_m,z_m,course_rad,climb_rad,bank_rad` of a sample, six decimals each.
pub fn push_sample(row: &mut Vec<u8>, sample: &Sample) {
    push_fixed(row, sample.time_s, 6);
    for value in [
        sample.position_m.x,
        sample.position_m.y,
        sample.position_m.z,
        sample.course_rad,
        sample.climb_rad,
        sample.bank_rad,
    ] {
        row.push(b',');
        push_fixed(row, value, 6);
    }
}

/// The least margin as written: the written number decides whether it is negative.
fn written(value_m: f64) -> f64 {
    libm::rint(value_m * 1e6) / 1e6
}

impl BatchRow {
    /// Whether the flight entered no volume, by the rule of `results.csv`.
    pub fn separated(&self) -> bool {
        written(self.outcome.min_margin_m) >= 0.0
    }

    /// Appends its row of `results.csv`, with the columns of [`result_columns`]; `name` is that of the encounter, if it has one.
    pub fn push_result(&self, row: &mut Vec<u8>, more: MoreColumns, name: Option<&str>) {
        let number = |row: &mut Vec<u8>, value: Option<f64>| {
            row.push(b',');
            if let Some(value) = value {
                push_fixed(row, value, 6);
            }
        };
        let outcome = &self.outcome;
        row.extend_from_slice(self.encounter.to_string().as_bytes());
        row.extend_from_slice(if self.separated() {
            b",true"
        } else {
            b",false"
        });
        for value in [
            Some(outcome.min_separation_m),
            Some(outcome.min_margin_m),
            outcome.start_s,
            outcome.clear_s,
            Some(outcome.max_cross_track_m),
            Some(outcome.extra_path_m),
        ] {
            number(row, value);
        }
        row.push(b',');
        row.extend_from_slice(outcome.waypoints_missed.to_string().as_bytes());
        if more.is_bounded {
            let above_m = outcome.min_terrain_clearance_m;
            number(row, above_m.filter(|above_m| above_m.is_finite()));
            number(row, outcome.min_zone_margin_m);
        }
        if more.is_own {
            row.push(b',');
            row.extend_from_slice(self.failure.map_or("", FailureKind::name).as_bytes());
        }
        if let Some(name) = name.filter(|_| more.is_named) {
            row.push(b',');
            push_csv_field(row, name.as_bytes());
        }
        row.push(b'\n');
    }

    /// Appends its row of `timing.csv`.
    pub fn push_timing(&self, row: &mut Vec<u8>) {
        row.extend_from_slice(self.encounter.to_string().as_bytes());
        for nanoseconds in [self.decision_median_ns, self.decision_max_ns] {
            row.push(b',');
            push_fixed(row, nanoseconds as f64 / 1000.0, 3);
        }
        row.push(b'\n');
    }
}
