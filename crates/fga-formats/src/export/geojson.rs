//! GeoJSON for maps: the flown track in pieces of one state, the mission, the obstacles' tracks
//! and footprints, the zones, the events.
//!
//! The property `kind` of a feature is `track`, `mission`, `obstacle`, `volume`, `zone` or `event`. The
//! footprint of a moving obstacle is at its position of the least margin.

use super::look::{MISSION_COLOR, OBSTACLE_COLOR, ZONE_COLOR, pieces, state_color};
use super::shapes::{self, circle};
use super::text::iso;
use crate::flight::{Flight, FlightObstacle};
use crate::geodesy::LocalFrame;
use ::geojson::{Feature, FeatureCollection, GeoJson, Geometry, GeometryValue};
use fga::Vec3;
use serde_json::{Map, Value, json};

/// Least time between samples, seconds.
const STEP_S: f64 = 0.1;

/// The flight as a GeoJSON feature collection.
pub fn text(flight: &Flight) -> String {
    let frame = flight.frame();
    let mut features = Vec::new();
    for (state, piece) in pieces(flight, STEP_S) {
        let times: Vec<String> = piece
            .iter()
            .map(|sample| iso(flight.unix_s(sample.time_s)))
            .collect();
        let above_m = piece.iter().map(|sample| sample.above_ground_m());
        let above_m: Vec<Option<f64>> = above_m
            .map(|above_m| Some(libm::rint(1e3 * above_m?) / 1e3))
            .collect();
        let positions = piece.iter().map(|sample| sample.position_m);
        features.push(feature(
            line(&frame, positions),
            json!({
                "kind": "track",
                "state": state,
                "from_s": piece.first().map(|sample| sample.time_s),
                "to_s": piece.last().map(|sample| sample.time_s),
                "coordTimes": times,
                "above_ground_m": above_m.iter().any(Option::is_some).then_some(above_m),
                "stroke": hex(state_color(state)),
            }),
        ));
    }
    if !flight.mission.is_empty() {
        features.push(feature(
            line(&frame, flight.mission.iter().copied()),
            json!({ "kind": "mission", "stroke": hex(MISSION_COLOR) }),
        ));
    }
    for obstacle in &flight.obstacles {
        push_obstacle(&mut features, flight, &frame, obstacle);
    }
    for zone in &flight.zones {
        let altitude_m = |z_m: f64| place(&frame, Vec3::Z * z_m)[2];
        let places = (zone.ring_m.iter()).map(|[x_m, y_m]| {
            let [longitude_deg, latitude_deg, _] = place(&frame, Vec3::new(*x_m, *y_m, 0.0));
            [longitude_deg, latitude_deg]
        });
        let mut ring: Vec<[f64; 2]> = places.collect();
        // The format requires outlines that are anticlockwise.
        let edges = ring.iter().zip(ring.iter().skip(1));
        if edges.map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>() < 0.0 {
            ring.reverse();
        }
        features.push(feature(
            GeometryValue::new_polygon([ring]),
            json!({
                "kind": "zone",
                "name": zone.name,
                "zone": zone.kind(),
                "floor_m": zone.floor_m.map(altitude_m),
                "ceiling_m": zone.ceiling_m.map(altitude_m),
                "stroke": hex(ZONE_COLOR),
            }),
        ));
    }
    for (event, position_m) in flight.placed_events() {
        features.push(feature(
            GeometryValue::new_point(place(&frame, position_m)),
            json!({
                "kind": "event",
                "event": event.kind,
                "time_s": event.time_s,
                "time": iso(flight.unix_s(event.time_s)),
                "text": event.text,
                "detail": event.detail,
            }),
        ));
    }
    let mut foreign = Map::new();
    foreign.insert("name".into(), flight.name.clone().into());
    foreign.insert("policy".into(), flight.policy.clone().into());
    let mut collection = FeatureCollection::new(features);
    collection.foreign_members = Some(foreign);
    GeoJson::FeatureCollection(collection).to_string()
}

fn push_obstacle(
    features: &mut Vec<Feature>,
    flight: &Flight,
    frame: &LocalFrame,
    obstacle: &FlightObstacle,
) {
    let volume = obstacle.volume;
    let common = |kind: &str| {
        json!({
            "kind": kind,
            "name": obstacle.name,
            "radius_m": volume.radius_m(),
            "half_height_m": volume.half_height_m(),
            "stroke": hex(OBSTACLE_COLOR),
        })
    };
    let positions: Vec<Vec3> = obstacle.track.iter().map(|row| row.position_m).collect();
    let geometry = match positions[..] {
        [only] => GeometryValue::new_point(place(frame, only)),
        _ => line(frame, positions.into_iter()),
    };
    features.push(feature(geometry, common("obstacle")));
    let closest = flight
        .samples
        .iter()
        .filter_map(|sample| {
            let position_m = obstacle.position_at(sample.time_s)?;
            let margin_m = volume.margin_m(sample.position_m - position_m);
            Some((margin_m, sample.time_s, position_m))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((margin_m, time_s, position_m)) = closest {
        let ring = circle(position_m, volume.radius_m());
        let ring: Vec<[f64; 3]> = ring.into_iter().map(|p| place(frame, p)).collect();
        let mut properties = common("volume");
        if let Some(properties) = properties.as_object_mut() {
            properties.insert("least_margin_m".into(), margin_m.into());
            properties.insert("time_s".into(), time_s.into());
        }
        features.push(feature(GeometryValue::new_polygon([ring]), properties));
    }
}

fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Longitude and latitude (degrees, to a millimetre) and altitude (metres).
fn place(frame: &LocalFrame, position_m: Vec3) -> [f64; 3] {
    let place = frame.to_geodetic(position_m);
    let round = |value: f64, unit: f64| libm::rint(value / unit) * unit;
    [
        round(place.longitude_deg, 1e-8),
        round(place.latitude_deg, 1e-8),
        round(place.altitude_m, 1e-3),
    ]
}

fn line(frame: &LocalFrame, positions: impl Iterator<Item = Vec3>) -> GeometryValue {
    GeometryValue::new_line_string(shapes::line(positions.map(|p| place(frame, p))))
}

fn feature(geometry: GeometryValue, properties: Value) -> Feature {
    let properties = match properties {
        Value::Object(properties) => Some(properties),
        _ => None,
    };
    Feature {
        geometry: Some(Geometry::new(geometry)),
        properties,
        ..Feature::default()
    }
}
