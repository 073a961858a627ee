//! The geographical zones of ED-269.

use serde::Deserialize;
use serde_json::{Map, Value};

use super::area::{EdgeLine, NamedArea};
use super::taken::Areas;
use crate::error::InputError;

/// A file.
#[derive(Debug, Deserialize)]
#[serde(expecting = "an object with features")]
struct Ed269File {
    #[serde(alias = "UASZoneList")]
    features: Vec<Ed269Zone>,
}

/// A geographical zone.
#[derive(Debug, Deserialize)]
#[serde(expecting = "a zone")]
struct Ed269Zone {
    identifier: Option<String>,
    name: Option<String>,
    restriction: Option<String>,
    #[serde(default)]
    applicability: Value,
    geometry: Vec<AreaVolume>,
}

/// A volume of one.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", expecting = "an airspace volume")]
struct AreaVolume {
    uom_dimensions: String,
    horizontal_projection: Projection,
    #[serde(flatten)]
    limits: Map<String, Value>,
}

#[derive(Debug, Deserialize)]
#[serde(tag = "type", expecting = "a Polygon or a Circle")]
enum Projection {
    Circle { center: Vec<f64>, radius: f64 },
    Polygon { coordinates: Vec<Vec<Vec<f64>>> },
}

impl Areas<'_> {
    /// Zones of a file, which some authorities write as a list alone.
    pub(super) fn take_ed269(&mut self, text: &str) -> Result<(), InputError> {
        let zones = if text.trim_start().starts_with('[') {
            self.json::<Vec<Ed269Zone>>(text, "ED-269")?
        } else {
            self.json::<Ed269File>(text, "ED-269")?.features
        };
        for zone in zones {
            let names = [zone.name, zone.identifier].into_iter();
            self.like = NamedArea {
                name: names.flatten().find_map(|name| Self::name(&name)),
                is_free: zone.restriction.as_deref() == Some("NO_RESTRICTION"),
                is_timed: is_timed(&zone.applicability),
                edges: EdgeLine::Geodesic,
                ..NamedArea::default()
            };
            if zone.geometry.is_empty() {
                return self.refuse("is a zone without a place, expected a geometry");
            }
            for volume in zone.geometry {
                let unit_m = self.unit_m(&volume.uom_dimensions)?;
                self.like.limits = [None; 2];
                self.take_limits(&volume.limits, Some(unit_m));
                match volume.horizontal_projection {
                    // All dimensions are in the unit of the volume.
                    Projection::Circle { center, radius } => {
                        self.take_circle(&center, radius * unit_m)?;
                    }
                    Projection::Polygon { coordinates } => self.take(&coordinates)?,
                }
            }
        }
        Ok(())
    }
}

/// Whether one of some periods is not permanent.
pub(super) fn is_timed(periods: &Value) -> bool {
    match periods {
        Value::Array(periods) => periods.iter().any(is_timed),
        Value::Object(period) => {
            let permanent = period.get("permanent").and_then(Value::as_str);
            !permanent.is_some_and(|word| word.eq_ignore_ascii_case("YES"))
        }
        _ => false,
    }
}
