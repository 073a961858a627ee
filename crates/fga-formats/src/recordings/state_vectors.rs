//! State vectors in JSON: of recordings, of readsb, and of the OpenSky network.
//!
//! Which documents, names and units there are: `docs/recorded-encounters.md`. Units are ft, kt and ft/min; OpenSky's are m and m/s.
//!
//! A file may hold several documents one after the other, or a list of them. Times are seconds or milliseconds since
//! 1970.

use std::path::Path;

use alloc::collections::BTreeMap;
use serde_json::{Map, Value, json};

use super::received::{Collector, Heard, Received, Who};
use crate::error::{InputError, shown};
use crate::geodesy::{Geodetic, velocity_from_compass};
use crate::number::finite;
use crate::tally::{LeftOut, Tally};
use crate::traffic::address_of;
use crate::units::{FOOT_M, FOOT_PER_MINUTE_MPS, KNOT_MPS};

/// A position that was older when the list was written is too old, seconds.
const OLDEST_S: f64 = 60.0;

/// A state vector as a document gives it, in SI units.
struct StateVector<'a> {
    name: &'a str,
    address: Option<u32>,
    callsign: Option<&'a str>,
    time_s: Option<f64>,
    /// Seconds before the document's time; 0 if it does not say.
    age_s: f64,
    place_deg: Option<[f64; 2]>,
    altitude_m: Option<f64>,
    is_by_pressure: bool,
    speed_mps: Option<f64>,
    track_deg: Option<f64>,
    climb_mps: Option<f64>,
    on_ground: bool,
}

impl StateVector<'_> {
    fn heard(&self) -> Result<Heard, LeftOut> {
        if self.on_ground {
            return Err(LeftOut::OnGround);
        }
        let [latitude_deg, longitude_deg] = self.place_deg.ok_or(LeftOut::NoPosition)?;
        let altitude_m = self.altitude_m.ok_or(LeftOut::NoAltitude)?;
        let time_s = self.time_s.ok_or(LeftOut::NoTime)?;
        if self.age_s > OLDEST_S {
            return Err(LeftOut::TooOld);
        }
        let place = Geodetic::new(latitude_deg, longitude_deg, altitude_m)
            .ok_or(LeftOut::UnreadableField)?;
        let velocity_mps = self
            .speed_mps
            .zip(self.track_deg)
            .map(|(speed_mps, track_deg)| {
                velocity_from_compass(track_deg, speed_mps, self.climb_mps.unwrap_or(0.0))
            });
        Ok(Heard {
            time_s: time_s - self.age_s,
            place,
            velocity_mps,
        })
    }
}

/// The tracks of the state vectors in a text.
///
/// # Errors
/// Text that is no JSON, or JSON of something else.
pub(super) fn parse(text: &str, path: &Path) -> Result<Received, InputError> {
    let mut reader = StateVectorReader::new(path);
    for document in serde_json::Deserializer::from_str(text).into_iter::<Value>() {
        let document =
            document.map_err(|error| InputError::json(path, "JSON that can be read", &error))?;
        reader.document(&document)?;
    }
    Ok(reader.collector.finish(reader.tally))
}

/// Whether a text is a table of OpenSky's history, by its columns.
pub(super) fn is_history(text: &str) -> bool {
    let head = text.lines().next().unwrap_or_default().to_ascii_lowercase();
    let columns: Vec<&str> = head
        .split([',', ';', '\t'])
        .map(|name| name.trim().trim_matches('"'))
        .collect();
    ["time", "icao24", "lat", "lon", "velocity"]
        .iter()
        .all(|name| columns.contains(name))
}

/// The tracks of a table of OpenSky's history: metres, metres per second, seconds since 1970.
///
/// # Errors
/// A table that is none.
pub(super) fn parse_history(text: &str, path: &Path) -> Result<Received, InputError> {
    let mut reader = StateVectorReader::new(path);
    let separator = text.bytes().find(|byte| b",;\t".contains(byte));
    let mut table = csv::ReaderBuilder::new()
        .delimiter(separator.unwrap_or(b','))
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let wrong = |error| InputError::csv(path, "table that can be read", &error);
    let columns = table.headers().map_err(wrong)?.clone();
    for row in table.records() {
        reader.history(&columns, &row.map_err(wrong)?);
    }
    Ok(reader.collector.finish(reader.tally))
}

struct StateVectorReader<'a> {
    path: &'a Path,
    collector: Collector,
    tally: Tally,
}

impl<'a> StateVectorReader<'a> {
    fn new(path: &'a Path) -> Self {
        Self {
            path,
            collector: Collector::default(),
            tally: Tally::default(),
        }
    }

    fn document(&mut self, document: &Value) -> Result<(), InputError> {
        let path = self.path;
        let wrong = |message: &str| Err(InputError::in_file(path, message));
        match document {
            Value::Array(rows) => rows.iter().try_for_each(|row| match row.as_object() {
                Some(object) if self.list(object) => Ok(()),
                _ => self.row(row),
            }),
            Value::Object(object) if self.list(object) => Ok(()),
            Value::Object(object) => match rows_of(object) {
                Some(rows) => rows.iter().try_for_each(|row| self.row(row)),
                None => wrong(
                    "is a JSON object of something else, expected areas (GeoJSON, ED-269, ED-318), a mission (.plan), or state vectors: a list of them, columns of them, aircraft of readsb or states of OpenSky",
                ),
            },
            _ => wrong("is no list, expected a list of state vectors"),
        }
    }

    /// Takes a document of readsb or OpenSky; `false` for another object.
    fn list(&mut self, object: &Map<String, Value>) -> bool {
        let list = |key: &str, is_row: fn(&Value) -> bool| {
            let list = object.get(key).and_then(Value::as_array);
            list.filter(|list| list.iter().all(is_row))
        };
        let time_s = |key: &str| seconds(object.get(key));
        let aircraft = list("aircraft", Value::is_object);
        let name = object.get("icao").and_then(name_of);
        let trace = list("trace", |_| true);
        if let Some(aircraft) = aircraft.or_else(|| list("ac", Value::is_object)) {
            for row in aircraft {
                self.aircraft(row, time_s("now"));
            }
        } else if let Some(states) = list("states", Value::is_array) {
            for row in states {
                self.opensky(row, time_s("time"));
            }
        } else if let (Some(name), Some(begin_s), Some(rows)) = (name, time_s("timestamp"), trace) {
            for row in rows {
                self.trace(name, begin_s, row);
            }
        } else {
            // OpenSky writes null for a missing value.
            return object.contains_key("time") && object.get("states") == Some(&Value::Null);
        }
        true
    }

    /// An object of a list, or of columns. Other objects than state vectors are errors.
    fn row(&mut self, row: &Value) -> Result<(), InputError> {
        let index = self.tally.read();
        let wrong = |message: String| {
            let message = format!("state vector {index} {message}");
            Err(InputError::in_file(self.path, message))
        };
        let words = |key: &str| row.get(key).and_then(Value::as_str);
        let keys = ["flight_id", "icao24", "callsign"];
        let names = || keys.iter().filter_map(|key| words(key)).map(str::trim);
        let Some(name) = names().find(|name| !name.is_empty()) else {
            if keys.iter().any(|key| row.get(key).is_some()) {
                self.tally.leave_out(LeftOut::NoAddress);
                return Ok(());
            }
            return wrong("has no icao24, callsign or flight_id, expected one".into());
        };
        let time_s = seconds(row.get("timestamp"));
        if time_s.is_none() {
            let found = row
                .get("timestamp")
                .map_or_else(|| "none".into(), |value| shown(&value.to_string()));
            return wrong(format!(
                "has the timestamp {found}, expected milliseconds or seconds since 1970"
            ));
        }
        let number = |key: &str| number(row.get(key));
        if let Some((latitude, longitude)) = number("latitude").zip(number("longitude"))
            && Geodetic::new(latitude, longitude, 0.0).is_none()
        {
            return wrong(format!(
                "is at {latitude}, {longitude}, expected a place on the earth"
            ));
        }
        self.object(row, name, time_s);
        Ok(())
    }

    /// An object of readsb's `aircraft.json`.
    fn aircraft(&mut self, row: &Value, now_s: Option<f64>) {
        match row.get("hex").and_then(name_of) {
            Some(name) => self.object(row, name, now_s),
            None => self.tally.leave_out(LeftOut::NoAddress),
        }
    }

    /// An object by the names of readsb, of dump1090-mutability and receivers of 978 MHz, and of recordings.
    fn object(&mut self, row: &Value, name: &str, time_s: Option<f64>) {
        let first = |keys: &[&str]| keys.iter().find_map(|key| number(row.get(key)));
        let text = |keys: &[&str]| keys.iter().find_map(|key| row.get(key)?.as_str());
        let place_deg = first(&["lat", "latitude"]).zip(first(&["lon", "longitude"]));
        let pressure_ft = first(&["alt_baro", "altitude"]);
        let altitude_ft = pressure_ft.or_else(|| first(&["alt_geom", "geoaltitude"]));
        let climb_fpm = first(&["baro_rate", "vert_rate", "vertical_rate", "geom_rate"]);
        let grounded = ["alt_baro", "altitude"].map(|key| row.get(key).and_then(Value::as_str));
        self.take(&StateVector {
            name,
            address: text(&["icao24", "hex"]).and_then(|text| address_of(text.trim())),
            callsign: text(&["callsign", "flight"]),
            time_s,
            age_s: first(&["seen_pos", "seen"]).unwrap_or(0.0).max(0.0),
            place_deg: place_deg.map(<[f64; 2]>::from),
            altitude_m: altitude_ft.map(|feet| feet * FOOT_M),
            is_by_pressure: pressure_ft.is_some(),
            speed_mps: first(&["gs", "speed", "groundspeed"]).map(|knots| knots * KNOT_MPS),
            track_deg: first(&["track"]),
            climb_mps: climb_fpm.map(|fpm| fpm * FOOT_PER_MINUTE_MPS),
            on_ground: grounded.contains(&Some("ground"))
                || ["onground", "on_ground"]
                    .iter()
                    .any(|key| is_true(row.get(key))),
        });
    }

    /// A list of OpenSky's `states`.
    fn opensky(&mut self, row: &Value, now_s: Option<f64>) {
        let field = |index: usize| row.get(index);
        let number = |index: usize| number(field(index));
        let Some(name) = field(0).and_then(name_of) else {
            return self.tally.leave_out(LeftOut::NoAddress);
        };
        let time_s = seconds(field(3));
        let age_s = now_s.zip(time_s).map(|(now_s, time_s)| now_s - time_s);
        self.take(&StateVector {
            name,
            address: address_of(name),
            callsign: field(1).and_then(Value::as_str),
            time_s: now_s.or(time_s),
            age_s: age_s.unwrap_or(0.0).max(0.0),
            place_deg: number(6).zip(number(5)).map(<[f64; 2]>::from),
            altitude_m: number(7).or_else(|| number(13)),
            is_by_pressure: number(7).is_some(),
            speed_mps: number(9),
            track_deg: number(10),
            climb_mps: number(11),
            on_ground: is_true(field(8)),
        });
    }

    /// A row of a trace of readsb: seconds since it began, place, altitude, speed, track, flags, climb rate, details, kind, altitude and
    /// climb rate above the ellipsoid.
    fn trace(&mut self, name: &str, begin_s: f64, row: &Value) {
        /// Flags of a row: its climb rate and its altitude are above the ellipsoid.
        const GEOMETRIC_RATE: u64 = 4;
        const GEOMETRIC: u64 = 8;
        let field = |index: usize| row.get(index).unwrap_or(&Value::Null);
        let flags = field(6).as_u64().unwrap_or(0);
        let is_geometric = |flag| flags & flag != 0;
        let is_rate = is_geometric(GEOMETRIC_RATE) && field(11).is_number();
        let pick = |is_second: bool, one: usize, other: usize| {
            let index = if is_second { other } else { one };
            field(index).clone()
        };
        let is_altitude = is_geometric(GEOMETRIC) && field(3).is_number();
        let state = json!({
            "hex": name,
            "flight": field(8).get("flight"),
            "lat": field(1),
            "lon": field(2),
            "alt_baro": if is_altitude { &Value::Null } else { field(3) },
            "alt_geom": pick(is_altitude, 10, 3),
            "gs": field(4),
            "track": field(5),
            "baro_rate": pick(is_rate, 7, 11),
            "geom_rate": field(11),
        });
        let time_s = number(Some(field(0))).map(|after_s| begin_s + after_s);
        self.aircraft(&state, time_s);
    }

    /// A row of OpenSky's history, a table of texts, as a row of its `states`.
    fn history(&mut self, columns: &csv::StringRecord, row: &csv::StringRecord) {
        let field = |name: &str| {
            let index = columns
                .iter()
                .position(|column| column.eq_ignore_ascii_case(name))?;
            let known = |text: &&str| {
                !["", "null", "nan", "none"].contains(&text.to_ascii_lowercase().as_str())
            };
            row.get(index).map(str::trim).filter(known)
        };
        let numbers = [
            "time",
            "lastposupdate",
            "lon",
            "lat",
            "baroaltitude",
            "velocity",
            "heading",
            "vertrate",
            "geoaltitude",
        ];
        let read = numbers.map(|name| field(name).map(finite));
        if field("icao24").is_some() && read.contains(&Some(None)) {
            return self.tally.leave_out(LeftOut::UnreadableField);
        }
        let [time_s, heard, lon, lat, low, speed, track, climb, high] = read.map(Option::flatten);
        let on_ground =
            field("onground").is_some_and(|text| text.eq_ignore_ascii_case("true") || text == "1");
        let (name, callsign) = (field("icao24"), field("callsign"));
        let state = json!([
            name, callsign, null, heard, null, lon, lat, low, on_ground, speed, track, climb, null,
            high
        ]);
        self.opensky(&state, seconds(Some(&json!(time_s))));
    }

    fn take(&mut self, state: &StateVector<'_>) {
        let heard = state.heard();
        self.tally.take(&heard);
        if let Ok(heard) = heard {
            let who = Who {
                name: state.name.trim(),
                address: state.address,
                callsign: state.callsign,
                is_by_pressure: state.is_by_pressure,
            };
            self.collector.push(who, heard);
        }
    }
}

/// A name that is not empty.
fn name_of(value: &Value) -> Option<&str> {
    value
        .as_str()
        .map(str::trim)
        .filter(|name| !name.is_empty())
}

fn number(value: Option<&Value>) -> Option<f64> {
    value?.as_f64().filter(|number| number.is_finite())
}

/// True, or 1 as tables write it.
fn is_true(value: Option<&Value>) -> bool {
    value.is_some_and(|value| value.as_bool() == Some(true) || value.as_f64() == Some(1.0))
}

/// A time since 1970, seconds: milliseconds where it is large. Finer units are refused, not guessed.
fn seconds(value: Option<&Value>) -> Option<f64> {
    let value = number(value).filter(|value| value.abs() <= 1e14)?;
    Some(if value.abs() > 1e11 {
        value / 1e3
    } else {
        value
    })
}

/// Rows of columns, each a list or an object by row number.
fn rows_of(columns: &Map<String, Value>) -> Option<Vec<Value>> {
    let mut rows: BTreeMap<usize, Map<String, Value>> = BTreeMap::new();
    for (name, column) in columns {
        let mut put = |index: usize, value: &Value| {
            rows.entry(index)
                .or_default()
                .insert(name.clone(), value.clone());
        };
        match column {
            Value::Array(values) => values.iter().enumerate().for_each(|(i, v)| put(i, v)),
            Value::Object(values) => {
                for (index, value) in values {
                    put(index.parse().ok()?, value);
                }
            }
            _ => return None,
        }
    }
    Some(rows.into_values().map(Value::Object).collect())
}
