//! The optional columns of a `.daa` file.

use super::columns::DaaColumn;
use crate::error::shown;
use crate::units::{Dimension, Unit};
use fga_alerts::Deviation;

/// The deviation columns, in the order of [`Extras::deviations`].
const DEVIATIONS: [(&str, Dimension); 8] = [
    ("s_ew_std", Dimension::Length),
    ("s_ns_std", Dimension::Length),
    ("s_en_std", Dimension::Length),
    ("sz_std", Dimension::Length),
    ("v_ew_std", Dimension::Speed),
    ("v_ns_std", Dimension::Speed),
    ("v_en_std", Dimension::Speed),
    ("vz_std", Dimension::Speed),
];

/// The optional columns.
#[derive(Debug, Clone)]
pub(super) struct Extras {
    heading: Option<DaaColumn>,
    airspeed: Option<DaaColumn>,
    air: [Option<DaaColumn>; 2],
    alerter: Option<usize>,
    deviations: [Option<DaaColumn>; 8],
}

impl Extras {
    /// The optional columns among these names.
    pub(super) fn of(names: &[String]) -> Self {
        let find = |name, dimension, unit| DaaColumn::optional(names, name, dimension, unit);
        Self {
            heading: find("heading", Dimension::Angle, Some(Unit::DEGREE)),
            airspeed: find("airspeed", Dimension::Speed, Some(Unit::KNOT)),
            air: ["air_vx", "air_vy"].map(|name| find(name, Dimension::Speed, Some(Unit::KNOT))),
            alerter: names.iter().position(|name| name == "alerter"),
            deviations: DEVIATIONS.map(|(name, dimension)| find(name, dimension, None)),
        }
    }

    /// Those with a quantity.
    pub(super) fn columns(&mut self) -> impl Iterator<Item = &mut DaaColumn> {
        let columns = [&mut self.heading, &mut self.airspeed].into_iter();
        let columns = columns.chain(&mut self.air);
        columns.chain(&mut self.deviations).flatten()
    }

    /// Velocity through the air to the east and north, metres per second.
    pub(super) fn air_mps(&self, fields: &[&str]) -> Result<Option<(f64, f64)>, String> {
        let [Some(east), Some(north)] = &self.air else {
            return Ok(None);
        };
        Ok(east.given(fields)?.zip(north.given(fields)?))
    }

    /// Compass direction (radians) and speed (metres per second) through the air.
    pub(super) fn air(&self, fields: &[&str]) -> Result<Option<(f64, f64)>, String> {
        let (Some(heading), Some(airspeed)) = (&self.heading, &self.airspeed) else {
            return Ok(None);
        };
        let (heading, airspeed) = (heading.given(fields)?, airspeed.given(fields)?);
        if airspeed.is_some_and(|speed_mps| speed_mps < 0.0) {
            return Err("column airspeed is negative, expected 0 or more".into());
        }
        Ok(heading.zip(airspeed))
    }

    pub(super) fn alerter(&self, fields: &[&str]) -> Result<Option<u32>, String> {
        let Some(place) = self.alerter else {
            return Ok(None);
        };
        let text = fields.get(place).copied().unwrap_or_default();
        if text.is_empty() || text == "-" {
            return Ok(None);
        }
        text.parse().map(Some).map_err(|_| {
            format!(
                "column alerter holds {}, expected a number of 0 or more",
                shown(text)
            )
        })
    }

    /// The uncertainty of a row's state; zero without these columns.
    pub(super) fn deviation(&self, fields: &[&str]) -> Result<Deviation, String> {
        let mut values = [0.0; 8];
        for (value, extra) in values.iter_mut().zip(&self.deviations) {
            if let Some(extra) = extra {
                *value = extra.given(fields)?.unwrap_or(0.0);
                let signed = extra.name.contains("_en_");
                if *value < 0.0 && !signed {
                    return Err(format!(
                        "column {} is negative, expected a deviation of 0 or more",
                        extra.name
                    ));
                }
            }
        }
        Ok(Deviation::from_array(values))
    }
}
