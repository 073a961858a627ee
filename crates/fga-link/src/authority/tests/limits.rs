//! How long, how often, and to which mode: each limit of the keeper from both sides.

use super::late::{arrives, called_off};
use super::*;

const LOITER: Mode = Mode(12);

fn ended(actions: &[Action]) -> Option<Fault> {
    actions.iter().find_map(|action| match action {
        Action::Ended(fault) => Some(*fault),
        _ => None,
    })
}

/// A keeper in each state that ends by itself, with the fault and the longest duration, seconds.
fn limited() -> [(Keeper, Fault, f64); 3] {
    let mut taking = Keeper::new(Mode::GUIDED, true);
    taking.readiness(true, 0.0);
    taking.take_over(Mode::AUTO, 10.0);
    let mut returning = Keeper::new(Mode::GUIDED, true);
    returning.readiness(true, 0.0);
    returning.take_over(Mode::AUTO, 9.0);
    returning.mode(Mode::GUIDED, 9.5);
    returning.hand_back(10.0);
    let mut resuming = Keeper::new(Mode::GUIDED, true);
    resuming.resume(Mode::AUTO, 10.0);
    [
        (taking, Fault::TakeOverRefused, 3.0),
        (returning, Fault::ReturnRefused, 5.0),
        (resuming, Fault::Restarted, 5.0),
    ]
}

#[test]
fn each_state_that_waits_ends_after_its_time_and_not_before() {
    for (mut keeper, fault, after_s) in limited() {
        let state = keeper.state();
        assert_eq!(keeper.tick(10.0 + after_s - 0.01), [], "{fault:?}");
        assert_eq!(keeper.state(), state);
        let actions = keeper.tick(10.0 + after_s + 0.01);
        assert_eq!(ended(&actions), Some(fault));
    }
}

#[test]
fn a_silent_vehicle_gets_its_time_to_confirm_from_when_it_is_heard() {
    for (mut keeper, fault, after_s) in limited() {
        keeper.excuse(20.0);
        // A restarted program is given no time.
        let excused_s = if fault == Fault::Restarted { 0.0 } else { 20.0 };
        assert_eq!(keeper.tick(10.0 + excused_s + after_s - 0.01), []);
        let actions = keeper.tick(10.0 + excused_s + after_s + 0.01);
        assert_eq!(ended(&actions), Some(fault));
    }
}

#[test]
fn a_refusal_ends_what_was_asked_for_and_nothing_else() {
    for (mut keeper, fault, _) in limited() {
        let refused = (fault != Fault::Restarted).then_some(fault);
        assert_eq!(ended(&keeper.mode_refused(11.0)), refused);
    }
    assert_eq!(in_command().keeper.mode_refused(1.0), []);
}

#[test]
fn it_is_engaged_while_it_has_the_mode_or_asks_for_it() {
    for bench in engaged() {
        assert!(bench.keeper.is_engaged(), "{:?}", bench.keeper.state());
    }
    assert!(!Bench::ready().keeper.is_engaged());
}

#[test]
fn the_states_have_the_names_of_the_log() {
    let names = engaged().map(|bench| bench.keeper.state().name());
    assert_eq!(names, ["taking", "in-command", "returning", "resuming"]);
    assert_eq!(Bench::ready().keeper.state().name(), "ready");
}

#[test]
fn after_a_gap_it_is_ready_within_a_second_and_after_another_fault_within_four() {
    for (fault, beats) in [(Fault::TelemetryStale, 4), (Fault::BelowFloor, 14)] {
        let mut bench = in_command();
        bench.fault(fault);
        bench.vehicle = Mode::AUTO;
        bench.beats(beats);
        assert_eq!(bench.keeper.state(), Authority::Ready, "{fault:?}");
    }
}

/// The pilot lands in another mode: nothing is owed to a vehicle on the ground.
#[test]
fn a_disarmed_vehicle_in_another_mode_is_owed_nothing() {
    let mut bench = in_command();
    bench.obeys = false;
    bench.fault(Fault::Disarmed);
    assert_eq!(bench.keeper.owed(), Some(Mode::AUTO));
    let beat = bench.next_beat(MANUAL, false);
    bench.keeper.heartbeat(beat, bench.now_s + 0.25);
    assert_eq!(bench.keeper.owed(), None);
}

#[test]
fn a_link_that_was_lost_for_more_than_ten_seconds_is_not_gone_on_with() {
    for (silent_s, goes_on) in [(9.0, true), (11.0, false)] {
        let mut bench = in_command();
        bench.now_s += 100.0;
        bench.fault(Fault::LinkLost);
        bench.now_s += silent_s;
        bench.keeper.mode(Mode::GUIDED, bench.now_s);
        let resumes = matches!(bench.keeper.state(), Authority::Resuming { .. });
        assert_eq!(resumes, goes_on, "{silent_s}");
    }
}

#[test]
fn the_owed_mode_is_asked_for_with_the_fault_and_24_times_after_it() {
    let mut keeper = Keeper::new(Mode::GUIDED, true);
    keeper.readiness(true, 0.0);
    keeper.take_over(Mode::AUTO, 1.0);
    keeper.mode(Mode::GUIDED, 1.2);
    assert!(keeper.fault(Fault::BelowFloor, 2.0).contains(&RESTORE));
    let asked = |n| 2.0 + 0.25 * f64::from(n);
    let answers = (1..100).filter(|n| keeper.mode(Mode::GUIDED, asked(*n)) == [RESTORE]);
    assert_eq!(answers.count(), 24);
}

/// The vehicle carries out the late request, and the network loses what undoes it.
#[test]
fn a_late_request_for_guided_is_undone_until_the_vehicle_obeys() {
    let mut bench = called_off();
    bench.beats(20);
    arrives(&mut bench, Mode::GUIDED);
    bench.obeys = false;
    bench.vehicle = Mode::GUIDED;
    bench.beats(8);
    assert!(matches!(
        bench.keeper.state(),
        Authority::Released {
            fault: Fault::LateRequest,
            owed: Some(Mode::AUTO),
            ..
        }
    ));
    bench.obeys = true;
    bench.beats(2);
    assert_eq!(bench.vehicle, Mode::AUTO);
}

/// A late return that was undone is a fault too: it waits for three seconds before it acts again.
#[test]
fn after_a_late_return_it_is_not_ready_at_once() {
    let mut bench = in_command();
    bench.obeys = false;
    let actions = bench.keeper.hand_back(bench.now_s);
    bench.perform(&actions);
    bench.beats(30);
    bench.pilot(LOITER);
    bench.keeper.set_enabled(true, bench.now_s);
    bench.beats(20);
    assert_eq!(bench.keeper.state(), Authority::Ready);
    arrives(&mut bench, Mode::AUTO);
    bench.beats(8);
    assert!(matches!(
        bench.keeper.state(),
        Authority::Released {
            fault: Fault::LateRequest,
            ..
        }
    ));
    bench.beats(8);
    assert_eq!(bench.keeper.state(), Authority::Ready);
}

/// A heartbeat that nobody answered for ends the return: where GUIDED comes again, it may have been forged.
#[test]
fn guided_again_after_an_unanswered_return_is_doubted() {
    for (mode, is_doubted) in [(Mode::AUTO, true), (LOITER, false)] {
        let mut bench = in_command();
        bench.obeys = false;
        let actions = bench.keeper.hand_back(bench.now_s);
        bench.perform(&actions);
        bench.pilot(mode);
        bench.now_s += 2.0;
        bench.told.clear();
        bench.pilot(Mode::GUIDED);
        let doubt = bench
            .told
            .contains(&"fga: mode is perhaps our late request: set one");
        assert_eq!(doubt, is_doubted, "{mode:?}: {:?}", bench.told);
    }
}

/// Heartbeats come once a second: none reports the pilot's mode between the choice and the late request.
#[test]
fn a_request_that_arrives_between_two_rare_heartbeats_is_undone() {
    let mut bench = crossed();
    bench.now_s += 1.0;
    arrives(&mut bench, Mode::GUIDED);
    bench.beats(2);
    assert_eq!(bench.vehicle, MANUAL);
}
