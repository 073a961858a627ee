//! KML for Google Earth: the flight with time, the protected volumes, the zones, the events.
//!
//! The aircraft and moving obstacles are tracks with time (`gx:Track`); a second copy of the flown
//! track has the colours of the states. A volume at rest is one surface; a moving one is a series of
//! surfaces, each with its time span.

use super::look::{MISSION_COLOR, OBSTACLE_COLOR, ZONE_COLOR, pieces, state_color};
use super::shapes::{surface, zone_surface};
use super::time::iso;
use crate::flight::{Flight, FlightObstacle, FlightSample};
use crate::geodesy::LocalFrame;
use crate::number::push_fixed;
use core::fmt::Write as _;
use fga::Vec3;

/// Least time between samples of the tracks, seconds.
const STEP_S: f64 = 0.1;
/// Most volumes of one moving obstacle, and of all together.
const VOLUMES_EACH: usize = 60;
const VOLUMES_ALL: usize = 600;

/// The flight as a KML document.
pub fn text(flight: &Flight) -> String {
    let mut out = Kml {
        text: String::from(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <kml xmlns=\"http://www.opengis.net/kml/2.2\" \
             xmlns:gx=\"http://www.google.com/kml/ext/2.2\">\n<Document>\n",
        ),
        frame: flight.frame(),
        altitude_mode: if flight.origin.is_some() {
            "absolute"
        } else {
            "relativeToGround"
        },
    };
    out.element("name", &title(flight));
    out.styles();
    out.aircraft(flight);
    out.mission(flight);
    let moving = flight.obstacles.iter().filter(|o| !o.is_static()).count();
    let volumes = (VOLUMES_ALL / moving.max(1)).clamp(1, VOLUMES_EACH);
    out.text.push_str("<Folder><name>Obstacles</name>\n");
    for obstacle in &flight.obstacles {
        out.obstacle(flight, obstacle, volumes);
    }
    out.text.push_str("</Folder>\n");
    out.zones(flight);
    out.events(flight);
    out.text.push_str("</Document>\n</kml>\n");
    out.text
}

fn title(flight: &Flight) -> String {
    if flight.policy.is_empty() {
        flight.name.clone()
    } else {
        format!("{} ({})", flight.name, flight.policy)
    }
}

/// `text` with XML's reserved characters escaped and forbidden ones removed.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&apos;"),
            '\t' | '\n' | '\r' | '\u{20}'..='\u{fffd}' | '\u{10000}'.. => out.push(character),
            _ => {}
        }
    }
    out
}

struct Kml {
    text: String,
    frame: LocalFrame,
    altitude_mode: &'static str,
}

impl Kml {
    fn element(&mut self, tag: &str, content: &str) {
        let _ = writeln!(self.text, "<{tag}>{}</{tag}>", escaped(content));
    }

    fn altitude_mode(&mut self) {
        let mode = self.altitude_mode;
        let _ = write!(self.text, "<altitudeMode>{mode}</altitudeMode>");
    }

    /// Longitude, latitude, altitude of a local position with `separator` between them.
    fn push_place(&mut self, position_m: Vec3, separator: char) {
        let place = self.frame.to_geodetic(position_m);
        let mut bytes = Vec::with_capacity(48);
        push_fixed(&mut bytes, place.longitude_deg, 8);
        bytes.push(separator as u8);
        push_fixed(&mut bytes, place.latitude_deg, 8);
        bytes.push(separator as u8);
        push_fixed(&mut bytes, place.altitude_m, 2);
        self.text.push_str(&String::from_utf8_lossy(&bytes));
    }

    fn coordinates(&mut self, positions: impl IntoIterator<Item = Vec3>) {
        self.text.push_str("<coordinates>");
        for position_m in positions {
            self.push_place(position_m, ',');
            self.text.push(' ');
        }
        self.text.push_str("</coordinates>");
    }

    fn styles(&mut self) {
        let states = ["cruise", "threatened", "avoiding", "recovering", "other"];
        for state in states {
            let [red, green, blue] = state_color(state);
            let _ = writeln!(
                self.text,
                "<Style id=\"{state}\"><LineStyle><color>ff{blue:02x}{green:02x}{red:02x}</color>\
                 <width>3</width></LineStyle></Style>"
            );
        }
        let [red, green, blue] = MISSION_COLOR;
        let _ = writeln!(
            self.text,
            "<Style id=\"mission\"><LineStyle><color>b0{blue:02x}{green:02x}{red:02x}</color>\
             <width>2</width></LineStyle></Style>"
        );
        for (id, [red, green, blue]) in [("volume", OBSTACLE_COLOR), ("zone", ZONE_COLOR)] {
            let _ = writeln!(
                self.text,
                "<Style id=\"{id}\"><LineStyle><color>60{blue:02x}{green:02x}{red:02x}</color>\
                 <width>1</width></LineStyle><PolyStyle><color>50{blue:02x}{green:02x}{red:02x}\
                 </color></PolyStyle></Style>"
            );
        }
    }

    fn aircraft(&mut self, flight: &Flight) {
        self.text.push_str("<Placemark>");
        self.element("name", "Aircraft");
        self.text.push_str("<gx:Track>");
        self.altitude_mode();
        let samples = flight.thinned(STEP_S);
        for sample in &samples {
            let when = iso(flight.unix_s(sample.time_s));
            let _ = write!(self.text, "<when>{when}</when>");
        }
        for sample in &samples {
            self.text.push_str("<gx:coord>");
            self.push_place(sample.position_m, ' ');
            self.text.push_str("</gx:coord>");
        }
        for sample in &samples {
            let heading = crate::number::fixed(sample.compass_deg(), 2);
            let _ = write!(self.text, "<gx:angles>{heading} 0 0</gx:angles>");
        }
        self.text.push_str("</gx:Track></Placemark>\n");

        self.text
            .push_str("<Folder><name>Flown track by state</name>\n");
        for (state, piece) in pieces(flight, STEP_S) {
            self.text.push_str("<Placemark>");
            self.element("name", state);
            let known = state_color(state) != state_color("");
            let style = if known { state } else { "other" };
            let _ = write!(self.text, "<styleUrl>#{}</styleUrl>", escaped(style));
            self.line(piece.iter().map(|sample: &&FlightSample| sample.position_m));
            self.text.push_str("</Placemark>\n");
        }
        self.text.push_str("</Folder>\n");
    }

    /// A line. Readers need two points, so a single point is doubled.
    fn line(&mut self, positions: impl IntoIterator<Item = Vec3>) {
        let mut positions: Vec<Vec3> = positions.into_iter().collect();
        if let [only] = positions[..] {
            positions.push(only);
        }
        self.text.push_str("<LineString>");
        self.altitude_mode();
        self.coordinates(positions);
        self.text.push_str("</LineString>");
    }

    fn mission(&mut self, flight: &Flight) {
        if flight.mission.is_empty() {
            return;
        }
        self.text.push_str("<Placemark>");
        self.element("name", "Mission");
        self.text.push_str("<styleUrl>#mission</styleUrl>");
        self.line(flight.mission.iter().copied());
        self.text.push_str("</Placemark>\n");
    }

    fn volume(&mut self, obstacle: &FlightObstacle, position_m: Vec3, span: Option<(f64, f64)>) {
        self.text.push_str("<Placemark>");
        self.element("name", &format!("{}: protected volume", obstacle.name));
        if let Some((from_s, to_s)) = span {
            let (begin, end) = (iso(from_s), iso(to_s));
            let _ = write!(
                self.text,
                "<TimeSpan><begin>{begin}</begin><end>{end}</end></TimeSpan>"
            );
        }
        self.text.push_str("<styleUrl>#volume</styleUrl>");
        let bands = if span.is_some() { 4 } else { 12 };
        self.polygons(surface(position_m, obstacle.volume, bands));
        self.text.push_str("</Placemark>\n");
    }

    fn polygons(&mut self, polygons: Vec<Vec<Vec3>>) {
        self.text.push_str("<MultiGeometry>");
        for polygon in polygons {
            self.text.push_str("<Polygon>");
            self.altitude_mode();
            self.text.push_str("<outerBoundaryIs><LinearRing>");
            self.coordinates(polygon);
            self.text
                .push_str("</LinearRing></outerBoundaryIs></Polygon>");
        }
        self.text.push_str("</MultiGeometry>");
    }

    fn zones(&mut self, flight: &Flight) {
        if flight.zones.is_empty() {
            return;
        }
        self.text.push_str("<Folder><name>Zones</name>\n");
        for zone in &flight.zones {
            self.text.push_str("<Placemark>");
            self.element("name", &zone.name);
            self.element("description", zone.kind());
            self.text.push_str("<styleUrl>#zone</styleUrl>");
            self.polygons(zone_surface(flight, zone));
            self.text.push_str("</Placemark>\n");
        }
        self.text.push_str("</Folder>\n");
    }

    fn obstacle(&mut self, flight: &Flight, obstacle: &FlightObstacle, volumes: usize) {
        self.text.push_str("<Folder>");
        self.element("name", &obstacle.name);
        if let ([only], true) = (&obstacle.track[..], obstacle.is_static()) {
            self.volume(obstacle, only.position_m, None);
            self.text.push_str("</Folder>\n");
            return;
        }
        self.text.push_str("<Placemark>");
        self.element("name", &obstacle.name);
        self.text.push_str("<gx:Track>");
        self.altitude_mode();
        for row in &obstacle.track {
            let when = iso(flight.unix_s(row.time_s));
            let _ = write!(self.text, "<when>{when}</when>");
        }
        for row in &obstacle.track {
            self.text.push_str("<gx:coord>");
            self.push_place(row.position_m, ' ');
            self.text.push_str("</gx:coord>");
        }
        self.text.push_str("</gx:Track></Placemark>\n");
        // The volume at a series of times within the flight.
        let (flown_from_s, flown_to_s) = flight.span_s();
        let (Some(first), Some(last)) = (obstacle.track.first(), obstacle.track.last()) else {
            self.text.push_str("</Folder>\n");
            return;
        };
        let from_s = first.time_s.max(flown_from_s);
        let to_s = last.time_s.min(flown_to_s);
        let step_s = ((to_s - from_s) / volumes as f64).max(0.5);
        let mut begin_s = from_s;
        while begin_s < to_s {
            let end_s = (begin_s + step_s).min(to_s);
            if let Some(position_m) = obstacle.position_at(f64::midpoint(begin_s, end_s)) {
                let span = (flight.unix_s(begin_s), flight.unix_s(end_s));
                self.volume(obstacle, position_m, Some(span));
            }
            // A step that no longer advances the time ends the series.
            begin_s = if end_s > begin_s { end_s } else { to_s };
        }
        self.text.push_str("</Folder>\n");
    }

    fn events(&mut self, flight: &Flight) {
        self.text.push_str("<Folder><name>Events</name>\n");
        for event in &flight.events {
            let Some(position_m) = flight.position_at(event.time_s) else {
                continue;
            };
            self.text.push_str("<Placemark>");
            self.element("name", &event.kind);
            self.element("description", &event.text);
            let when = iso(flight.unix_s(event.time_s));
            let _ = write!(
                self.text,
                "<TimeStamp><when>{when}</when></TimeStamp><Point>"
            );
            self.altitude_mode();
            self.coordinates([position_m]);
            self.text.push_str("</Point></Placemark>\n");
        }
        self.text.push_str("</Folder>\n");
    }
}
