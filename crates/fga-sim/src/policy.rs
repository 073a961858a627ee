//! Policies by name, and the step that all of them share.

use fga::avoider::{Avoider, Decision, Policy, Settings, SettingsError, Start};
use fga::situation::Situation;
use fga::vehicle::Vehicle;

use crate::baselines::Baseline;

/// Whatever decides: one step a cycle, from a situation to what is flown until the next.
pub trait Pilot {
    /// Decides what to fly until the next step.
    fn step(&mut self, situation: &Situation<'_>) -> Decision;

    /// Takes over changed limits of the vehicle; called only before it has manoeuvred.
    fn retune(&mut self, _vehicle: &Vehicle) {}

    /// Forgets the last flight: the next step is the first of another one, with a vehicle of the
    /// limits that it was made for.
    fn restart(&mut self);
}

/// The core's avoider.
#[derive(Debug)]
pub struct CorePilot {
    avoider: Avoider,
    vehicle: Vehicle,
}

impl CorePilot {
    /// An avoider in cruise.
    ///
    /// # Errors
    /// Settings or limits that are not usable.
    pub fn new(settings: Settings, vehicle: Vehicle) -> Result<Self, SettingsError> {
        Ok(Self {
            avoider: Avoider::new(settings, vehicle)?,
            vehicle,
        })
    }
}

impl Pilot for CorePilot {
    fn step(&mut self, situation: &Situation<'_>) -> Decision {
        self.avoider.step(situation)
    }

    fn retune(&mut self, vehicle: &Vehicle) {
        // Limits that the core refuses leave it with those that it has.
        let _ = self.avoider.set_vehicle(*vehicle);
    }

    fn restart(&mut self) {
        self.avoider.restart();
        if *self.avoider.vehicle() != self.vehicle {
            // It had these limits before.
            let _ = self.avoider.set_vehicle(self.vehicle);
        }
    }
}

/// A policy as it is named on the command line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PolicyChoice {
    /// One of the core's.
    Core(Policy),
    /// A baseline or a peer.
    Baseline(Baseline),
}

/// Names of the policies, for messages and help.
pub const POLICY_NAMES: &str = "turn-aware, published, published-literal, circle, none, \
     potential-field, waypoint-greedy, waypoint-optimal, orca, mvp, velocity-obstacles";

impl Default for PolicyChoice {
    fn default() -> Self {
        Self::Core(Policy::TurnAware(Start::Free))
    }
}

impl PolicyChoice {
    /// The policy called `name` with the start `start` (`t0`, `tc`, `latest`, `free`, `Cs=0.5`).
    ///
    /// # Errors
    /// A name or a start that is not known, or a start that the policy does not have; one
    /// sentence.
    pub fn parse(name: &str, start: Option<&str>) -> Result<Self, String> {
        let chosen = start.map(parse_start).transpose()?;
        let without_start = |policy| match start {
            None => Ok(Self::Core(policy)),
            Some(start) => Err(no_start(name, start)),
        };
        match name {
            "turn-aware" => Ok(Self::Core(Policy::TurnAware(chosen.unwrap_or(Start::Free)))),
            "published" => match chosen.unwrap_or(Start::Latest) {
                Start::Free => Err(
                    "policy published has no free start, expected --start t0, tc or Cs=0 to 1"
                        .into(),
                ),
                start => Ok(Self::Core(Policy::Published(start))),
            },
            "published-literal" => without_start(Policy::PublishedLiteral),
            "circle" => without_start(Policy::Circle),
            "none" => without_start(Policy::None),
            other => match (Baseline::parse(other), start) {
                (Some(baseline), None) => Ok(Self::Baseline(baseline)),
                (Some(_), Some(start)) => Err(no_start(other, start)),
                (None, _) => Err(format!(
                    "unknown policy {}, expected one of {POLICY_NAMES}",
                    fga_formats::error::shown(other)
                )),
            },
        }
    }

    /// The policy's name as it is written on the command line.
    pub fn name(&self) -> String {
        let start_name = |start: Start| match start {
            Start::Free => String::new(),
            Start::AtDetection => " --start t0".into(),
            Start::Latest => " --start tc".into(),
            Start::Score(score) => format!(" --start Cs={score}"),
        };
        match self {
            Self::Core(policy) => match policy {
                Policy::None => "none".into(),
                Policy::Published(start) => format!("published{}", start_name(*start)),
                Policy::PublishedLiteral => "published-literal".into(),
                Policy::Circle => "circle".into(),
                Policy::TurnAware(Start::Latest) => "turn-aware --start latest".into(),
                Policy::TurnAware(start) => format!("turn-aware{}", start_name(*start)),
            },
            Self::Baseline(baseline) => baseline.name().into(),
        }
    }

    /// A pilot that flies by this policy.
    ///
    /// # Errors
    /// Settings or limits that are not usable.
    pub fn pilot(
        &self,
        settings: &Settings,
        vehicle: &Vehicle,
    ) -> Result<Box<dyn Pilot + Send>, SettingsError> {
        match *self {
            Self::Core(policy) => {
                let settings = Settings {
                    policy,
                    ..*settings
                };
                Ok(Box::new(CorePilot::new(settings, *vehicle)?))
            }
            Self::Baseline(baseline) => baseline.pilot(settings, vehicle),
        }
    }
}

fn no_start(name: &str, start: &str) -> String {
    format!("policy {name} has no start time, found --start {start}; expected none")
}

fn parse_start(text: &str) -> Result<Start, String> {
    match text {
        "t0" => Ok(Start::AtDetection),
        "tc" | "latest" => Ok(Start::Latest),
        "free" => Ok(Start::Free),
        other => other
            .strip_prefix("Cs=")
            .and_then(|score| score.parse::<f64>().ok())
            .filter(|score| (0.0..=1.0).contains(score))
            .map(Start::Score)
            .ok_or_else(|| {
                format!(
                    "unknown start {}, expected t0, tc, latest, free or Cs=0 to Cs=1",
                    fga_formats::error::shown(other)
                )
            }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_starts() {
        let parse = |name, start| PolicyChoice::parse(name, start).unwrap();
        assert_eq!(parse("turn-aware", None), PolicyChoice::default());
        for (name, start, shown) in [
            ("published", None, "published --start tc"),
            ("published", Some("t0"), "published --start t0"),
            ("turn-aware", Some("latest"), "turn-aware --start latest"),
            ("turn-aware", Some("Cs=0.5"), "turn-aware --start Cs=0.5"),
            ("none", None, "none"),
        ] {
            assert_eq!(parse(name, start).name(), shown);
        }
        for (name, start) in [
            ("nobody", None),
            ("none", Some("t0")),
            ("published", Some("free")),
            ("published", Some("Cs=1.5")),
            ("published", Some("Cs=x")),
        ] {
            assert!(
                PolicyChoice::parse(name, start).is_err(),
                "{name} {start:?}"
            );
        }
    }
}
