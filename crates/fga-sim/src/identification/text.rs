//! The figures as a vehicle file.

use core::fmt::Write as _;

use super::{FigureEstimate, Identified, MARGIN_AHEAD_S};

impl Identified {
    /// The figures with their keys in a vehicle file and the decimals that they are written with.
    pub fn figures(&self) -> [(&'static str, FigureEstimate, usize); 9] {
        [
            ("airspeed_mps", self.airspeed_mps, 2),
            ("max_bank_deg", self.max_bank_deg, 1),
            ("climb_min_deg", self.climb_min_deg, 1),
            ("climb_max_deg", self.climb_max_deg, 1),
            ("climb_rate_radps", self.climb_rate_radps, 3),
            ("dead_time_s", self.dead_time_s, 3),
            ("bank_time_constant_s", self.bank_time_constant_s, 3),
            ("turn_rate_factor", self.turn_rate_factor, 3),
            ("position_error_m", self.position_error_m, 1),
        ]
    }

    /// The text of a vehicle file, each figure with its interval. The protected volume is no property of the
    /// log: its radius and, for a cylinder, its half height are given.
    ///
    /// # Errors
    /// A radius or a half height that is not positive, as one sentence.
    pub fn to_toml(
        &self,
        name: &str,
        radius_m: f64,
        half_height_m: Option<f64>,
    ) -> Result<String, String> {
        let lengths = [
            ("radius_m", Some(radius_m)),
            ("half_height_m", half_height_m),
        ];
        for (key, length) in lengths {
            if let Some(length) = length.filter(|length| !(length.is_finite() && *length > 0.0)) {
                return Err(format!("{key} is {length}, expected a positive number"));
            }
        }
        let mut text = format!(
            "# Identified from {} windows in which the bank followed its command; {} were left out.\n\
             # Behind each figure stands what the middle 90 % of the windows give.\n\
             name = {}\n",
            self.windows,
            self.windows_left_out,
            toml::Value::String(name.to_owned())
        );
        let [of_flight @ .., dead_time, time_constant, factor, error] = self.figures();
        let line = |text: &mut String, (key, estimate, decimals): (&str, FigureEstimate, usize)| {
            let FigureEstimate { value, low, high } = estimate;
            let _ = writeln!(
                text,
                "{key} = {value:.decimals$}    # {low:.decimals$} to {high:.decimals$}"
            );
        };
        for figure in of_flight {
            line(&mut text, figure);
        }
        let _ = writeln!(text, "\n[protection]\nradius_m = {radius_m:?}");
        if let Some(half_height_m) = half_height_m {
            let _ = writeln!(text, "half_height_m = {half_height_m:?}");
        }
        text += "\n[response]\n";
        for figure in [dead_time, time_constant, factor] {
            line(&mut text, figure);
        }
        let _ = writeln!(
            text,
            "\n[avoidance]\n# After {MARGIN_AHEAD_S} s the aircraft is {:.1} m (median) from where these figures put it; \
             95 % of the time nearer than this.\nmargin_m = {:.1}",
            error.1.value,
            error.1.high.max(0.1)
        );
        Ok(text)
    }
}
