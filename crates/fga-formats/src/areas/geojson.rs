//! Areas in GeoJSON, and the geographical zones of ED-318, which is GeoJSON with limits (`layer`) and circles (`extent`).

use serde::Deserialize;
use serde_json::{Map, Value};

use super::area::NamedArea;
use super::ed269::is_timed;
use super::taken::Areas;
use crate::error::InputError;

/// Names of the coordinate system of GeoJSON.
const WGS84: [&str; 3] = ["CRS84", "EPSG:4326", "EPSG::4326"];

/// An object of GeoJSON.
#[derive(Debug, Deserialize)]
#[serde(tag = "type", expecting = "an object of GeoJSON")]
pub(super) enum GeoJson {
    FeatureCollection {
        features: Vec<Self>,
        /// A coordinate system; RFC 7946 has WGS 84 alone, files from before it may name another one.
        crs: Option<Value>,
    },
    Feature {
        geometry: Option<Box<Self>>,
        properties: Option<Map<String, Value>>,
    },
    GeometryCollection {
        geometries: Vec<Self>,
        layer: Option<Map<String, Value>>,
    },
    Point {
        coordinates: Vec<f64>,
        extent: Option<Extent>,
        layer: Option<Map<String, Value>>,
    },
    Polygon {
        coordinates: Vec<Vec<Vec<f64>>>,
        layer: Option<Map<String, Value>>,
    },
    MultiPolygon {
        coordinates: Vec<Vec<Vec<Vec<f64>>>>,
        layer: Option<Map<String, Value>>,
    },
    LineString {},
    MultiLineString {},
    MultiPoint {},
    #[serde(other)]
    Other,
}

/// What makes a circle of a point.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", expecting = "an extent of ED-318")]
pub(super) struct Extent {
    sub_type: String,
    radius: f64,
}

impl Areas<'_> {
    pub(super) fn take_geojson(&mut self, json: GeoJson) -> Result<(), InputError> {
        match json {
            GeoJson::FeatureCollection { features, crs } => {
                if let Some(crs) = crs.map(|crs| crs.to_string())
                    && !WGS84.iter().any(|name| crs.contains(name))
                {
                    let message = format!(
                        "has the coordinate system {crs}, expected WGS 84 (CRS84, EPSG:4326) or none"
                    );
                    return Err(InputError::in_file(self.path, message));
                }
                features
                    .into_iter()
                    .try_for_each(|each| self.take_geojson(each))
            }
            GeoJson::GeometryCollection { geometries, layer } => {
                self.limited(layer);
                let limits = self.like.limits;
                geometries.into_iter().try_for_each(|each| {
                    self.like.limits = limits;
                    self.take_geojson(each)
                })
            }
            GeoJson::Feature {
                geometry,
                properties,
            } => {
                self.described(&properties.unwrap_or_default());
                if let Some(geometry) = geometry {
                    return self.take_geojson(*geometry);
                }
                self.leave_out("feature without a place");
                Ok(())
            }
            GeoJson::Point {
                coordinates,
                extent: Some(extent),
                layer,
            } if extent.sub_type == "Circle" => {
                self.limited(layer);
                self.take_circle(&coordinates, extent.radius)
            }
            GeoJson::Polygon { coordinates, layer } => {
                self.limited(layer);
                self.take(&coordinates)
            }
            GeoJson::MultiPolygon { coordinates, layer } => {
                self.limited(layer);
                coordinates.iter().try_for_each(|rings| self.take(rings))
            }
            GeoJson::Point { extent: Some(_), .. } => self.refuse(
                "is no area, expected Polygon, MultiPolygon, or Point with an extent that is a Circle",
            ),
            other => {
                self.leave_out(match other {
                    GeoJson::Point { .. } => "point",
                    GeoJson::LineString {} | GeoJson::MultiLineString {} => "line",
                    _ => "object of another kind",
                });
                Ok(())
            }
        }
    }

    /// What the properties of a feature say of its areas. ENAIRE keeps those of ED-318 in objects of their own (`UASZone`,
    /// `verticalLayer`).
    fn described(&mut self, properties: &Map<String, Value>) {
        let zone = properties.get("UASZone").and_then(Value::as_object);
        let zone = zone.unwrap_or(properties);
        let text = |key| zone.get(key).and_then(Value::as_str);
        // A list has a text for each language.
        let texts = zone.get("name").and_then(Value::as_array);
        let texts = texts.into_iter().flatten();
        let texts = texts.filter_map(|name| name.get("text")?.as_str());
        let names = text("name")
            .into_iter()
            .chain(texts)
            .chain(text("identifier"));
        let times = properties.get("limitedApplicability");
        let times = times.and_then(Value::as_array);
        let restrictions = [text("type"), text("restriction")];
        self.like = NamedArea {
            name: names.into_iter().find_map(Self::name),
            is_free: restrictions.contains(&Some("NO_RESTRICTION")),
            is_timed: times.is_some_and(|all| !all.is_empty())
                || zone.get("applicability").is_some_and(is_timed),
            ..NamedArea::default()
        };
        self.take_limits(zone, None);
        let layer = properties.get("verticalLayer").and_then(Value::as_object);
        self.limited(layer.cloned());
    }

    /// The limits of a layer, in metres where it does not say its unit.
    fn limited(&mut self, layer: Option<Map<String, Value>>) {
        if let Some(layer) = layer {
            self.take_limits(&layer, Some(1.0));
        }
    }
}
