//! Every fault in every state, and the pilot in each.

use super::*;

const ALL: [Fault; 10] = [
    Fault::ModeChanged,
    Fault::Disarmed,
    Fault::BelowFloor,
    Fault::TelemetryStale,
    Fault::LinkLost,
    Fault::TakeOverRefused,
    Fault::ReturnRefused,
    Fault::NotFollowing,
    Fault::AutopilotRestarted,
    Fault::OperatorOff,
];

fn in_command() -> Keeper {
    let mut keeper = Keeper::new(Mode::GUIDED, true);
    keeper.readiness(true, 0.0);
    assert_eq!(keeper.state(), Authority::Ready);
    keeper.take_over(Mode::AUTO, 1.0);
    keeper.mode(Mode::GUIDED, 1.1);
    assert!(matches!(keeper.state(), Authority::InCommand { .. }));
    keeper
}

/// A keeper in each of the states in which the mode is not the vehicle's own affair.
fn engaged() -> [Keeper; 3] {
    let mut taking = Keeper::new(Mode::GUIDED, true);
    taking.readiness(true, 0.0);
    taking.take_over(Mode::AUTO, 1.0);
    let mut returning = in_command();
    returning.hand_back(2.0);
    [taking, in_command(), returning]
}

#[test]
fn every_fault_has_a_row_with_a_text_that_fits() {
    for fault in ALL {
        assert_eq!(REACTIONS.iter().filter(|row| row.fault == fault).count(), 1);
        assert!(reaction(fault).text.len() <= 50);
    }
}

#[test]
fn every_fault_does_what_its_row_says_in_every_state() {
    for fault in ALL {
        let row = reaction(fault);
        for mut keeper in engaged() {
            let actions = keeper.fault(fault, 5.0);
            let restores = actions.contains(&Action::SetMode(Mode::AUTO));
            assert_eq!(restores, row.hand_back == HandBack::Restore, "{fault:?}");
            assert!(actions.contains(&Action::Ended(fault)));
            assert!(actions.contains(&Action::Tell(row.severity, row.text)));
            assert!(!keeper.commands());
            assert_eq!(
                keeper.is_enabled(),
                row.rearm == Rearm::Automatic,
                "{fault:?}"
            );
            // The vehicle is heard in its old mode again, and all is well for a while.
            keeper.mode(Mode::AUTO, 6.0);
            keeper.readiness(true, 6.0);
            keeper.readiness(true, 10.0);
            keeper.readiness(true, 10.1);
            let back = keeper.state() == Authority::Ready;
            assert_eq!(back, row.rearm == Rearm::Automatic, "{fault:?}");
            keeper.set_enabled(true, 11.0);
            keeper.readiness(true, 11.1);
            assert_eq!(keeper.state(), Authority::Ready, "{fault:?}");
        }
    }
}

#[test]
fn the_pilot_wins_in_every_state_with_one_message() {
    for mode in [Mode::FBWB, Mode::RTL, Mode(0)] {
        for mut keeper in engaged() {
            let actions = keeper.mode(mode, 3.0);
            assert!(actions.contains(&Action::Ended(Fault::ModeChanged)));
            assert!(actions.contains(&Action::CancelSetMode));
            assert!(
                !actions
                    .iter()
                    .any(|action| matches!(action, Action::SetMode(_)))
            );
            // Nothing is taken over again, however well all is.
            keeper.readiness(true, 100.0);
            assert!(keeper.take_over(Mode::AUTO, 100.0).is_empty());
        }
    }
    // In command, the pilot may also go back to the old mode.
    let mut keeper = in_command();
    assert!(
        keeper
            .mode(Mode::AUTO, 3.0)
            .contains(&Action::Ended(Fault::ModeChanged))
    );
}

#[test]
fn a_lost_link_is_paid_back_when_the_vehicle_is_heard() {
    let mut keeper = in_command();
    assert!(
        !keeper
            .fault(Fault::LinkLost, 5.0)
            .contains(&Action::SetMode(Mode::AUTO))
    );
    assert_eq!(
        keeper.mode(Mode::GUIDED, 9.0),
        [Action::SetMode(Mode::AUTO)]
    );
    keeper.mode(Mode::AUTO, 9.2);
    // Had it changed meanwhile, nothing would be sent.
    let mut other = in_command();
    other.fault(Fault::LinkLost, 5.0);
    assert_eq!(other.mode(Mode::RTL, 9.0), [Action::CancelSetMode]);
}

#[test]
fn unanswered_requests_end_it() {
    let mut keeper = Keeper::new(Mode::GUIDED, true);
    keeper.readiness(true, 0.0);
    keeper.take_over(Mode::AUTO, 1.0);
    assert!(keeper.tick(2.0).is_empty());
    assert!(
        keeper
            .tick(4.5)
            .contains(&Action::Ended(Fault::TakeOverRefused))
    );
    let mut keeper = in_command();
    keeper.hand_back(10.0);
    assert!(
        keeper
            .tick(15.5)
            .contains(&Action::Ended(Fault::ReturnRefused))
    );
    assert!(!keeper.is_enabled());
}
