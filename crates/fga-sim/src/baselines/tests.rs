//! Each method against encounters with a known answer, and the properties of all.

use fga::Vec3;
use fga::avoider::{Settings, State};
use fga::situation::{Mission, Obstacles, Situation};
use fga::situation::{Obstacle, Ownship, ProtectedVolume};
use fga::vehicle::{Response, Vehicle};

use super::*;
use crate::engine::{Engine, Observer, Sample};
use crate::plant::{Autopilot, PlantDifference};
use crate::policy::PolicySettings;
use crate::sensor::SensorSettings;
use crate::track::Track;
use crate::world::{Ending, StartState, World, WorldObstacle};

const VOLUME: ProtectedVolume = ProtectedVolume::Sphere { radius_m: 30.0 };

/// Table 4.
fn vehicle() -> Vehicle {
    Vehicle {
        airspeed_mps: 15.0,
        turn_radius_m: 30.0,
        climb_min_rad: -0.261_8,
        climb_max_rad: 0.261_8,
        climb_rate_radps: 0.2,
        response: Response::default(),
    }
}

fn settings() -> Settings {
    Settings {
        surveillance_radius_m: f64::INFINITY,
        ..Settings::default()
    }
}

fn world(bodies: &[(Vec3, Vec3)]) -> World {
    World {
        mission_m: vec![Vec3::ZERO, Vec3::X * 1e6],
        passing: Vec::new(),
        limits_m: (f64::NEG_INFINITY, f64::INFINITY),
        zones: Vec::new(),
        ground: None,
        start: StartState {
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
        },
        vehicle: vehicle(),
        plant: PlantDifference::NONE,
        autopilot: Autopilot::default(),
        settings: PolicySettings {
            avoider: settings(),
            ..PolicySettings::default()
        },
        wind_mps: Vec3::ZERO,
        gust: None,
        obstacles: bodies
            .iter()
            .zip(0..)
            .map(|((position, velocity), id)| {
                WorldObstacle::new(id, Track::straight(*position, *velocity), VOLUME)
            })
            .collect(),
        sensor: SensorSettings::default(),
        more_sensors: Vec::new(),
        seed: 1,
        stream: 0,
        horizon_s: 60.0,
        ending: Ending::BackAndPassed,
        recorded: None,
    }
}

/// Keeps every sample of a flight.
#[derive(Default)]
struct Track3(Vec<Sample>);

impl Observer for Track3 {
    fn sample(&mut self, sample: &Sample) {
        self.0.push(*sample);
    }
}

fn situation<'a>(obstacles: &'a [Obstacle], waypoints_m: &'a [Vec3]) -> Situation<'a> {
    Situation {
        time_s: 0.0,
        ownship: Ownship {
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: 15.0,
        },
        obstacles: Obstacles::Rows(obstacles),
        mission: Mission::new(waypoints_m),
        wind_mps: Vec3::ZERO,
    }
}

#[test]
fn names_are_read_back() {
    for baseline in Baseline::ALL {
        assert_eq!(Baseline::parse(baseline.name()), Some(baseline));
    }
    assert_eq!(Baseline::parse("turn-aware"), None);
}

#[test]
fn each_avoids_a_mast_ahead_and_comes_back() {
    // 8 m beside the line, seen at 300 m: ten seconds of room on either side.
    let world = world(&[(Vec3::new(300.0, 8.0, 2.0), Vec3::ZERO)]);
    for baseline in Baseline::ALL {
        let mut pilot = baseline
            .pilot(&world.settings.avoider, &world.vehicle)
            .unwrap();
        let mut track = Track3::default();
        let outcome = Engine::new().fly(&world, pilot.as_mut(), &mut track);
        let name = baseline.name();
        assert!(outcome.separated(), "{name}: {outcome:?}");
        assert!(outcome.start_s.is_some(), "{name}");
        assert!(outcome.end_s < 60.0, "{name} did not come back");
        let last = track.0.last().unwrap();
        assert_eq!(last.state, State::Cruise, "{name}");
        assert!(last.position_m.y.abs() < 1.0 && last.position_m.z.abs() < 1.0);
    }
}

#[test]
fn no_method_manoeuvres_for_receding_obstacles() {
    // Behind, as fast and slower, and far to the side of the line.
    let world = world(&[
        (Vec3::new(-150.0, 0.0, 0.0), Vec3::new(-20.0, 0.0, 0.0)),
        (Vec3::new(200.0, 900.0, 0.0), Vec3::new(0.0, 25.0, 0.0)),
    ]);
    for baseline in Baseline::ALL {
        let mut pilot = baseline
            .pilot(&world.settings.avoider, &world.vehicle)
            .unwrap();
        let outcome = Engine::new().fly(&world, pilot.as_mut(), &mut ());
        // The potential field knows only positions: a near obstacle may push it.
        if baseline != Baseline::PotentialField {
            assert_eq!(outcome.start_s, None, "{}", baseline.name());
        }
    }
}

#[test]
fn limits_are_kept_and_a_planar_vehicle_stays_level() {
    let mut planar = world(&[
        (Vec3::new(250.0, 0.0, 10.0), Vec3::new(-10.0, 1.0, 0.0)),
        (Vec3::new(150.0, 120.0, 0.0), Vec3::new(0.0, -9.0, 0.0)),
    ]);
    (planar.vehicle.climb_min_rad, planar.vehicle.climb_max_rad) = (0.0, 0.0);
    for baseline in Baseline::ALL {
        let mut pilot = baseline
            .pilot(&planar.settings.avoider, &planar.vehicle)
            .unwrap();
        let mut track = Track3::default();
        Engine::new().fly(&planar, pilot.as_mut(), &mut track);
        for pair in track.0.windows(2) {
            let turned = fga::angle::wrap_pi(pair[1].course_rad - pair[0].course_rad).abs();
            let most = 15.0 / 30.0 * (pair[1].time_s - pair[0].time_s);
            assert!(turned <= most + 1e-9, "{}", baseline.name());
            assert_eq!(pair[1].position_m.z, 0.0, "{}", baseline.name());
        }
    }
}

#[test]
fn a_flight_is_the_same_twice() {
    let world = world(&[
        (Vec3::new(280.0, 5.0, -3.0), Vec3::new(-22.0, 0.5, 0.0)),
        (Vec3::new(120.0, -180.0, 4.0), Vec3::new(1.0, 18.0, 0.2)),
    ]);
    for baseline in Baseline::ALL {
        let fly = || {
            let mut pilot = baseline
                .pilot(&world.settings.avoider, &world.vehicle)
                .unwrap();
            Engine::new().fly(&world, pilot.as_mut(), &mut ())
        };
        assert_eq!(fly(), fly(), "{}", baseline.name());
    }
}

#[test]
fn nothing_that_is_not_finite_comes_out() {
    let waypoints = [Vec3::ZERO, Vec3::X * 1000.0];
    let at = |position: Vec3, velocity: Vec3| Obstacle::straight(1, position, velocity, VOLUME);
    let odd = [
        at(Vec3::ZERO, Vec3::ZERO),
        at(Vec3::ZERO, Vec3::X * 15.0),
        at(Vec3::X * 20.0, Vec3::X * 15.0),
        at(Vec3::X * 200.0, Vec3::X * -15.0),
        at(Vec3::Z * 100.0, Vec3::Z * -30.0),
        at(Vec3::X * 30.0, Vec3::ZERO),
        at(Vec3::X * 1e9, Vec3::X * -1e9),
        at(Vec3::X * f64::NAN, Vec3::ZERO),
    ];
    for baseline in Baseline::ALL {
        let mut sets: Vec<&[Obstacle]> = odd.chunks(1).collect();
        sets.push(&odd);
        for obstacles in sets {
            let mut pilot = baseline.pilot(&settings(), &vehicle()).unwrap();
            let decision = pilot.step(&situation(obstacles, &waypoints));
            for stage in decision.command.stages() {
                assert!(
                    stage.course_rad.is_finite() && stage.climb_rad.is_finite(),
                    "{}: {obstacles:?}",
                    baseline.name()
                );
            }
        }
    }
}

fn sphere(offset_m: Vec3, velocity_mps: Vec3) -> Sphere {
    Sphere {
        id: 1,
        offset_m,
        velocity_mps,
        radius_m: 30.0,
    }
}

#[test]
fn entry_and_closest_approach_by_hand() {
    // Head-on at 300 m, 15 + 15 m/s: 270 m at 30 m/s.
    let head_on = sphere(Vec3::X * 300.0, Vec3::X * -15.0);
    assert_eq!(head_on.entry_s(Vec3::X * 15.0), Some(9.0));
    assert_eq!(head_on.closest(Vec3::X * 15.0), (10.0, Vec3::ZERO));
    // 24 m beside a static one: the chord begins 18 m before abeam (18² + 24² = 30²).
    let beside = sphere(Vec3::new(168.0, 24.0, 0.0), Vec3::ZERO);
    assert_eq!(beside.entry_s(Vec3::X * 15.0), Some(10.0));
    assert_eq!(beside.entry_s(Vec3::X * -15.0), None);
    // A leg that ends before it: 300 − 100 − 30.
    let clear = head_on.clearance_m(Vec3::ZERO, Vec3::X * 100.0, 0.0, 1e9);
    assert!((clear - 170.0).abs() < 1e-3);
}

fn view<'a>(spheres: &'a [Sphere], vehicle: &'a Vehicle) -> View<'a> {
    View {
        velocity_mps: Vec3::X * 15.0,
        preferred_mps: Vec3::X * 15.0,
        route: RelativeRoute {
            foot_m: Vec3::ZERO,
            along: Vec3::X,
        },
        spheres,
        vehicle,
        period_s: 0.1,
    }
}

#[test]
fn velocity_methods_aim_along_the_tangent() {
    // A static sphere ahead, a little to the left, at this height: the tangent to its right.
    let vehicle = vehicle();
    let spheres = [sphere(Vec3::new(200.0, 5.0, 0.0), Vec3::ZERO)];
    let view = view(&spheres, &vehicle);
    let right = |inflation: f64| {
        let bearing = libm::atan2(5.0, 200.0);
        bearing - libm::asin(30.0 * inflation / libm::hypot(200.0, 5.0))
    };
    let orca = Orca {
        horizon_s: 60.0,
        inflation: 1.0,
    };
    let chosen = { orca }.steer(&view).unwrap();
    // The half-space touches the cone where it is nearest to the wish: the projected velocity is slower
    // than the wish, but lies on the tangent.
    assert!((fga::angle::course_of(chosen) - right(1.0)).abs() < 1e-3);
    let voltage = VoltagePotential {
        look_ahead_s: 60.0,
        inflation: 1.0,
    };
    let chosen = { voltage }.steer(&view).unwrap();
    assert!((fga::angle::course_of(chosen) - right(1.0)).abs() < 1e-3);
}

#[test]
fn velocity_obstacles_take_the_nearest_free_direction() {
    let mut vehicle = vehicle();
    (vehicle.climb_min_rad, vehicle.climb_max_rad) = (0.0, 0.0);
    let spheres = [sphere(Vec3::new(200.0, 5.0, 0.0), Vec3::ZERO)];
    let mut method = VelocityObstacles {
        inflation: 1.0,
        horizon_s: 60.0,
        ..VelocityObstacles::default()
    };
    let chosen = method.steer(&view(&spheres, &vehicle)).unwrap();
    // Tangents at 1.43° ± 8.62°: −7.2° and 10.1°; steps of 5° give −10°.
    assert!((fga::angle::course_of(chosen).to_degrees() + 10.0).abs() < 1e-9);
}

#[test]
fn a_repulsion_that_equals_the_attraction_bends_by_half_the_angle() {
    // At one protected radius from the surface the force is gain · (1 − 1/reach) = 1, straight to
    // the right: the sum points 45° to the right.
    let vehicle = vehicle();
    let spheres = [sphere(Vec3::Y * 60.0, Vec3::ZERO)];
    let mut field = PotentialField {
        gain: 2.0,
        reach: 2.0,
    };
    let chosen = field.steer(&view(&spheres, &vehicle)).unwrap();
    assert!((fga::angle::course_of(chosen) + core::f64::consts::FRAC_PI_4).abs() < 1e-12);
}

#[test]
fn the_search_finds_the_shorter_way() {
    // A row of spheres across the line that ends on the left: both planners fly a clear path, and
    // the searched one is not longer.
    let mut planar = vehicle();
    (planar.climb_min_rad, planar.climb_max_rad) = (0.0, 0.0);
    let spheres: Vec<Sphere> = (0..5)
        .map(|i| {
            sphere(
                Vec3::new(150.0, 20.0 - 45.0 * f64::from(i), 0.0),
                Vec3::ZERO,
            )
        })
        .collect();
    let view = view(&spheres, &planar);
    let cube = Cube {
        half_edge_m: 60.0,
        points: 5,
        inflation: 1.2,
        goal_m: 300.0,
    };
    for chosen in [
        Waypoints::new(cube, None).steer(&view).unwrap(),
        Waypoints::new(cube, Some(200)).steer(&view).unwrap(),
    ] {
        assert!(chosen.y >= 0.0, "{chosen:?}");
        assert!(spheres.iter().all(|s| {
            s.entry_s(chosen.normalize() * 15.0)
                .is_none_or(|t| t * 15.0 > chosen.length())
        }));
    }
}
