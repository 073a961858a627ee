//! What aircraft do, before any report: one table, from which filter and futures follow.
//!
//! Turns begin as often as in the 58 recorded flights of the NRC of Canada: 0.012 a second above 1.5 °/s, 0.017 above 1 °/s, by the courses of
//! positions four seconds apart. The other rates are about those of the uncorrelated encounter model of low altitudes (MIT Lincoln
//! Laboratory), rounded and not yet checked against its tables: a decision must not hang on them. Turns, climbs and accelerations are those of
//! [`MovementBounds`](fga_proof::situation::MovementBounds).

/// Turns that begin in straight flight, per second, half of them to either side.
pub(crate) const TURN_BEGINS_PER_S: f32 = 0.012;

/// The same as the filter sees them, beside what wavers: with more of them it is less sure of recorded flights than it is right.
pub(crate) const TURN_SEEN_PER_S: f32 = 0.010;

/// Turns that end, per second: they last half a minute.
pub(crate) const TURN_ENDS_PER_S: f32 = 0.037;

/// Turns that change their side at once, per second.
pub(crate) const TURN_CHANGES_SIDE_PER_S: f32 = 0.002;

/// Steady flight that begins to waver, per second: small turns, gusts, another speed.
pub(crate) const WAVERING_BEGINS_PER_S: f32 = 0.015;

/// Wavering that ends, per second.
pub(crate) const WAVERING_ENDS_PER_S: f32 = 0.1;

/// Climbs and descents that begin in level flight, per second.
pub(crate) const CLIMB_BEGINS_PER_S: f32 = 0.009;

/// Climbs and descents that end in level flight, per second.
pub(crate) const LEVELS_OFF_PER_S: f32 = 0.03;

/// Speed changes that begin, per second.
pub(crate) const SPEED_CHANGES_PER_S: f32 = 0.01;

/// Speed change of an aircraft that changes its speed, σ, share of it.
pub(crate) const SPEED_CHANGE: f32 = 0.1;

/// Climb rates that begin to change, per second, as the filter sees them.
pub(crate) const CLIMB_CHANGES_PER_S: f32 = 0.02;

/// Changes of the climb rate that end, per second: they take some seconds.
pub(crate) const CLIMB_SETTLES_PER_S: f32 = 0.2;

/// Shares of a new aircraft: steady, wavering, turning left, turning right.
pub(crate) const MODES: [f32; 4] = [0.75, 0.1, 0.075, 0.075];

/// Share of steady climb rates among new aircraft.
pub(crate) const STEADY_CLIMBS: f32 = 0.9;

/// Speed of an aircraft of which no velocity is known, σ along an axis, metres per second.
pub(crate) const SPEED_MPS: f32 = 60.0;

/// Climb rate of an aircraft of which no velocity is known, σ, metres per second.
pub(crate) const CLIMB_MPS: f32 = 3.0;

/// Turn rate of a turn that begins, as a share of the sustained one: mean and σ.
pub(crate) const TURN_SHARE: (f32, f32) = (0.8, 0.4);

/// The chance that an aircraft does anything that its bounds allow: 28 futures say little of what is less likely. Without it 4.3 of 100 recorded
/// aircraft, seen with σ of 5 m, are beyond the quantiles across their way that 2 are to be beyond after five seconds; with it 2.8.
pub(crate) const OTHERWISE: f32 = 0.02;

/// How long an aircraft that does anything gains speed at the most that its bounds allow, seconds.
pub(crate) const FASTER_FOR_S: f32 = 5.0;

/// Turn rate of straight flight ahead, σ, radians per second: pilots wander. Without it and the next one 9 of 100 recorded aircraft, seen with
/// σ of 5 m, are beyond the quantiles across their way that 2 are to be beyond after ten seconds.
pub(crate) const WANDERS_RADPS: f32 = 0.0025;

/// Change of a turn rate within a turn ahead, σ, as a share of the sustained one.
pub(crate) const TURN_CHANGE: f32 = 0.4;

/// White acceleration in steady flight, m²/s³: 0.3 m/s after ten seconds, as in the recorded flights of the NRC.
pub(crate) const STEADY: f32 = 0.010;

/// The same while it wavers: 0.6 m/s after a second.
pub(crate) const WAVERING: f32 = 0.35;

/// White jerk in a turn, m²/s⁵, for each (m/s²)² of a usual turn: the turn rate drifts by a sixth in ten seconds.
pub(crate) const TURN_DRIFT: f32 = 0.003;

/// Longest time in which what is steady wavers further, seconds: after that the variance of its place grows in proportion to time. A velocity
/// that is held from then on would have twice the variance after half a minute: the aircraft then flies a tenth farther aside.
pub(crate) const WAVERS_FOR_S: f32 = 15.0;

/// White acceleration of a steady climb rate, m²/s³: 0.5 m/s after ten seconds, as in the same flights.
pub(crate) const STEADY_CLIMB: f32 = 0.03;

/// The same ahead, small changes included that begin and end: with that of steady flight 8 of 100 recorded aircraft, seen with σ of 5 m, are
/// beyond the quantiles that 2 are to be beyond after ten seconds.
pub(crate) const CLIMB_AHEAD: f32 = 0.1;

/// The same while the climb rate changes, for each (m/s)² of a usual change.
pub(crate) const CLIMB_CHANGE: f32 = 0.12;

/// Reports that are false, one in this many: a wrong address, a bit error that passed.
pub(crate) const FALSE_REPORTS: f32 = 1e-3;

/// Chance for each report that from now on the belief is about nothing: the aircraft jumped, or another one took its name.
pub(crate) const LOST: f32 = 1e-5;

/// Where a false report may lie: within this distance, metres; velocity, metres per second; the same up and down.
pub(crate) const ANYWHERE: [f32; 4] = [5000.0, 100.0, 500.0, 10.0];
