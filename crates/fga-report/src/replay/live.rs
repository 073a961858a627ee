//! The same page for a running flight: it receives messages instead of holding the data.

use serde::Serialize;

use super::{ReplayDecision, ReplayDecisionTime, ReplayEvent, ReplayGround, ReplayObstacle};
use super::{ReplayOutcome, ReplayRun, ReplaySample, encode};
use crate::page::{self, json};

/// A page that connects to a WebSocket on the host that served it and draws each message.
///
/// `path` is the WebSocket's path, for example `/live`. Messages are [`LiveMessage`]s as JSON.
#[must_use]
pub fn render_live(title: &str, path: &str) -> String {
    let data = json(&serde_json::json!({ "title": title, "live": path, "runs": [] }));
    page::fill(encode::TEMPLATE, title, &data, "'self'")
}

/// The messages to a page during a run. Each message names its run by `run`, the index of
/// its [`LiveMessage::Run`] among those sent, from 0.
#[derive(Debug, Clone, PartialEq)]
pub enum LiveMessage {
    /// A run begins; the page shows the data in it.
    Run(Box<ReplayRun>),
    /// A new sample of the aircraft.
    Sample {
        /// The run.
        run: usize,
        /// The sample.
        sample: ReplaySample,
    },
    /// The mission changed.
    Mission {
        /// The run.
        run: usize,
        /// Its waypoints, metres.
        mission_m: Vec<[f64; 3]>,
    },
    /// The ground, in place of the one before.
    Ground {
        /// The run.
        run: usize,
        /// Its heights.
        ground: ReplayGround,
    },
    /// A new obstacle, or an update of the obstacle with this identifier.
    Obstacle {
        /// The run.
        run: usize,
        /// The obstacle with its whole motion so far.
        obstacle: ReplayObstacle,
    },
    /// A decision.
    Decision {
        /// The run.
        run: usize,
        /// The record.
        decision: ReplayDecision,
    },
    /// The duration of a decision.
    DecisionTime {
        /// The run.
        run: usize,
        /// The duration.
        time: ReplayDecisionTime,
    },
    /// An event.
    Event {
        /// The run.
        run: usize,
        /// The event.
        event: ReplayEvent,
    },
    /// The end of the run.
    End {
        /// The run.
        run: usize,
        /// Its least margin, if known.
        outcome: Option<ReplayOutcome>,
    },
}

impl LiveMessage {
    /// The message in the page's form: a JSON object with a `type`.
    #[must_use]
    pub fn to_json(&self) -> String {
        json(&match self {
            Self::Run(run) => typed("run", None, "data", encode::run(run, 1)),
            Self::Sample { run, sample } => {
                let [x, y, z] = sample.position_m;
                let row = [
                    sample.t_s,
                    x,
                    y,
                    z,
                    sample.course_rad,
                    sample.climb_rad,
                    sample.bank_rad,
                    f64::from(sample.state.code()),
                ];
                typed("sample", Some(*run), "row", row)
            }
            Self::Mission { run, mission_m } => typed("mission", Some(*run), "points", mission_m),
            Self::Ground { run, ground } => {
                typed("ground", Some(*run), "data", encode::ground(ground))
            }
            Self::Obstacle { run, obstacle } => {
                let mut pool = Vec::new();
                let data = encode::obstacle(obstacle, &mut pool);
                let mut message = typed("obstacle", Some(*run), "data", data);
                message["motion"] = encode::floats(pool.into_iter()).into();
                message
            }
            Self::Decision { run, decision } => {
                let mut pool = Vec::new();
                let data = encode::decision(decision, &mut pool);
                let mut message = typed("decision", Some(*run), "data", data);
                message["points"] = encode::bytes(&pool).into();
                message
            }
            Self::DecisionTime { run, time } => {
                typed("time", Some(*run), "row", [time.t_s, time.decision_us])
            }
            Self::Event { run, event } => {
                let data = serde_json::json!({ "t": event.t_s, "text": event.text });
                typed("event", Some(*run), "data", data)
            }
            Self::End { run, outcome } => {
                let data = outcome
                    .map(|o| serde_json::json!({ "margin": o.min_margin_m, "t": o.t_s, "id": o.obstacle }));
                typed("end", Some(*run), "outcome", data)
            }
        })
    }
}

fn typed(kind: &str, run: Option<usize>, key: &str, value: impl Serialize) -> serde_json::Value {
    let mut message = serde_json::json!({ "type": kind });
    if let Some(run) = run {
        message["run"] = run.into();
    }
    message[key] = serde_json::to_value(value).unwrap_or_default();
    message
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_carry_their_type_and_run() {
        let sample = LiveMessage::Sample {
            run: 1,
            sample: ReplaySample {
                t_s: 2.5,
                ..ReplaySample::default()
            },
        };
        let read: serde_json::Value = serde_json::from_str(&sample.to_json()).expect("JSON");
        assert_eq!(read["type"], "sample");
        assert_eq!(read["run"], 1);
        assert_eq!(read["row"][0], 2.5);
        let end = LiveMessage::End {
            run: 0,
            outcome: None,
        };
        assert!(end.to_json().contains("\"type\":\"end\""));
        let run = LiveMessage::Run(Box::new(ReplayRun::named("live")));
        assert!(run.to_json().contains("\"name\":\"live\""));
    }

    #[test]
    fn a_live_page_may_connect_to_its_host_alone() {
        let page = render_live("flight", "/live");
        assert!(page.contains("connect-src 'self'"));
        let still = super::super::render(&super::super::Replay::default());
        assert!(still.contains("connect-src 'none'"));
    }
}
