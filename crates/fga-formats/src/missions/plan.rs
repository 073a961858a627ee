//! Plans of QGroundControl: <https://docs.qgroundcontrol.com/master/en/qgc-dev-guide/file_formats/plan.html>.
//!
//! A plan is of version 1, its mission and rally points of version 2, its fences of version 1 or 2; a part that does not say
//! its version is read as such a one. Surveys, corridor scans and structure scans hold the items that were made of them; a landing pattern of an aeroplane
//! is its approach and a landing.

use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use super::items::{Item, ItemReader};
use super::{MissionFence, MissionFile};
use crate::areas::AreaOutline;
use crate::error::{InputError, json_sentence};
use crate::geodesy::Geodetic;

/// A plan; what else it holds concerns the ground station alone.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Plan {
    file_type: String,
    version: Option<Value>,
    #[serde(default)]
    mission: PlanMission,
    #[serde(default)]
    geo_fence: GeoFence,
    #[serde(default)]
    rally_points: RallyPoints,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
struct PlanMission {
    version: Option<Value>,
    #[serde(default)]
    items: Vec<Value>,
    planned_home_position: Option<Vec<Option<f64>>>,
    cruise_speed: Option<f64>,
}

#[derive(Debug, Default, Deserialize)]
struct GeoFence {
    version: Option<Value>,
    #[serde(default)]
    circles: Vec<Circle>,
    #[serde(default)]
    polygons: Vec<Polygon>,
    /// Version 1: one polygon to stay in.
    #[serde(default)]
    polygon: Vec<[f64; 2]>,
}

#[derive(Debug, Deserialize)]
struct Circle {
    circle: CircleShape,
    inclusion: bool,
}

#[derive(Debug, Deserialize)]
struct CircleShape {
    center: [f64; 2],
    radius: f64,
}

#[derive(Debug, Deserialize)]
struct Polygon {
    polygon: Vec<[f64; 2]>,
    inclusion: bool,
}

#[derive(Debug, Default, Deserialize)]
struct RallyPoints {
    version: Option<Value>,
    #[serde(default)]
    points: Vec<[f64; 3]>,
}

#[derive(Debug, Deserialize)]
struct SimpleItem {
    command: u16,
    frame: u16,
    params: Vec<Option<f64>>,
    /// What the station made its height of: above the terrain, and above the sea over it, metres.
    #[serde(rename = "Altitude")]
    above_m: Option<f64>,
    #[serde(rename = "AltitudeMode")]
    mode: Option<f64>,
    #[serde(rename = "AMSLAltAboveTerrain")]
    sea_m: Option<f64>,
}

/// Heights of one item that are farther apart contradict each other, metres.
const APART_M: f64 = 1.0;
/// The height above the sea that the station computes from its terrain.
const CALCULATED: f64 = 3.0;

/// What a complex item may hold of interest.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct ComplexItem {
    #[serde(rename = "complexItemType")]
    kind: String,
    #[serde(rename = "TransectStyleComplexItem")]
    transects: Option<Transects>,
    #[serde(default)]
    altitudes_are_relative: bool,
    #[serde(alias = "loiterCoordinate")]
    landing_approach_coordinate: Option<[f64; 3]>,
}

#[derive(Debug, Deserialize)]
struct Transects {
    #[serde(rename = "Items")]
    items: Option<Vec<Value>>,
}

pub(super) fn parse(text: &str, path: &Path) -> Result<MissionFile, InputError> {
    let wrong = |error| InputError::json(path, "plan of QGroundControl", &error);
    let plan: Plan = serde_json::from_str(text).map_err(wrong)?;
    if plan.file_type != "Plan" {
        let message = format!(
            "is of type {}, expected a Plan of QGroundControl",
            crate::error::shown(&plan.file_type)
        );
        return Err(InputError::in_file(path, message));
    }
    for (part, found, known) in [
        ("", &plan.version, &[1][..]),
        ("mission.", &plan.mission.version, &[2]),
        ("geoFence.", &plan.geo_fence.version, &[1, 2]),
        ("rallyPoints.", &plan.rally_points.version, &[2]),
    ] {
        if let Some(found) = found
            && !known.iter().any(|known| found == known)
        {
            let known: Vec<String> = known.iter().map(u32::to_string).collect();
            let known = known.join(" or ");
            let message = format!("has {part}version {found}, expected {known}");
            return Err(InputError::in_file(path, message));
        }
    }
    let mut reader = ItemReader::new(path);
    match plan.mission.planned_home_position.as_deref() {
        None => (),
        Some(&[Some(latitude_deg), Some(longitude_deg), altitude_m]) => {
            let home = Geodetic::new(latitude_deg, longitude_deg, altitude_m.unwrap_or(0.0));
            let home = home.ok_or_else(|| InputError::in_file(path, HOME))?;
            reader.file().home = Some(home);
            if altitude_m.is_none() {
                reader.note("home has no altitude: it counts as at sea level");
            }
        }
        Some(_) => return Err(InputError::in_file(path, HOME)),
    }
    let mut count = Counted::default();
    for value in &plan.mission.items {
        take(value, &mut count, &mut reader, true)?;
    }
    // Fences have numbers of their own in messages.
    let mut item = Item::default();
    let circles = plan.geo_fence.circles.into_iter().map(|circle| {
        let outline = AreaOutline::Circle {
            center_deg: circle.circle.center,
            radius_m: circle.circle.radius,
        };
        (outline, circle.inclusion)
    });
    let old = Some(plan.geo_fence.polygon).filter(|corners| !corners.is_empty());
    let polygon = |corners_deg: Vec<[f64; 2]>| AreaOutline::Polygon(vec![corners_deg]);
    let polygons = plan.geo_fence.polygons.into_iter();
    let polygons = polygons.map(|each| (polygon(each.polygon), each.inclusion));
    let old = old.map(|corners_deg| (polygon(corners_deg), true));
    for (outline, keep_in) in circles.chain(polygons).chain(old) {
        item.number += 1;
        reader.add_fence(&item, MissionFence { outline, keep_in })?;
    }
    for [latitude_deg, longitude_deg, above_home_m] in plan.rally_points.points {
        reader.take(&Item {
            command: 5100,
            frame: 3,
            at: [Some(latitude_deg), Some(longitude_deg), Some(above_home_m)],
            ..item
        })?;
    }
    let cruise_mps = plan.mission.cruise_speed;
    reader.file().cruise_mps = cruise_mps.filter(|mps| mps.is_finite() && *mps > 0.0);
    reader.finish()
}

const HOME: &str = "has an unusable plannedHomePosition, expected [latitude, longitude, altitude]";

/// The items taken so far.
#[derive(Debug, Default)]
struct Counted {
    items: u64,
    /// The last number that an item gives itself; jumps name items by it.
    jump_id: Option<u64>,
}

/// Takes an item, and the items within it where `complex` ones may be.
fn take(
    value: &Value,
    count: &mut Counted,
    reader: &mut ItemReader,
    complex: bool,
) -> Result<(), InputError> {
    count.items += 1;
    let item = Item {
        number: count.items,
        ..Item::default()
    };
    if let Some(id) = value.get("doJumpId") {
        let number = id.as_u64();
        if number.is_none() || number <= count.jump_id {
            let before = count.jump_id;
            let after = before.map_or_else(String::new, |before| format!(" after {before}"));
            let message = format!("has doJumpId {id}{after}, expected whole numbers that grow");
            return Err(reader.error(&item, &message));
        }
        count.jump_id = number;
    }
    let unusable = |reader: &ItemReader, error: &serde_json::Error| {
        reader.error(&item, &format!("cannot be read: {}", json_sentence(error)))
    };
    if value.get("type").and_then(Value::as_str) != Some("ComplexItem") {
        let simple = SimpleItem::deserialize(value).map_err(|error| unusable(reader, &error))?;
        let parameter = |index: usize| simple.params.get(index).copied().flatten();
        if simple.frame == 0 && simple.mode == Some(CALCULATED) {
            let above_m = simple.above_m.unwrap_or(f64::NAN);
            match (parameter(6), simple.sea_m) {
                (None, _) => {
                    let message = format!(
                        "is {above_m} m above the terrain, whose height the station did not write, expected its altitude above mean sea level"
                    );
                    return Err(reader.error(&item, &message));
                }
                (Some(flown_m), Some(sea_m)) if (flown_m - sea_m).abs() > APART_M => {
                    reader.note(&format!(
                        "item {} is flown {flown_m} m above the sea (params), though {above_m} m above the terrain are {sea_m} m there (AMSLAltAboveTerrain)",
                        item.number
                    ));
                }
                _ => (),
            }
        }
        return reader.take(&Item {
            command: simple.command,
            frame: simple.frame,
            first_parameter: parameter(0),
            at: [parameter(4), parameter(5), parameter(6)],
            ..item
        });
    }
    let found = ComplexItem::deserialize(value).map_err(|error| unusable(reader, &error))?;
    if let Some(items) = found.transects.and_then(|transects| transects.items)
        && complex
    {
        // Its items have the numbers, as the ground station counts.
        count.items -= 1;
        return items
            .iter()
            .try_for_each(|value| take(value, count, reader, false));
    }
    let Some(approach) = found.landing_approach_coordinate else {
        if value.get("grid").is_some() || value.get("Grid").is_some() {
            let message = "is a survey without its items, as old stations wrote it, expected one that a newer QGroundControl saved again";
            return Err(reader.error(&item, message));
        }
        let message = format!(
            "is a complex item of type {}, expected a survey, a scan or a landing pattern with its items",
            crate::error::shown(&found.kind)
        );
        return Err(reader.error(&item, &message));
    };
    reader.take(&Item {
        command: 31,
        frame: if found.altitudes_are_relative { 3 } else { 0 },
        at: approach.map(Some),
        ..item
    })?;
    reader.take(&Item {
        command: 21,
        ..item
    })
}
