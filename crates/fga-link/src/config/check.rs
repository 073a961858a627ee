//! Reading and checking a configuration.

use fga_formats::error::toml_sentence;

use super::{Config, ConfigError, LimitsConfig};
use crate::number::RangeCheck;

/// Checks keys by their names, each with its least and its largest value; an absent key is in any range.
macro_rules! ranges {
    ($checked:ident { $($table:ident.$key:ident: $low:expr, $high:expr;)* }) => {
        $($checked.within(
            concat!(stringify!($table), ".", stringify!($key)), $table.$key, $low, $high,
        );)*
    };
}

/// The fault of a file that is no configuration, with its line.
fn in_one_sentence(error: &toml::de::Error, text: &str) -> ConfigError {
    let message = error.message();
    let limit = ["floor_m", "ceiling_m"]
        .into_iter()
        .find(|key| message.starts_with(&format!("unknown field `{key}`")));
    let message = match limit {
        Some(key) => format!("{key} is out of place, expected limits.{key}"),
        None => toml_sentence(message),
    };
    ConfigError(match error.span() {
        Some(span) => {
            let before = text.get(..span.start).unwrap_or_default();
            format!("line {}: {message}", 1 + before.matches('\n').count())
        }
        None => message,
    })
}

impl Config {
    /// Reads and checks a configuration.
    ///
    /// # Errors
    /// The fault, with the key and the expected value.
    pub fn parse(text: &str) -> Result<Self, ConfigError> {
        let mut config: Self =
            toml::from_str(text).map_err(|error| in_one_sentence(&error, text))?;
        config.move_limits()?;
        config.check()?;
        Ok(config)
    }

    /// Takes limits of altitude from their former place.
    fn move_limits(&mut self) -> Result<(), ConfigError> {
        let former = (self.safety.floor_m, self.safety.ceiling_m);
        if former == (None, None) {
            return Ok(());
        }
        if self.limits != LimitsConfig::default() {
            let message =
                "safety.floor_m and safety.ceiling_m stand beside limits, expected limits alone";
            return Err(ConfigError(message.to_owned()));
        }
        self.limits = LimitsConfig {
            floor_m: former.0.unwrap_or(self.limits.floor_m),
            ceiling_m: former.1,
        };
        Ok(())
    }

    /// Checks ranges.
    ///
    /// # Errors
    /// The first key out of range.
    pub fn check(&self) -> Result<(), ConfigError> {
        let Self {
            vehicle,
            protection,
            volumes,
            command,
            limits,
            terrain,
            safety,
            response,
            traffic,
            alerts,
            ..
        } = self;
        let mut checked = RangeCheck::default();
        let lowest_ceiling_m = limits.floor_m + 1.0;
        ranges!(checked {
            vehicle.max_bank_deg: 10.0, 70.0;
            vehicle.max_bank_in_need_deg: 10.0, 70.0;
            vehicle.max_climb_deg: 0.0, 45.0;
            protection.margin_m: 0.0, 1000.0;
            protection.confidence_sigmas: 0.0, 10.0;
            protection.horizon_s: 5.0, 300.0;
            protection.radius_m: 1.0, 5000.0;
            protection.half_height_m: 1.0, 5000.0;
            protection.surveillance_m: 50.0, 50_000.0;
            protection.safety_score: 0.0, 1.0;
            command.rate_hz: 2.0, 50.0;
            command.decision_period_s: 0.02, 1.0;
            limits.floor_m: 0.0, 10_000.0;
            limits.ceiling_m: lowest_ceiling_m, 20_000.0;
            terrain.clearance_m: 0.0, 10_000.0;
            safety.telemetry_stale_s: 0.3, 5.0;
            safety.link_lost_s: 1.5, 30.0;
            safety.follow_tolerance_deg: 5.0, 60.0;
            safety.follow_time_s: 1.0, 30.0;
            response.turn_rate_factor: 0.2, 1.2;
            response.bank_time_constant_s: 0.0, 5.0;
            response.dead_time_s: 0.0, 3.0;
            traffic.drop_after_s: 2.0, 120.0;
            traffic.position_sigma_m: 0.0, 1000.0;
        });
        let (act_at, most) = (alerts.act_at_level, alerts.levels.most());
        checked.within("alerts.act_at_level", f64::from(act_at), 0.0, most.into());
        for (name, volume) in volumes.each() {
            let mut within = |key: &str, value: f64| {
                checked.within(&format!("volumes.{name}.{key}"), value, 1.0, 5000.0);
            };
            within("radius_m", volume.radius_m);
            within("half_height_m", volume.half_height_m);
        }
        for sensor in &traffic.sensor {
            let sigma_m = sensor.position_sigma_m;
            checked.within("traffic.sensor.position_sigma_m", sigma_m, 0.0, 1000.0);
        }
        for obstacle in &self.obstacle {
            ranges!(checked {
                obstacle.latitude_deg: -90.0, 90.0;
                obstacle.longitude_deg: -360.0, 360.0;
                obstacle.altitude_m: -1000.0, 100_000.0;
                obstacle.radius_m: 0.1, 50_000.0;
                obstacle.track_deg: -360.0, 360.0;
                obstacle.speed_mps: 0.0, 1000.0;
                obstacle.climb_mps: -200.0, 200.0;
                obstacle.half_height_m: 0.1, 50_000.0;
            });
        }
        checked.finish().map_err(ConfigError)?;
        self.check_across()?;
        self.check_terrain()?;
        self.own_icao()?;
        self.signing_key()?;
        self.take_over()?;
        Ok(())
    }

    /// The vehicle's ICAO address.
    ///
    /// # Errors
    /// A text that is not up to six hexadecimal digits.
    pub fn own_icao(&self) -> Result<Option<u32>, ConfigError> {
        let Some(text) = &self.traffic.own_icao else {
            return Ok(None);
        };
        u32::from_str_radix(text, 16)
            .ok()
            .filter(|address| *address <= 0x00FF_FFFF)
            .map(Some)
            .ok_or_else(|| {
                ConfigError(format!(
                    "traffic.own_icao is '{text}', expected up to six hexadecimal digits"
                ))
            })
    }

    /// The key of signing.
    ///
    /// # Errors
    /// A text that is not 64 hexadecimal digits.
    pub fn signing_key(&self) -> Result<Option<[u8; 32]>, ConfigError> {
        let Some(text) = &self.link.signing_key else {
            return Ok(None);
        };
        let error = || ConfigError("link.signing_key: expected 64 hexadecimal digits".to_owned());
        let digits: Option<Vec<u8>> = text
            .chars()
            .map(|c| c.to_digit(16).and_then(|d| u8::try_from(d).ok()))
            .collect();
        let digits = digits
            .filter(|digits| digits.len() == 64)
            .ok_or_else(error)?;
        let mut key = [0; 32];
        for (byte, pair) in key.iter_mut().zip(digits.chunks_exact(2)) {
            *byte = pair.iter().fold(0, |value, digit| value * 16 + digit);
        }
        Ok(Some(key))
    }

    /// The modes that may be taken over.
    ///
    /// # Errors
    /// A name that is no mode, or a mode that the companion cannot take over.
    pub fn take_over(&self) -> Result<Vec<crate::mode::Mode>, ConfigError> {
        self.vehicle
            .take_over
            .iter()
            .map(|name| {
                crate::mode::Mode::from_name(name).filter(|mode| mode.can_be_taken_over()).ok_or_else(|| {
                    ConfigError(format!(
                        "vehicle.take_over: '{name}' cannot be taken over, expected AUTO, CRUISE, FBWB or RTL"
                    ))
                })
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::*;

    #[test]
    fn an_empty_file_is_valid() {
        assert_eq!(Config::parse("").unwrap(), Config::default());
    }

    #[test]
    fn wrong_keys_and_ranges_are_named() {
        let error = |text: &str| Config::parse(text).unwrap_err().0;
        assert!(error("[safety]\nflor_m = 3").contains("flor_m"));
        assert_eq!(
            error("[vehicle]\nceiling_m = 120"),
            "line 2: ceiling_m is out of place, expected limits.ceiling_m"
        );
        assert!(error("[safety]\nfloor_m = 9.0\n[limits]\nfloor_m = 8.0").contains("limits alone"));
        assert!(error("[vehicle]\nmax_bank_deg = 90.0").contains("vehicle.max_bank_deg is 90"));
        assert!(error("[vehicle]\ntake_over = [\"GUIDED\"]").contains("GUIDED"));
        assert!(error("[traffic]\nown_icao = \"xyz\"").contains("own_icao"));
        assert!(error("[link]\nsigning_key = \"00\"").contains("64"));
        assert!(error("[response]\ndead_time_s = nan").contains("dead_time_s"));
        let both = error("[command]\nmode = \"paper\"\npolicy = \"belief\"");
        assert!(both.contains("command.policy"), "{both}");
    }

    #[test]
    fn worst_cases_are_the_default_and_have_their_former_name() {
        let [default, former, named] = ["", "policy = \"turn-aware\"", "policy = \"worst-case\""]
            .map(|line| {
                Config::parse(&format!("[command]\n{line}"))
                    .unwrap()
                    .command
                    .policy
            });
        assert_eq!([default, former, named], [PolicyName::WorstCase; 3]);
    }

    /// Files of earlier versions have them in `[safety]`.
    #[test]
    fn limits_of_altitude_count_in_their_former_place_with_a_warning() {
        let config = Config::parse("[safety]\nfloor_m = 45.0\nceiling_m = 120.0").unwrap();
        let limits = LimitsConfig {
            floor_m: 45.0,
            ceiling_m: Some(120.0),
        };
        assert_eq!(config.limits, limits);
        assert!(
            config
                .warnings()
                .iter()
                .any(|words| words.contains("limits.floor_m"))
        );
        let config = Config::parse("[limits]\nfloor_m = 45.0\nceiling_m = 120.0").unwrap();
        assert_eq!(config.limits, limits);
        assert!(
            !config
                .warnings()
                .iter()
                .any(|words| words.contains("limits"))
        );
    }

    #[test]
    fn obstacles_and_keys_are_read() {
        let key = "0f".repeat(32);
        let text = format!(
            "[link]\nsigning_key = \"{key}\"\n[[obstacle]]\nlatitude_deg = 37.6\nlongitude_deg = -122.4\naltitude_m = 100.0\nradius_m = 150.0\n"
        );
        let config = Config::parse(&text).unwrap();
        assert_eq!(config.obstacle.len(), 1);
        assert_eq!(config.signing_key().unwrap(), Some([0x0F; 32]));
    }
}
