use super::*;
use crate::draw::table_4;

const WAYPOINTS_M: [(f64, f64); 3] = [(0.0, 0.0), (1000.0, 0.0), (1000.0, 1000.0)];

fn at(x_m: f64, y_m: f64, course_rad: f64) -> MotionState {
    MotionState {
        position_m: Vec3::new(x_m, y_m, 0.0),
        course_rad,
        ..MotionState::ahead(0.0)
    }
}

/// The right angle is turned from 30 m before the waypoint on.
#[test]
fn a_leg_is_over_where_its_corner_begins() {
    table_4(&WAYPOINTS_M, |route| {
        let mut progress = Progress::new();
        for (x_m, index, left_s) in [(100.0, 0, 58.0), (969.0, 0, 1.0 / 15.0), (971.0, 1, 0.0)] {
            let state = at(x_m, 0.0, 0.0);
            progress.update(route, &state, x_m / 15.0);
            assert_eq!(progress.index(), index);
            assert!((progress.straight_for_s(&state) - left_s).abs() < 1e-9);
        }
        progress.update(route, &at(1000.0, 1001.0, 1.57), 140.0);
        assert!(progress.is_complete());
    });
}

#[test]
fn straight_on_is_the_course_of_the_leg_until_a_corner_is_near() {
    table_4(&WAYPOINTS_M, |route| {
        let mut progress = Progress::new();
        let state = at(520.0, 0.0, 0.0);
        progress.update(route, &state, 0.0);
        let straight =
            |horizon_s: f64| progress.straight_course_rad(&state, route.flyer, horizon_s);
        assert_eq!((straight(29.0), straight(31.0)), (Some(0.0), None));
        let aside = at(520.0, 1.0, 0.0);
        assert_eq!(progress.straight_course_rad(&aside, route.flyer, 1.0), None);
    });
}

/// From 470 m before the corner the arc begins after 470 / 15 s and lasts π s.
#[test]
fn guidance_turns_at_the_corner_and_is_straight_after_it() {
    table_4(&WAYPOINTS_M, |route| {
        let mut progress = Progress::new();
        let state = at(500.0, 0.0, 0.0);
        progress.update(route, &state, 0.0);
        let mut far = Maneuver::hold();
        let straight_s = progress.guidance(route, &state, 20.0, &mut far);
        assert_eq!((far.stages().len(), straight_s), (1, 0.0));
        let straight_s = progress.guidance(route, &state, 60.0, &mut far);
        let [_, turn] = far.stages() else {
            panic!("{far:?}");
        };
        let corner_s = 470.0 / 15.0;
        assert!((turn.start_s - corner_s).abs() < 1e-9, "{turn:?}");
        assert!((straight_s - corner_s - core::f64::consts::PI).abs() < 1e-9);
        let mut again = Maneuver::hold();
        progress.guidance(route, &state, 60.0, &mut again);
        assert_eq!(again, far);
    });
}

/// Against the leg 1 m aside: it turns round to the beginning, keeps that turn while it follows it, and then flies the leg.
#[test]
fn a_turn_round_is_flown_to_its_end() {
    table_4(&[(0.0, 0.0), (400.0, 0.0), (0.0, 1.0)], |route| {
        let (mut progress, mut state) = (Progress::new(), at(0.0, 0.0, 0.0));
        let mut turned_s = 0.0;
        for step in 0..700_u32 {
            let time_s = 0.1 * f64::from(step);
            progress.update(route, &state, time_s);
            if progress.is_complete() {
                break;
            }
            let mut command = Maneuver::hold();
            let straight_s = progress.guidance(route, &state, 0.2, &mut command);
            if progress.is_unentered {
                let ends_s = time_s + straight_s;
                assert!(
                    turned_s == 0.0 || (ends_s - turned_s).abs() < 1e-6,
                    "{ends_s}"
                );
                turned_s = ends_s;
            }
            state = flown(route.flyer, &state, command.stages(), 0.1, route.meter);
            state.time_s = 0.0;
            if progress.index() == 1 && !progress.is_unentered {
                let leg = progress.leg(&state);
                assert!(leg.position(state.position_m, 0.0).cross_m.abs() < 10.0);
            }
        }
        assert!(progress.is_complete() && turned_s > 30.0, "{turned_s}");
    });
}

/// On the first leg of three waypoints, on the second, and past the end.
#[test]
fn another_mission_goes_on_along_a_leg_that_it_has_too() {
    let longer = [(0.0, 0.0), (1000.0, 0.0), (1000.0, 1000.0), (0.0, 1000.0)];
    for (state, kept, index) in [
        (at(500.0, 0.0, 0.0), 1, 0),
        (at(500.0, 0.0, 0.0), 2, 0),
        (at(1000.0, 500.0, 1.57), 2, 0),
        (at(1000.0, 500.0, 1.57), 3, 1),
        (at(1000.0, 1001.0, 1.57), 2, 0),
        (at(1000.0, 1001.0, 1.57), 3, 2),
    ] {
        let mut progress = Progress::new();
        table_4(&WAYPOINTS_M, |route| progress.update(route, &state, 0.0));
        progress.take_up(kept);
        table_4(&longer, |route| progress.update(route, &state, 0.1));
        assert_eq!((progress.index(), progress.is_complete()), (index, false));
        assert!(progress.corner.is_some() || index == 2);
    }
}

/// Without work a corner is left for the next step.
#[test]
fn a_corner_that_was_refused_is_planned_later() {
    table_4(&WAYPOINTS_M, |route| {
        let mut progress = Progress::new();
        let none = fga_proof::meter::Meter::new(0, 0);
        let state = at(100.0, 0.0, 0.0);
        progress.update(
            &Route {
                meter: &none,
                ..*route
            },
            &state,
            0.0,
        );
        assert!(progress.corner.is_none());
        progress.update(route, &state, 0.1);
        assert!(progress.corner.is_some());
    });
}
