//! CZML for Cesium: the flight with its attitude and its height above the ground, the protected volumes, the zones, the events.

use super::look::{GROUND_COLOR, MISSION_COLOR, OBSTACLE_COLOR, ZONE_COLOR, pieces, state_color};
use super::shapes::{curtain, zone_heights_m};
use super::text::{escaped, iso};
use crate::flight::{Flight, FlightObstacle, FlightZone};
use crate::geodesy::LocalFrame;
use fga::Vec3;
use fga::situation::ProtectedVolume;
use serde_json::{Value, json};

/// Least time between samples, seconds.
const STEP_S: f64 = 0.1;

/// The flight as a CZML document: an array of packets, the first of which is the document.
pub fn text(flight: &Flight) -> String {
    let (from_s, to_s) = flight.span_s();
    let interval = interval(flight, from_s, to_s);
    let mut packets = vec![json!({
        "id": "document",
        "version": "1.0",
        "name": flight.name,
        "clock": {
            "interval": interval,
            "currentTime": iso(flight.unix_s(from_s)),
            "multiplier": 1,
            "range": "LOOP_STOP",
        },
    })];
    packets.push(aircraft(flight, &interval));
    packets.extend(state_lines(flight));
    let frame = flight.frame();
    if !flight.mission.is_empty() {
        packets.push(json!({
            "id": "mission",
            "name": "Mission",
            "polyline": polyline(&frame, flight.mission.iter().copied(), MISSION_COLOR, 2),
        }));
    }
    for (index, [ground, path]) in curtain(flight).into_iter().enumerate() {
        let lowest_m: Vec<f64> = ground.iter().map(|at| degrees(&frame, *at)[2]).collect();
        let places: Vec<f64> = path.iter().flat_map(|at| degrees(&frame, *at)).collect();
        packets.push(json!({
            "id": format!("ground/{index}"),
            "name": "Height above the ground",
            "wall": {
                "positions": { "cartographicDegrees": places },
                "minimumHeights": { "array": lowest_m },
                "material": { "solidColor": { "color": rgba(GROUND_COLOR, 80) } },
            },
        }));
    }
    for (index, obstacle) in flight.obstacles.iter().enumerate() {
        packets.push(self::obstacle(flight, index, obstacle, &interval));
    }
    for (index, zone) in flight.zones.iter().enumerate() {
        packets.push(self::zone(flight, index, zone));
    }
    for (index, (event, position_m)) in flight.placed_events().enumerate() {
        packets.push(json!({
            "id": format!("event/{index}"),
            "name": event.kind,
            "description": html(&event.text),
            "availability": self::interval(flight, event.time_s, to_s.max(event.time_s)),
            "position": { "cartographicDegrees": degrees(&frame, position_m) },
            "point": { "pixelSize": 6, "color": rgba(state_color("avoiding"), 255) },
        }));
    }
    Value::Array(packets).to_string()
}

/// Cesium renders descriptions as HTML.
fn html(text: &str) -> String {
    format!("<p>{}</p>", escaped(text))
}

fn interval(flight: &Flight, from_s: f64, to_s: f64) -> String {
    // An interval of no length shows nothing.
    let to_s = to_s.max(from_s + 0.001);
    format!(
        "{}/{}",
        iso(flight.unix_s(from_s)),
        iso(flight.unix_s(to_s))
    )
}

fn rgba([red, green, blue]: [u8; 3], alpha: u8) -> Value {
    json!({ "rgba": [red, green, blue, alpha] })
}

/// Longitude and latitude (degrees) and altitude (metres).
fn degrees(frame: &LocalFrame, position_m: Vec3) -> [f64; 3] {
    let place = frame.to_geodetic(position_m);
    [place.longitude_deg, place.latitude_deg, place.altitude_m]
}

fn polyline(
    frame: &LocalFrame,
    positions: impl Iterator<Item = Vec3>,
    color: [u8; 3],
    width: u32,
) -> Value {
    let degrees: Vec<f64> = positions.flat_map(|p| degrees(frame, p)).collect();
    json!({
        "positions": { "cartographicDegrees": degrees },
        "arcType": "NONE",
        "width": width,
        "material": { "solidColor": { "color": rgba(color, 255) } },
    })
}

/// The flown track again, as one line for each state.
fn state_lines(flight: &Flight) -> impl Iterator<Item = Value> {
    let frame = flight.frame();
    pieces(flight, STEP_S)
        .into_iter()
        .enumerate()
        .map(move |(index, (state, piece))| {
            let positions = piece.iter().map(|sample| sample.position_m);
            json!({
                "id": format!("track/{index}"),
                "name": state,
                "polyline": polyline(&frame, positions, state_color(state), 3),
            })
        })
}

/// Times, longitudes, latitudes and altitudes.
fn timed(frame: &LocalFrame, rows: impl Iterator<Item = (f64, Vec3)>) -> Vec<f64> {
    rows.flat_map(|(time_s, position_m)| {
        let [longitude, latitude, altitude] = degrees(frame, position_m);
        [time_s, longitude, latitude, altitude]
    })
    .collect()
}

fn aircraft(flight: &Flight, interval: &str) -> Value {
    let frame = flight.frame();
    let samples = flight.thinned(STEP_S);
    let epoch = iso(flight.unix_s(0.0));
    let rows = samples
        .iter()
        .map(|sample| (sample.time_s, sample.position_m));
    let positions = timed(&frame, rows);
    let mut last: Option<[f64; 4]> = None;
    let attitudes: Vec<f64> = samples
        .iter()
        .flat_map(|sample| {
            // Earth-centred.
            let mut quaternion = sample.attitude(|axis| frame.centred_direction(axis));
            // q and −q are the same attitude; interpolation takes the near one.
            if let Some(last) = last
                && last.iter().zip(quaternion).map(|(a, b)| a * b).sum::<f64>() < 0.0
            {
                quaternion = quaternion.map(core::ops::Neg::neg);
            }
            last = Some(quaternion);
            let [x, y, z, w] = quaternion;
            [sample.time_s, x, y, z, w]
        })
        .collect();
    json!({
        "id": "aircraft",
        "name": if flight.policy.is_empty() { "Aircraft" } else { &flight.policy },
        "availability": interval,
        "position": { "epoch": epoch, "cartographicDegrees": positions },
        "orientation": { "epoch": epoch, "unitQuaternion": attitudes },
        "point": { "pixelSize": 8, "color": rgba(state_color("cruise"), 255) },
        "box": {
            "dimensions": { "cartesian": [4.0, 6.0, 1.0] },
            "material": { "solidColor": { "color": rgba(state_color("cruise"), 255) } },
        },
    })
}

/// A zone between two altitudes; of one to keep within the wall alone, through which the flight is seen.
fn zone(flight: &Flight, index: usize, zone: &FlightZone) -> Value {
    let frame = flight.frame();
    let (floor_m, ceiling_m) = zone_heights_m(flight, zone);
    let places = zone.ring_m.iter();
    let degrees: Vec<[f64; 3]> = places
        .map(|[x_m, y_m]| degrees(&frame, Vec3::new(*x_m, *y_m, floor_m)))
        .collect();
    let [floor_m, ceiling_m] =
        [floor_m, ceiling_m].map(|z_m| self::degrees(&frame, Vec3::Z * z_m)[2]);
    let material = json!({ "solidColor": { "color": rgba(ZONE_COLOR, 80) } });
    let positions = json!({ "cartographicDegrees": degrees.as_flattened() });
    let (key, shape) = if zone.keep_in {
        let count = degrees.len();
        let wall = json!({
            "positions": positions,
            "minimumHeights": { "array": vec![floor_m; count] },
            "maximumHeights": { "array": vec![ceiling_m; count] },
            "material": material,
        });
        ("wall", wall)
    } else {
        let body = json!({
            "positions": positions,
            "height": floor_m,
            "extrudedHeight": ceiling_m,
            "material": material,
        });
        ("polygon", body)
    };
    json!({
        "id": format!("zone/{index}"),
        "name": zone.name,
        "description": html(zone.kind()),
        key: shape,
    })
}

fn obstacle(flight: &Flight, index: usize, obstacle: &FlightObstacle, interval: &str) -> Value {
    let frame = flight.frame();
    let material = json!({ "solidColor": { "color": rgba(OBSTACLE_COLOR, 80) } });
    let (position, availability) = match (&obstacle.track[..], obstacle.is_static()) {
        ([only], true) => (
            json!({ "cartographicDegrees": degrees(&frame, only.position_m) }),
            interval.to_owned(),
        ),
        (track, _) => {
            let rows = timed(&frame, track.iter().map(|row| (row.time_s, row.position_m)));
            let from_s = track.first().map_or(0.0, |row| row.time_s);
            let to_s = track.last().map_or(0.0, |row| row.time_s);
            (
                json!({ "epoch": iso(flight.unix_s(0.0)), "cartographicDegrees": rows }),
                self::interval(flight, from_s, to_s),
            )
        }
    };
    let (key, shape) = match obstacle.volume {
        ProtectedVolume::Sphere { radius_m } => (
            "ellipsoid",
            json!({ "radii": { "cartesian": [radius_m, radius_m, radius_m] }, "material": material }),
        ),
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        } => (
            "cylinder",
            json!({
                "length": 2.0 * half_height_m,
                "topRadius": radius_m,
                "bottomRadius": radius_m,
                "material": material,
            }),
        ),
    };
    json!({
        "id": format!("obstacle/{index}"),
        "name": obstacle.name,
        "point": { "pixelSize": 5, "color": rgba(OBSTACLE_COLOR, 255) },
        "label": {
            "text": obstacle.name,
            "font": "12px sans-serif",
            "pixelOffset": { "cartesian2": [0, -16] },
        },
        "position": position,
        "availability": availability,
        key: shape,
    })
}
