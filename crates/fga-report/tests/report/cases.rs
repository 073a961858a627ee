//! Runs to draw: an ordinary one and extremes.

use fga::Vec3;
use fga::avoider::State;
use fga::situation::ProtectedVolume;
use fga_report::overview::{
    MomentKind, Overview, OverviewMoment, OverviewObstacle, OverviewPoint, PathSample,
};

const SPHERE: ProtectedVolume = ProtectedVolume::Sphere { radius_m: 30.0 };

/// Flies `waypoints` at 15 m/s; `state` gives the state at a time.
fn fly(waypoints: &[Vec3], rate_hz: f64, state: impl Fn(f64) -> State) -> Vec<PathSample> {
    let mut samples = Vec::new();
    let mut time_s = 0.0;
    let step_m = 15.0 / rate_hz;
    for leg in waypoints.windows(2) {
        let length = leg[0].distance(leg[1]);
        let mut along = 0.0;
        while along < length {
            samples.push(PathSample {
                time_s,
                position_m: leg[0] + (leg[1] - leg[0]) * (along / length),
                state: state(time_s),
            });
            along += step_m;
            time_s += 1.0 / rate_hz;
        }
    }
    samples
}

/// A smooth detour round (`at`, 0) of the given height, along +x.
fn detour(length_m: f64, at_m: f64, width_m: f64, off_m: f64) -> Vec<Vec3> {
    (0..=200)
        .map(|i| {
            let x = length_m * f64::from(i) / 200.0;
            let u = (x - at_m) / width_m;
            let bump = libm::exp(-u * u);
            Vec3::new(x, off_m * bump, 60.0 + 0.25 * off_m * bump)
        })
        .collect()
}

fn still(id: u32, name: &str, volume: ProtectedVolume, at: Vec3) -> OverviewObstacle {
    OverviewObstacle {
        id,
        name: name.into(),
        volume,
        track: vec![OverviewPoint {
            time_s: 0.0,
            position_m: at,
        }],
        closest: None,
    }
}

fn mover(id: u32, name: &str, from: Vec3, velocity: Vec3, end_s: f64) -> OverviewObstacle {
    OverviewObstacle {
        id,
        name: name.into(),
        volume: SPHERE,
        track: vec![
            OverviewPoint {
                time_s: 0.0,
                position_m: from,
            },
            OverviewPoint {
                time_s: end_s,
                position_m: from + velocity * end_s,
            },
        ],
        closest: None,
    }
}

fn moment(time_s: f64, kind: MomentKind) -> OverviewMoment {
    OverviewMoment {
        time_s,
        kind,
        obstacle: Some(1),
    }
}

fn phases(time_s: f64, seen: f64, begun: f64, clear: f64, back: f64) -> State {
    if time_s < seen || time_s >= back {
        State::Cruise
    } else if time_s < begun {
        State::Threatened
    } else if time_s < clear {
        State::Avoiding
    } else {
        State::Recovering
    }
}

/// Every case with a name that suits a file.
pub(crate) fn all() -> Vec<(&'static str, Overview)> {
    vec![
        ("encounter", encounter(55.0)),
        ("lost", encounter(20.0)),
        ("survey", survey()),
        ("thousand", thousand()),
        ("no-obstacles", no_obstacles()),
        ("one-sample", one_sample()),
        ("empty", Overview::default()),
        ("northbound", northbound()),
        ("cylinders", cylinders()),
    ]
}

pub(crate) fn encounter(off_m: f64) -> Overview {
    let moments = vec![
        moment(1.2, MomentKind::ThreatSeen),
        moment(4.0, MomentKind::ManeuverBegun),
        moment(17.5, MomentKind::Rejoined),
    ];
    Overview {
        zones: Vec::new(),
        title: "Two threats within 200 m <&> a \"name\"".into(),
        mission_m: vec![Vec3::new(0.0, 0.0, 60.0), Vec3::new(300.0, 0.0, 60.0)],
        samples: fly(&detour(300.0, 150.0, 55.0, off_m), 20.0, |t| {
            phases(t, 1.2, 4.0, 11.0, 17.5)
        }),
        obstacles: vec![
            still(1, "mast <b>&", SPHERE, Vec3::new(150.0, -8.0, 60.0)),
            mover(
                2,
                "crossing aircraft",
                Vec3::new(330.0, -60.0, 70.0),
                Vec3::new(-11.0, 2.0, 0.0),
                24.0,
            ),
        ],
        moments,
    }
}

fn survey() -> Overview {
    let mut waypoints = Vec::new();
    for row in 0..8 {
        let y = f64::from(row) * 120.0;
        let (a, b) = if row % 2 == 0 {
            (0.0, 1100.0)
        } else {
            (1100.0, 0.0)
        };
        waypoints.push(Vec3::new(a, y, 80.0));
        waypoints.push(Vec3::new(b, y, 80.0));
    }
    let cylinder = |radius_m, half_height_m| ProtectedVolume::Cylinder {
        radius_m,
        half_height_m,
    };
    let mut moments = Vec::new();
    for event in 0..7 {
        let at = 40.0 + 85.0 * f64::from(event);
        moments.push(moment(at, MomentKind::ThreatSeen));
        moments.push(moment(at + 6.0, MomentKind::ManeuverBegun));
        moments.push(moment(at + 30.0, MomentKind::Rejoined));
    }
    Overview {
        zones: Vec::new(),
        title: "Survey of ten minutes with buildings, a mast and three aircraft".into(),
        mission_m: waypoints.clone(),
        samples: fly(&waypoints, 100.0, |t| {
            let phase = (t - 40.0).rem_euclid(85.0);
            if t < 40.0 {
                State::Cruise
            } else {
                phases(phase, 0.0, 6.0, 18.0, 30.0)
            }
        }),
        obstacles: vec![
            still(
                1,
                "town hall",
                cylinder(45.0, 60.0),
                Vec3::new(300.0, 190.0, 0.0),
            ),
            still(
                2,
                "warehouse",
                cylinder(60.0, 40.0),
                Vec3::new(760.0, 420.0, 0.0),
            ),
            still(
                3,
                "radio mast",
                cylinder(35.0, 140.0),
                Vec3::new(540.0, 660.0, 0.0),
            ),
            mover(
                4,
                "N123AB",
                Vec3::new(-200.0, 300.0, 90.0),
                Vec3::new(30.0, 6.0, 0.0),
                60.0,
            ),
            mover(
                5,
                "glider",
                Vec3::new(1300.0, 900.0, 110.0),
                Vec3::new(-9.0, -5.0, -0.1),
                300.0,
            ),
            mover(
                6,
                "helicopter of the rescue service",
                Vec3::new(500.0, 1500.0, 80.0),
                Vec3::new(1.0, -20.0, 0.0),
                600.0,
            ),
        ],
        moments,
    }
}

fn thousand() -> Overview {
    let mut overview = encounter(55.0);
    overview.title = "A thousand obstacles".into();
    let mut seed = 12345_u32;
    let mut random = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(seed >> 8) / f64::from(1_u32 << 24)
    };
    for id in 10..1008 {
        let at = Vec3::new(
            random() * 900.0 - 300.0,
            random() * 900.0 - 450.0,
            random() * 400.0 - 100.0,
        );
        let velocity = Vec3::new(random() - 0.5, random() - 0.5, 0.0) * 20.0;
        let name = format!("object {id}");
        overview.obstacles.push(if id % 2 == 0 {
            still(id, &name, ProtectedVolume::Sphere { radius_m: 8.0 }, at)
        } else {
            mover(id, &name, at, velocity, 25.0)
        });
    }
    overview
}

fn no_obstacles() -> Overview {
    Overview {
        title: "Nothing in the way".into(),
        mission_m: vec![Vec3::ZERO, Vec3::new(900.0, 400.0, 0.0)],
        samples: fly(&[Vec3::ZERO, Vec3::new(900.0, 400.0, 0.0)], 20.0, |_| {
            State::Cruise
        }),
        ..Overview::default()
    }
}

fn one_sample() -> Overview {
    let mut overview = encounter(55.0);
    overview.title = "A single sample".into();
    overview.samples.truncate(1);
    overview.moments.clear();
    overview
}

fn northbound() -> Overview {
    let mut overview = encounter(55.0);
    let turn = |p: Vec3| Vec3::new(-p.y, 3.0 * p.x, p.z);
    overview.title = "Towards the north".into();
    overview.mission_m.iter_mut().for_each(|p| *p = turn(*p));
    for sample in &mut overview.samples {
        sample.position_m = turn(sample.position_m);
        sample.time_s *= 3.0;
    }
    for point in overview.obstacles.iter_mut().flat_map(|o| &mut o.track) {
        point.position_m = turn(point.position_m);
        point.time_s *= 3.0;
    }
    for moment in &mut overview.moments {
        moment.time_s *= 3.0;
    }
    overview
}

fn cylinders() -> Overview {
    let knots = 0.514_444;
    let end = Vec3::new(14_000.0, 0.0, 1_500.0);
    let mut overview = Overview {
        title: "Recorded encounter, general aviation".into(),
        mission_m: vec![Vec3::new(0.0, 0.0, 1_500.0), end],
        samples: fly(&detour(14_000.0, 7_000.0, 1_200.0, 700.0), 1.0, |_| {
            State::Cruise
        }),
        obstacles: vec![mover(
            1,
            "intruder",
            Vec3::new(14_000.0, 500.0, 80.0),
            Vec3::new(-200.0 * knots, 0.0, 0.0),
            140.0,
        )],
        zones: Vec::new(),
        moments: vec![
            moment(20.0, MomentKind::ThreatSeen),
            moment(28.0, MomentKind::ManeuverBegun),
            moment(90.0, MomentKind::Rejoined),
        ],
    };
    for sample in &mut overview.samples {
        sample.time_s *= 15.0 / (180.0 * knots);
        let time = sample.time_s;
        sample.state = phases(time, 20.0, 28.0, 60.0, 90.0);
    }
    overview.obstacles[0].volume = ProtectedVolume::Cylinder {
        radius_m: 152.4,
        half_height_m: 30.48,
    };
    overview
}
