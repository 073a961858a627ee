//! Places of a file, local or geodetic.

use fga::Vec3;
use fga_files::TomlText;
use fga_formats::InputError;
use fga_formats::geodesy::{Geodetic, LocalFrame};
use toml::Spanned;

/// Places of a file, local or geodetic.
pub(super) struct FilePlaces<'a> {
    pub(super) text: TomlText<'a>,
    pub(super) frame: Option<LocalFrame>,
}

/// A place is at most this far from the origin, kilometres: a quarter of the earth away a plane folds back.
const MOST_AWAY_KM: f64 = 9_000.0;

impl FilePlaces<'_> {
    pub(super) fn local(&self, key: &str, at: &Spanned<[f64; 3]>) -> Result<Vec3, InputError> {
        let place = Vec3::from_array(*at.get_ref());
        if place.is_finite() && place.abs().max_element() <= 1e7 {
            Ok(place)
        } else {
            Err(self.text.error_at(
                at,
                format!("{key} is {place}, expected three finite numbers within 10,000 km"),
            ))
        }
    }

    pub(super) fn geodetic(&self, key: &str, at: &Spanned<[f64; 3]>) -> Result<Vec3, InputError> {
        let Some(frame) = &self.frame else {
            return Err(self.text.error_at(
                at,
                format!(
                    "{key} is geodetic, expected an [origin] with latitude_deg and longitude_deg"
                ),
            ));
        };
        let [latitude_deg, longitude_deg, altitude_m] = *at.get_ref();
        let place = Geodetic::new(latitude_deg, longitude_deg, altitude_m).ok_or_else(|| {
            self.text.error_at(
                at,
                format!("{key} is [{latitude_deg}, {longitude_deg}, {altitude_m}], expected [latitude, longitude, altitude_m]"),
            )
        })?;
        let away_km = 1e-3 * frame.origin().distance_m(place);
        if away_km > MOST_AWAY_KM {
            let message = format!(
                "{key} is {away_km:.0} km from the origin, expected at most {MOST_AWAY_KM} km"
            );
            return Err(self.text.error_at(at, message));
        }
        Ok(frame.to_local_m(place))
    }

    /// The given one of two keys.
    pub(super) fn either(
        &self,
        local: Option<&Spanned<[f64; 3]>>,
        geodetic: Option<&Spanned<[f64; 3]>>,
    ) -> Result<Option<Vec3>, InputError> {
        match (local, geodetic) {
            (Some(local), None) => self.local("position_m", local).map(Some),
            (None, Some(geodetic)) => self.geodetic("position_deg", geodetic).map(Some),
            (None, None) => Ok(None),
            (Some(_), Some(geodetic)) => Err(self.text.error_at(
                geodetic,
                "both position_m and position_deg are given, expected one of them",
            )),
        }
    }
}
