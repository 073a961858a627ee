//! What the tests of the learner share.

use fga_c::fga_known_aircraft;

/// Each interval is finite and holds its mean.
pub(crate) fn assert_in_order(known: &fga_known_aircraft) {
    for interval in [
        known.turn_rate_factor,
        known.bank_time_constant_s,
        known.dead_time_s,
        known.late_s,
        known.wind_east_mps,
        known.wind_north_mps,
    ] {
        assert!(
            interval.low <= interval.mean && interval.mean <= interval.high,
            "{known:?}"
        );
        assert!((interval.high - interval.low).is_finite(), "{known:?}");
    }
}
