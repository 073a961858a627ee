//! Asks the oracle about encounters of a batch file.

use fga::Vec3;
use fga::situation::ProtectedVolume;
use fga_formats::encounters::Encounter;
use fga_judge::oracle::{
    OracleObstacle, OracleSettings, OracleStart, OracleVehicle, best_margin_within,
};
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::wind::crab;

use super::airspace::airspace_among;
use crate::batch::volume_of;
use crate::encounters::Scenery;

/// Finds the margin that any manoeuvre can keep in each encounter of a batch.
#[derive(Debug, Clone)]
pub struct Judge {
    vehicle: OracleVehicle,
    start: OracleStart,
    settings: OracleSettings,
    protection: ProtectedVolume,
    wind_mps: Vec3,
    limits_m: (f64, f64),
}

impl Judge {
    /// For an aircraft that flies along +x; the margin counts over `horizon_s` seconds.
    ///
    /// # Errors
    /// One sentence about a wind that is too strong for that line.
    pub fn new(model: &VehicleModel, horizon_s: f64) -> Result<Self, String> {
        let airspeed_mps = model.vehicle.airspeed_mps;
        let (course_rad, climb_rad) =
            crab(Vec3::X, airspeed_mps, model.wind_mps).ok_or_else(|| {
                format!(
                    "wind of {} m/s at an airspeed of {airspeed_mps} m/s, expected less: the line cannot be flown",
                    model.wind_mps.length()
                )
            })?;
        Ok(Self {
            vehicle: OracleVehicle::from(&model.flies()),
            start: OracleStart {
                course_rad,
                climb_rad,
                ..OracleStart::ORIGIN
            },
            settings: OracleSettings {
                horizon_s,
                ..OracleSettings::default()
            },
            protection: model.protection,
            wind_mps: model.blows_mps(),
            limits_m: model.limits_m,
        })
    }

    /// The same, but a margin of `enough_m` ends the search.
    #[must_use]
    pub fn until(mut self, enough_m: f64) -> Self {
        self.settings.enough_m = Some(enough_m);
        self
    }

    /// The largest margin found, metres, with six decimals, so that the written and the judged value never
    /// disagree.
    pub fn best_margin_m(&self, encounter: &Encounter) -> f64 {
        self.best_margin_among_m(encounter, &Scenery::default())
    }

    /// The same among ground and zones.
    pub fn best_margin_among_m(&self, encounter: &Encounter, scenery: &Scenery) -> f64 {
        let obstacles: Vec<OracleObstacle> = encounter
            .obstacles
            .iter()
            .map(|obstacle| {
                OracleObstacle {
                    volume: volume_of(obstacle, &self.protection),
                    ..OracleObstacle::from(obstacle)
                }
                .in_wind(self.wind_mps)
            })
            .collect();
        let airspace = airspace_among(scenery, self.limits_m, self.wind_mps);
        let answer = best_margin_within(
            &self.start,
            &self.vehicle,
            &obstacles,
            airspace,
            &self.settings,
        );
        libm::rint(answer.best_margin_m * 1e6) / 1e6
    }
}
