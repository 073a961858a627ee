//! What a file of encounters holds, and where each comes from.

use fga_formats::daa::Recording;

/// The keys of a recording's parameters.
pub(super) const KEYS: [&str; 3] = ["fga_encounter", "fga_seed", "fga_weight"];

/// The largest weight: sums of squares of weights stay finite.
pub(super) const LARGEST_WEIGHT: f64 = 1e12;

/// Where a recording comes from, if it was drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Origin {
    /// Number of the encounter in its campaign: the stream of its sensor noise.
    pub number: Option<u64>,
    /// Its master seed.
    pub seed: Option<u64>,
    /// Number of encounters that it represents.
    pub weight: f64,
}

impl Origin {
    /// The origin that a recording names; without one its weight is 1.
    ///
    /// # Errors
    /// One sentence about a number that is missing, appears twice or cannot be used.
    pub fn of(recording: &Recording) -> Result<Self, String> {
        let value = |name: &str| {
            let mut found = recording.parameters.iter().filter(|(key, _)| key == name);
            found.next().map(|(_, value)| value.as_str())
        };
        for name in KEYS {
            let named = |(key, _): &&(String, String)| key == name;
            if recording.parameters.iter().filter(named).count() > 1 {
                return Err(format!("{name} appears twice, expected it once"));
            }
        }
        let whole = |name: &str| {
            value(name)
                .map(|text| {
                    text.parse::<u64>().map_err(|_| {
                        format!(
                            "{name} is {}, expected a whole number from 0",
                            fga_formats::error::shown(text)
                        )
                    })
                })
                .transpose()
        };
        let [number, seed, weight] = KEYS;
        let weight = match value(weight) {
            // A drawn encounter counts by its weight: 1 would change every ratio.
            None if value(number).is_some() => {
                return Err(format!("{weight} is missing, expected it beside {number}"));
            }
            None => 1.0,
            Some(text) => text
                .parse()
                .ok()
                .filter(|weight: &f64| *weight > 0.0 && *weight <= LARGEST_WEIGHT)
                .ok_or_else(|| {
                    format!(
                        "{weight} is {}, expected a positive number up to {LARGEST_WEIGHT:e}",
                        fga_formats::error::shown(text)
                    )
                })?,
        };
        Ok(Self {
            number: whole(number)?,
            seed: whole(seed)?,
            weight,
        })
    }

    /// Writes the origin into a recording.
    pub fn mark(&self, recording: &mut Recording) {
        recording
            .parameters
            .retain(|(key, _)| !KEYS.contains(&key.as_str()));
        let values = [
            self.number.map(|number| number.to_string()),
            self.seed.map(|seed| seed.to_string()),
            Some(self.weight.to_string()),
        ];
        for (key, value) in KEYS.iter().zip(values) {
            let value = value.map(|value| ((*key).to_owned(), value));
            recording.parameters.extend(value);
        }
    }
}

/// The content of a file of encounters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrawnContent {
    /// Obstacles around the line of the ownship.
    Rows,
    /// Aircraft with tracks.
    Tracks,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_origin_is_read_back_and_wrong_numbers_are_refused() {
        let mut recording = Recording {
            aircraft: Vec::new(),
            tally: fga_formats::tally::Tally::default(),
            frame: None,
            parameters: vec![("fga_weight".into(), "-1".into())],
        };
        let said = Origin::of(&recording).unwrap_err();
        assert_eq!(
            said,
            "fga_weight is \"-1\", expected a positive number up to 1e12"
        );
        let origin = Origin {
            number: Some(17),
            seed: Some(u64::MAX),
            weight: 0.1 + 0.2,
        };
        origin.mark(&mut recording);
        assert_eq!(Origin::of(&recording), Ok(origin));
        recording.parameters[1].1 = "1.5".into();
        let said = Origin::of(&recording).unwrap_err();
        assert_eq!(said, "fga_seed is \"1.5\", expected a whole number from 0");
        origin.mark(&mut recording);
        recording.parameters.pop();
        let said = Origin::of(&recording).unwrap_err();
        assert_eq!(
            said,
            "fga_weight is missing, expected it beside fga_encounter"
        );
        origin.mark(&mut recording);
        recording.parameters.push(("fga_weight".into(), "1".into()));
        let said = Origin::of(&recording).unwrap_err();
        assert_eq!(said, "fga_weight appears twice, expected it once");
    }
}
