//! A column of a `.daa` file with a quantity, and its unit.

use crate::error::shown;
use crate::units::{Dimension, Unit};

/// A column with a quantity.
#[derive(Debug, Clone, Copy)]
pub(super) struct DaaColumn {
    /// Its index in a row.
    place: usize,
    /// Its name in the file.
    pub(super) name: &'static str,
    dimension: Dimension,
    /// Its unit; `None` if the file has to give one.
    unit: Option<Unit>,
}

impl DaaColumn {
    /// A column with its unit where the file gives none.
    pub(super) const fn new(place: usize, name: &'static str, unit: Unit) -> Self {
        Self {
            place,
            name,
            dimension: unit.dimension,
            unit: Some(unit),
        }
    }

    /// Its field in a row.
    pub(super) fn field<'a>(&self, fields: &[&'a str]) -> Option<&'a str> {
        fields.get(self.place).copied()
    }

    /// The column of this name, if there is one.
    pub(super) fn optional(
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
    pub(super) fn take_unit(&mut self, units: &[&str]) -> Result<(), String> {
        let unit = Unit::of(self.field(units).unwrap_or_default(), self.dimension);
        let unit = unit.map_err(|message| format!("column {} {message}", self.name))?;
        self.unit = unit.or(self.unit);
        Ok(())
    }

    /// The number in a row, in SI units.
    pub(super) fn value(&self, fields: &[&str]) -> Result<f64, String> {
        let name = self.name;
        let text = self.field(fields).unwrap_or_default();
        let wrong = |expected| format!("column {name} holds {}, expected {expected}", shown(text));
        let number: f64 = text.parse().map_err(|_| wrong("a number"))?;
        if !number.is_finite() {
            return Err(wrong("a finite number"));
        }
        let unit = self.unit.ok_or_else(|| {
            let examples = self.dimension.examples();
            format!("column {name} has no unit, expected one such as {examples} in a line of units")
        })?;
        Ok(unit.to_si(number))
    }

    /// The same of an optional column; `None` for an empty field.
    pub(super) fn given(&self, fields: &[&str]) -> Result<Option<f64>, String> {
        match self.field(fields) {
            None | Some("" | "-") => Ok(None),
            Some(_) => self.value(fields).map(Some),
        }
    }

    /// The time in this column, s: a number, or `hours:minutes:seconds`, or `minutes:seconds`.
    pub(super) fn clock_s(&self, fields: &[&str]) -> Result<f64, String> {
        let text = self.field(fields).unwrap_or_default();
        if !text.contains(':') {
            return self.value(fields);
        }
        let parts: Option<Vec<f64>> = text.split(':').map(|part| part.parse().ok()).collect();
        let valid = |parts: &Vec<f64>| {
            parts.len() <= 3
                && parts.iter().all(|part| part.is_finite() && *part >= 0.0)
                && parts.iter().skip(1).all(|part| *part < 60.0)
        };
        match parts.filter(valid) {
            Some(parts) => Ok(parts.iter().fold(0.0, |sum, part| sum * 60.0 + part)),
            None => Err(format!(
                "column {} holds {}, expected seconds or hours:minutes:seconds",
                self.name,
                shown(text)
            )),
        }
    }
}
