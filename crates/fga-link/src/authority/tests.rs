//! Every fault in every state, and the pilot in each, with a vehicle that obeys what it is sent.

mod late;
mod limits;

use super::*;
use crate::mode::Mode;
use crate::mode::ModeChange;

const ALL: [Fault; 16] = [
    Fault::ModeChanged,
    Fault::OthersCommand,
    Fault::Disarmed,
    Fault::BelowFloor,
    Fault::TelemetryStale,
    Fault::LinkLost,
    Fault::TakeOverRefused,
    Fault::ReturnRefused,
    Fault::NotFollowing,
    Fault::AutopilotRestarted,
    Fault::OperatorOff,
    Fault::NoDecision,
    Fault::Contradiction,
    Fault::ProgramEnds,
    Fault::Restarted,
    Fault::LateRequest,
];
const MANUAL: Mode = Mode(0);
const RESTORE: Action = Action::SetMode {
    to: Mode::AUTO,
    from: Mode::GUIDED,
};

/// A keeper, its hearing, and a vehicle that obeys permitted commands.
#[derive(Debug)]
struct Bench {
    keeper: Keeper,
    hearing: Hearing,
    vehicle: Mode,
    obeys: bool,
    asked: Option<(Mode, Mode)>,
    sequence: u8,
    now_s: f64,
    told: Vec<&'static str>,
    commands: u32,
}

impl Bench {
    fn ready() -> Self {
        let mut bench = Self {
            keeper: Keeper::new(Mode::GUIDED, true),
            hearing: Hearing::default(),
            vehicle: Mode::AUTO,
            obeys: true,
            asked: None,
            sequence: 0,
            now_s: 0.0,
            told: Vec::new(),
            commands: 0,
        };
        bench.beats(4);
        assert_eq!(bench.keeper.state(), Authority::Ready);
        bench
    }

    fn perform(&mut self, actions: &[Action]) {
        for action in actions {
            match *action {
                Action::SetMode { to, from } => self.asked = Some((to, from)),
                Action::CancelSetMode => self.asked = None,
                Action::Tell(_, words) => self.told.push(words),
                _ => {}
            }
        }
        if let Some((to, from)) = self.asked
            && self.hearing.ask(ModeChange { from, to }, self.now_s)
        {
            self.asked = None;
            self.commands += 1;
            self.keeper.asked(ModeChange { from, to }, self.now_s);
            if self.obeys {
                self.answers();
                self.vehicle = to;
            }
        }
    }

    /// The vehicle accepts a request.
    fn answers(&mut self) {
        self.sequence = self.sequence.wrapping_add(1);
        let actions = self.keeper.answered(self.sequence, true, self.now_s);
        self.perform(&actions);
    }

    /// The vehicle's next heartbeat.
    fn next_beat(&mut self, mode: Mode, armed: bool) -> Beat {
        self.sequence = self.sequence.wrapping_add(9);
        Beat {
            sequence: self.sequence,
            mode,
            armed,
        }
    }

    fn hears(&mut self, beat: Beat) {
        let is_overtaken = self.hearing.hear(beat, self.now_s) == BeatOrder::Overtaken;
        let actions = if is_overtaken {
            self.keeper.overtaken(beat, self.now_s)
        } else {
            self.keeper.heartbeat(beat, self.now_s)
        };
        self.perform(&actions);
    }

    /// A quarter of a second passes, and a heartbeat comes.
    fn beat(&mut self) {
        self.now_s += 0.25;
        let beat = self.next_beat(self.vehicle, true);
        self.hears(beat);
        let actions = self.keeper.tick(self.now_s);
        self.perform(&actions);
        let actions = self.keeper.readiness(true, self.now_s);
        self.perform(&actions);
    }

    fn beats(&mut self, count: u32) {
        for _ in 0..count {
            self.beat();
        }
    }

    fn take_over(&mut self) {
        let actions = self.keeper.take_over(self.vehicle, self.now_s);
        self.perform(&actions);
    }

    fn fault(&mut self, fault: Fault) {
        let actions = self.keeper.fault(fault, self.now_s);
        self.perform(&actions);
    }

    fn pilot(&mut self, mode: Mode) {
        self.vehicle = mode;
        self.beat();
    }
}

fn in_command() -> Bench {
    let mut bench = Bench::ready();
    bench.take_over();
    bench.beats(2);
    assert!(matches!(bench.keeper.state(), Authority::InCommand { .. }));
    bench
}

/// Benches in each of the states in which the companion has the mode or asks for it.
fn engaged() -> [Bench; 4] {
    let mut taking = Bench::ready();
    taking.obeys = false;
    taking.take_over();
    taking.obeys = true;
    let mut returning = in_command();
    returning.obeys = false;
    let actions = returning.keeper.hand_back(returning.now_s);
    returning.perform(&actions);
    returning.obeys = true;
    let mut resuming = in_command();
    resuming.keeper = Keeper::new(Mode::GUIDED, true);
    resuming.keeper.resume(Mode::AUTO, resuming.now_s);
    [taking, in_command(), returning, resuming]
}

/// A fault in command, as the vehicle shows it.
fn observed_hand_back(fault: Fault) -> HandBack {
    let mut bench = in_command();
    bench.fault(fault);
    if bench.vehicle == Mode::AUTO {
        return HandBack::Restore;
    }
    bench.beats(4);
    if bench.vehicle == Mode::AUTO {
        return HandBack::RestoreWhenHeard;
    }
    if bench.keeper.commands() {
        return HandBack::ResumeWhenHeard;
    }
    bench.beats(40);
    assert_eq!(bench.vehicle, Mode::GUIDED);
    HandBack::LeaveAlone
}

/// Whether it is ready again by itself, once the vehicle flies its mission and all is well.
fn observed_rearm(fault: Fault) -> Rearm {
    let mut bench = in_command();
    bench.fault(fault);
    bench.vehicle = Mode::AUTO;
    // A gap in the telemetry ends as suddenly as it began; after everything else it waits for longer.
    let gap = matches!(fault, Fault::TelemetryStale | Fault::LinkLost);
    bench.beats(if gap { 1 } else { 8 });
    assert_ne!(bench.keeper.state(), Authority::Ready, "not at once");
    bench.beats(40);
    if bench.keeper.state() == Authority::Ready {
        return Rearm::Automatic;
    }
    bench.take_over();
    assert_eq!(bench.vehicle, Mode::AUTO);
    let actions = bench.keeper.set_enabled(true, bench.now_s);
    bench.perform(&actions);
    bench.beats(2);
    assert_eq!(bench.keeper.state(), Authority::Ready, "{fault:?}");
    Rearm::Operator
}

#[test]
fn the_table_says_what_every_fault_does() {
    assert_eq!(REACTIONS.len(), ALL.len());
    for fault in ALL {
        assert_eq!(REACTIONS.iter().filter(|row| row.fault == fault).count(), 1);
        let row = reaction(fault);
        assert!(row.text.len() <= 50);
        assert_eq!(row.hand_back, observed_hand_back(fault), "{fault:?}");
        assert_eq!(row.rearm, observed_rearm(fault), "{fault:?}");
        let mut bench = in_command();
        bench.told.clear();
        bench.fault(fault);
        assert_eq!(bench.told, [row.text], "{fault:?} is told once");
    }
}

#[test]
fn the_page_says_what_the_table_says() {
    let page = include_str!("../../../../docs/fly-reactions.md");
    for row in &REACTIONS {
        let line = page
            .lines()
            .find(|line| line.starts_with('|') && line.contains(&format!("`{}`", row.text)))
            .unwrap_or_else(|| panic!("'{}' is not in docs/fly-reactions.md", row.text));
        let mode = match row.hand_back {
            HandBack::Restore => "| restored |",
            HandBack::RestoreWhenHeard => "| restored when",
            HandBack::ResumeWhenHeard => "| flown on when",
            HandBack::LeaveAlone => "| left alone |",
        };
        assert!(line.contains(mode), "{line}");
        let by_itself = line.contains("| by itself") || line.contains("| after 5 s");
        assert_eq!(by_itself, row.rearm == Rearm::Automatic, "{line}");
    }
}

#[test]
fn every_fault_ends_the_command_in_every_state() {
    for fault in ALL {
        for mut bench in engaged() {
            bench.fault(fault);
            assert!(!bench.keeper.commands() && !bench.keeper.is_engaged());
            if reaction(fault).hand_back != HandBack::ResumeWhenHeard {
                bench.beats(3);
                assert!(!bench.keeper.commands());
            }
        }
    }
}

#[test]
fn the_pilot_wins_in_every_state_with_one_message() {
    for mode in [Mode::FBWB, Mode::RTL, MANUAL, Mode(2), Mode(5)] {
        for mut bench in engaged() {
            bench.pilot(mode);
            let commands = bench.commands;
            assert!(bench.told.contains(&reaction(Fault::ModeChanged).text));
            // It does not take over again, even if all is well.
            bench.beats(60);
            bench.take_over();
            assert_eq!((bench.vehicle, bench.commands), (mode, commands));
        }
    }
    // In command, the pilot may also go back to the old mode.
    let mut bench = in_command();
    bench.pilot(Mode::AUTO);
    assert!(bench.told.contains(&reaction(Fault::ModeChanged).text));
}

#[test]
fn the_pilot_wins_after_every_fault() {
    for fault in ALL {
        for mode in [MANUAL, Mode::AUTO, Mode(12)] {
            for mut bench in engaged() {
                bench.obeys = false;
                bench.fault(fault);
                bench.obeys = true;
                bench.pilot(mode);
                let commands = bench.commands;
                bench.beats(60);
                assert_eq!((bench.vehicle, bench.commands), (mode, commands));
            }
        }
    }
}

#[test]
fn a_request_that_arrives_after_the_pilots_change_is_undone() {
    let mut bench = Bench::ready();
    bench.obeys = false;
    bench.take_over();
    bench.obeys = true;
    bench.pilot(MANUAL);
    // Our own request for GUIDED arrives now.
    bench.pilot(Mode::GUIDED);
    assert_eq!(bench.vehicle, MANUAL);
    bench.beats(8);
    // Later on, GUIDED is what the pilot wants.
    bench.pilot(Mode::GUIDED);
    bench.beats(8);
    assert_eq!(bench.vehicle, Mode::GUIDED);
}

#[test]
fn the_owed_mode_is_requested_a_limited_number_of_times() {
    let mut bench = in_command();
    bench.obeys = false;
    bench.fault(Fault::TelemetryStale);
    bench.beats(100);
    assert!(bench.commands <= 30, "{}", bench.commands);
    assert!(bench.told.contains(&reaction(Fault::ReturnRefused).text));
    assert_eq!(bench.keeper.owed(), None);
    assert!(!bench.keeper.is_enabled());
    assert_eq!(bench.asked, None);
}

#[test]
fn a_vehicle_that_was_disarmed_for_a_moment_gets_its_mode_back() {
    let disarmed = |bench: &mut Bench, by_s: f64| {
        bench.now_s += by_s;
        let beat = bench.next_beat(Mode::GUIDED, false);
        let actions = bench.keeper.heartbeat(beat, bench.now_s);
        actions.contains(&RESTORE)
    };
    let mut bench = in_command();
    bench.fault(Fault::Disarmed);
    assert!(!disarmed(&mut bench, 0.5), "not while it is disarmed");
    bench.beat();
    assert_eq!(bench.vehicle, Mode::AUTO);
    // One that has landed keeps what its pilot chooses.
    let mut bench = in_command();
    bench.fault(Fault::Disarmed);
    bench.now_s += 60.0;
    assert!(!disarmed(&mut bench, 0.5), "however long ago the fault was");
    assert!(!disarmed(&mut bench, 4.5));
    assert_eq!(bench.keeper.owed(), Some(Mode::AUTO));
    assert!(!disarmed(&mut bench, 1.0));
    assert_eq!(bench.keeper.owed(), None);
    bench.beats(4);
    assert_eq!(bench.vehicle, Mode::GUIDED);
}

#[test]
fn a_lost_link_is_paid_back_when_the_vehicle_is_heard() {
    let mut bench = in_command();
    bench.fault(Fault::LinkLost);
    bench.now_s += 20.0;
    bench.beat();
    assert_eq!(bench.vehicle, Mode::AUTO);
    // Had it changed meanwhile, nothing would be sent.
    let mut other = in_command();
    other.fault(Fault::LinkLost);
    other.now_s += 20.0;
    let commands = other.commands;
    other.pilot(Mode::RTL);
    other.beats(40);
    assert_eq!((other.vehicle, other.commands), (Mode::RTL, commands));
}

/// The vehicle is heard again in GUIDED while the threat still exists: AUTO would lead back to the threat,
/// and the next decision would take the mode once more.
#[test]
fn a_manoeuvre_is_gone_on_with_when_the_link_comes_back_soon() {
    let lost_for = |lost_s: f64| {
        let mut bench = in_command();
        bench.fault(Fault::LinkLost);
        bench.now_s += lost_s;
        bench
    };
    let mut bench = lost_for(9.0);
    let commands = bench.commands;
    bench.beats(2);
    assert!(matches!(bench.keeper.state(), Authority::InCommand { .. }));
    assert!(bench.told.contains(&"fga: link back, goes on avoiding"));
    assert_eq!((bench.vehicle, bench.commands), (Mode::GUIDED, commands));
    // Heard, but not ready: the mode is restored after 5 s.
    let mut bench = lost_for(2.0);
    let beat = bench.next_beat(Mode::GUIDED, true);
    let actions = bench.keeper.heartbeat(beat, bench.now_s);
    assert!(actions.is_empty());
    assert!(bench.keeper.tick(bench.now_s + 4.9).is_empty());
    assert!(bench.keeper.tick(bench.now_s + 5.1).contains(&RESTORE));
    // Switched off meanwhile, it is restored at once.
    let mut bench = lost_for(2.0);
    let actions = bench.keeper.set_enabled(false, bench.now_s);
    bench.perform(&actions);
    bench.beats(2);
    assert_eq!(bench.vehicle, Mode::AUTO);
}

#[test]
fn unanswered_requests_end_it() {
    let mut bench = Bench::ready();
    bench.obeys = false;
    bench.take_over();
    bench.beats(11);
    assert!(matches!(bench.keeper.state(), Authority::Taking { .. }));
    bench.beats(2);
    assert!(bench.told.contains(&reaction(Fault::TakeOverRefused).text));
    let mut bench = in_command();
    bench.obeys = false;
    let actions = bench.keeper.hand_back(bench.now_s);
    bench.perform(&actions);
    bench.beats(19);
    assert!(matches!(bench.keeper.state(), Authority::Returning { .. }));
    bench.beats(3);
    assert!(bench.told.contains(&reaction(Fault::ReturnRefused).text));
    assert!(!bench.keeper.is_enabled());
}

#[test]
fn a_restarted_program_goes_on_or_restores() {
    let mut bench = in_command();
    bench.keeper = Keeper::new(Mode::GUIDED, false);
    bench.keeper.resume(Mode::AUTO, bench.now_s);
    assert_eq!(bench.keeper.owed(), Some(Mode::AUTO));
    bench.beat();
    assert!(matches!(bench.keeper.state(), Authority::InCommand { .. }));
    assert!(bench.told.contains(&"fga: restarted, goes on avoiding"));
    let actions = bench.keeper.hand_back(bench.now_s);
    bench.perform(&actions);
    bench.beats(2);
    assert_eq!(bench.vehicle, Mode::AUTO);
    assert_eq!(
        bench.keeper.state(),
        Authority::Waiting,
        "never switched on"
    );
    // One that does not become ready restores after 5 s.
    let mut keeper = Keeper::new(Mode::GUIDED, true);
    keeper.resume(Mode::AUTO, 0.0);
    assert!(keeper.tick(4.9).is_empty());
    assert!(keeper.tick(5.1).contains(&RESTORE));
}

#[test]
fn it_is_not_ready_while_anything_is_wrong() {
    let mut bench = Bench::ready();
    assert!(bench.keeper.readiness(false, bench.now_s).is_empty());
    assert_eq!(bench.keeper.state(), Authority::Waiting);
    bench.beat();
    assert_eq!(bench.keeper.state(), Authority::Ready);
}

#[test]
fn it_is_ready_again_after_three_seconds_of_all_well_since_fault_and_trouble() {
    let after_fault = |trouble_s: f64| {
        let mut bench = in_command();
        bench.fault(Fault::BelowFloor);
        let fault_s = bench.now_s;
        while bench.keeper.state() != Authority::Ready {
            bench.beat();
            if bench.now_s <= fault_s + trouble_s {
                bench.keeper.readiness(false, bench.now_s);
            }
            assert!(bench.now_s < fault_s + 20.0);
        }
        bench.now_s - fault_s
    };
    let (at_once, later) = (after_fault(0.0), after_fault(4.0));
    assert!((3.0..=3.75).contains(&at_once), "{at_once}");
    assert!((7.0..=7.75).contains(&later), "{later}");
}

/// The companion requested the take-over, and the pilot chose before the vehicle obeyed.
fn crossed() -> Bench {
    let mut bench = Bench::ready();
    bench.obeys = false;
    bench.take_over();
    bench.obeys = true;
    bench.pilot(MANUAL);
    bench
}

#[test]
fn a_late_request_is_undone_for_as_long_as_it_may_be_on_its_way() {
    let mut bench = crossed();
    bench.beats(2);
    bench.pilot(Mode::GUIDED);
    assert_eq!(bench.vehicle, MANUAL, "0.75 s after");
    let mut bench = crossed();
    bench.beats(3);
    bench.pilot(Mode::GUIDED);
    assert_eq!(bench.vehicle, Mode::GUIDED, "1 s after it is the pilot's");
    // A second choice of the pilot ends it at once.
    let mut bench = crossed();
    bench.pilot(Mode::RTL);
    bench.pilot(Mode::GUIDED);
    assert_eq!(bench.vehicle, Mode::GUIDED);
}

#[test]
fn a_second_fault_changes_only_what_it_must() {
    let released = |second: Fault| {
        let mut bench = in_command();
        bench.obeys = false;
        bench.fault(Fault::TelemetryStale);
        bench.told.clear();
        bench.fault(second);
        bench
    };
    // One from which it recovers by itself is no news, and what is owed stays owed.
    for second in [Fault::LinkLost, Fault::NoDecision, Fault::Disarmed] {
        let bench = released(second);
        assert!(bench.told.is_empty() && bench.keeper.is_enabled());
        assert_eq!(bench.keeper.owed(), Some(Mode::AUTO));
    }
    // The operator's word counts, and the mode is restored all the same.
    for second in [Fault::OperatorOff, Fault::ProgramEnds] {
        let mut bench = released(second);
        assert_eq!(bench.told, [reaction(second).text]);
        assert!(!bench.keeper.is_enabled());
        bench.obeys = true;
        bench.beats(2);
        assert_eq!(bench.vehicle, Mode::AUTO);
    }
    // Where the mode is to be left alone, nothing is owed any more.
    for second in [Fault::Contradiction, Fault::AutopilotRestarted] {
        let mut bench = in_command();
        bench.fault(Fault::LinkLost);
        bench.asked = Some((Mode::AUTO, Mode::GUIDED));
        bench.hearing.forget();
        bench.fault(second);
        assert_eq!((bench.keeper.owed(), bench.asked), (None, None));
        assert!(!bench.keeper.is_enabled());
    }
    // After one that only the operator undoes, no other counts.
    let mut bench = in_command();
    bench.fault(Fault::NotFollowing);
    bench.told.clear();
    bench.fault(Fault::OperatorOff);
    assert!(bench.told.is_empty());
}

#[test]
fn a_fault_of_a_manoeuvre_is_none_without_one() {
    for fault in [Fault::NotFollowing, Fault::AutopilotRestarted] {
        let mut bench = Bench::ready();
        bench.told.clear();
        bench.fault(fault);
        assert!(bench.told.is_empty());
        assert_eq!(bench.keeper.state(), Authority::Ready);
    }
    for fault in [Fault::OperatorOff, Fault::Contradiction] {
        let mut bench = Bench::ready();
        bench.told.clear();
        bench.fault(fault);
        assert_eq!(bench.told, [reaction(fault).text]);
        assert_eq!(bench.keeper.state(), Authority::Waiting);
    }
}

#[test]
fn a_restarted_program_has_five_seconds() {
    let mut keeper = Keeper::new(Mode::GUIDED, true);
    keeper.resume(Mode::AUTO, 100.0);
    assert!(keeper.tick(104.9).is_empty());
    assert!(keeper.tick(105.1).contains(&RESTORE));
}
