//! MCAP for Foxglove and PlotJuggler: JSON messages with JSON schemas, uncompressed.
//!
//! | topic | schema | what |
//! |---|---|---|
//! | `/aircraft/pose` | `foxglove.PoseInFrame` | position and attitude in the frame `local` |
//! | `/aircraft/location` | `foxglove.LocationFix` | place on the globe, where the origin is known |
//! | `/aircraft/state` | `fga.State` | numbers to plot, and the avoidance's state |
//! | `/scene` | `foxglove.SceneUpdate` | mission, obstacles with their volumes |
//! | `/separations` | `fga.Separations` | distance and margin to every obstacle |
//! | `/events` | `fga.Event` | what happened and was decided, with the whole record |
//!
//! The frame `local` has x east, y north, z up.

use super::look::{MISSION_COLOR, OBSTACLE_COLOR, state_color};
use crate::flight::{Flight, FlightEvent, FlightObstacle, FlightSample};
use crate::number::count;
use ::mcap::records::MessageHeader;
use ::mcap::{McapError, WriteOptions, Writer};
use alloc::collections::BTreeMap;
use fga::Vec3;
use fga::situation::ProtectedVolume;
use serde_json::{Value, json};
use std::io::{self, Cursor};

/// Least time between samples, seconds.
const STEP_S: f64 = 0.05;
/// Least time between drawings of the scene, seconds.
const SCENE_STEP_S: f64 = 0.1;
/// The frame's name.
const FRAME: &str = "local";

/// The flight as an MCAP file.
///
/// # Errors
/// No flight causes one; only errors of the library.
pub fn bytes(flight: &Flight) -> io::Result<Vec<u8>> {
    log(flight).map_err(|error| io::Error::other(error.to_string()))
}

fn log(flight: &Flight) -> Result<Vec<u8>, McapError> {
    let options = WriteOptions::new()
        .compression(None)
        .library(concat!("fga ", env!("CARGO_PKG_VERSION")));
    let mut log = McapLog {
        writer: Writer::with_options(Cursor::new(Vec::new()), options)?,
        channels: BTreeMap::new(),
        sequence: 0,
        flight,
    };
    let frame = flight.frame();
    let mut events = flight.events.iter().peekable();
    let mut scene_s = f64::NEG_INFINITY;
    for sample in flight.thinned(STEP_S) {
        while let Some(event) = events.next_if(|event| event.time_s <= sample.time_s) {
            log.event(event)?;
        }
        let time_s = sample.time_s;
        log.write("/aircraft/state", STATE, time_s, &state(sample))?;
        let stamp = log.stamp(time_s);
        let pose = json!({
            "timestamp": stamp,
            "frame_id": FRAME,
            "pose": pose(sample.position_m, sample.attitude(|axis| axis)),
        });
        log.write("/aircraft/pose", POSE_IN_FRAME, time_s, &pose)?;
        if flight.origin.is_some() {
            let place = frame.to_geodetic(sample.position_m);
            let fix = json!({
                "timestamp": stamp,
                "frame_id": FRAME,
                "latitude": place.latitude_deg,
                "longitude": place.longitude_deg,
                "altitude": place.altitude_m,
                "position_covariance": vec![0.0; 9],
                "position_covariance_type": 0,
            });
            log.write("/aircraft/location", LOCATION_FIX, time_s, &fix)?;
        }
        log.write(
            "/separations",
            SEPARATIONS,
            time_s,
            &separations(flight, sample),
        )?;
        if time_s - scene_s >= SCENE_STEP_S * (1.0 - 1e-9) {
            let first = scene_s == f64::NEG_INFINITY;
            let scene = scene(flight, sample, first, &stamp);
            log.write("/scene", SCENE_UPDATE, time_s, &scene)?;
            scene_s = time_s;
        }
    }
    for event in events {
        log.event(event)?;
    }
    log.writer.finish()?;
    Ok(log.writer.into_inner().into_inner())
}

struct McapLog<'a> {
    writer: Writer<Cursor<Vec<u8>>>,
    channels: BTreeMap<&'static str, u16>,
    sequence: u32,
    flight: &'a Flight,
}

impl McapLog<'_> {
    /// Nanoseconds since 1970; 0 for times before.
    fn nanoseconds(&self, time_s: f64) -> u64 {
        let microseconds = libm::rint(self.flight.unix_s(time_s) * 1e6).clamp(0.0, 1e16);
        count(microseconds) as u64 * 1000
    }

    fn stamp(&self, time_s: f64) -> Value {
        let nanoseconds = self.nanoseconds(time_s);
        json!({ "sec": nanoseconds / 1_000_000_000, "nsec": nanoseconds % 1_000_000_000 })
    }

    fn event(&mut self, event: &FlightEvent) -> Result<(), McapError> {
        let message = json!({
            "time_s": event.time_s,
            "kind": event.kind,
            "text": event.text,
            "detail": event.detail,
        });
        self.write("/events", EVENT, event.time_s, &message)
    }

    fn write(
        &mut self,
        topic: &'static str,
        (schema, definition): (&str, &str),
        time_s: f64,
        message: &Value,
    ) -> Result<(), McapError> {
        let channel_id = if let Some(id) = self.channels.get(topic) {
            *id
        } else {
            let schema = self
                .writer
                .add_schema(schema, "jsonschema", definition.as_bytes())?;
            let id = self
                .writer
                .add_channel(schema, topic, "json", &BTreeMap::new())?;
            self.channels.insert(topic, id);
            id
        };
        self.sequence = self.sequence.wrapping_add(1);
        let nanoseconds = self.nanoseconds(time_s);
        let header = MessageHeader {
            channel_id,
            sequence: self.sequence,
            log_time: nanoseconds,
            publish_time: nanoseconds,
        };
        self.writer
            .write_to_known_channel(&header, message.to_string().as_bytes())
    }
}

fn state(sample: &FlightSample) -> Value {
    json!({
        "time_s": sample.time_s,
        "state": sample.state,
        "x_m": sample.position_m.x,
        "y_m": sample.position_m.y,
        "z_m": sample.position_m.z,
        "course_rad": sample.course_rad,
        "climb_rad": sample.climb_rad,
        "bank_rad": sample.bank_rad,
        "compass_deg": sample.compass_deg(),
        "above_ground_m": sample.above_ground_m(),
    })
}

fn separations(flight: &Flight, sample: &FlightSample) -> Value {
    let mut least_margin_m = f64::INFINITY;
    let obstacles: Vec<Value> = flight
        .obstacles
        .iter()
        .filter_map(|obstacle| {
            let offset_m = sample.position_m - obstacle.position_at(sample.time_s)?;
            let margin_m = obstacle.volume.margin_m(offset_m);
            least_margin_m = least_margin_m.min(margin_m);
            Some(json!({
                "name": obstacle.name,
                "separation_m": offset_m.length(),
                "margin_m": margin_m,
            }))
        })
        .collect();
    json!({
        "time_s": sample.time_s,
        "least_margin_m": least_margin_m.is_finite().then_some(least_margin_m),
        "obstacles": obstacles,
    })
}

fn point(position_m: Vec3) -> Value {
    json!({ "x": position_m.x, "y": position_m.y, "z": position_m.z })
}

fn pose(position_m: Vec3, [x, y, z, w]: [f64; 4]) -> Value {
    json!({
        "position": point(position_m),
        "orientation": { "x": x, "y": y, "z": z, "w": w },
    })
}

fn rgba([red, green, blue]: [u8; 3], alpha: f64) -> Value {
    let part = |value: u8| f64::from(value) / 255.0;
    json!({ "r": part(red), "g": part(green), "b": part(blue), "a": alpha })
}

/// The entities to draw: everything at first, then the aircraft and moving obstacles.
fn scene(flight: &Flight, sample: &FlightSample, first: bool, stamp: &Value) -> Value {
    let mut entities = vec![entity(
        "aircraft",
        stamp,
        "cubes",
        json!([{
            "pose": pose(sample.position_m, sample.attitude(|axis| axis)),
            "size": { "x": 4.0, "y": 6.0, "z": 1.0 },
            "color": rgba(state_color(&sample.state), 1.0),
        }]),
    )];
    if first && !flight.mission.is_empty() {
        let points: Vec<Value> = flight.mission.iter().copied().map(point).collect();
        let lines = json!([{
            "type": 0,
            "pose": pose(Vec3::ZERO, [0.0, 0.0, 0.0, 1.0]),
            "thickness": 2.0,
            "scale_invariant": true,
            "points": points,
            "color": rgba(MISSION_COLOR, 1.0),
            "colors": [],
            "indices": [],
        }]);
        entities.push(entity("mission", stamp, "lines", lines));
    }
    let mut deletions = Vec::new();
    for (index, obstacle) in flight.obstacles.iter().enumerate() {
        if !first && obstacle.is_static() {
            continue;
        }
        let id = format!("obstacle/{index}");
        match obstacle.position_at(sample.time_s) {
            Some(position_m) => {
                let (kind, shape) = volume(obstacle, position_m);
                let mut drawn = entity(&id, stamp, kind, json!([shape]));
                let metadata = json!([{ "key": "name", "value": obstacle.name }]);
                if let Some(drawn) = drawn.as_object_mut() {
                    drawn.insert("metadata".into(), metadata);
                }
                entities.push(drawn);
            }
            None if !first => {
                deletions.push(json!({ "timestamp": stamp, "type": 0, "id": id }));
            }
            None => {}
        }
    }
    json!({ "deletions": deletions, "entities": entities })
}

fn volume(obstacle: &FlightObstacle, position_m: Vec3) -> (&'static str, Value) {
    let pose = pose(position_m, [0.0, 0.0, 0.0, 1.0]);
    let color = rgba(OBSTACLE_COLOR, 0.4);
    let width = 2.0 * obstacle.volume.radius_m();
    let height = 2.0 * obstacle.volume.half_height_m();
    let size = json!({ "x": width, "y": width, "z": height });
    match obstacle.volume {
        ProtectedVolume::Sphere { .. } => (
            "spheres",
            json!({ "pose": pose, "size": size, "color": color }),
        ),
        ProtectedVolume::Cylinder { .. } => (
            "cylinders",
            json!({
                "pose": pose,
                "size": size,
                "bottom_scale": 1.0,
                "top_scale": 1.0,
                "color": color,
            }),
        ),
    }
}

/// A scene entity with one kind of primitive; the other lists are empty.
fn entity(id: &str, stamp: &Value, kind: &str, primitives: Value) -> Value {
    let mut entity = json!({
        "timestamp": stamp,
        "frame_id": FRAME,
        "id": id,
        "lifetime": { "sec": 0, "nsec": 0 },
        "frame_locked": false,
        "metadata": [],
        "arrows": [], "cubes": [], "spheres": [], "cylinders": [],
        "lines": [], "triangles": [], "texts": [], "models": [],
    });
    if let Some(entity) = entity.as_object_mut() {
        entity.insert(kind.into(), primitives);
    }
    entity
}

const STATE: (&str, &str) = (
    "fga.State",
    r#"{"title":"fga.State","type":"object","properties":{"time_s":{"type":"number"},"state":{"type":"string"},"x_m":{"type":"number","description":"east"},"y_m":{"type":"number","description":"north"},"z_m":{"type":"number","description":"up"},"course_rad":{"type":"number","description":"from east towards north"},"climb_rad":{"type":"number"},"bank_rad":{"type":"number","description":"positive in a left turn"},"compass_deg":{"type":"number"},"above_ground_m":{"type":["number","null"],"description":"null where the ground is not known"}}}"#,
);
const SEPARATIONS: (&str, &str) = (
    "fga.Separations",
    r#"{"title":"fga.Separations","type":"object","properties":{"time_s":{"type":"number"},"least_margin_m":{"type":["number","null"],"description":"distance to the nearest protected volume, negative inside"},"obstacles":{"type":"array","items":{"type":"object","properties":{"name":{"type":"string"},"separation_m":{"type":"number"},"margin_m":{"type":"number"}}}}}}"#,
);
const EVENT: (&str, &str) = (
    "fga.Event",
    r#"{"title":"fga.Event","type":"object","properties":{"time_s":{"type":"number"},"kind":{"type":"string"},"text":{"type":"string"},"detail":{}}}"#,
);
// The programs know the schemas of this name; the definitions cover the fields written here.
const POSE_IN_FRAME: (&str, &str) = (
    "foxglove.PoseInFrame",
    r#"{"title":"foxglove.PoseInFrame","type":"object","properties":{"timestamp":{"type":"object","title":"time","properties":{"sec":{"type":"integer","minimum":0},"nsec":{"type":"integer","minimum":0,"maximum":999999999}}},"frame_id":{"type":"string"},"pose":{"type":"object","title":"foxglove.Pose","properties":{"position":{"type":"object","title":"foxglove.Vector3","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"}}},"orientation":{"type":"object","title":"foxglove.Quaternion","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"},"w":{"type":"number"}}}}}}}"#,
);
const LOCATION_FIX: (&str, &str) = (
    "foxglove.LocationFix",
    r#"{"title":"foxglove.LocationFix","type":"object","properties":{"timestamp":{"type":"object","title":"time","properties":{"sec":{"type":"integer","minimum":0},"nsec":{"type":"integer","minimum":0,"maximum":999999999}}},"frame_id":{"type":"string"},"latitude":{"type":"number"},"longitude":{"type":"number"},"altitude":{"type":"number"},"position_covariance":{"type":"array","items":{"type":"number"},"minItems":9,"maxItems":9},"position_covariance_type":{"type":"integer"}}}"#,
);
const SCENE_UPDATE: (&str, &str) = (
    "foxglove.SceneUpdate",
    include_str!("scene_update.schema.json"),
);
