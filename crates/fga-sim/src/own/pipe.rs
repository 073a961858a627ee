//! A policy that is a program: it reads a situation a line and writes a command a line, both JSON.
//!
//! `docs/own-policy.md` describes the lines.

use alloc::sync::Arc;
use core::time::Duration;
use std::io::{BufRead, BufReader, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, PoisonError};

use fga::Vec3;
use fga::avoider::{Decision, Reason, State};
use fga::maneuver::{MAX_STAGES, Maneuver, Stage};
use fga::situation::{Movement, Obstacle, Passing, ProtectedVolume, Situation};
use fga::vehicle::Vehicle;
use fga_formats::error::shown;
use serde::Deserialize;
use serde_json::{Value, json};

use super::{FailureKind, Outside, OwnPolicy, PolicyAnswer, PolicyFailure, Silence, Worker};
use crate::fingerprint::fingerprint;
use crate::settings::PolicySettings;

/// The beginning of the name of such a policy; `pipe@5:` gives it 5 s a step.
pub const PREFIX: &str = "pipe";

/// Time limit of a step, seconds.
const LIMIT_S: f64 = 1.0;

/// Time limit of the first step of a program, which starts then, seconds.
const START_LIMIT_S: f64 = 10.0;

/// Longest time limit, seconds.
const LONGEST_LIMIT_S: f64 = 3600.0;

/// Longest line of an answer, bytes.
const LONGEST_LINE: u64 = 1 << 20;

/// The policy of a name such as `pipe:./my-policy --option` or `pipe@5:python3 planner.py`; `None` for a name of another kind.
/// Blanks separate the program from its arguments.
///
/// # Errors
/// One sentence about a time limit or a program that cannot be used.
pub fn piped(name: &str) -> Option<Result<OwnPolicy, String>> {
    let rest = name.strip_prefix(PREFIX)?;
    if let Some(command) = rest.strip_prefix(':') {
        return Some(policy(name, LIMIT_S, command));
    }
    let (limit, command) = rest.strip_prefix('@')?.split_once(':')?;
    let limit_s = limit.parse::<f64>().ok();
    let limit_s = limit_s.filter(|limit_s| *limit_s > 0.0 && *limit_s <= LONGEST_LIMIT_S);
    Some(match limit_s {
        Some(limit_s) => policy(name, limit_s, command),
        None => Err(format!(
            "policy {} has a time limit of {}, expected seconds above 0, at most {LONGEST_LIMIT_S}, as in pipe@5:./my-policy",
            shown(name),
            shown(limit)
        )),
    })
}

fn policy(name: &str, limit_s: f64, command: &str) -> Result<OwnPolicy, String> {
    let words: Vec<String> = command.split_whitespace().map(str::to_owned).collect();
    let (first, arguments) = words.split_first().ok_or_else(|| {
        format!(
            "policy {} names no program, expected one as in pipe:./my-policy",
            shown(name)
        )
    })?;
    let program = found(first).ok_or_else(|| {
        format!(
            "policy {}: there is no program {}, expected the path of one, or its name in PATH",
            shown(name),
            shown(first)
        )
    })?;
    // Scripts are arguments of their interpreters.
    let mut code = Vec::new();
    for path in
        core::iter::once(&program).chain(&arguments.iter().map(PathBuf::from).collect::<Vec<_>>())
    {
        if path.is_file()
            && let Ok(bytes) = std::fs::read(path)
        {
            code.extend_from_slice(fingerprint(&bytes).as_bytes());
        }
    }
    let program = Arc::new(Program {
        path: program,
        arguments: arguments.to_vec(),
        limit: Duration::from_secs_f64(limit_s),
        idle: Mutex::default(),
    });
    Ok(OwnPolicy::new(
        name,
        fingerprint(&code),
        Box::new(move |settings, vehicle| {
            Box::new(Piped {
                program: Arc::clone(&program),
                process: None,
                settings: *settings,
                vehicle: *vehicle,
                made_for: *vehicle,
                begins: true,
                tells_vehicle: true,
            })
        }),
    ))
}

/// The file of a program: a path, or a name in PATH.
fn found(program: &str) -> Option<PathBuf> {
    let path = Path::new(program);
    if path.components().count() > 1 {
        return path.is_file().then(|| path.to_owned());
    }
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders)
        .map(|folder| folder.join(path))
        .find(|path| path.is_file())
}

/// The program of a policy.
struct Program {
    path: PathBuf,
    arguments: Vec<String>,
    limit: Duration,
    /// Processes whose flights have ended.
    idle: Mutex<Vec<Process>>,
}

/// A line of the program, or its end.
type PipeLine = Result<String, PolicyFailure>;

/// A running program.
struct Process {
    child: Child,
    lines: Worker<String, PipeLine>,
    is_new: bool,
}

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Program {
    fn start(&self) -> Result<Process, PolicyFailure> {
        let idle = self
            .idle
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .pop();
        if let Some(process) = idle {
            return Ok(process);
        }
        let failed = |error: &std::io::Error| {
            PolicyFailure::new(
                FailureKind::Ended,
                format!("{} cannot be started: {error}", self.path.display()),
            )
        };
        let mut child = Command::new(&self.path)
            .args(&self.arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| failed(&error))?;
        let pipes = child.stdin.take().zip(child.stdout.take());
        let ended =
            |what: &str| PolicyFailure::new(FailureKind::Ended, format!("the program {what}"));
        let (mut input, output) = pipes.ok_or_else(|| ended("has no pipes"))?;
        let mut output = BufReader::new(output);
        let lines = Worker::start(move |question: String| {
            // A program that ends breaks the pipe; what it wrote before counts.
            let sent = input
                .write_all(question.as_bytes())
                .and_then(|()| input.flush());
            let mut line = Vec::new();
            match output
                .by_ref()
                .take(LONGEST_LINE)
                .read_until(b'\n', &mut line)
            {
                Ok(_) if line.last() == Some(&b'\n') => {
                    Ok(String::from_utf8_lossy(&line).into_owned())
                }
                Ok(_) if line.len() as u64 >= LONGEST_LINE => Err(PolicyFailure::new(
                    FailureKind::WrongShape,
                    format!("the answer is longer than {LONGEST_LINE} bytes, expected a line"),
                )),
                Ok(_) if sent.is_err() => Err(ended("ended before it read the situation")),
                Ok(_) => Err(ended(
                    "ended without an answer, expected a line for each line",
                )),
                Err(error) => Err(ended(&format!("cannot be read: {error}"))),
            }
        })
        .map_err(|error| failed(&error))?;
        Ok(Process {
            child,
            lines,
            is_new: true,
        })
    }
}

/// Asks the program in one flight after the other.
struct Piped {
    program: Arc<Program>,
    process: Option<Process>,
    settings: PolicySettings,
    vehicle: Vehicle,
    made_for: Vehicle,
    begins: bool,
    tells_vehicle: bool,
}

impl Drop for Piped {
    fn drop(&mut self) {
        if let Some(process) = self.process.take() {
            let mut idle = self
                .program
                .idle
                .lock()
                .unwrap_or_else(PoisonError::into_inner);
            idle.push(process);
        }
    }
}

impl Outside for Piped {
    fn answer(&mut self, situation: &Situation<'_>) -> Result<PolicyAnswer, PolicyFailure> {
        let mut process = match self.process.take() {
            Some(process) => process,
            None => self.program.start()?,
        };
        let mut question = question(situation);
        if self.begins {
            question["begins"] = true.into();
            question["decision_period_s"] = self.settings.avoider.decision_period_s.into();
            question["mission"] = mission(situation);
        }
        if self.tells_vehicle {
            question["vehicle"] = vehicle(&self.vehicle);
        }
        (self.begins, self.tells_vehicle) = (false, false);
        let limit = if process.is_new {
            self.program
                .limit
                .max(Duration::from_secs_f64(START_LIMIT_S))
        } else {
            self.program.limit
        };
        process.is_new = false;
        // A process that failed is dropped, which ends it.
        let line = match process.lines.ask(format!("{question}\n"), limit) {
            Ok(line) => line?,
            Err(Silence::Ended) => {
                return Err(PolicyFailure::new(FailureKind::Ended, "the program ended"));
            }
            Err(Silence::TimedOut) => {
                return Err(PolicyFailure::new(
                    FailureKind::TimedOut,
                    format!("no answer within {} s", limit.as_secs_f64()),
                ));
            }
        };
        let answer = read(line.trim_end())?;
        self.process = Some(process);
        Ok(answer)
    }

    fn retune(&mut self, vehicle: &Vehicle) {
        self.vehicle = *vehicle;
        self.tells_vehicle = true;
    }

    fn restart(&mut self) {
        self.vehicle = self.made_for;
        (self.begins, self.tells_vehicle) = (true, true);
    }
}

fn triple(vector: Vec3) -> Value {
    json!([vector.x, vector.y, vector.z])
}

fn question(situation: &Situation<'_>) -> Value {
    let own = &situation.ownship;
    json!({
        "time_s": situation.time_s,
        "ownship": {
            "position_m": triple(own.position_m),
            "course_rad": own.course_rad,
            "climb_rad": own.climb_rad,
            "bank_rad": own.bank_rad,
            "airspeed_mps": own.airspeed_mps,
        },
        "wind_mps": triple(situation.wind_mps),
        "obstacles": situation.obstacles.iter().map(|obstacle| self::obstacle(&obstacle)).collect::<Vec<_>>(),
    })
}

fn obstacle(obstacle: &Obstacle) -> Value {
    let half_height_m = match obstacle.volume {
        ProtectedVolume::Sphere { .. } => None,
        ProtectedVolume::Cylinder { half_height_m, .. } => Some(half_height_m),
    };
    let kind = match obstacle.movement {
        Movement::AtRest => "still",
        Movement::Straight => "straight",
        movement if movement == Movement::CREWED => "aircraft",
        Movement::Aircraft(_) => "uas",
    };
    json!({
        "id": obstacle.id,
        "position_m": triple(obstacle.position_m),
        "velocity_mps": triple(obstacle.velocity_mps),
        "radius_m": obstacle.volume.radius_m(),
        "half_height_m": half_height_m,
        "position_sigma_m": obstacle.uncertainty.position_m,
        "velocity_sigma_mps": obstacle.uncertainty.velocity_mps,
        "kind": kind,
    })
}

fn mission(situation: &Situation<'_>) -> Value {
    let mission = &situation.mission;
    let fly_over = (0..)
        .zip(mission.passing)
        .filter(|(_, passing)| **passing == Passing::FlyOver);
    // An altitude without a limit is null.
    let (lowest_m, highest_m) = mission.limits_m;
    json!({
        "waypoints_m": mission.waypoints_m.iter().copied().map(triple).collect::<Vec<_>>(),
        "fly_over": fly_over.map(|(index, _)| index).collect::<Vec<usize>>(),
        "limits_m": [lowest_m, highest_m],
    })
}

fn vehicle(vehicle: &Vehicle) -> Value {
    let response = &vehicle.response;
    json!({
        "airspeed_mps": vehicle.airspeed_mps,
        "turn_radius_m": vehicle.turn_radius_m,
        "climb_min_rad": vehicle.climb_min_rad,
        "climb_max_rad": vehicle.climb_max_rad,
        "climb_rate_radps": vehicle.climb_rate_radps,
        "dead_time_s": response.dead_time_s,
        "bank_time_constant_s": response.bank_time_constant_s,
    })
}

/// An answer as written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Reply {
    course_rad: Option<f64>,
    climb_rad: Option<f64>,
    stages: Option<Vec<ReplyStage>>,
    state: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ReplyStage {
    #[serde(default)]
    start_s: f64,
    course_rad: f64,
    #[serde(default)]
    climb_rad: f64,
    #[serde(default = "full_rate")]
    rate_share: f64,
}

const fn full_rate() -> f64 {
    1.0
}

/// The answer of a line.
fn read(line: &str) -> Result<PolicyAnswer, PolicyFailure> {
    let wrong = |what: &str| {
        PolicyFailure::new(
            FailureKind::WrongShape,
            format!("answered {}: {what}", shown(line)),
        )
    };
    if line == "null" {
        return Ok(PolicyAnswer::Mission);
    }
    let reply: Reply = serde_json::from_str(line).map_err(|error| {
        let says = error.to_string();
        // JSON has no such numbers, but many libraries write them.
        let is_number = ["NaN", "nan", "Infinity", "inf"].iter().any(|word| line.contains(word));
        if is_number || says.contains("out of range") {
            PolicyFailure::new(
                FailureKind::NotFinite,
                format!("answered {}, expected finite numbers", shown(line)),
            )
        } else {
            wrong(&format!(
                "{says}, expected {{}}, {{\"course_rad\": …, \"climb_rad\": …}} or {{\"stages\": […]}}"
            ))
        }
    })?;
    let Reply {
        course_rad,
        climb_rad,
        stages,
        state,
    } = reply;
    match (course_rad, climb_rad, stages, state) {
        (None, None, None, None) => Ok(PolicyAnswer::Mission),
        (Some(course_rad), climb_rad, None, None) => Ok(PolicyAnswer::Heading {
            course_rad,
            climb_rad: climb_rad.unwrap_or(0.0),
        }),
        (None, None, Some(stages), state) => {
            let word = state.as_deref().unwrap_or(State::Avoiding.name());
            let mut states = State::ALL.into_iter();
            let state = states.find(|state| state.name() == word).ok_or_else(|| {
                wrong("state is unknown, expected cruise, threatened, avoiding or recovering")
            })?;
            let mut maneuver = Maneuver::hold();
            for stage in &stages {
                let stage = Stage {
                    start_s: stage.start_s,
                    course_rad: stage.course_rad,
                    climb_rad: stage.climb_rad,
                    rate_share: stage.rate_share,
                };
                let usable =
                    stage.start_s >= 0.0 && stage.rate_share > 0.0 && stage.rate_share <= 1.0;
                if !usable || !maneuver.push(stage) {
                    return Err(wrong(&format!(
                        "expected at most {MAX_STAGES} stages in the order of start_s, from 0 on, with a rate_share above 0, at most 1"
                    )));
                }
            }
            Ok(PolicyAnswer::Decided(Box::new(decided(state, &maneuver))))
        }
        _ => Err(wrong(
            "expected either stages, with a state, or course_rad with climb_rad",
        )),
    }
}

/// A decision with the usual reason of its state.
pub(super) fn decided(state: State, maneuver: &Maneuver) -> Decision {
    let reason = match state {
        State::Cruise | State::Threatened => Reason::Clear,
        State::Avoiding => Reason::ManeuverKept,
        State::Recovering => Reason::RejoinKept,
    };
    Decision::new(state, maneuver, reason)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(line: &str) -> FailureKind {
        read(line).unwrap_err().kind
    }

    #[test]
    fn an_answer_is_the_mission_a_heading_or_stages_and_nothing_else() {
        assert_eq!(read("{}").unwrap(), PolicyAnswer::Mission);
        assert_eq!(read("null").unwrap(), PolicyAnswer::Mission);
        let heading = PolicyAnswer::Heading {
            course_rad: 1.5,
            climb_rad: 0.0,
        };
        assert_eq!(read("{\"course_rad\": 1.5}").unwrap(), heading);
        let PolicyAnswer::Decided(decision) =
            read("{\"stages\": [{\"course_rad\": 1}], \"state\": \"recovering\"}").unwrap()
        else {
            panic!("stages are a decision");
        };
        assert_eq!(decision.state, State::Recovering);
        assert_eq!(decision.command.stages().len(), 1);
        for wrong in [
            "",
            "left",
            "[1, 2]",
            "{\"climb_rad\": 0.1}",
            "{\"heading\": 1}",
            "{\"course_rad\": \"north\"}",
            "{\"course_rad\": 1, \"stages\": []}",
            "{\"stages\": [{\"course_rad\": 1, \"rate_share\": 0}]}",
            "{\"stages\": [{\"course_rad\": 1}], \"state\": \"lost\"}",
        ] {
            assert_eq!(kind(wrong), FailureKind::WrongShape, "{wrong}");
        }
        assert_eq!(kind("{\"course_rad\": NaN}"), FailureKind::NotFinite);
        assert_eq!(kind("{\"course_rad\": 1e999}"), FailureKind::NotFinite);
    }

    #[test]
    fn a_name_says_which_program_and_its_time_limit() {
        assert!(piped("turn-aware").is_none() && piped("pipeline").is_none());
        for (name, what) in [
            ("pipe:", "names no program"),
            (
                "pipe:./no-such-program",
                "there is no program \"./no-such-program\"",
            ),
            ("pipe@x:cat", "time limit of \"x\""),
            ("pipe@0:cat", "time limit of"),
        ] {
            let error = piped(name).unwrap().unwrap_err();
            assert!(error.contains(what), "{error}");
        }
        assert_eq!(
            piped("pipe@2.5:cat -u").unwrap().unwrap().name(),
            "pipe@2.5:cat -u"
        );
    }
}
