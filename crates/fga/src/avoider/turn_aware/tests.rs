use super::*;
use crate::Vec3;
use crate::avoider::Settings;
use crate::situation::{Mission, Movement, Obstacle, Obstacles, Ownship, ProtectedVolume};
use crate::vehicle::Vehicle;

pub(super) const RADIUS_M: f64 = 30.0;

/// A sphere at a place that keeps its velocity.
pub(super) fn sphere(id: u32, place_m: (f64, f64), velocity_mps: (f64, f64)) -> Obstacle {
    let [place_m, velocity_mps] = [place_m, velocity_mps].map(|(x, y)| Vec3::new(x, y, 0.0));
    let volume = ProtectedVolume::Sphere { radius_m: RADIUS_M };
    Obstacle::straight(id, place_m, velocity_mps, volume)
}

/// The same for an aircraft, which may turn.
pub(super) fn aircraft(id: u32, place_m: (f64, f64), velocity_mps: (f64, f64)) -> Obstacle {
    Obstacle {
        movement: Movement::CREWED,
        ..sphere(id, place_m, velocity_mps)
    }
}

/// Looks at a moment of an avoider: its aircraft is at the origin and flies along x, as does its mission.
pub(super) fn among<T>(
    rows: &[Obstacle],
    look: impl FnOnce(&mut Avoider, &Situation<'_>, &Now<'_>) -> T,
) -> T {
    let mut avoider = Avoider::new(Settings::default(), Vehicle::lagged(0.0)).unwrap();
    let waypoints_m = [Vec3::ZERO, Vec3::new(9000.0, 0.0, 0.0)];
    let situation = Situation {
        time_s: 0.0,
        ownship: Ownship {
            position_m: Vec3::ZERO,
            airspeed_mps: avoider.vehicle().airspeed_mps,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
        },
        obstacles: Obstacles::Rows(&[]),
        mission: Mission::new(&waypoints_m),
        wind_mps: Vec3::ZERO,
    };
    // A step alone, so that it knows its leg.
    avoider.step(&situation);
    let situation = Situation {
        obstacles: Obstacles::Rows(rows),
        ..situation
    };
    let now = Now {
        state: MotionState::of(&situation.ownship),
        mission: &situation.mission,
    };
    avoider.meter = crate::meter::Meter::unlimited();
    avoider.load_tracks(&situation, None, false);
    avoider.far_s = avoider.far_horizon_s(&now);
    look(&mut avoider, &situation, &now)
}

/// A plan on a rung that turns to a course, against the obstacle 1.
pub(super) fn plan(
    avoider: &mut Avoider,
    situation: &Situation<'_>,
    (course_rad, rung): (f64, usize),
) -> Plan {
    let turns = crate::search::Turns {
        wait_s: 0.0,
        turn_rad: course_rad,
        climb_rad: 0.0,
        second: None,
    };
    let answer = Answer {
        found: Found {
            turns,
            margin_m: 0.05,
            cost: 0.0,
        },
        outcome: Outcome::Open,
        rung,
    };
    avoider.tables.answer = Maneuver::turn(0.0, course_rad, 0.0).into();
    let threat = Threat {
        id: 1,
        entry_s: 5.0,
        closest_s: 6.0,
        margin_m: -1.0,
    };
    let mut against = Against::default();
    against.add(1);
    let decision = &mut Decision::default();
    avoider.begin(situation, &answer, (threat, against), decision);
    avoider.plan.unwrap()
}

fn reason(rows: &[Obstacle]) -> Reason {
    among(rows, |avoider, situation, now| {
        let mut decision = Decision::default();
        avoider.watch(situation, now, &mut decision);
        decision.record.reason
    })
}

#[test]
fn what_is_beside_the_mission_is_no_threat() {
    assert_eq!(reason(&[]), Reason::Clear);
    assert_eq!(
        reason(&[sphere(1, (200.0, 35.0), (0.0, 0.0))]),
        Reason::Clear
    );
}

/// One that may turn is waited for as long as a turn remains; then the turn begins at once.
#[test]
fn what_is_ahead_is_waited_for() {
    assert_eq!(
        reason(&[aircraft(1, (900.0, 5.0), (-20.0, 0.0))]),
        Reason::WaitingForStart
    );
    assert_eq!(
        reason(&[aircraft(1, (150.0, 5.0), (-20.0, 0.0))]),
        Reason::ManeuverChosen
    );
}

/// What keeps its velocity is waited for until its entry lies within the horizon of 60 s; then the start is planned.
#[test]
fn what_flies_nearly_as_the_aircraft_is_planned_for_within_the_horizon() {
    let plans = |ahead_m| {
        among(
            &[sphere(1, (ahead_m, 0.0), (13.5, 0.0))],
            |avoider, situation, now| {
                let mut decision = Decision::default();
                avoider.watch(situation, now, &mut decision);
                assert!(decision.record.reason != Reason::Clear);
                avoider.plan.is_some()
            },
        )
    };
    // It comes nearer by 1.5 m/s.
    assert!(!plans(RADIUS_M + 1.5 * 61.0) && plans(RADIUS_M + 1.5 * 59.0));
}

/// As on the mission: an aircraft that turns towards it is not yet a reason to turn again. Another course leads away.
#[test]
fn along_the_mission_a_manoeuvre_goes_on_while_a_turn_remains_in_reserve() {
    let flies = |turn_rad: f64, ahead_m: f64| {
        let (sin, cos) = turn_rad.sin_cos();
        let row = aircraft(
            1,
            (ahead_m * cos, ahead_m * sin),
            (-20.0 * cos, -20.0 * sin),
        );
        among(&[row], |avoider, situation, now| {
            plan(avoider, situation, (turn_rad, WANTED));
            let flown = avoider.flown;
            let mut decision = Decision::default();
            avoider.avoid(situation, now, &mut decision);
            (decision.record.reason, avoider.flown == flown)
        })
    };
    assert_eq!(flies(0.0, 900.0), (Reason::WaitingForStart, true));
    assert_eq!(flies(0.3, 900.0), (Reason::WaitingForStart, true));
    assert_eq!(flies(0.5, 900.0), (Reason::ManeuverReplaced, false));
    assert_eq!(flies(0.0, 200.0), (Reason::ManeuverReplaced, false));
}

#[test]
fn a_way_back_waits_for_the_time_of_a_turn_or_until_the_aircraft_passes() {
    let has_begun = |rows: &[Obstacle], turned_rad: f64| {
        among(rows, |avoider, situation, _| {
            let plan = plan(avoider, situation, (0.5, WANTED));
            let later = Situation {
                time_s: turned_rad / avoider.flyer.course_rate_radps(),
                ..*situation
            };
            avoider.has_begun(&plan, &later)
        })
    };
    let comes = aircraft(1, (300.0, 80.0), (-20.0, 0.0));
    let passes = aircraft(1, (-300.0, 80.0), (-20.0, 0.0));
    assert!(!has_begun(&[comes], 0.79) && has_begun(&[comes], 0.81));
    assert!(has_begun(&[passes], 0.0));
    assert!(!has_begun(&[passes, comes], 0.0));
    // What it does not avoid does not matter, and what keeps its velocity is looked at by the way back itself.
    let other = Obstacle { id: 2, ..comes };
    assert!(has_begun(&[passes, other], 0.0));
    assert!(has_begun(&[sphere(1, (300.0, 0.0), (-20.0, 0.0))], 0.0));
}

/// Only a certified one, not past another aircraft, and for a minute at most.
#[test]
fn among_uncertain_reports_a_manoeuvre_is_flown_until_the_aircraft_passes() {
    let row = |id, ahead_m, velocity_mps| {
        let mut row = aircraft(id, (ahead_m, 80.0), (-20.0, 0.0));
        row.uncertainty.velocity_mps = velocity_mps;
        row
    };
    let has_begun = |rows: &[Obstacle], later_s: f64, is_certified| {
        among(rows, |avoider, situation, _| {
            let mut plan = plan(avoider, situation, (0.5, WANTED));
            if is_certified {
                plan.outcome = Outcome::Proven;
            }
            let later = Situation {
                time_s: later_s,
                ..*situation
            };
            avoider.has_begun(&plan, &later)
        })
    };
    let comes = row(1, 300.0, 0.5);
    assert!(!has_begun(&[comes], 59.0, true) && has_begun(&[comes], 61.0, true));
    assert!(has_begun(&[comes], 59.0, false) && has_begun(&[row(1, 300.0, 0.0)], 59.0, true));
    assert!(has_begun(&[row(1, -300.0, 0.5)], 59.0, true));
    assert!(has_begun(&[comes, row(2, 900.0, 0.5)], 59.0, true));
}
