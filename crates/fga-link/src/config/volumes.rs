//! The room of other aircraft, and how far to look for them.

use fga::situation::ProtectedVolume;
use fga::vehicle::{Response, Vehicle};
use fga_files::surveillance::{self, CREWED_MPS, Evasion};

use super::{CommandMode, Config, ConfigError, NMAC, PolicyName, VolumesConfig};
use crate::traffic::class::{AircraftClass, Volumes, volume_of};

/// Airspeed that warnings assume before the vehicle reports its airspeed, metres per second: ArduPlane's cruise.
const CRUISE_MPS: f64 = 22.0;
/// Change of the climb angle that warnings are judged at, radians per second.
const CLIMB_RATE_RADPS: f64 = 0.2;
/// Time between two reports of ADS-B, seconds.
const REPORT_PERIOD_S: f64 = 1.0;

impl Config {
    /// Keys that are usable one by one and not together.
    pub(super) fn check_across(&self) -> Result<(), ConfigError> {
        let protection = &self.protection;
        if let (None, Some(half_height_m)) = (protection.radius_m, protection.half_height_m) {
            return Err(ConfigError(format!(
                "protection.half_height_m is {half_height_m} without protection.radius_m, expected both, or [volumes]"
            )));
        }
        if protection.radius_m.is_some() && self.volumes != VolumesConfig::default() {
            return Err(ConfigError(
                "protection.radius_m and [volumes] are given, expected one of them".to_owned(),
            ));
        }
        if (self.command.mode, self.command.policy) == (CommandMode::Paper, PolicyName::Belief) {
            return Err(ConfigError(
                "command.policy is 'belief' beside command.mode 'paper', expected one of them"
                    .to_owned(),
            ));
        }
        let Some(surveillance_m) = protection.surveillance_m else {
            return Ok(());
        };
        let radii_m = self.volumes.each().map(|(_, volume)| volume.radius_m);
        let widest_m = protection
            .radius_m
            .unwrap_or(radii_m.into_iter().fold(0.0, f64::max));
        if surveillance_m <= widest_m {
            return Err(ConfigError(format!(
                "protection.surveillance_m is {surveillance_m}, expected more than the protected radius, {widest_m}"
            )));
        }
        Ok(())
    }

    /// The protected volume about an aircraft of a class.
    pub fn volume(&self, class: AircraftClass) -> ProtectedVolume {
        let protection = &self.protection;
        if let Some(radius_m) = protection.radius_m {
            return volume_of(radius_m, protection.half_height_m);
        }
        let volume = match class {
            AircraftClass::Crewed => self.volumes.crewed,
            AircraftClass::SmallUnmanned => self.volumes.small_unmanned,
            AircraftClass::GliderBalloon => self.volumes.glider_balloon,
        };
        volume_of(volume.radius_m, Some(volume.half_height_m))
    }

    /// The distance beyond which obstacles are not considered at an airspeed, metres.
    pub fn surveillance_m(&self, airspeed_mps: f64) -> f64 {
        let protection = &self.protection;
        protection.surveillance_m.unwrap_or_else(|| {
            let volume = self.volume(AircraftClass::Crewed);
            surveillance::derived_m(
                airspeed_mps,
                protection.horizon_s,
                volume,
                protection.margin_m,
            )
        })
    }

    /// Warnings about a usable configuration, one sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.safety.floor_m.or(self.safety.ceiling_m).is_some() {
            let words = "floor_m and ceiling_m of [safety] count as limits.floor_m and limits.ceiling_m, their new place";
            warnings.push(words.to_owned());
        }
        if self.command.mode == CommandMode::Paper && self.safety.use_fence {
            let words = "Algorithm 4 (command.mode \"paper\") knows no fence: safety.use_fence has no effect";
            warnings.push(words.to_owned());
        }
        if self.command.mode == CommandMode::Paper && self.terrain.clearance_m.is_some() {
            let words =
                "Algorithm 4 (command.mode \"paper\") knows no ground: terrain has no effect";
            warnings.push(words.to_owned());
        }
        if self.command.policy == PolicyName::Belief && self.alerts.act_at_level > 0 {
            let words = "policy belief begins manoeuvres by their cost: alerts.act_at_level has no effect on aircraft";
            warnings.push(words.to_owned());
        }
        let crewed = self.volume(AircraftClass::Crewed);
        if crewed.radius_m() < NMAC.radius_m || crewed.half_height_m() < NMAC.half_height_m {
            warnings.push(format!(
                "crewed aircraft get {} x +-{} m, less than a near mid-air collision with one, {} x +-{} m",
                crewed.radius_m(),
                crewed.half_height_m(),
                NMAC.radius_m,
                NMAC.half_height_m
            ));
        }
        let bank_rad = self.vehicle.max_bank_deg.to_radians();
        let climb_rad = if self.vehicle.vertical {
            self.vehicle.max_climb_deg.to_radians()
        } else {
            0.0
        };
        let evasion = Vehicle::from_bank(CRUISE_MPS, bank_rad).map(|vehicle| Evasion {
            vehicle: Vehicle {
                response: Response {
                    dead_time_s: self.response.dead_time_s,
                    bank_time_constant_s: self.response.bank_time_constant_s,
                    turn_rate_factor: self.response.turn_rate_factor,
                },
                ..vehicle.with_climb(-climb_rad, climb_rad, CLIMB_RATE_RADPS)
            },
            late_s: self.command.decision_period_s + REPORT_PERIOD_S,
            volume: crewed,
            margin_m: self.protection.margin_m,
        });
        let seen = ("protection.surveillance_m", self.surveillance_m(CRUISE_MPS));
        let closing_mps = CRUISE_MPS + CREWED_MPS;
        let whom = format!("crewed traffic at {CREWED_MPS} m/s");
        let horizon_s = self.protection.horizon_s;
        warnings.extend(
            evasion
                .into_iter()
                .filter_map(|evasion| evasion.shortfall(seen, horizon_s, closing_mps, &whom)),
        );
        warnings
    }
}

impl Volumes {
    /// Those of a configuration.
    pub fn new(config: &Config) -> Self {
        let classes = [
            AircraftClass::Crewed,
            AircraftClass::SmallUnmanned,
            AircraftClass::GliderBalloon,
        ];
        let [crewed, small_unmanned, glider_balloon] = classes.map(|class| config.volume(class));
        Self {
            crewed,
            small_unmanned,
            glider_balloon,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paper_mode_says_that_it_knows_no_fence() {
        let mut config = Config::default();
        let says = |config: &Config| {
            config
                .warnings()
                .iter()
                .any(|words| words.contains("no fence"))
        };
        assert!(!says(&config));
        config.command.mode = CommandMode::Paper;
        assert!(says(&config));
        config.safety.use_fence = false;
        assert!(!says(&config));
    }

    #[test]
    fn n2_every_class_has_a_volume_and_the_unknown_one_is_crewed() {
        use mavlink::dialects::ardupilotmega::AdsbEmitterType as Emitter;
        let config = Config::default();
        let room = |emitter| {
            let volume = config.volume(AircraftClass::of(emitter));
            (volume.radius_m(), volume.half_height_m())
        };
        for crewed in [
            Emitter::ADSB_EMITTER_TYPE_NO_INFO,
            Emitter::ADSB_EMITTER_TYPE_LIGHT,
            Emitter::ADSB_EMITTER_TYPE_UNASSIGNED,
            Emitter::ADSB_EMITTER_TYPE_ULTRA_LIGHT,
        ] {
            assert_eq!(room(crewed), (152.4, 30.48), "{crewed:?}");
        }
        assert_eq!(room(Emitter::ADSB_EMITTER_TYPE_UAV), (60.96, 18.288));
        for tall in [
            Emitter::ADSB_EMITTER_TYPE_GLIDER,
            Emitter::ADSB_EMITTER_TYPE_LIGHTER_AIR,
        ] {
            assert_eq!(room(tall), (152.4, 60.96));
        }
        assert!(config.warnings().is_empty());
        let text = "[volumes]\nsmall_unmanned = { radius_m = 100.0, half_height_m = 40.0 }\n";
        let volume = Config::parse(text)
            .unwrap()
            .volume(AircraftClass::SmallUnmanned);
        assert_eq!((volume.radius_m(), volume.half_height_m()), (100.0, 40.0));
        let small = Config::parse("[protection]\nradius_m = 60.0\n").unwrap();
        assert!(small.warnings()[0].contains("less than a near mid-air collision"));
    }

    #[test]
    fn l12_keys_are_checked_across() {
        let error = |text: &str| Config::parse(text).unwrap_err().0;
        assert_eq!(
            error("[protection]\nsurveillance_m = 50.0\nradius_m = 60.0"),
            "protection.surveillance_m is 50, expected more than the protected radius, 60"
        );
        assert!(error("[protection]\nsurveillance_m = 150.0").contains("radius, 152.4"));
        assert!(
            error("[protection]\nhalf_height_m = 30.0").contains("without protection.radius_m")
        );
        let both = "[protection]\nradius_m = 60.0\n[volumes.crewed]\nradius_m = 200.0\nhalf_height_m = 50.0";
        assert!(error(both).contains("expected one of them"));
        let near = Config::parse("[protection]\nsurveillance_m = 500.0").unwrap();
        assert!(near.warnings()[0].starts_with("protection.surveillance_m is 500 m, too near"));
        let short = Config::parse("[protection]\nhorizon_s = 5.0").unwrap();
        assert!(
            short.warnings()[0].contains("horizon_s is 5, too short"),
            "{:?}",
            short.warnings()
        );
    }
}
