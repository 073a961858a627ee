//! The optional columns of a `.daa` file.

use super::columns::fields;
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

/// An optional column.
#[derive(Debug, Clone, Copy)]
struct Extra {
    place: usize,
    name: &'static str,
    dimension: Dimension,
    unit: Option<Unit>,
}

impl Extra {
    fn find(
        names: &[String],
        name: &'static str,
        dimension: Dimension,
        unit: Option<Unit>,
    ) -> Option<Self> {
        let place = names.iter().position(|known| known == name)?;
        Some(Self {
            place,
            name,
            dimension,
            unit,
        })
    }

    /// Takes the unit of a line of units.
    fn take_unit(&mut self, units: &[&str]) -> Result<(), String> {
        let text = units.get(self.place).copied().unwrap_or_default();
        if Unit::is_unspecified(text) {
            return Ok(());
        }
        let expected = self.dimension.with_article();
        let unit = Unit::parse(text)
            .filter(|unit| unit.dimension == self.dimension)
            .ok_or_else(|| {
                format!(
                    "column {} has the unit {}, expected {expected} unit such as {}",
                    self.name,
                    shown(text),
                    self.dimension.examples()
                )
            })?;
        self.unit = Some(unit);
        Ok(())
    }

    /// The number in a row, in SI units; `None` for an empty field.
    fn value(&self, fields: &[&str]) -> Result<Option<f64>, String> {
        let text = fields.get(self.place).copied().unwrap_or_default();
        if text.is_empty() || text == "-" {
            return Ok(None);
        }
        let number: f64 = text
            .parse()
            .ok()
            .filter(|number: &f64| number.is_finite())
            .ok_or_else(|| {
                format!(
                    "column {} holds {}, expected a finite number",
                    self.name,
                    shown(text)
                )
            })?;
        let unit = self.unit.ok_or_else(|| {
            format!(
                "column {} has no unit, expected one such as {} in a line of units",
                self.name,
                self.dimension.examples()
            )
        })?;
        Ok(Some(unit.to_si(number)))
    }
}

/// The optional columns.
pub(super) struct Extras {
    heading: Option<Extra>,
    airspeed: Option<Extra>,
    air: [Option<Extra>; 2],
    alerter: Option<usize>,
    deviations: [Option<Extra>; 8],
}

impl Extras {
    /// The optional columns that a line of column names has.
    pub(super) fn from_header(header: &str) -> Self {
        let names: Vec<String> = fields(header, None)
            .into_iter()
            .map(str::to_ascii_lowercase)
            .collect();
        let find = |name, dimension, unit| Extra::find(&names, name, dimension, unit);
        Self {
            heading: find("heading", Dimension::Angle, Some(Unit::DEGREE)),
            airspeed: find("airspeed", Dimension::Speed, Some(Unit::KNOT)),
            air: ["air_vx", "air_vy"].map(|name| find(name, Dimension::Speed, Some(Unit::KNOT))),
            alerter: names.iter().position(|name| name == "alerter"),
            deviations: DEVIATIONS.map(|(name, dimension)| find(name, dimension, None)),
        }
    }

    /// Takes the units of a line of units.
    pub(super) fn take_units(&mut self, line: &str, width: usize) -> Result<(), String> {
        let units = fields(line, Some(width));
        [&mut self.heading, &mut self.airspeed]
            .into_iter()
            .chain(&mut self.air)
            .chain(&mut self.deviations)
            .flatten()
            .try_for_each(|extra| extra.take_unit(&units))
    }

    /// Velocity through the air to the east and north, metres per second.
    pub(super) fn air_mps(&self, fields: &[&str]) -> Result<Option<(f64, f64)>, String> {
        let [Some(east), Some(north)] = &self.air else {
            return Ok(None);
        };
        Ok(east.value(fields)?.zip(north.value(fields)?))
    }

    /// Compass direction (radians) and speed (metres per second) through the air.
    pub(super) fn air(&self, fields: &[&str]) -> Result<Option<(f64, f64)>, String> {
        let (Some(heading), Some(airspeed)) = (&self.heading, &self.airspeed) else {
            return Ok(None);
        };
        let (heading, airspeed) = (heading.value(fields)?, airspeed.value(fields)?);
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
                *value = extra.value(fields)?.unwrap_or(0.0);
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
