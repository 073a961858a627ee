//! The companion itself: telemetry and traffic in, commands out.
//!
//! It reads no clock, no socket and no file: [`Companion::receive`] takes a message,
//! [`Companion::take_report`] a report of traffic, [`Companion::tick`] advances the time,
//! [`Companion::outbox`] holds the messages to send and [`Companion::take_log`] the log. The
//! program, the replay of a recording and the tests in scaled time all drive the same code.
//!
//! Each part has its own file and hides its fields from the others:
//!
//! | part | question |
//! |---|---|
//! | `Session` | which vehicle is this, and what did an earlier run leave with it? |
//! | `VehicleRequests` | what is the vehicle asked for (rates, parameters, lists, commands), and what has it answered? |
//! | `LaidRoute`, `PassedItems`, `Boundary` | which way would it fly by itself, what of its mission has a manoeuvre passed, and what of its fence binds? |
//! | `Lead` | when does a command act, and how is the aircraft then? |
//! | `TrafficReports`, `ObstaclesAround`, `OverGround` | who reports traffic, who and what is around, and how high is the ground? |
//! | `Decisions` | who decides with which limits, and what was decided last? |
//! | `Keeper`, `Handover`, `Gap` | who has the authority, when is control wanted and given back, and how long without telemetry? |
//! | `OtherOrders` | does somebody else command the vehicle in the mode of the manoeuvre? |
//! | `OperatorReports`, `Voice` | what has the operator read, and what is said: messages, texts, lines of the log? |
//!
//! A decision goes from `observe.rs` by `decide.rs` and `authorize.rs` to the targets in `send.rs`.

mod alerts;
mod around;
mod authorize;
mod boundary;
mod decide;
mod decider;
mod decisions;
mod feeds;
mod gap;
mod handover;
mod lacking;
mod lead;
mod lists;
mod nearest;
mod neighbors;
mod observe;
mod others;
mod over_ground;
mod passing;
mod picture;
mod promise;
mod rally;
mod receive;
mod requests;
mod route;
mod send;
mod session;
mod switch;
mod target;
mod terrain;
mod traffic;
mod trips;
mod voice;
mod watched;
mod words;

use fga::avoider::Decision;
use fga::vehicle::Vehicle;
use serde_json::{Value, json};

use crate::authority::{Action, Authority, Fault, HandBack, Keeper, Owed, Severity, reaction};
use crate::config::{Config, ConfigError};
use crate::hand::{self, Hand};
use crate::mode::Mode;
use crate::outgoing::Outgoing;
use crate::ownship::OwnshipEstimate;
use crate::restart::Note;
use crate::traffic::{Defects, TrackTable};

use alerts::AlertWatch;
use around::ObstaclesAround;
use boundary::Boundary;
use decider::CompanionPilot;
use decisions::Decisions;
use gap::Gap;
use handover::Handover;
pub use handover::LONGEST_END_S;
use lacking::OperatorReports;
use lead::Lead;
pub use nearest::LeastSeparation;
use others::OtherOrders;
use over_ground::OverGround;
use passing::PassedItems;
pub use picture::FlightPicture;
use promise::Promise;
use requests::VehicleRequests;
use route::LaidRoute;
use session::Session;
use traffic::TrafficReports;
pub(crate) use trips::round_trip_of;
use voice::Voice;

/// System id of the first heartbeats, before the first one of a vehicle: the id of most vehicles.
const FIRST_SYSTEM: u8 = 1;

/// When things are due again, seconds.
#[expect(clippy::struct_field_names, reason = "the unit is part of each name")]
#[derive(Debug, Clone, Copy, Default)]
struct Due {
    heartbeat_s: f64,
    decision_s: f64,
    command_s: f64,
    tidy_s: f64,
    values_s: f64,
    collision_s: f64,
}

/// Counters for the status line and tests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Manoeuvres begun.
    pub maneuvers: u32,
    /// Number of decisions.
    pub decisions: u64,
    /// Texts sent.
    pub texts: u32,
    /// Certified flights that the aircraft was off by more than the certificate leaves room for.
    pub missed: u32,
}

/// The companion of one vehicle.
#[derive(Debug)]
pub struct Companion {
    config: Config,
    voice: Voice,
    session: Session,
    requests: VehicleRequests,
    ownship: OwnshipEstimate,
    lead: Lead,
    boundary: Boundary,
    route: LaidRoute,
    passing: PassedItems,
    around: ObstaclesAround,
    reports: TrafficReports,
    over: OverGround,
    alerts: Option<AlertWatch>,
    decisions: Decisions,
    keeper: Keeper,
    handover: Handover,
    gap: Gap,
    others: OtherOrders,
    told: OperatorReports,
    least: Option<LeastSeparation>,
    promise: Promise,
    hand: Box<dyn Hand>,
    due: Due,
}

impl Companion {
    /// A companion without any messages yet; with `dry_run` it only reports.
    ///
    /// # Errors
    /// An unusable configuration.
    pub fn new(config: Config, dry_run: bool) -> Result<Self, ConfigError> {
        config.check()?;
        let hand = hand::of(config.command.mode);
        let take_over = match hand.takes_over_from() {
            Some(mode) => vec![mode],
            None => config.take_over()?,
        };
        let target = hand.mode();
        if take_over.contains(&target) {
            return Err(ConfigError(format!(
                "vehicle.take_over: {} is the mode that manoeuvres are flown in",
                target.name()
            )));
        }
        let mut voice = Voice::default();
        voice.speak_to(match config.vehicle.system_id {
            0 => FIRST_SYSTEM,
            system_id => system_id,
        });
        Ok(Self {
            voice,
            session: Session::new(config.vehicle.system_id, dry_run),
            requests: VehicleRequests::new(&config, take_over.contains(&Mode::RTL)),
            ownship: OwnshipEstimate::default(),
            lead: Lead::new(&config.response),
            boundary: Boundary::default(),
            route: LaidRoute::default(),
            passing: PassedItems::default(),
            around: ObstaclesAround::new(&config)?,
            reports: TrafficReports::default(),
            over: OverGround::new(
                config.terrain.source,
                config.terrain.clearance_m.unwrap_or(0.0),
            ),
            alerts: AlertWatch::new(&config.alerts),
            decisions: Decisions::default(),
            keeper: Keeper::new(target, config.safety.armed_at_start),
            handover: Handover::from_modes(take_over),
            gap: Gap::default(),
            others: OtherOrders::default(),
            told: OperatorReports::default(),
            least: None,
            promise: Promise::default(),
            hand,
            due: Due::default(),
            config,
        })
    }

    /// Marks the vehicle as recorded: it follows the commands of its own flight, which
    /// need not be these, so that a difference is no fault.
    pub const fn set_recorded(&mut self) {
        self.session.set_recorded();
    }

    /// Whether it only reports, as the flight that is repeated did.
    pub const fn set_dry_run(&mut self, dry_run: bool) {
        self.session.set_dry_run(dry_run);
    }

    /// A number that differs between configurations.
    pub fn fingerprint(&self) -> u64 {
        crate::steps::fingerprint(&self.config)
    }

    /// The messages to send, oldest first.
    pub fn outbox(&mut self) -> Vec<Outgoing> {
        self.voice.take_messages()
    }

    /// Lines of the decision log since the last call.
    pub fn take_log(&mut self) -> Vec<Value> {
        self.voice.take_log()
    }

    /// The state of the authority.
    pub const fn authority(&self) -> Authority {
        self.keeper.state()
    }

    /// Counters.
    pub const fn counts(&self) -> Counts {
        Counts {
            maneuvers: self.handover.maneuvers(),
            decisions: self.decisions.count(),
            texts: self.voice.texts(),
            missed: self.promise.counts().1,
        }
    }

    /// The end of the status line about feeds; empty while all of them are well.
    pub fn feeds_in_words(&self) -> String {
        self.reports.feeds().words(self.voice.now_s())
    }

    /// The defects of reports so far.
    pub const fn defects(&self) -> &Defects {
        self.reports.defects()
    }

    /// The least separation so far; `None` where nobody was within the surveillance.
    pub const fn least_separation(&self) -> Option<&LeastSeparation> {
        self.least.as_ref()
    }

    /// The least separation in words.
    pub fn least_in_words(&self) -> String {
        LeastSeparation::words(self.least.as_ref())
    }

    /// What came of certified flights, in words; empty where none was missed.
    pub fn missed_in_words(&self) -> String {
        let (kept, missed) = self.promise.counts();
        match missed {
            0 => String::new(),
            _ => format!(
                "{missed} of {} certified flights were not flown as certified",
                kept + missed
            ),
        }
    }

    /// Tracks of other aircraft.
    pub const fn tracks(&self) -> &TrackTable {
        self.around.tracks()
    }

    /// The vehicle's planned limits.
    pub fn vehicle(&self) -> Option<&Vehicle> {
        self.decisions.pilot().map(CompanionPilot::vehicle)
    }

    /// How the vehicle follows, as estimated so far.
    pub fn response(&self) -> fga::vehicle::Response {
        self.lead.response()
    }

    /// The last decision.
    pub fn decision(&self) -> Option<&Decision> {
        self.decisions.last().map(|decided| &decided.decision)
    }

    /// System id of the vehicle, once heard.
    pub fn vehicle_system(&self) -> Option<u8> {
        self.session.system()
    }

    /// The mode to restore, and the vehicle, if this program stops now; `None` without a manoeuvre.
    pub fn owed(&self) -> Option<Owed> {
        Some(Owed {
            system_id: self.session.commanded_system()?,
            owned: self.keeper.target(),
            previous: self.keeper.owed()?,
        })
    }

    /// Passes the debt of an earlier run of this program, before any message.
    pub fn set_notes(&mut self, notes: Vec<Note>) {
        self.session.set_notes(notes);
    }

    /// The note for a later run, if this one stops now.
    pub fn restart_note(&self, now_s: f64) -> Option<Note> {
        let owned = self.keeper.target();
        self.session.restart_note(
            self.keeper.owed(),
            self.passing.asked(),
            owned,
            self.keeper.may_arrive(owned, now_s),
        )
    }

    /// The link carries MAVLink 1 frames of a system, which nobody here reads.
    pub fn hear_version1(&mut self, system: u8, now_s: f64) {
        self.voice.at(now_s);
        self.session.hear_version1(system, &mut self.voice);
    }

    /// The operator's switch.
    pub fn set_enabled(&mut self, enabled: bool, now_s: f64) {
        self.voice.at(now_s);
        self.keep(now_s, |keeper| keeper.set_enabled(enabled, now_s));
    }

    /// The program is to end. A manoeuvre goes on until the mode can be restored without a collision, for
    /// [`LONGEST_END_S`] at most; then, or without a manoeuvre at once, nothing is owed any more.
    pub fn shut_down(&mut self, now_s: f64) {
        self.voice.at(now_s);
        if self.keeper.commands() {
            self.handover.end(now_s);
            self.voice.warn(&format!(
                "fga: program ends when clear, {LONGEST_END_S} s at most"
            ));
            return;
        }
        self.shut_down_at_once(now_s);
    }

    /// Restores the mode in an orderly way before the program ends, whatever threatens.
    pub fn shut_down_at_once(&mut self, now_s: f64) {
        self.voice.at(now_s);
        if self.keeper.owed().is_some() {
            self.fault(Fault::ProgramEnds, now_s);
        } else if self.vehicle_system().is_some() {
            self.voice.tell(Severity::Notice, "fga: program ends");
        }
        self.reports.note_defects(&mut self.voice);
        self.over.note_heard(&mut self.voice);
        self.send_commands(now_s);
    }

    /// Whether it flies the vehicle.
    pub const fn flies(&self) -> bool {
        self.keeper.commands()
    }

    /// Whether the vehicle has confirmed that it flies what the companion commands.
    const fn is_in_command(&self) -> bool {
        matches!(self.keeper.state(), Authority::InCommand { .. })
    }

    /// Records trouble of the surrounding program, for the operator and the log.
    pub fn tell_trouble(&mut self, words: &str, now_s: f64) {
        self.voice.at(now_s).tell_trouble(words);
    }

    /// Advances the time: sends due messages and decides if no telemetry prompted it.
    pub fn tick(&mut self, now_s: f64) {
        self.voice.at(now_s);
        self.watch_link(now_s);
        self.take_held_reports();
        if !self.is_silent(now_s) {
            self.keep(now_s, |keeper| keeper.tick(now_s));
        }
        self.send_regular(now_s);
        if now_s >= self.due.tidy_s {
            self.due.tidy_s = now_s + 0.5;
            if self.vehicle_system().is_some() {
                self.reports.tell_left_out(&mut self.voice);
            }
            let decided = self.decisions.last();
            let own = decided.map(|d| (d.own.ownship.position_m, d.own.ground_velocity_mps));
            self.around.tracks_mut().tidy(now_s, own);
        }
        // Telemetry prompts decisions and commands; the clock stands in where it pauses.
        let slack_s = self.config.command.decision_period_s;
        if now_s >= self.due.decision_s + slack_s {
            self.decide(now_s);
        }
        let taking = matches!(self.keeper.state(), Authority::Taking { .. });
        let slack_s = if taking {
            0.0
        } else {
            0.5 / self.config.command.rate_hz
        };
        if now_s >= self.due.command_s + slack_s {
            self.command(now_s);
        }
        self.send_commands(now_s);
    }

    fn watch_link(&mut self, now_s: f64) {
        let Some(silent_s) = self.session.silent_s(now_s) else {
            return;
        };
        // While it requests the return nothing flies, and a restarted program must wait: only the
        // heartbeat matters.
        let flies = matches!(
            self.keeper.state(),
            Authority::Taking { .. } | Authority::InCommand { .. }
        );
        let flies_blind = self.flies_blind(now_s);
        if silent_s > self.config.safety.link_lost_s && !flies_blind {
            self.fault(Fault::LinkLost, now_s);
        } else if flies && self.is_blind(now_s) && !flies_blind {
            self.end_gap(now_s);
        } else if self.keeper.commands() && !self.decisions.are_possible(now_s) {
            self.fault(Fault::NoDecision, now_s);
        }
        if self.handover.must_end(now_s) && self.keeper.commands() {
            self.fault(Fault::ProgramEnds, now_s);
        }
    }

    fn fault(&mut self, fault: Fault, now_s: f64) {
        self.keep(now_s, |keeper| keeper.fault(fault, now_s));
    }

    /// Lets the keeper of authority take an event, and carries out its actions.
    fn keep(&mut self, now_s: f64, event: impl FnOnce(&mut Keeper) -> Vec<Action>) {
        use mavlink::dialects::ardupilotmega::MavCmd;
        for action in event(&mut self.keeper) {
            match action {
                Action::SetMode { to, from } => {
                    self.ask_for_mode(to, from, now_s);
                    self.voice.note("set-mode", json!({ "mode": to.name() }));
                }
                Action::CancelSetMode => self.requests.cancel(MavCmd::MAV_CMD_DO_SET_MODE),
                Action::Tell(severity, words) => self.voice.tell(severity, words),
                Action::Resumed => {
                    self.start_commanding(true, now_s);
                }
                Action::Began => {
                    self.session.date_note();
                    let (lists, parameters) = (self.requests.lists(), self.requests.parameters());
                    self.passing
                        .begin_maneuver(&self.route, lists.item(), parameters);
                    self.start_commanding(false, now_s);
                    self.tell_threat();
                }
                Action::Returned => {
                    self.handover.succeeded();
                    self.let_go(now_s);
                    self.voice.tell(Severity::Info, "fga: clear, mode restored");
                    self.forget_plan();
                }
                Action::Ended(fault) => {
                    self.voice
                        .note("released", json!({ "fault": format!("{fault:?}") }));
                    self.requests.cancel(MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT);
                    if reaction(fault).hand_back == HandBack::LeaveAlone {
                        self.passing.leave_alone();
                    }
                    if fault == Fault::TakeOverRefused {
                        self.handover.refused(now_s);
                    }
                    self.let_go(now_s);
                    self.forget_plan();
                }
            }
        }
    }

    fn start_commanding(&mut self, resumed: bool, now_s: f64) {
        self.hand.begin();
        self.lead.begin(self.ownship.bank_rad(), now_s);
        self.handover.begin(resumed, now_s);
        self.told.begin();
        self.others = OtherOrders::default();
        self.due.command_s = f64::NEG_INFINITY;
    }

    /// The next decision makes a new plan and a new way.
    fn forget_plan(&mut self) {
        self.decisions.forget();
        self.route.fly_leg(0);
        self.handover.forget();
        self.lead.end();
    }
}
