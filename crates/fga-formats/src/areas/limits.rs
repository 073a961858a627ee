//! Limits as properties, texts and other formats write them: a height, its unit and what it counts from, in one word or in several.

use serde_json::{Map, Value};

use super::area::{AreaLimit, Reference};
use super::taken::Areas;
use crate::error::{InputError, shown};
use crate::units::{Dimension, FOOT_M, Unit};

/// A flight level is this many feet.
const LEVEL_FT: f64 = 100.0;
/// Files round a height that they say again in another unit by this share at most.
const ROUNDED: f64 = 0.02;

/// What a file says of one limit, piece by piece.
#[derive(Debug, Clone, Default)]
pub(super) struct SaidLimit {
    height: Option<f64>,
    unit_m: Option<f64>,
    above: Option<Reference>,
    is_unlimited: bool,
    /// What nothing here understands.
    unknown: Option<String>,
    /// What it was read from.
    said: Vec<String>,
}

impl SaidLimit {
    /// Takes words such as `2500 ft AMSL`, `FL 65`, `GND` or `UNL`.
    pub(super) fn take(&mut self, text: &str) {
        // AIXM writes W84.
        let text = text.trim().to_ascii_uppercase().replace("WGS84", "W84");
        let text = text.replace("W84", "HAE");
        self.said.push(text.clone());
        let mut words: Vec<String> = Vec::new();
        let mut kind = None;
        for each in text.chars() {
            let this = match each {
                '0'..='9' | '.' | '+' => Some(true),
                '-' if kind != Some(true) => Some(true),
                'A'..='Z' => Some(false),
                _ => None,
            };
            match (this, words.last_mut()) {
                (Some(_), Some(word)) if this == kind => word.push(each),
                (Some(_), _) => words.push(each.into()),
                (None, _) => (),
            }
            kind = this;
        }
        for word in words {
            self.word(&word);
        }
    }

    fn word(&mut self, word: &str) {
        if let Ok(number) = word.parse::<f64>() {
            self.number(number);
            return;
        }
        match word {
            "UNL" | "UNLIM" | "UNLIMITED" | "UNLTD" => self.is_unlimited = true,
            "FL" => {
                self.unit_m = Some(LEVEL_FT * FOOT_M);
                self.above = Some(Reference::Pressure);
            }
            "GND" | "SFC" | "GROUND" | "SURFACE" => {
                self.above = Some(Reference::Ground);
                self.height = self.height.or(Some(0.0));
                self.unit_m = self.unit_m.or(Some(1.0));
            }
            // Between numbers and words that say more, these say nothing.
            "A" | "ABOVE" | "LEVEL" | "N" => (),
            _ => match (reference(word), length_m(word)) {
                (Some(above), _) => self.above = Some(above),
                (None, Some(unit_m)) => self.unit_m = Some(unit_m),
                (None, None) => self.unknown = Some(word.to_owned()),
            },
        }
    }

    fn number(&mut self, number: f64) {
        let before = self.height.filter(|height| *height != 0.0);
        if !number.is_finite() {
            self.unknown = Some(number.to_string());
        } else if before.is_some_and(|height| height != number) {
            self.unknown = Some(format!("{number} as a second height"));
        }
        self.height = Some(number);
    }

    /// Takes a value, or an object of value, unit and reference, as `OpenAIP` writes it.
    fn take_value(&mut self, value: &Value) {
        match value {
            Value::Number(number) => {
                self.said.push(number.to_string());
                self.number(number.as_f64().unwrap_or(f64::NAN));
            }
            Value::String(text) => self.take(text),
            Value::Object(parts) => {
                for (key, value) in parts {
                    match Role::of(&words_of(key)) {
                        Role::Unit => self.take_unit(value),
                        Role::Reference => self.take_reference(value),
                        Role::Height => self.take_value(value),
                    }
                }
            }
            Value::Null => (),
            other => self.unknown = Some(other.to_string()),
        }
    }

    /// A unit by its name, or by its number at `OpenAIP`.
    pub(super) fn take_unit(&mut self, value: &Value) {
        self.take_word(value, &[(0, "M"), (1, "FT"), (6, "FL")]);
    }

    pub(super) fn take_reference(&mut self, value: &Value) {
        // What a height counts from is no height.
        let height = self.height;
        self.take_word(value, &[(0, "AGL"), (1, "AMSL"), (2, "STD")]);
        self.height = height;
    }

    fn take_word(&mut self, value: &Value, numbered: &[(u64, &str)]) {
        let number = value.as_u64();
        let known = numbered.iter().find(|(code, _)| number == Some(*code));
        match (known, value) {
            (Some((_, word)), _) => self.word(word),
            (None, Value::String(text)) => self.take(text),
            (None, Value::Null) => (),
            (None, other) => self.unknown = Some(other.to_string()),
        }
    }

    /// The limit; `Ok(None)` if the file says that there is none, or says nothing.
    pub(super) fn limit(&self) -> Result<Option<AreaLimit>, String> {
        let said = || shown(&self.said.join(" "));
        if let Some(unknown) = &self.unknown {
            return Err(format!("{} ({} is not known)", said(), shown(unknown)));
        }
        if self.is_unlimited {
            return Ok(None);
        }
        match (self.height, self.unit_m, self.above) {
            (None, ..) => Ok(None),
            // On the ground and at the sea no unit is needed.
            (Some(0.0), _, Some(above)) => Ok(Some(AreaLimit {
                height_m: 0.0,
                above,
            })),
            (Some(height), Some(unit_m), Some(above)) if (height * unit_m).is_finite() => {
                let height_m = height * unit_m;
                Ok(Some(AreaLimit { height_m, above }))
            }
            (_, None, _) => Err(format!("{} without a unit", said())),
            _ => Err(format!("{} without what it counts from", said())),
        }
    }

    /// Whether it is the height of another one once more, perhaps in another unit and rounded.
    fn says_the_same(&self, other: &Self) -> bool {
        let height_m = |said: &Self| Some(said.height? * said.unit_m?);
        let heights_m = height_m(self).zip(height_m(other));
        heights_m.is_some_and(|(one_m, other_m)| (one_m - other_m).abs() <= ROUNDED * other_m.abs())
    }

    fn is_said(&self) -> bool {
        self.height.is_some() || self.is_unlimited || self.unknown.is_some()
    }
}

/// What a limit counts from, by a word in capitals.
fn reference(word: &str) -> Option<Reference> {
    Some(match word {
        "AMSL" | "MSL" | "ALT" | "QNH" | "SEA" => Reference::Sea,
        "AGL" | "GND" | "SFC" | "ASFC" | "HEI" | "GROUND" | "SURFACE" => Reference::Ground,
        "HAE" | "W" | "ELLIPSOID" => Reference::Ellipsoid,
        "STD" | "QNE" | "FL" => Reference::Pressure,
        _ => return None,
    })
}

fn length_m(word: &str) -> Option<f64> {
    let word = if word == "F" { "FT" } else { word };
    let unit = Unit::parse(word).filter(|unit| unit.dimension == Dimension::Length);
    unit.map(|unit| unit.factor)
}

/// What a name says of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    Height,
    Unit,
    Reference,
}

impl Role {
    fn of(words: &[String]) -> Self {
        let has = |all: &[&str]| words.iter().any(|word| all.contains(&word.as_str()));
        if has(&["unit", "units", "uom"]) {
            Self::Unit
        } else if has(&["ref", "reference", "datum", "code"]) {
            Self::Reference
        } else {
            Self::Height
        }
    }
}

/// The words of a name, as in `lowerLimit_alt`, in small letters.
fn words_of(key: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for each in key.chars() {
        let begins = !before.is_alphanumeric() || (each.is_uppercase() && before.is_lowercase());
        match words.last_mut() {
            Some(word) if !begins && each.is_alphanumeric() => word.extend(each.to_lowercase()),
            _ if each.is_alphanumeric() => words.push(each.to_lowercase().collect()),
            _ => (),
        }
        before = each;
    }
    words
}

/// Which limit a name is about: 0 the lower one, 1 the upper one.
fn side(words: &[String]) -> Option<usize> {
    let has = |all: &[&str]| words.iter().any(|word| all.contains(&word.as_str()));
    let of_heights = [
        "alt", "altitude", "height", "limit", "level", "m", "ft", "agl", "amsl", "msl", "val",
        "uom", "code",
    ];
    // Words for both limits of other things need one that says that they are about heights.
    let is_about = words.len() == 1 || has(&of_heights);
    if has(&["lower"]) || (is_about && has(&["floor", "bottom", "base", "min", "minimum"])) {
        Some(0)
    } else if has(&["upper"]) || (is_about && has(&["ceiling", "top", "max", "maximum"])) {
        Some(1)
    } else {
        None
    }
}

impl Areas<'_> {
    /// A unit of lengths, metres.
    pub(super) fn unit_m(&self, unit: &str) -> Result<f64, InputError> {
        length_m(&unit.to_ascii_uppercase()).map_or_else(
            || self.refuse(format_args!("has the unit {unit:?}, expected m or ft")),
            Ok,
        )
    }

    /// A limit, or a note that says why there is none.
    pub(super) fn named(&mut self, said: &SaidLimit, what: &str) -> Option<AreaLimit> {
        said.limit().unwrap_or_else(|message| {
            self.note(&format!(
                "has the {what} limit {message}: it counts without one"
            ));
            None
        })
    }

    /// Takes the limits that properties state by names of their own, in a unit where they say none, and names those that cannot be read.
    pub(super) fn take_limits(&mut self, properties: &Map<String, Value>, unit_m: Option<f64>) {
        let mut said = [SaidLimit::default(), SaidLimit::default()];
        let mut shared = SaidLimit::default();
        // Authorities keep what ED-269 says of a volume in an object, or a list of one, with its outline elsewhere.
        let inner = ["geometry", "verticalLayer", "layer", "limits"].into_iter();
        let inner = inner.filter_map(|key| match properties.get(key)? {
            Value::Object(object) => Some(object),
            Value::Array(list) => match list.as_slice() {
                [Value::Object(object)] => Some(object),
                _ => None,
            },
            _ => None,
        });
        for (key, value) in inner
            .chain([properties])
            .flatten()
            .filter(|(_, value)| !value.is_null())
        {
            let words = words_of(key);
            let Some(side) = side(&words).and_then(|side| said.get_mut(side)) else {
                if words.len() <= 2 && Role::of(&words) == Role::Unit {
                    shared.take_unit(value);
                }
                continue;
            };
            let are_words = ["desc", "description", "text", "name"];
            if words.iter().any(|word| are_words.contains(&word.as_str())) {
                continue;
            }
            match Role::of(&words) {
                Role::Unit => side.take_unit(value),
                Role::Reference => side.take_reference(value),
                Role::Height => {
                    let words = words.iter().map(|word| word.to_ascii_uppercase());
                    let words: Vec<String> = words.collect();
                    let mut again = SaidLimit {
                        unit_m: words.iter().find_map(|word| length_m(word)),
                        ..SaidLimit::default()
                    };
                    again.take_value(value);
                    if again.says_the_same(side) {
                        continue;
                    }
                    side.take_value(value);
                    // As in floor_m and upper_ft_amsl.
                    let mut above = words.iter().filter(|word| *word != "ALT");
                    side.above = side.above.or(above.find_map(|word| reference(word)));
                    side.unit_m = side.unit_m.or(again.unit_m);
                }
            }
        }
        let mut limits = self.like.limits;
        let said = said.into_iter().zip(["lower", "upper"]);
        for ((mut said, what), limit) in said.zip(&mut limits) {
            if !said.is_said() {
                continue;
            }
            if said.unit_m.is_none() {
                said.unknown = said.unknown.or(shared.unknown.clone());
                said.unit_m = shared.unit_m.or(unit_m);
            }
            *limit = self.named(&said, what);
        }
        self.like.limits = limits;
    }
}
