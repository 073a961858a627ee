//! Policies by name, and the step that all of them share.
use crate::mission_pilot::MissionPilot;
use fga::avoider::belief::BeliefAvoider;
use fga::avoider::{Avoider, Settings, SettingsError, Start};
pub use fga::pilot::Pilot;
use fga::vehicle::Vehicle;
use fga_paper::pilot::{PaperPilot, Rule};

use crate::ahead::Ahead;
use crate::baselines::Baseline;
use crate::own::{OwnPolicy, piped};
pub use crate::policy_pilot::PolicyPilot;
pub use crate::settings::PolicySettings;
use crate::world::World;

/// A policy by its name on the command line.
#[derive(Debug, Clone, PartialEq)]
pub enum PolicyChoice {
    /// The core's policy: [`Self::Belief`] where one sensor sees all, its reports have errors, all that it sees are aircraft, and the start
    /// is free; else [`Self::WorstCase`].
    Avoider(Start),
    /// Clear of the worst that aircraft may do, whatever the errors of reports.
    WorstCase,
    /// The least expected cost among the futures of a belief, also where reports are exact.
    Belief,
    /// The mission, whatever comes.
    Mission,
    /// One of the paper's rules.
    Paper(Rule),
    /// A baseline or a peer.
    Baseline(Baseline),
    /// One outside of this crate.
    Own(OwnPolicy),
}

/// Names of the policies, for messages and help.
pub fn policy_names() -> String {
    let baselines = Baseline::every().map(Baseline::name);
    let baselines = baselines.collect::<Vec<_>>().join(", ");
    format!(
        "turn-aware, {WORST_CASE}, {BELIEF}, published, published-literal, circle, none, {baselines}, pipe:PROGRAM"
    )
}

/// The names of the two ways to decide among aircraft.
const WORST_CASE: &str = "worst-case";
const BELIEF: &str = "belief";

/// The beginning of the name of a policy that is an object in Python.
pub const PYTHON: &str = "python:";

impl Default for PolicyChoice {
    fn default() -> Self {
        Self::Avoider(Start::Free)
    }
}

impl PolicyChoice {
    /// The policy called `name` with the start `start` (`t0`, `tc`, `latest`, `free`, `Cs=0.5`).
    ///
    /// # Errors
    /// An unknown name or start, or a start that the policy does not have; one sentence.
    pub fn parse(name: &str, start: Option<&str>) -> Result<Self, String> {
        if let Some(own) = piped(name) {
            return match start {
                None => own.map(Self::Own),
                Some(start) => Err(no_start(name, start)),
            };
        }
        let chosen = start.map(parse_start).transpose()?;
        let without_start = |policy| match start {
            None => Ok(policy),
            Some(start) => Err(no_start(name, start)),
        };
        match name {
            "turn-aware" => Ok(Self::Avoider(chosen.unwrap_or(Start::Free))),
            "published" => match chosen.unwrap_or(Start::Latest) {
                Start::Free => Err(
                    "policy published has no free start, expected --start t0, tc or Cs=0 to 1"
                        .into(),
                ),
                start => Ok(Self::Paper(Rule::Corrected(start))),
            },
            "published-literal" => without_start(Self::Paper(Rule::AsPrinted)),
            "circle" => without_start(Self::Paper(Rule::Circle)),
            "none" => without_start(Self::Mission),
            WORST_CASE => without_start(Self::WorstCase),
            BELIEF => without_start(Self::Belief),
            other => match (Baseline::parse(other), start) {
                (Some(baseline), None) => Ok(Self::Baseline(baseline)),
                (Some(_), Some(start)) => Err(no_start(other, start)),
                (None, _) if other.starts_with(PYTHON) => Err(format!(
                    "policy {} is an object of a Python program, expected it to be given there",
                    fga_formats::error::shown(other)
                )),
                (None, _) => Err(format!(
                    "unknown policy {}, expected one of {}",
                    fga_formats::error::shown(other),
                    policy_names()
                )),
            },
        }
    }

    /// Whether it keeps to the zones of a world.
    pub const fn knows_zones(&self) -> bool {
        matches!(self, Self::Avoider(_) | Self::WorstCase | Self::Belief)
    }

    /// The world as it must see it, where that differs: reports without a tracker, and their errors.
    pub fn sees(&self, world: &World) -> Option<World> {
        let believes = match self {
            Self::Avoider(Start::Free) => {
                let mut unsure = world.obstacles.iter();
                !world.sensor.errors().is_exact()
                    && world.more_sensors.is_empty()
                    && unsure
                        .all(|it| it.charted_sigma_m.is_some() || it.movement.bounds().is_some())
            }
            Self::Belief => true,
            _ => false,
        };
        believes.then(|| world.as_reported())
    }

    /// The policy's name on the command line.
    pub fn name(&self) -> String {
        let start_name = |start: Start| match start {
            Start::Free => String::new(),
            Start::AtDetection => " --start t0".into(),
            Start::Latest => " --start tc".into(),
            Start::Score(score) => format!(" --start Cs={score}"),
        };
        match self {
            Self::Avoider(Start::Latest) => "turn-aware --start latest".into(),
            Self::Avoider(start) => format!("turn-aware{}", start_name(*start)),
            Self::Mission => "none".into(),
            Self::WorstCase => WORST_CASE.into(),
            Self::Belief => BELIEF.into(),
            Self::Paper(Rule::Corrected(start)) => format!("published{}", start_name(*start)),
            Self::Paper(Rule::AsPrinted) => "published-literal".into(),
            Self::Paper(Rule::Circle) => "circle".into(),
            Self::Baseline(baseline) => baseline.name().into(),
            Self::Own(own) => own.name().into(),
        }
    }

    /// The policy, if it is one outside of this crate.
    pub const fn own(&self) -> Option<&OwnPolicy> {
        match self {
            Self::Own(own) => Some(own),
            _ => None,
        }
    }

    /// A pilot that flies by this policy.
    ///
    /// # Errors
    /// Unusable settings or limits.
    pub fn pilot(
        &self,
        settings: &PolicySettings,
        vehicle: &Vehicle,
    ) -> Result<Box<dyn PolicyPilot + Send>, SettingsError> {
        let avoider = &settings.avoider;
        match self {
            Self::Avoider(start) if *start != Start::Free || settings.errors.is_exact() => {
                let settings = Settings {
                    start: *start,
                    ..*avoider
                };
                Ok(ahead(Avoider::new(settings, *vehicle)?, vehicle))
            }
            Self::WorstCase => Ok(ahead(Avoider::new(*avoider, *vehicle)?, vehicle)),
            Self::Avoider(_) | Self::Belief => {
                let pilot = BeliefAvoider::new(*avoider, *vehicle, settings.errors)?;
                Ok(ahead(pilot, vehicle))
            }
            Self::Mission => {
                avoider.check()?;
                Ok(Box::new(MissionPilot::new(avoider.horizon_s, *vehicle)?))
            }
            Self::Paper(rule) => {
                let paper = PaperPilot::new(settings.of_paper(*rule), *vehicle)?;
                // The other rules begin their turns earlier by the dead time.
                Ok(if *rule == Rule::Circle {
                    ahead(paper, vehicle)
                } else {
                    Box::new(paper)
                })
            }
            Self::Baseline(baseline) => baseline.pilot(avoider, vehicle),
            Self::Own(own) => Ok(Box::new(own.pilot(settings, vehicle)?)),
        }
    }
}

/// A pilot that decides for the end of the dead time of a vehicle, if it has one.
fn ahead(
    pilot: impl PolicyPilot + Send + 'static,
    vehicle: &Vehicle,
) -> Box<dyn PolicyPilot + Send> {
    if vehicle.response.dead_time_s > 0.0 {
        Box::new(Ahead::new(pilot, vehicle))
    } else {
        Box::new(pilot)
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
            ("worst-case", None, "worst-case"),
            ("none", None, "none"),
        ] {
            assert_eq!(parse(name, start).name(), shown);
        }
        for (name, start) in [
            ("nobody", None),
            ("none", Some("t0")),
            ("worst-case", Some("t0")),
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
