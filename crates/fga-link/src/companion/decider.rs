//! Who decides: one of our own policies, or the paper's Algorithm 4.

use fga::avoider::belief::{BeliefAvoider, Errors, Sigma, Source};
use fga::avoider::{Avoider, Decision, Settings, Start, State};
use fga::limit::SettingsError;
use fga::pilot::Pilot as _;
use fga::situation::Situation;
use fga::vehicle::Vehicle;
use fga_paper::pilot::{PaperPilot, PaperSettings, Rule};

use crate::config::{CommandMode, Config, PolicyName};
use crate::traffic::motion::COARSEST_STEP_M;
use crate::traffic::report::VELOCITY_SIGMA_MPS;

/// How much faster than estimated a vehicle may turn: the estimate of the turn-rate factor is a little low.
const TURN_RATE_EXCESS: f64 = 1.07;

/// Where the configuration has no safety score: a manoeuvre for obstacles at rest begins after this share of the time until the
/// latest certified start. The least departure from the mission would begin as soon as the obstacle is seen, and hold the mode for
/// a minute; manoeuvres for aircraft wait anyway.
const LATE_SCORE: f64 = 0.9;

/// The errors of a report that does not say them; that of its altitude's datum is in the volume.
#[expect(clippy::cast_possible_truncation, reason = "standard deviations")]
fn assumed_errors(position_sigma_m: f64) -> Errors {
    let assumed = |value: f64| Sigma::new(value as f32, Source::Assumed);
    // σ of what is rounded to steps: no report says which encoder counted.
    let altitude_m = COARSEST_STEP_M / libm::sqrt(12.0);
    Errors {
        position_m: assumed(position_sigma_m),
        altitude_m: Sigma::new(altitude_m as f32, Source::Standard),
        velocity_mps: assumed(VELOCITY_SIGMA_MPS),
        climb_mps: assumed(VELOCITY_SIGMA_MPS),
        ..Errors::default()
    }
}

/// The pilot of a companion.
#[derive(Debug, Clone)]
pub(super) enum CompanionPilot {
    Avoider(Box<Avoider>),
    Belief(Box<BeliefAvoider>),
    Paper(Box<PaperPilot>),
}

impl CompanionPilot {
    pub(super) fn new(config: &Config, vehicle: Vehicle) -> Result<Self, SettingsError> {
        let protection = &config.protection;
        let decision_period_s = config.command.decision_period_s;
        // The caller has left out distant obstacles.
        let surveillance_radius_m = f64::INFINITY;
        if config.command.mode == CommandMode::Paper {
            let settings = PaperSettings {
                decision_period_s,
                surveillance_radius_m,
                horizon_s: protection.horizon_s,
                margin_m: protection.margin_m,
                confidence_sigmas: protection.confidence_sigmas,
                turn_rate_excess: TURN_RATE_EXCESS,
                ..PaperSettings::new(Rule::Circle)
            };
            return Ok(Self::Paper(Box::new(PaperPilot::new(settings, vehicle)?)));
        }
        let settings = Settings {
            start: Start::Score(protection.safety_score.unwrap_or(LATE_SCORE)),
            decision_period_s,
            surveillance_radius_m,
            horizon_s: protection.horizon_s,
            margin_m: protection.margin_m,
            confidence_sigmas: protection.confidence_sigmas,
            ..Settings::default()
        };
        Ok(match config.command.policy {
            PolicyName::WorstCase => Self::Avoider(Box::new(Avoider::new(settings, vehicle)?)),
            PolicyName::Belief => {
                let errors = assumed_errors(config.traffic.position_sigma_m);
                Self::Belief(Box::new(BeliefAvoider::new(settings, vehicle, errors)?))
            }
        })
    }

    pub(super) fn step(&mut self, situation: &Situation<'_>) -> Decision {
        match self {
            Self::Avoider(avoider) => avoider.step(situation),
            Self::Belief(avoider) => {
                // The table of tracks says who is there, and for how long.
                avoider.forget_absent(situation);
                avoider.step(situation)
            }
            Self::Paper(pilot) => pilot.step(situation),
        }
    }

    /// The avoider, or the one of a choice among beliefs; `None` of Algorithm 4.
    const fn avoider(&self) -> Option<&Avoider> {
        match self {
            Self::Avoider(avoider) => Some(avoider),
            Self::Belief(avoider) => Some(avoider.avoider()),
            Self::Paper(_) => None,
        }
    }

    /// The same, to change its limits.
    const fn avoider_mut(&mut self) -> Option<&mut Avoider> {
        match self {
            Self::Avoider(avoider) => Some(avoider),
            Self::Belief(avoider) => Some(avoider.avoider_mut()),
            Self::Paper(_) => None,
        }
    }

    /// The limits that are planned with.
    pub(super) fn vehicle(&self) -> &Vehicle {
        match self {
            Self::Avoider(avoider) => avoider.vehicle(),
            Self::Belief(avoider) => avoider.avoider().vehicle(),
            Self::Paper(pilot) => pilot.vehicle(),
        }
    }

    /// The limits of plans in need; `None` where they are the ordinary ones.
    pub(super) fn vehicle_in_need(&self) -> Option<&Vehicle> {
        self.avoider()?.vehicle_in_need()
    }

    pub(super) const fn state(&self) -> State {
        match self {
            Self::Avoider(avoider) => avoider.state(),
            Self::Belief(avoider) => avoider.avoider().state(),
            Self::Paper(pilot) => pilot.state(),
        }
    }

    /// Index of the waypoint at the start of the leg that is flown.
    pub(super) fn leg_index(&self) -> usize {
        match self {
            Self::Avoider(avoider) => avoider.leg_index(),
            Self::Belief(avoider) => avoider.avoider().leg_index(),
            Self::Paper(pilot) => pilot.leg_index(),
        }
    }

    /// Whether its manoeuvres are certified with its limits, so that they may be flown on without telemetry. Algorithm 4 follows its circle by
    /// the airspeed that the vehicle flies now.
    pub(super) const fn certifies(&self) -> bool {
        self.avoider().is_some()
    }

    /// Takes over other limits. Limits that cannot be flown change nothing.
    pub(super) fn retune(&mut self, vehicle: &Vehicle) {
        match self {
            Self::Avoider(avoider) => avoider.retune(vehicle),
            Self::Belief(avoider) => avoider.retune(vehicle),
            Self::Paper(pilot) => pilot.retune(vehicle),
        }
    }

    /// Sets the velocity with which it may leave its prediction, metres per second; Algorithm 4 has no such margin.
    pub(super) fn set_drift(&mut self, drift_mps: f64) {
        if let Some(avoider) = self.avoider_mut() {
            // One out of range changes nothing.
            let _ = avoider.set_drift(drift_mps);
        }
    }

    /// Sets when a manoeuvre begins; Algorithm 4 has its own rule.
    pub(super) fn set_start(&mut self, start: Start) {
        if let Some(avoider) = self.avoider_mut() {
            // Only a score can be out of range.
            let _ = avoider.set_start(start);
        }
    }

    /// Takes over other limits in need; those that cannot be flown change nothing.
    pub(super) fn set_vehicle_in_need(&mut self, vehicle: Option<Vehicle>) {
        if let Some(avoider) = self.avoider_mut() {
            // Limits that cannot be flown change nothing.
            let _ = avoider.set_vehicle_in_need(vehicle);
        }
    }
}

#[cfg(test)]
mod tests {
    use fga::Vec3;
    use fga::avoider::belief::Beliefs;
    use fga::situation::{Mission, Obstacles, Ownship};
    use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};

    use super::*;
    use crate::traffic::report::Quality;
    use crate::traffic::table::Wanted;
    use crate::traffic::{
        AltitudeReference, PlaceReport, ReportSender, ReportSource, TrackTable, Volumes,
    };

    const OWN_M: Vec3 = Vec3::new(0.0, 0.0, 1000.0);
    /// From a report's time to the decision, seconds.
    const LATE_S: f64 = 0.6;
    /// Weights of the modes of a belief after its first report.
    const FIRST_MODES: [f64; 4] = [0.75, 0.1, 0.075, 0.075];

    /// Uniform numbers.
    struct Random(u64);

    impl Random {
        fn within(&mut self, half: f64) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
            self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
            let unit = f64::from(u32::try_from(self.0 >> 32).unwrap()) / f64::from(u32::MAX);
            half * (2.0 * unit - 1.0)
        }
    }

    /// A report of a true position and velocity.
    struct Said {
        position_m: Vec3,
        velocity_mps: Option<Vec3>,
        climb_is_known: bool,
        /// Error of its time, seconds.
        off_s: f64,
    }

    impl Said {
        fn of(position_m: Vec3, velocity_mps: Vec3) -> Self {
            Self {
                position_m,
                velocity_mps: Some(velocity_mps),
                climb_is_known: true,
                off_s: 0.0,
            }
        }
    }

    /// What beliefs say against the truth.
    #[derive(Debug, Default)]
    struct Judged {
        reports: u32,
        /// Beliefs that were thrown away for new ones.
        resets: u32,
        /// Sums of squared errors over their variances: position along an axis, altitude, climb rate.
        ratios: [f64; 3],
        /// Sum of squared errors of the climb rate, m²/s².
        climb_m2ps2: f64,
    }

    impl Judged {
        /// Adds errors of position, metres, and climb rate, metres per second, with the variances that the belief states: of a horizontal
        /// axis, of the altitude, of the climb rate.
        fn add(&mut self, off_m: Vec3, off_mps: f64, variances: [f64; 3]) {
            let level_m2 = 0.5 * (off_m.x * off_m.x + off_m.y * off_m.y);
            let squares = [level_m2, off_m.z * off_m.z, off_mps * off_mps];
            self.reports += 1;
            self.climb_m2ps2 += squares[2];
            for ((sum, square), variance) in self.ratios.iter_mut().zip(squares).zip(variances) {
                *sum += square / variance;
            }
        }

        /// Mean squared errors over their variances, 1 where the beliefs are right: position along an axis, altitude, climb rate.
        fn means(&self) -> [f64; 3] {
            self.ratios.map(|sum| sum / f64::from(self.reports))
        }

        /// Root mean square error of the climb rate, metres per second.
        fn climb_off_mps(&self) -> f64 {
            libm::sqrt(self.climb_m2ps2 / f64::from(self.reports))
        }
    }

    /// The aircraft of `tracks` as the policy has them at `at_s`, seconds.
    fn heard(tracks: &mut TrackTable, beliefs: &mut Beliefs, config: &Config, at_s: f64) {
        let wanted = Wanted {
            at_s,
            own_m: OWN_M,
            own_altitude_m: OWN_M.z,
            within_m: f64::INFINITY,
            volumes: Volumes::new(config),
            most: 64,
            as_reported: true,
        };
        let mut obstacles = Vec::new();
        tracks.obstacles(&wanted, &mut obstacles);
        let situation = Situation {
            time_s: at_s,
            ownship: Ownship {
                position_m: OWN_M,
                course_rad: 0.0,
                climb_rad: 0.0,
                bank_rad: 0.0,
                airspeed_mps: 25.0,
            },
            obstacles: Obstacles::Rows(&obstacles),
            mission: Mission::new(&[]),
            wind_mps: Vec3::ZERO,
        };
        beliefs.hear(&situation, &assumed_errors(config.traffic.position_sigma_m));
    }

    /// What is believed in 20 flights with these positions and velocities over time, reported each second as `say` says.
    fn judged(
        seconds: u32,
        truth: impl Fn(f64) -> (Vec3, Vec3),
        say: impl FnMut(&mut Random, Vec3, Vec3) -> Said,
    ) -> Judged {
        judged_by(&Config::default(), seconds, truth, say)
    }

    /// The same by a configuration.
    fn judged_by(
        config: &Config,
        seconds: u32,
        truth: impl Fn(f64) -> (Vec3, Vec3),
        mut say: impl FnMut(&mut Random, Vec3, Vec3) -> Said,
    ) -> Judged {
        let sigma_m = config.traffic.position_sigma_m;
        let frame = LocalFrame::new(Geodetic::new(47.0, 8.0, 0.0).unwrap(), Earth::Wgs84);
        let sender = ReportSender::mavlink(ReportSource::Mavlink, 200, 156);
        let mut random = Random(7);
        let mut judged = Judged::default();
        for flight in 0..20 {
            // Other heights within a step of 100 ft.
            let higher_m = Vec3::Z * (1.5 * f64::from(flight));
            let mut tracks = TrackTable::new(&config.traffic, None);
            let mut beliefs = Beliefs::new();
            for second in 0..seconds {
                let (true_s, at_s) = (f64::from(second), f64::from(second) + LATE_S);
                let (position_m, velocity_mps) = truth(true_s);
                let said = say(&mut random, position_m + higher_m, velocity_mps);
                let quality = Quality {
                    velocity_mps: VELOCITY_SIGMA_MPS,
                    climb_is_known: said.climb_is_known,
                    ..Quality::of_position(sigma_m, AltitudeReference::MeanSeaLevel)
                };
                let (place, valid_s) = (frame.to_geodetic(said.position_m), true_s + said.off_s);
                let report = PlaceReport {
                    icao: 0x00AB_CDEF,
                    velocity_mps: said.velocity_mps,
                    ..PlaceReport::of_position(sender, place, valid_s, quality)
                };
                tracks.take(&report, &frame, at_s);
                heard(&mut tracks, &mut beliefs, config, at_s);
                let mut each = beliefs.each();
                let (_, _, belief) = each.next().unwrap();
                assert!(each.next().is_none(), "one aircraft");
                let (position_m, velocity_mps) = truth(at_s);
                let said = belief.at(at_s);
                let off_m = said.position_m - position_m - higher_m;
                let [level_m, altitude_m] = said.lasting_m;
                let variances = [
                    said.horizontal_variance[0] + level_m * level_m,
                    said.vertical_variance[0] + altitude_m * altitude_m,
                    said.vertical_variance[1],
                ];
                judged.add(off_m, said.velocity_mps.z - velocity_mps.z, variances);
                let modes = belief.at(belief.time_s()).modes.into_iter();
                let mut modes = modes.zip(FIRST_MODES);
                let is_new = modes.all(|(now, first)| (now - first).abs() < 1e-6);
                judged.resets += u32::from(is_new && second > 0);
            }
        }
        let (means, off_mps) = (judged.means(), judged.climb_off_mps());
        eprintln!(
            "{} resets, {means:.2?}, climb off {off_mps:.2} m/s",
            judged.resets
        );
        judged
    }

    /// Level at 60 m/s to the north-east, then with a climb rate from a time on, seconds.
    fn flight(climb_mps: f64, from_s: f64) -> impl Fn(f64) -> (Vec3, Vec3) {
        move |at_s| {
            let level_mps = Vec3::new(36.0, 48.0, 0.0);
            let climbed_m = climb_mps * (at_s - from_s).max(0.0);
            let climb_mps = if at_s < from_s { 0.0 } else { climb_mps };
            (
                level_mps * at_s + Vec3::Z * (1000.0 + climbed_m),
                level_mps + Vec3::Z * climb_mps,
            )
        }
    }

    fn in_steps(position_m: Vec3, step_m: f64) -> Vec3 {
        Vec3::new(
            position_m.x,
            position_m.y,
            (position_m.z / step_m).round() * step_m,
        )
    }

    /// Whole seconds are off by up to half of one: 30 m at 60 m/s.
    #[test]
    fn times_that_are_off_do_not_begin_a_belief_again() {
        let judged = judged(60, flight(0.0, 0.0), |random, position_m, velocity_mps| {
            Said {
                off_s: random.within(0.5),
                ..Said::of(position_m, velocity_mps)
            }
        });
        assert_eq!(judged.resets, 0);
        assert!(judged.means()[0] < 1.5, "{judged:?}");
    }

    /// The times of one sender may all be off by up to half a second: 30 m at 60 m/s, all of it along the way. No filter sees that.
    #[test]
    fn times_that_are_off_for_a_whole_flight_are_in_what_beliefs_say() {
        const SECONDS: u32 = 60;
        let mut said = 0;
        let judged = judged(SECONDS, flight(0.0, 0.0), |_, position_m, velocity_mps| {
            let flight = f64::from(said / SECONDS);
            said += 1;
            Said {
                off_s: 0.05 * (flight - 9.5),
                ..Said::of(position_m, velocity_mps)
            }
        });
        assert_eq!(judged.resets, 0);
        let along = 2.0 * judged.means()[0];
        assert!((0.8..1.3).contains(&along), "{judged:?}");
    }

    /// Positions by satellites are off by about the same for minutes: all of σ lasts.
    #[test]
    fn positions_that_are_off_for_a_whole_flight_are_in_what_beliefs_say() {
        const SECONDS: u32 = 60;
        let mut config = Config::default();
        config.traffic.position_sigma_m = 15.0;
        let truth = |at_s: f64| (Vec3::new(10.0 * at_s, 0.0, 1000.0), Vec3::X * 10.0);
        let mut said = 0;
        let judged = judged_by(&config, SECONDS, truth, |_, position_m, velocity_mps| {
            let flight = f64::from(said / SECONDS);
            said += 1;
            // Twenty quantiles of a circular normal distribution, each in another direction.
            let off_m = 15.0 * libm::sqrt(-2.0 * libm::log((flight + 0.5) / 20.0));
            let (sin, cos) = libm::sincos(2.4 * flight);
            Said::of(position_m + Vec3::new(cos, sin, 0.0) * off_m, velocity_mps)
        });
        assert_eq!(judged.resets, 0);
        assert!((0.8..1.3).contains(&judged.means()[0]), "{judged:?}");
    }

    /// Encoders that count in 100 ft, in a slow climb. While a step lasts so does its error, which the filter takes for a new one.
    #[test]
    fn steps_of_altitude_do_not_begin_a_belief_again() {
        for climb_is_known in [true, false] {
            let judged = judged(120, flight(1.0, 0.0), |_, position_m, velocity_mps| Said {
                climb_is_known,
                ..Said::of(in_steps(position_m, 30.48), velocity_mps)
            });
            assert_eq!(judged.resets, 0, "climb known: {climb_is_known}");
            assert!(judged.means()[1] < 6.0, "{judged:?}");
        }
    }

    /// A descent begins after half a minute of level flight. Nobody foresees it, so the climb rate is off by more than its σ at first.
    #[test]
    fn the_climb_that_altitudes_show_is_no_second_measurement() {
        for step_m in [7.62, 30.48] {
            let judged = judged(60, flight(-5.0, 30.0), |_, position_m, velocity_mps| Said {
                climb_is_known: false,
                ..Said::of(in_steps(position_m, step_m), velocity_mps)
            });
            assert_eq!(judged.resets, 0, "steps of {step_m} m");
            assert!(judged.means()[2] < 3.5, "steps of {step_m} m: {judged:?}");
        }
    }

    /// Those that state their climb keep its σ.
    #[test]
    fn a_reported_climb_counts_as_reported() {
        let judged = judged(60, flight(-5.0, 30.0), |_, position_m, velocity_mps| {
            Said::of(in_steps(position_m, 7.62), velocity_mps)
        });
        assert!(judged.climb_off_mps() < 1.0, "{judged:?}");
    }

    /// Positions alone show the velocity.
    #[test]
    fn the_velocity_that_positions_show_is_no_second_measurement() {
        let judged = judged(60, flight(0.0, 0.0), |random, position_m, velocity_mps| {
            Said {
                velocity_mps: None,
                off_s: random.within(0.2),
                ..Said::of(position_m, velocity_mps)
            }
        });
        assert_eq!(judged.resets, 0);
        assert!(judged.means()[0] < 1.5, "{judged:?}");
    }
}
