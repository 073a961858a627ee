//! Risk ratios: losses with the system over losses without it.
//!
//! Every encounter flies with and without the system, so the ratio is paired: the weighted number of
//! encounters with a loss as flown, divided by the weighted number with one without avoidance. Losses
//! that the system itself causes count as flown ones.
//!
//! Two intervals, both 95 %. The *bootstrap* draws encounters with replacement (each as often as a
//! Poisson number of mean 1, one stream of random numbers for all) and takes the 2.5 and 97.5 percentiles of
//! the ratio. It knows the weights and the pairing, but fails where no loss is left. *Wilson's* takes the
//! remaining losses as a share of those without avoidance, counted by the effective sample size.
//!
//! The effective sample size of some weights is (Σw)² / Σw² (Kish).

use alloc::collections::BTreeMap;

use super::Row;
use super::interval::{Interval, percentiles, poisson};
use super::metrics::{EncounterGeometry, Metrics};
use super::tail::{Nearness, Tail, tail};
use crate::encounters::Random;

/// Bootstrap samples.
const SAMPLES: usize = 1000;

/// Master seed of the bootstrap; independent of any campaign.
const SEED: u64 = 0x5AFE_CA5E;

/// Normal quantile of a two-sided 95 % interval.
const Z95: f64 = 1.959_963_984_540_054;

/// A kind of loss.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LossRule {
    /// Near mid-air collision.
    Nmac,
    /// Well clear of ASTM F3442.
    WellClear,
    /// Well clear of DO-365B en route.
    Do365,
}

impl LossRule {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Nmac, Self::WellClear, Self::Do365];

    /// Its name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nmac => "nmac",
            Self::WellClear => "lowc",
            Self::Do365 => "do365",
        }
    }

    /// Whether it happens without avoidance, and as flown.
    fn of(self, metrics: &Metrics) -> Option<(bool, bool)> {
        match self {
            Self::Nmac => metrics.nominal_nmac.zip(metrics.nmac),
            Self::WellClear => metrics.nominal_lowc.zip(metrics.lowc),
            Self::Do365 => metrics.nominal_do365.zip(metrics.do365),
        }
    }
}

/// A class of encounters.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum RiskClass {
    /// All encounters.
    All,
    /// The encounters of one source, an index.
    Source(u32),
    /// The encounters of one geometry.
    EncounterGeometry(EncounterGeometry),
    /// Encounters with an intruder of this speed: below 50 m/s, up to 100 m/s, above.
    Speed(u8),
}

impl RiskClass {
    /// Its name in files.
    pub fn name(&self, sources: &[String]) -> String {
        match self {
            Self::All => "all".into(),
            Self::Source(index) => {
                let name = sources.get(*index as usize).map_or("", String::as_str);
                format!("source {name}")
            }
            Self::EncounterGeometry(geometry) => geometry.name().into(),
            Self::Speed(0) => "intruder below 50 m/s".into(),
            Self::Speed(1) => "intruder of 50 to 100 m/s".into(),
            Self::Speed(_) => "intruder above 100 m/s".into(),
        }
    }

    fn speed(metrics: &Metrics) -> Option<Self> {
        let speed_mps = metrics.intruder_mps?;
        Some(Self::Speed(
            u8::from(speed_mps >= 50.0) + u8::from(speed_mps > 100.0),
        ))
    }
}

/// An encounter with a loss, with the system or without it.
#[derive(Debug, Clone, Copy)]
struct Case {
    /// Number of encounters before it.
    at: u64,
    weight: f64,
    nominal: bool,
    flown: bool,
}

/// The result of one policy for one kind of loss.
#[derive(Debug, Clone, Default)]
pub struct LossCount {
    cases: Vec<Case>,
    /// Encounters with the loss without avoidance.
    pub nominal: u64,
    /// Encounters with the loss as flown.
    pub flown: u64,
    /// Encounters with the loss only as flown.
    pub induced: u64,
    /// Encounters with a manoeuvre although there is no loss without avoidance.
    pub needless: u64,
    /// Encounters without a loss without avoidance.
    pub clear: u64,
}

/// A ratio with its intervals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RiskRatio {
    /// Weighted losses as flown over weighted losses without avoidance.
    pub ratio: f64,
    /// By bootstrap; `None` if no loss is left.
    pub bootstrap: Option<Interval>,
    /// By Wilson.
    pub wilson: Interval,
    /// Effective number of encounters with a loss without avoidance.
    pub effective: f64,
}

impl RiskRatio {
    /// The interval to show: the bootstrap's, or Wilson's where fewer than ten losses are left or all of
    /// them, where the bootstrap fails.
    pub fn interval(&self) -> Interval {
        match self.bootstrap {
            Some(bootstrap)
                if self.effective * self.ratio >= 10.0 && bootstrap.high > bootstrap.low =>
            {
                bootstrap
            }
            _ => self.wilson,
        }
    }
}

impl LossCount {
    fn take(&mut self, at: u64, weight: f64, (nominal, flown): (bool, bool), acted: bool) {
        self.nominal += u64::from(nominal);
        self.flown += u64::from(flown);
        self.induced += u64::from(flown && !nominal);
        self.clear += u64::from(!nominal);
        self.needless += u64::from(acted && !nominal);
        if nominal || flown {
            self.cases.push(Case {
                at,
                weight,
                nominal,
                flown,
            });
        }
    }

    /// The ratio; `None` without any loss in the flights without avoidance.
    pub fn ratio(&self) -> Option<RiskRatio> {
        ratio_of(&self.cases)
    }

    /// The ratio after growing numbers of encounters, each about a quarter more than the previous one:
    /// number, ratio.
    pub fn convergence(&self, encounters: u64) -> Vec<(u64, RiskRatio)> {
        let mut curve = Vec::new();
        let mut count = 10;
        loop {
            let until = count.min(encounters);
            let cases = self.cases.partition_point(|case| case.at <= until);
            if let Some(ratio) = ratio_of(self.cases.get(..cases).unwrap_or_default()) {
                curve.push((until, ratio));
            }
            if until >= encounters {
                return curve;
            }
            count = (count * 5).div_ceil(4);
        }
    }

    /// Weighted share of encounters with a loss without avoidance and as flown, of the total weight.
    pub fn rates(&self, weight: f64) -> (f64, f64) {
        let (nominal, flown) = sums(self.cases.iter().map(|case| (case, 1.0)));
        (nominal / weight, flown / weight)
    }
}

/// Weighted counts of losses without avoidance and as flown.
fn sums<'a>(cases: impl Iterator<Item = (&'a Case, f64)>) -> (f64, f64) {
    cases.fold((0.0, 0.0), |(nominal, flown), (case, times)| {
        let weight = case.weight * times;
        (
            nominal + if case.nominal { weight } else { 0.0 },
            flown + if case.flown { weight } else { 0.0 },
        )
    })
}

fn ratio_of(cases: &[Case]) -> Option<RiskRatio> {
    let (nominal, flown) = sums(cases.iter().map(|case| (case, 1.0)));
    if nominal <= 0.0 {
        return None;
    }
    let squares: f64 = cases
        .iter()
        .filter(|case| case.nominal)
        .map(|case| case.weight * case.weight)
        .sum();
    let effective = nominal * nominal / squares;
    let ratio = flown / nominal;
    Some(RiskRatio {
        ratio,
        bootstrap: (flown > 0.0).then(|| bootstrap(cases)).flatten(),
        wilson: wilson(ratio.min(1.0), effective),
        effective,
    })
}

/// Wilson's score interval of a share; the number of trials need not be whole.
fn wilson(share: f64, trials: f64) -> Interval {
    let z2 = Z95 * Z95;
    let middle = (share + z2 / (2.0 * trials)) / (1.0 + z2 / trials);
    let half = Z95 / (1.0 + z2 / trials)
        * libm::sqrt(share * (1.0 - share) / trials + z2 / (4.0 * trials * trials));
    Interval {
        low: (middle - half).clamp(0.0, share),
        high: (middle + half).clamp(share, 1.0),
    }
}

/// Encounters without any loss do not change the ratio, so only those with one are drawn.
fn bootstrap(cases: &[Case]) -> Option<Interval> {
    let ratios: Vec<f64> = (0..SAMPLES as u64)
        .filter_map(|sample| {
            let mut random = Random::new(SEED, sample);
            let (nominal, flown) = sums(cases.iter().map(|case| (case, poisson(&mut random))));
            (nominal > 0.0).then(|| flown / nominal)
        })
        .collect();
    percentiles(ratios)
}

/// The result of one policy for one class of encounters.
#[derive(Debug, Clone, Default)]
pub struct PolicyRisk {
    /// Encounters.
    pub encounters: u64,
    /// Sum of their weights.
    pub weight: f64,
    weight_squares: f64,
    /// Encounters with a maneuver.
    pub acted: u64,
    /// The losses, in the order of [`LossRule::ALL`].
    pub losses: [LossCount; 3],
    /// How near each encounter came, where the tail is asked for.
    nearness: Vec<Nearness>,
}

impl PolicyRisk {
    fn take(&mut self, row: &Row) {
        self.encounters += 1;
        self.weight += row.weight;
        self.weight_squares += row.weight * row.weight;
        let acted = row.start_s.is_some();
        self.acted += u64::from(acted);
        for (count, loss) in self.losses.iter_mut().zip(LossRule::ALL) {
            if let Some(lost) = loss.of(&row.metrics) {
                count.take(self.encounters, row.weight, lost, acted);
            }
        }
    }

    /// The risk of a near mid-air collision beyond what was counted; only for the class of all encounters.
    pub fn tail(&self) -> Option<Tail> {
        tail(&self.nearness)
    }

    /// The effective number of encounters.
    pub fn effective(&self) -> f64 {
        if self.weight_squares > 0.0 {
            self.weight * self.weight / self.weight_squares
        } else {
            0.0
        }
    }
}

/// Risks of all policies by class.
#[derive(Debug, Clone, Default)]
pub struct Risks {
    by_class: BTreeMap<(u32, RiskClass), PolicyRisk>,
}

impl Risks {
    /// Adds a row; one without metrics is no encounter of aircraft and does not count.
    pub fn take(&mut self, row: &Row) {
        if row.metrics.nominal_nmac.is_none() {
            return;
        }
        let classes = [
            Some(RiskClass::All),
            Some(RiskClass::Source(row.source)),
            row.metrics.geometry().map(RiskClass::EncounterGeometry),
            RiskClass::speed(&row.metrics),
        ];
        for class in classes.into_iter().flatten() {
            let is_all = class == RiskClass::All;
            let risk = self.by_class.entry((row.policy, class)).or_default();
            risk.take(row);
            if is_all && let Some(scale) = row.metrics.nmac_scale {
                risk.nearness.push(Nearness {
                    weight: row.weight,
                    // A written scale of 0 is a hit.
                    y: -libm::log(scale.max(1e-6)),
                    nominal: row.metrics.nominal_nmac == Some(true),
                });
            }
        }
    }

    /// Whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.by_class.is_empty()
    }

    /// The risk of a policy over all encounters.
    pub fn of(&self, policy: u32) -> Option<&PolicyRisk> {
        self.by_class.get(&(policy, RiskClass::All))
    }

    /// The risks of each policy and class.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &RiskClass, &PolicyRisk)> {
        self.by_class
            .iter()
            .map(|((policy, class), risk)| (*policy, class, risk))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(cases: &[(f64, bool, bool)]) -> LossCount {
        let mut count = LossCount::default();
        for ((weight, nominal, flown), at) in cases.iter().zip(1..) {
            count.take(at, *weight, (*nominal, *flown), *nominal);
        }
        count
    }

    #[test]
    fn a_ratio_is_weighted_and_counts_what_is_induced() {
        let count = count(&[
            (1.0, true, false),
            (3.0, true, true),
            (2.0, false, true),
            (9.0, false, false),
        ]);
        let ratio = count.ratio().unwrap();
        assert!((ratio.ratio - 5.0 / 4.0).abs() < 1e-12);
        // (1 + 3)² / (1 + 9).
        assert!((ratio.effective - 1.6).abs() < 1e-12);
        assert_eq!((count.nominal, count.flown, count.induced), (2, 2, 1));
        assert_eq!((count.clear, count.needless), (2, 0));
        let (nominal, flown) = count.rates(15.0);
        assert!((nominal - 4.0 / 15.0).abs() < 1e-12 && (flown - 5.0 / 15.0).abs() < 1e-12);
    }

    #[test]
    fn the_intervals_cover_as_often_as_they_say() {
        // 200 campaigns of 300 losses, of which a fifth is left; the true ratio is 0.2.
        let mut covered = [0; 2];
        for campaign in 0..200 {
            let mut random = Random::new(7, campaign);
            let cases: Vec<_> = (0..300)
                .map(|_| (0.5 + random.unit(), true, random.unit() < 0.2))
                .collect();
            let ratio = count(&cases).ratio().unwrap();
            for (covered, interval) in covered
                .iter_mut()
                .zip([ratio.bootstrap.unwrap(), ratio.wilson])
            {
                *covered += i32::from(interval.low <= 0.2 && 0.2 <= interval.high);
            }
        }
        // 95 % of 200 within four standard deviations.
        for covered in covered {
            assert!((178..=200).contains(&covered), "{covered}");
        }
    }

    #[test]
    fn where_nothing_is_left_the_upper_end_is_wilsons() {
        let count = count(&[(1.0, true, false); 27]);
        let ratio = count.ratio().unwrap();
        assert_eq!((ratio.ratio, ratio.bootstrap), (0.0, None));
        // Wilson's for 0 of 27: z² / (n + z²).
        assert!((ratio.interval().high - 3.8415 / 30.8415).abs() < 1e-4);
        assert_eq!(count.convergence(27).last().unwrap().0, 27);
    }

    #[test]
    fn a_poisson_number_has_mean_and_variance_one() {
        let mut random = Random::new(1, 1);
        let numbers: Vec<f64> = (0..20_000).map(|_| poisson(&mut random)).collect();
        let mean = numbers.iter().sum::<f64>() / 20_000.0;
        let variance = numbers.iter().map(|n| (n - mean).powi(2)).sum::<f64>() / 20_000.0;
        assert!(
            (mean - 1.0).abs() < 0.03 && (variance - 1.0).abs() < 0.06,
            "{mean} {variance}"
        );
    }
}
