//! Requests that a slow link delivers after they were given up.

use super::*;

/// A request that was on its way now reaches the vehicle, and its answer comes.
pub(super) fn arrives(bench: &mut Bench, mode: Mode) {
    bench.answers();
    bench.vehicle = mode;
    bench.obeys = true;
    bench.beat();
}

/// The mode was asked for, and the request is on its way on a slow link when the traffic has passed: an AUTO
/// from before it arrives looks like a return.
pub(super) fn called_off() -> Bench {
    let mut bench = Bench::ready();
    bench.obeys = false;
    bench.take_over();
    bench.beat();
    let actions = bench.keeper.hand_back(bench.now_s);
    bench.perform(&actions);
    bench.beat();
    assert_eq!(bench.keeper.state(), Authority::Ready);
    bench.told.clear();
    bench
}

const LATE: &str = "fga: late request carried out, restores the mode";
const RESTORED: &str = "fga: mode restored";
const NOBODY: &str = "fga: GUIDED, but nobody flies: set a mode";
const WHOSE: &str = "fga: mode is perhaps our late request: set one";

#[test]
fn a_request_that_arrives_after_the_manoeuvre_was_called_off_is_undone() {
    for later in [0, 1, 8, 40, 110] {
        let mut bench = called_off();
        bench.beats(later);
        arrives(&mut bench, Mode::GUIDED);
        bench.beats(2);
        assert_eq!(bench.vehicle, Mode::AUTO, "{later}");
        assert_eq!(bench.told, [LATE, RESTORED]);
        bench.beats(16);
        assert_eq!(bench.keeper.state(), Authority::Ready);
    }
}

/// An answer that comes after more than 30 s may be forged, and the mode the pilot's.
#[test]
fn after_an_answer_to_an_old_request_the_operator_is_asked() {
    let mut bench = called_off();
    bench.beats(200);
    arrives(&mut bench, Mode::GUIDED);
    bench.beats(20);
    assert_eq!(bench.vehicle, Mode::GUIDED);
    assert_eq!(bench.told, [WHOSE]);
}

#[test]
fn a_request_that_arrives_after_it_was_given_up_is_undone() {
    let mut bench = Bench::ready();
    bench.obeys = false;
    bench.take_over();
    bench.beats(30);
    assert!(bench.told.contains(&reaction(Fault::TakeOverRefused).text));
    arrives(&mut bench, Mode::GUIDED);
    bench.beats(2);
    assert_eq!(bench.vehicle, Mode::AUTO);
    assert!(bench.told.contains(&LATE));
}

/// The program that gave the request up has ended, and the next one begins before or after it arrives.
#[test]
fn a_request_that_outlives_its_program_is_the_operators_to_judge() {
    for arrived_before in [0, 20] {
        let mut bench = Bench::ready();
        bench.obeys = false;
        bench.take_over();
        bench.beats(30);
        assert!(bench.keeper.may_arrive(Mode::GUIDED, bench.now_s));
        bench.keeper = Keeper::new(Mode::GUIDED, true);
        bench.told.clear();
        if arrived_before > 0 {
            bench.vehicle = Mode::GUIDED;
            bench.beats(arrived_before);
        }
        bench.keeper.doubt(Mode::GUIDED, Mode::AUTO, bench.now_s);
        bench.beats(4);
        bench.pilot(Mode::GUIDED);
        bench.beats(4);
        assert_eq!(bench.vehicle, Mode::GUIDED);
        assert_eq!(
            bench.told.iter().filter(|words| **words == WHOSE).count(),
            1
        );
    }
}

#[test]
fn a_request_that_was_answered_or_is_old_arrives_no_more() {
    let mut bench = in_command();
    assert!(!bench.keeper.may_arrive(Mode::GUIDED, bench.now_s));
    bench = called_off();
    assert!(bench.keeper.may_arrive(Mode::GUIDED, bench.now_s));
    assert!(!bench.keeper.may_arrive(MANUAL, bench.now_s));
    bench.beats(124);
    assert!(!bench.keeper.may_arrive(Mode::GUIDED, bench.now_s));
}

#[test]
fn a_request_that_arrives_seconds_after_the_pilots_choice_is_undone() {
    for later in [0, 4, 20, 80] {
        let mut bench = crossed();
        bench.beats(later);
        arrives(&mut bench, Mode::GUIDED);
        bench.beats(2);
        assert_eq!(bench.vehicle, MANUAL, "{later}");
        bench.beats(40);
        bench.take_over();
        bench.beats(4);
        assert_eq!(bench.vehicle, MANUAL, "the operator has to arm it again");
    }
}

/// The fence sets RTL, and the vehicle then accepts a return that was on its way: RTL, the answer and AUTO come in some order.
#[test]
fn a_failsafe_that_a_late_return_undoes_is_restored_in_every_order() {
    for order in [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ] {
        let mut bench = in_command();
        bench.obeys = false;
        let actions = bench.keeper.hand_back(bench.now_s);
        bench.perform(&actions);
        let rtl = bench.next_beat(Mode::RTL, true);
        let answer = bench.next_beat(Mode::AUTO, true).sequence;
        let auto = bench.next_beat(Mode::AUTO, true);
        bench.vehicle = Mode::AUTO;
        bench.obeys = true;
        for frame in order {
            bench.now_s += 0.05;
            match frame {
                0 => bench.hears(rtl),
                1 => {
                    let actions = bench.keeper.answered(answer, true, bench.now_s);
                    bench.perform(&actions);
                }
                _ => bench.hears(auto),
            }
        }
        bench.beats(8);
        assert_eq!(bench.vehicle, Mode::RTL, "{order:?}: {:?}", bench.told);
        assert_ne!(bench.keeper.state(), Authority::Ready, "{order:?}");
        // The pilot's AUTO is the pilot's.
        bench.pilot(Mode::AUTO);
        bench.beats(8);
        assert_eq!(bench.vehicle, Mode::AUTO, "{order:?}");
    }
}

/// The vehicle returned for our request, then the fence acted: AUTO after that is the pilot's, however soon.
#[test]
fn the_pilots_auto_after_a_failsafe_stays() {
    let mut bench = in_command();
    let actions = bench.keeper.hand_back(bench.now_s);
    bench.perform(&actions);
    bench.beat();
    bench.pilot(Mode::RTL);
    let commands = bench.commands;
    bench.pilot(Mode::AUTO);
    bench.beats(8);
    assert_eq!((bench.vehicle, bench.commands), (Mode::AUTO, commands));
}

#[test]
fn a_return_that_arrives_after_the_pilots_choice_is_undone() {
    let mut bench = in_command();
    bench.obeys = false;
    let actions = bench.keeper.hand_back(bench.now_s);
    bench.perform(&actions);
    bench.beats(30);
    assert!(bench.told.contains(&reaction(Fault::ReturnRefused).text));
    bench.pilot(Mode(12));
    bench.beats(20);
    arrives(&mut bench, Mode::AUTO);
    bench.beats(4);
    assert_eq!(bench.vehicle, Mode(12));
    let commands = bench.commands;
    bench.beats(40);
    assert_eq!((bench.vehicle, bench.commands), (Mode(12), commands));
}

/// The answer was lost: the mode may also be the pilot's choice, which wins.
#[test]
fn where_nothing_tells_whose_mode_it_is_the_operator_is_asked() {
    let mut bench = called_off();
    bench.beats(20);
    let commands = bench.commands;
    bench.pilot(Mode::GUIDED);
    bench.beats(40);
    assert_eq!((bench.vehicle, bench.commands), (Mode::GUIDED, commands));
    assert_eq!(bench.told, [WHOSE]);
    assert!(WHOSE.len() <= 50);
}

#[test]
fn guided_is_the_pilots_where_every_request_was_answered() {
    let mut bench = in_command();
    let actions = bench.keeper.hand_back(bench.now_s);
    bench.perform(&actions);
    bench.beats(4);
    assert_eq!(bench.keeper.state(), Authority::Ready);
    bench.told.clear();
    let commands = bench.commands;
    bench.pilot(Mode::GUIDED);
    bench.beats(40);
    assert_eq!((bench.vehicle, bench.commands), (Mode::GUIDED, commands));
    assert!(bench.told.is_empty());
}

/// ArduPlane sets the mode from before a short failsafe by itself. It may be the pilot's choice: it is told and stays.
#[test]
fn guided_after_a_mode_of_others_in_a_manoeuvre_is_told_each_time() {
    let mut bench = in_command();
    bench.pilot(Mode(1));
    bench.beats(200);
    bench.told.clear();
    let commands = bench.commands;
    for _ in 0..2 {
        bench.pilot(Mode::GUIDED);
        bench.beats(20);
        assert_eq!(core::mem::take(&mut bench.told), [NOBODY]);
        bench.pilot(Mode(1));
        bench.beats(4);
        assert!(bench.told.is_empty());
    }
    assert!(NOBODY.len() <= 50);
    // Armed again, the companion is not displaced any more.
    let actions = bench.keeper.set_enabled(true, bench.now_s);
    bench.perform(&actions);
    bench.pilot(Mode::GUIDED);
    assert!(!bench.told.contains(&NOBODY));
    assert_eq!(bench.commands, commands);
    // Nor was it by a fault of its own.
    let mut bench = in_command();
    bench.fault(Fault::BelowFloor);
    bench.beats(4);
    bench.told.clear();
    bench.pilot(Mode::GUIDED);
    assert!(!bench.told.contains(&NOBODY));
}

/// The link is lost in a manoeuvre, and the first heartbeats that come are forged.
#[test]
fn after_a_forged_heartbeat_of_another_mode_the_operator_is_asked_about_guided() {
    for forged in [MANUAL, Mode::AUTO] {
        let mut bench = in_command();
        bench.fault(Fault::LinkLost);
        bench.now_s += 12.0;
        bench.told.clear();
        bench.pilot(forged);
        assert_eq!(bench.keeper.owed(), None);
        bench.pilot(Mode::GUIDED);
        let first = if forged == MANUAL {
            "fga: mode chosen by others, not restored"
        } else {
            RESTORED
        };
        assert_eq!(bench.told, [first, WHOSE]);
        bench.beats(8);
        assert_eq!(bench.vehicle, Mode::GUIDED, "it may be the pilot's");
    }
    // A mode that the pilot chose in command is no riddle.
    let mut bench = in_command();
    bench.told.clear();
    bench.pilot(MANUAL);
    assert!(!bench.told.contains(&WHOSE));
}
