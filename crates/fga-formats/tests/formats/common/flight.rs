//! A synthetic flight for the exports.

use fga::Vec3;
use fga::situation::ProtectedVolume;
use fga_formats::flight::{Flight, FlightEvent, FlightObstacle, FlightSample, ObstacleSample};
use fga_formats::geodesy::Geodetic;

/// A name that every format must escape.
pub(crate) const HOSTILE: &str = "</script><img src=x onerror=alert(1)>&\"']]> \u{1}\u{fffe}ü\n2";

/// East along the equator at 20 m/s for 30 s with a left turn of the state in the middle, a mast,
/// and an intruder between 5 s and 25 s.
pub(crate) fn flight() -> Flight {
    let samples = (0_u32..=300)
        .map(|step| {
            let time_s = f64::from(step) * 0.1;
            FlightSample {
                time_s,
                position_m: Vec3::new(20.0 * time_s, 0.0, 50.0),
                course_rad: 0.0,
                climb_rad: 0.0,
                bank_rad: 0.0,
                state: if (100..200).contains(&step) {
                    "avoiding".into()
                } else {
                    "cruise".into()
                },
                ground_m: None,
            }
        })
        .collect();
    Flight {
        name: HOSTILE.into(),
        policy: "published".into(),
        origin: Geodetic::new(0.0, 10.0, 100.0),
        start_unix_s: Some(1_709_164_799.25),
        samples,
        mission: vec![Vec3::new(0.0, 0.0, 50.0), Vec3::new(600.0, 0.0, 50.0)],
        obstacles: vec![
            FlightObstacle {
                name: HOSTILE.into(),
                volume: ProtectedVolume::Cylinder {
                    radius_m: 30.0,
                    half_height_m: 60.0,
                },
                track: vec![ObstacleSample {
                    time_s: 0.0,
                    position_m: Vec3::new(300.0, 100.0, 0.0),
                }],
            },
            FlightObstacle {
                name: "N2".into(),
                volume: ProtectedVolume::Sphere { radius_m: 30.0 },
                track: [5.0, 25.0]
                    .map(|time_s| ObstacleSample {
                        time_s,
                        position_m: Vec3::new(900.0 - 20.0 * time_s, 40.0, 50.0),
                    })
                    .to_vec(),
            },
        ],
        events: vec![
            FlightEvent {
                time_s: 10.0,
                kind: "start".into(),
                text: format!("turn left for {HOSTILE}"),
                detail: serde_json::json!({ "obstacle": HOSTILE, "least_margin_m": 4.2 }),
            },
            FlightEvent {
                time_s: 31.0,
                kind: "end".into(),
                text: "the flight ends".into(),
                detail: serde_json::Value::Null,
            },
        ],
        ..Flight::default()
    }
}

/// Flights at the edges: one sample, no obstacles, many obstacles.
pub(crate) fn odd_flights() -> Vec<Flight> {
    let one = Flight {
        samples: flight().samples[..1].to_vec(),
        mission: Vec::new(),
        ..flight()
    };
    let alone = Flight {
        origin: None,
        obstacles: Vec::new(),
        events: Vec::new(),
        ..flight()
    };
    let mut many = flight();
    let [mast, intruder] = [0, 1].map(|i| many.obstacles[i].clone());
    many.obstacles = (0..1000)
        .map(|i| if i % 2 == 0 { &mast } else { &intruder }.clone())
        .collect();
    vec![one, alone, many]
}
