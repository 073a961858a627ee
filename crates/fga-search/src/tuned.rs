//! The tuned numbers of the search, each with its unit and its source.
//!
//! Sources: `compare` is `fga-experiments departures compare 1 100`, `lost` is `fga-experiments lost 7 200`.

/// Climb targets on each side of the original one.
pub(super) const CLIMBS_A_SIDE: usize = 2;

/// All climb targets.
pub(super) const CLIMBS: usize = 2 * CLIMBS_A_SIDE + 1;

/// Starts that are compared, as shares of the time to the first entry (`compare`).
pub(super) const STARTS: [f64; 4] = [0.0, 0.25, 0.5, 0.75];

/// First turns of two opposite ones, radians (`compare`).
pub(super) const ASIDE_RAD: [f64; 4] = [0.6, 0.9, 1.2, 1.5];

/// The second one ends at most this much beyond the mission's direction, radians: across it.
pub(super) const BEYOND_RAD: f64 = 1.6;

/// When a climb or descent straight ahead levels off, in turn radii: steps grow with the time (`compare`).
pub(super) const LEVEL_AFTER: [f64; 10] = [0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.5, 6.5, 10.0];

/// Two stages replace a single turn if they depart by at most this share of its departure (`compare`).
pub(super) const WORTH: f64 = 0.8;

/// Obstacles count as passed after at most this long, s: the default horizon.
pub(super) const LONGEST_PASS_S: f64 = 60.0;

/// The line of the cheapest member of a row keeps at most this much more margin than the target, turn radii (`compare`).
pub(super) const NEAR: f64 = 0.005;

/// After a turn that fails, the step is the least that may help divided by this share: only a part of a turn's displacement leads
/// away from the obstacle (`compare`).
pub(super) const USUAL: f64 = 0.7;

/// Straight flight between two turns, in turn radii (`lost`).
pub(super) const GAPS: [f64; 6] = [0.0, 0.35, 0.75, 1.25, 2.0, 3.25];

/// First turns of two are multiples of this, and last turns at most twice this apart, radians (`lost`).
pub(super) const STEP_RAD: f64 = 0.2;

/// Parts of the two-turn rows: each has every n-th first turn (`lost`).
pub const PARTS: u32 = 4;

/// Seeds that climb in each round, and the steps of each (`lost`).
pub(super) const ROUNDS: [(usize, u32); 4] = [(16, 2), (8, 4), (3, 8), (1, 16)];

/// Most seeds: they are flown before the best of them climb, as lines do not show the arc of a last turn (`lost`).
pub(super) const SEEDS: usize = 48;

/// Seeds this far below the best one are not worth a climb, turn radii (`lost`).
pub(super) const WORTH_A_CLIMB: f64 = 0.27;

/// Where a part of the two-turn rows ends this far short of the target, the others hardly ever reach it, turn radii (`lost`).
pub(super) const FAR: f64 = 0.3;
