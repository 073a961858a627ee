//! Times that pass, from the stamps of a clock that may be set.

/// A smaller step back is one of threads that wrote in another order, seconds.
const DISORDER_S: f64 = 1.0;
/// A larger step is a clock that was set, seconds: from 1970 to now, for instance.
const LONGEST_STEP_S: f64 = 86_400.0;

/// The time that has passed since the first stamp.
///
/// ```
/// use fga_formats::clock::Elapsed;
///
/// let mut elapsed = Elapsed::default();
/// assert_eq!(elapsed.at_s(5_000_000), 0.0);
/// assert_eq!(elapsed.at_s(7_500_000), 2.5);
/// // The clock is set to 2026, and later an hour back.
/// assert_eq!(elapsed.at_s(1_780_000_000_000_000), 2.5);
/// assert_eq!(elapsed.at_s(1_779_996_400_000_000), 2.5);
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub struct Elapsed {
    /// The last stamp, microseconds, and its time, seconds.
    last: Option<(u64, f64)>,
    /// The same of the first stamp since the clock was set.
    begin: (u64, f64),
    set_s: f64,
}

impl Elapsed {
    /// The same where this much time passes when the clock is set, seconds: a gap that splits signals.
    pub fn with_gaps(set_s: f64) -> Self {
        Self {
            set_s,
            ..Self::default()
        }
    }

    /// The time at a stamp, microseconds of the clock, in seconds since the first stamp.
    pub fn at_s(&mut self, stamp_us: u64) -> f64 {
        let (last_us, last_s) = self.last.unwrap_or_else(|| {
            self.begin = (stamp_us, 0.0);
            self.begin
        });
        if !(-DISORDER_S..=LONGEST_STEP_S).contains(&between_s(last_us, stamp_us)) {
            self.begin = (stamp_us, last_s + self.set_s);
        }
        let (begin_us, begin_s) = self.begin;
        let at_s = begin_s + between_s(begin_us, stamp_us);
        self.last = Some((stamp_us, at_s));
        at_s
    }
}

/// From one stamp to another, seconds.
fn between_s(from_us: u64, to_us: u64) -> f64 {
    #[expect(
        clippy::cast_precision_loss,
        reason = "a step that is kept fits in 53 bits"
    )]
    let passed_s = |from_us: u64, to_us: u64| to_us.saturating_sub(from_us) as f64 * 1e-6;
    passed_s(from_us, to_us) - passed_s(to_us, from_us)
}
