//! Requests that a slow link delivers after they were given up.

use super::*;

/// A request that was on its way now reaches the vehicle, and its answer comes.
pub(super) fn arrives(bench: &mut Bench, mode: Mode) {
    bench.keeper.answered(true, bench.now_s);
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

const LATE: &str = "fga: late request carried out, mode restored";
const WHOSE: &str = "fga: mode is perhaps our late request: set one";

#[test]
fn a_request_that_arrives_after_the_manoeuvre_was_called_off_is_undone() {
    for later in [0, 1, 8, 40, 200] {
        let mut bench = called_off();
        bench.beats(later);
        arrives(&mut bench, Mode::GUIDED);
        bench.beats(2);
        assert_eq!(bench.vehicle, Mode::AUTO, "{later}");
        assert_eq!(bench.told, [LATE]);
        bench.beats(16);
        assert_eq!(bench.keeper.state(), Authority::Ready);
    }
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
        assert_eq!(bench.told, [WHOSE]);
        bench.beats(8);
        assert_eq!(bench.vehicle, Mode::GUIDED, "it may be the pilot's");
    }
    // A mode that the pilot chose in command is no riddle, nor is the next one.
    let mut bench = in_command();
    bench.pilot(MANUAL);
    bench.told.clear();
    bench.pilot(Mode::GUIDED);
    bench.beats(8);
    assert!(bench.told.is_empty());
}
