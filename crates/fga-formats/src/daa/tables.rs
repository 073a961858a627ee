//! Alerts and bands as tables, in the layout of DAIDALUS, so that `diff` compares them.

use super::instants::{EarthPlace, Instants, Place};
use super::scene::{DaaScene, Seen, Wind};
use crate::conf::{Configuration, ShownUnit};
use crate::number::trimmed;
use crate::units::NAUTICAL_MILE_M;
use core::fmt::Write as _;
use fga_alerts::{
    LastTime, Loss, ManeuverSide, Monitor, Pair, PairDeviation, Quantity, Recovery, Region,
    Resolution, TerminalGuidance,
};

/// Decimals of every number.
const DECIMALS: usize = 6;

/// The regions in the order of the tables.
const REGIONS: [Region; 3] = [Region::Far, Region::Mid, Region::Near];

fn text(value: f64) -> String {
    trimmed(value, DECIMALS)
}

/// A value in SI units with its unit.
fn with_unit(value_si: f64, unit: &ShownUnit) -> String {
    format!("{} [{}]", in_unit(value_si, unit), unit.symbol)
}

fn in_unit(value_si: f64, unit: &ShownUnit) -> String {
    text(unit.of_si(value_si))
}

fn seconds(value_s: f64) -> String {
    format!("{} [s]", text(value_s))
}

/// Writes alerts and bands of every instant at which the ownship has a row.
///
/// `show` receives the monitor after each step and the scene of that step.
///
/// # Errors
/// A time or state that is not finite, as one sentence.
pub fn watch(
    recording: &Instants,
    configuration: &Configuration,
    mut show: impl FnMut(&mut Monitor, &DaaScene),
) -> Result<(), String> {
    let mut monitor = Monitor::new(configuration.settings.clone());
    let mut wind = Wind::default();
    let area = &configuration.settings.terminal;
    let terminal =
        (area.guidance != TerminalGuidance::Off).then_some(Place::Geodetic(EarthPlace {
            latitude_rad: area.latitude_rad,
            longitude_rad: area.longitude_rad,
            altitude_m: 0.0,
        }));
    for instant in &recording.instants {
        let Some(scene) = DaaScene::of(instant, &mut wind, terminal) else {
            continue;
        };
        monitor
            .step(
                scene.time_s,
                &scene.ownship_aircraft(),
                &scene.traffic_aircraft(),
            )
            .map_err(|error| format!("at {} s: {error}", scene.time_s))?;
        show(&mut monitor, &scene);
    }
    Ok(())
}

/// The input of both tables.
#[derive(Debug, Clone, Copy)]
pub struct DaaTables<'a> {
    /// The recording.
    pub recording: &'a Instants,
    /// The configuration.
    pub configuration: &'a Configuration,
}

impl DaaTables<'_> {
    fn name(&self, aircraft: usize) -> &str {
        self.recording
            .names
            .get(aircraft)
            .map_or("", String::as_str)
    }

    /// The names of aircraft of the traffic in braces.
    fn braced(&self, scene: &DaaScene, places: impl Iterator<Item = usize>) -> String {
        let names: Vec<&str> = places
            .filter_map(|place| scene.traffic.get(place))
            .map(|seen| self.name(seen.aircraft))
            .collect();
        format!("{{{}}}", names.join(", "))
    }

    /// Distance of the well-clear volume whose modified tau the table shows: the volume of the first
    /// alerter's corrective level.
    fn tau_distance_m(&self) -> Option<f64> {
        let settings = &self.configuration.settings;
        let level = settings.corrective_level(0)?;
        let volume = &settings.alerters.first()?.level(level)?.volume;
        volume.well_clear().map(|volume| volume.distance_m)
    }

    fn shows_terminal(&self) -> bool {
        self.configuration.settings.terminal.guidance != TerminalGuidance::Off
    }

    /// The two head lines of `alerts.csv`.
    pub fn alerts_head(&self) -> String {
        let units = &self.configuration.units;
        let mut names = String::from(" Time, Ownship, Traffic, Alerter, Alert Level");
        let mut symbols = String::from("[s],,,,");
        if self.shows_terminal() {
            names.push_str(", DTA Active, DTA Guidance, Distance to DTA");
            symbols.push_str(",,, [nmi]");
        }
        for level in 1..=self.configuration.settings.most_levels() {
            let _ = write!(names, ", Time to Volume of Alert({level})");
            symbols.push_str(", [s]");
        }
        names.push_str(
            ", Horizontal Separation, Vertical Separation, Horizontal Closure Rate, Vertical Closure Rate, \
             Projected HMD, Projected VMD, Projected TCPA, Projected DCPA, Projected TCOA",
        );
        let (far, high) = (
            &units.horizontal_distance.symbol,
            &units.vertical_distance.symbol,
        );
        let (fast, climb) = (&units.horizontal_speed.symbol, &units.vertical_speed.symbol);
        let _ = write!(
            symbols,
            ", [{far}], [{high}], [{fast}], [{climb}], [{far}], [{high}], [s], [{far}], [s]"
        );
        if self.tau_distance_m().is_some() {
            names.push_str(", Projected TAUMOD (WCV*)");
            symbols.push_str(", [s]");
        }
        format!("{names}\n{symbols}\n")
    }

    /// Appends the rows of `alerts.csv` for a time: one for each aircraft with an alerter.
    pub fn alerts_rows(&self, monitor: &Monitor, scene: &DaaScene, out: &mut String) {
        for (index, (seen, alert)) in scene.traffic.iter().zip(monitor.alerts()).enumerate() {
            let Some(alerter) = alert.alerter else {
                continue;
            };
            let _ = write!(
                out,
                "{}, {}, {}, {}, {}",
                text(scene.time_s),
                self.name(scene.ownship.aircraft),
                self.name(seen.aircraft),
                alerter + 1,
                shown_level(alert.level)
            );
            self.terminal_fields(monitor, scene, seen, out);
            for level in 1..=self.configuration.settings.most_levels() {
                let time = monitor.violation(index, level);
                let time = time.map_or_else(String::new, |loss| text(loss.entry_s));
                let _ = write!(out, ", {time}");
            }
            self.approach_fields(scene, index, out);
            out.push('\n');
        }
    }

    fn terminal_fields(&self, monitor: &Monitor, scene: &DaaScene, seen: &Seen, out: &mut String) {
        if !self.shows_terminal() {
            return;
        }
        let settings = &self.configuration.settings;
        let (is_inside, is_guided) = monitor.terminal();
        let guidance = match settings.terminal.guidance {
            TerminalGuidance::Departing if is_guided => "Departing",
            TerminalGuidance::Landing if is_guided => "Landing",
            _ => "",
        };
        let measured = if settings.ownship_centric {
            &scene.ownship
        } else {
            seen
        };
        let area = &settings.terminal;
        let distance = if area.radius_m == 0.0 && area.height_m == 0.0 {
            String::new()
        } else {
            scene
                .terminal_distance_m(measured)
                .map_or_else(String::new, |distance_m| text(distance_m / NAUTICAL_MILE_M))
        };
        let _ = write!(out, ", {is_inside}, {guidance}, {distance}");
    }

    /// The approach of two aircraft.
    fn approach_fields(&self, scene: &DaaScene, index: usize, out: &mut String) {
        use fga_alerts::FutureStates as _;
        let pair = Pair {
            ownship: scene.ownship(0.0),
            intruder: scene.intruder(index, 0.0),
            deviation: PairDeviation::default(),
        };
        let units = &self.configuration.units;
        let within_s = self.configuration.settings.lookahead_s;
        let far = &units.horizontal_distance;
        let high = &units.vertical_distance;
        let distance_at_closest = pair.distance_at_closest_m().unwrap_or(f64::NAN);
        let _ = write!(
            out,
            ", {}, {}, {}, {}, {}, {}, {}, {}, ",
            in_unit(pair.horizontal_separation_m(), far),
            in_unit(pair.vertical_separation_m(), high),
            in_unit(
                pair.horizontal_relative_speed_mps(),
                &units.horizontal_speed
            ),
            in_unit(pair.vertical_relative_speed_mps(), &units.vertical_speed),
            in_unit(pair.horizontal_miss_m(within_s), far),
            in_unit(pair.vertical_miss_m(within_s), high),
            text(pair.time_to_closest_s().unwrap_or(f64::NAN)),
            in_unit(distance_at_closest, far),
        );
        let coaltitude = pair.time_to_coaltitude_s().filter(|time_s| *time_s >= 0.0);
        out.push_str(&coaltitude.map_or_else(String::new, text));
        out.push_str(", ");
        let tau = self
            .tau_distance_m()
            .and_then(|distance_m| pair.modified_tau_s(distance_m));
        out.push_str(&tau.map_or_else(String::new, text));
    }

    /// The first line of `bands.out`.
    pub fn bands_head(file: &str) -> String {
        format!("# File: {file}\n")
    }

    /// Appends the part of `bands.out` of a time.
    pub fn bands_text(&self, monitor: &mut Monitor, scene: &DaaScene, out: &mut String) {
        self.states(scene, out);
        self.conflicts(monitor, scene, out);
        for quantity in Quantity::ALL {
            self.bands_of(quantity, monitor, scene, out);
        }
        for (index, seen) in scene.traffic.iter().enumerate() {
            let name = self.name(seen.aircraft);
            let _ = writeln!(out, "Last Times to Maneuver with Respect to {name}");
            for quantity in Quantity::ALL {
                let time = match monitor.last_time(quantity, index, scene) {
                    LastTime::NoConflict => f64::NAN,
                    LastTime::Passed => f64::NEG_INFINITY,
                    LastTime::In(time_s) => time_s,
                };
                let [title, ..] = words(quantity);
                let _ = writeln!(out, "  Last Time to {title} Maneuver: {}", seconds(time));
            }
        }
    }

    /// Time and states.
    fn states(&self, scene: &DaaScene, out: &mut String) {
        let units = &self.configuration.units;
        let _ = writeln!(out, "Time: {}", seconds(scene.time_s));
        let plane = self.plane_unit();
        let (xy, alt) = (&plane.symbol, &units.altitude.symbol);
        let (gs, vs) = (&units.horizontal_speed.symbol, &units.vertical_speed.symbol);
        let (place_names, place_units) = if self.recording.is_geodetic {
            ("lat lon alt", "[deg] [deg]".to_owned())
        } else {
            ("sx sy sz", format!("[{xy}] [{xy}]"))
        };
        let _ = writeln!(
            out,
            "NAME {place_names} trk gs vs heading airspeed time alerter s_EW_std s_NS_std s_EN_std sz_std \
             v_EW_std v_NS_std v_EN_std vz_std"
        );
        let _ = writeln!(
            out,
            "[none] {place_units} [{alt}] [deg] [{gs}] [{vs}] [deg] [{gs}] [s] [none] [{xy}] [{xy}] [{xy}] \
             [{alt}] [{gs}] [{gs}] [{gs}] [{vs}]"
        );
        for seen in core::iter::once(&scene.ownship).chain(&scene.traffic) {
            self.state(seen, scene.time_s, out);
        }
    }

    /// The unit of positions in the plane and of their deviations.
    fn plane_unit(&self) -> ShownUnit {
        let symbol = &self.configuration.units.horizontal_speed.symbol;
        // The reference's table of compatible speeds lacks km/h.
        let is_metric = matches!(symbol.as_str(), "kph" | "km/h" | "kilometer_per_hour");
        if is_metric {
            ShownUnit::new("m", 1.0)
        } else {
            ShownUnit::new("nmi", NAUTICAL_MILE_M)
        }
    }

    fn state(&self, seen: &Seen, time_s: f64, out: &mut String) {
        use crate::units::DEGREE_RAD;
        let units = &self.configuration.units;
        let plane = self.plane_unit();
        let degrees = |angle_rad: f64| text(angle_rad / DEGREE_RAD);
        let (alt, gs, vs) = (
            &units.altitude,
            &units.horizontal_speed,
            &units.vertical_speed,
        );
        let place = match seen.place {
            Place::Geodetic(at) => [
                degrees(at.latitude_rad),
                degrees(at.longitude_rad),
                in_unit(at.altitude_m, alt),
            ],
            Place::Local(p) => [
                in_unit(p.x, &plane),
                in_unit(p.y, &plane),
                in_unit(p.z, alt),
            ],
        };
        let deviation_units = [&plane, &plane, &plane, alt, gs, gs, gs, vs];
        let deviation = seen.deviation.to_array().into_iter().zip(deviation_units);
        let motion = [
            degrees(compass(seen.ground.track_rad)),
            in_unit(seen.ground.speed_mps, gs),
            in_unit(seen.ground.velocity_mps.z, vs),
            degrees(compass(seen.air.track_rad)),
            in_unit(seen.air.speed_mps, gs),
            text(time_s),
            seen.alerter.to_string(),
        ];
        let fields = place.into_iter().chain(motion);
        let fields = fields.chain(deviation.map(|(value, unit)| in_unit(value, unit)));
        let fields: Vec<String> = fields.collect();
        let name = self.name(seen.aircraft);
        let _ = writeln!(out, "{name}, {}", fields.join(", "));
    }

    /// Conflicts and alerts.
    fn conflicts(&self, monitor: &Monitor, scene: &DaaScene, out: &mut String) {
        let settings = &self.configuration.settings;
        let enabled = |is_on: bool| if is_on { "Enabled" } else { "Disabled" };
        let _ = writeln!(
            out,
            "Conflict Criteria: {}\nRecovery Criteria: {}\nMost Urgent Aircraft: _NoAc_\n\
             Horizontal Epsilon: 0\nVertical Epsilon: 0",
            enabled(settings.coordinates_conflicts),
            enabled(settings.coordinates_recovery)
        );
        for region in REGIONS {
            let aircraft = self.braced(scene, monitor.conflicts(region));
            let name = region.name();
            let _ = writeln!(out, "Conflict Bands Aircraft ({name}): {aircraft}");
        }
        for region in REGIONS {
            let (name, times) = (region.name(), interval(monitor.conflict_times(region)));
            let _ = writeln!(out, "Time Interval of Conflict ({name}): {times}");
        }
        for (index, seen) in scene.traffic.iter().enumerate() {
            let alerter = monitor.alerts().get(index).and_then(|alert| alert.alerter);
            let loss = alerter
                .and_then(|alerter| settings.corrective_level(alerter))
                .and_then(|level| monitor.violation(index, level))
                .filter(|loss| loss.is_conflict());
            if let Some(loss) = loss {
                let name = self.name(seen.aircraft);
                let times = interval(loss);
                let _ = writeln!(out, "Time to Corrective Volume with {name}: {times}");
            }
        }
        for (seen, alert) in scene.traffic.iter().zip(monitor.alerts()) {
            let level = shown_level(alert.level);
            let _ = writeln!(out, "Alert Level {level} with {}", self.name(seen.aircraft));
        }
    }

    fn bands_of(&self, quantity: Quantity, monitor: &Monitor, scene: &DaaScene, out: &mut String) {
        let units = &self.configuration.units;
        let [title, high, low] = words(quantity);
        let (unit, value) = match quantity {
            Quantity::Direction => (&units.direction, compass(scene.ownship.air.track_rad)),
            Quantity::HorizontalSpeed => (&units.horizontal_speed, scene.ownship.air.speed_mps),
            Quantity::VerticalSpeed => (&units.vertical_speed, scene.ownship.air.velocity_mps.z),
            Quantity::Altitude => (&units.altitude, scene.ownship.place.altitude_m()),
        };
        let bands = monitor.bands(quantity);
        let _ = writeln!(out, "Ownship {title}: {}", with_unit(value, unit));
        let region = bands.region_at(value).map_or("UNKNOWN", Region::name);
        let _ = writeln!(out, "Region of Current {title}: {region}\n{title} Bands:");
        for band in bands.bands() {
            let (low, high) = (with_unit(band.low, unit), with_unit(band.high, unit));
            let region = band.region.map_or("UNKNOWN", Region::name);
            let _ = writeln!(out, "  [{low}, {high}] {region}");
        }
        for region in REGIONS {
            let aircraft = self.braced(scene, bands.peripheral(region));
            let name = region.name();
            let _ = writeln!(
                out,
                "Peripheral {title} Bands Aircraft ({name}): {aircraft}"
            );
        }
        for (way, side) in [(ManeuverSide::High, high), (ManeuverSide::Low, low)] {
            let value = match (bands.resolution(way), way) {
                (Resolution::Unneeded, _) => f64::NAN,
                (Resolution::Unavailable, ManeuverSide::High) => f64::INFINITY,
                (Resolution::Unavailable, ManeuverSide::Low) => f64::NEG_INFINITY,
                (Resolution::Value(value), _) => value,
            };
            let value = with_unit(value, unit);
            let _ = writeln!(out, "{title} Resolution ({side}): {value}");
        }
        let preferred = match bands.preferred() {
            ManeuverSide::High => high,
            ManeuverSide::Low => low,
        };
        let _ = writeln!(out, "Preferred {title}: {preferred}");
        let recovery = bands.recovery();
        let (time_s, distance_m, height_m) = match recovery {
            Recovery::NotNeeded => [f64::NAN; 3].into(),
            Recovery::Impossible { .. } => [f64::NEG_INFINITY; 3].into(),
            Recovery::Found {
                time_s,
                distance_m,
                height_m,
                ..
            } => (time_s, distance_m, height_m),
        };
        let _ = writeln!(
            out,
            "Recovery Information for {title} Bands:\n  Time to Recovery: {}\n  \
             Recovery Horizontal Distance: {}\n  Recovery Vertical Distance: {}\n  Recovery N Factor: {}",
            seconds(time_s),
            with_unit(distance_m, &units.horizontal_distance),
            with_unit(height_m, &units.vertical_distance),
            recovery.shrinkings()
        );
    }
}

/// The names of a quantity, of its high side and of its low side in tables.
const fn words(quantity: Quantity) -> [&'static str; 3] {
    match quantity {
        Quantity::Direction => ["Horizontal Direction", "right", "left"],
        Quantity::HorizontalSpeed => ["Horizontal Speed", "up", "down"],
        Quantity::VerticalSpeed => ["Vertical Speed", "up", "down"],
        Quantity::Altitude => ["Altitude", "up", "down"],
    }
}

/// A level in a table: −1 without an alerter.
fn shown_level(level: Option<usize>) -> String {
    level.map_or_else(|| "-1".to_owned(), |level| level.to_string())
}

/// An angle in `[0, 2π)`.
fn compass(angle_rad: f64) -> f64 {
    let turn = core::f64::consts::TAU;
    let rest = angle_rad - libm::floor(angle_rad / turn) * turn;
    if (turn - rest).abs() < 1e-11 {
        0.0
    } else {
        rest
    }
}

fn interval(loss: Loss) -> String {
    if loss.entry_s > loss.exit_s {
        return "[]".into();
    }
    format!("[{}, {}]", seconds(loss.entry_s), seconds(loss.exit_s))
}
