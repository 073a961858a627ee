//! KML for Google Earth: the flight with time and its height above the ground, the protected volumes, the zones, the events.
//!
//! The aircraft and moving obstacles are tracks with time (`gx:Track`); a second copy of the flown
//! track has the colours of the states. A volume at rest is one surface; a moving one is a series of
//! surfaces, each with its time span.

use super::look::{GROUND_COLOR, MISSION_COLOR, OBSTACLE_COLOR, ZONE_COLOR, pieces, state_color};
use super::shapes::{curtain, line, surface, wall, zone_surface};
use super::text::{escaped, iso};
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
    for [ground, path] in curtain(flight) {
        out.named("Placemark", "Height above the ground", |out| {
            out.style("ground");
            out.polygons(wall(&ground, &path));
        });
    }
    let moving = flight.obstacles.iter().filter(|o| !o.is_static()).count();
    let volumes = (VOLUMES_ALL / moving.max(1)).clamp(1, VOLUMES_EACH);
    out.named("Folder", "Obstacles", |out| {
        for obstacle in &flight.obstacles {
            out.obstacle(flight, obstacle, volumes);
        }
    });
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

/// A colour behind its opacity: blue, green, red.
fn kml_color([red, green, blue]: [u8; 3]) -> String {
    format!("{blue:02x}{green:02x}{red:02x}")
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

    /// An element with a name and what `fill` writes.
    fn named(&mut self, tag: &str, name: &str, fill: impl FnOnce(&mut Self)) {
        let _ = write!(self.text, "<{tag}>");
        self.element("name", name);
        fill(self);
        let _ = writeln!(self.text, "</{tag}>");
    }

    fn style(&mut self, style: &str) {
        let _ = write!(self.text, "<styleUrl>#{}</styleUrl>", escaped(style));
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
        let lines = states.map(|state| (state, state_color(state), "ff", 3));
        for (id, color, alpha, width) in
            lines
                .into_iter()
                .chain([("mission", MISSION_COLOR, "b0", 2)])
        {
            let color = kml_color(color);
            let _ = writeln!(
                self.text,
                "<Style id=\"{id}\"><LineStyle><color>{alpha}{color}</color>\
                 <width>{width}</width></LineStyle></Style>"
            );
        }
        for (id, color) in [
            ("volume", OBSTACLE_COLOR),
            ("zone", ZONE_COLOR),
            ("ground", GROUND_COLOR),
        ] {
            let color = kml_color(color);
            let _ = writeln!(
                self.text,
                "<Style id=\"{id}\"><LineStyle><color>60{color}</color>\
                 <width>1</width></LineStyle><PolyStyle><color>50{color}\
                 </color></PolyStyle></Style>"
            );
        }
    }

    /// Positions with time; perhaps with headings.
    fn track(
        &mut self,
        flight: &Flight,
        rows: impl Iterator<Item = (f64, Vec3)> + Clone,
        headings_deg: impl Iterator<Item = f64>,
    ) {
        self.text.push_str("<gx:Track>");
        self.altitude_mode();
        for (time_s, _) in rows.clone() {
            let when = iso(flight.unix_s(time_s));
            let _ = write!(self.text, "<when>{when}</when>");
        }
        for (_, position_m) in rows {
            self.text.push_str("<gx:coord>");
            self.push_place(position_m, ' ');
            self.text.push_str("</gx:coord>");
        }
        for heading_deg in headings_deg {
            let heading = crate::number::fixed(heading_deg, 2);
            let _ = write!(self.text, "<gx:angles>{heading} 0 0</gx:angles>");
        }
        self.text.push_str("</gx:Track>");
    }

    fn aircraft(&mut self, flight: &Flight) {
        let samples = flight.thinned(STEP_S);
        let rows = samples
            .iter()
            .map(|sample| (sample.time_s, sample.position_m));
        let headings_deg = samples.iter().map(|sample| sample.compass_deg());
        self.named("Placemark", "Aircraft", |out| {
            out.track(flight, rows, headings_deg);
        });
        self.named("Folder", "Flown track by state", |out| {
            for (state, piece) in pieces(flight, STEP_S) {
                out.named("Placemark", state, |out| {
                    let known = state_color(state) != state_color("");
                    out.style(if known { state } else { "other" });
                    out.line(piece.iter().map(|sample: &&FlightSample| sample.position_m));
                });
            }
        });
    }

    fn line(&mut self, positions: impl Iterator<Item = Vec3>) {
        self.text.push_str("<LineString>");
        self.altitude_mode();
        self.coordinates(line(positions));
        self.text.push_str("</LineString>");
    }

    fn mission(&mut self, flight: &Flight) {
        if flight.mission.is_empty() {
            return;
        }
        self.named("Placemark", "Mission", |out| {
            out.style("mission");
            out.line(flight.mission.iter().copied());
        });
    }

    fn volume(&mut self, obstacle: &FlightObstacle, position_m: Vec3, span: Option<(f64, f64)>) {
        let name = format!("{}: protected volume", obstacle.name);
        self.named("Placemark", &name, |out| {
            if let Some((from_s, to_s)) = span {
                let (begin, end) = (iso(from_s), iso(to_s));
                let _ = write!(
                    out.text,
                    "<TimeSpan><begin>{begin}</begin><end>{end}</end></TimeSpan>"
                );
            }
            out.style("volume");
            let bands = if span.is_some() { 4 } else { 12 };
            out.polygons(surface(position_m, obstacle.volume, bands));
        });
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
        self.named("Folder", "Zones", |out| {
            for zone in &flight.zones {
                out.named("Placemark", &zone.name, |out| {
                    out.element("description", zone.kind());
                    out.style("zone");
                    out.polygons(zone_surface(flight, zone));
                });
            }
        });
    }

    fn obstacle(&mut self, flight: &Flight, obstacle: &FlightObstacle, volumes: usize) {
        self.named("Folder", &obstacle.name, |out| {
            if let ([only], true) = (&obstacle.track[..], obstacle.is_static()) {
                return out.volume(obstacle, only.position_m, None);
            }
            let rows = obstacle
                .track
                .iter()
                .map(|row| (row.time_s, row.position_m));
            out.named("Placemark", &obstacle.name, |out| {
                out.track(flight, rows, core::iter::empty());
            });
            // The volume at a series of times within the flight.
            let (flown_from_s, flown_to_s) = flight.span_s();
            let (Some(first), Some(last)) = (obstacle.track.first(), obstacle.track.last()) else {
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
                    out.volume(obstacle, position_m, Some(span));
                }
                // A step that no longer advances the time ends the series.
                begin_s = if end_s > begin_s { end_s } else { to_s };
            }
        });
    }

    fn events(&mut self, flight: &Flight) {
        self.named("Folder", "Events", |out| {
            for (event, position_m) in flight.placed_events() {
                out.named("Placemark", &event.kind, |out| {
                    out.element("description", &event.text);
                    let when = iso(flight.unix_s(event.time_s));
                    let _ = write!(
                        out.text,
                        "<TimeStamp><when>{when}</when></TimeStamp><Point>"
                    );
                    out.altitude_mode();
                    out.coordinates([position_m]);
                    out.text.push_str("</Point>");
                });
            }
        });
    }
}
