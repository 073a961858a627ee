//! The fences of a mission.

use super::taken::Areas;
use crate::error::InputError;
use crate::missions;

impl Areas<'_> {
    pub(super) fn take_fences(&mut self, text: &str) -> Result<(), InputError> {
        for (fence, number) in missions::parse(text, self.path)?.fences.iter().zip(1..) {
            self.like.name = Some(format!("fence {number}"));
            self.like.keep_in = Some(fence.keep_in);
            self.push(fence.outline.clone());
        }
        Ok(())
    }

    /// A fence of ArduPilot from before missions held fences: where the aircraft returns to, then a polygon to stay in.
    pub(super) fn take_fence_points(&mut self, text: &str) -> Result<(), InputError> {
        let [_, corners @ ..] = &fence_points(text).unwrap_or_default()[..] else {
            return self.refuse("has no corners, expected a return point and a polygon");
        };
        self.like.name = Some("fence".into());
        self.like.keep_in = Some(true);
        let exchanged =
            |[latitude_deg, longitude_deg]: &[f64; 2]| vec![*longitude_deg, *latitude_deg];
        if corners.len() < 2 || corners.first() != corners.last() {
            return self.refuse("is not closed, expected its first corner at its end again");
        }
        self.take(&[corners.iter().map(exchanged).collect()])?;
        self.leave_out("return point");
        Ok(())
    }
}

/// The places of a text that holds a latitude and a longitude in each line and nothing else.
pub(super) fn fence_points(text: &str) -> Option<Vec<[f64; 2]>> {
    let lines = text.lines().map(str::trim);
    let lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    let place = |line: &str| {
        let mut numbers = line.split_whitespace().map(|word| word.parse().ok());
        match (numbers.next(), numbers.next(), numbers.next()) {
            (Some(Some(latitude)), Some(Some(longitude)), None) => Some([latitude, longitude]),
            _ => None,
        }
    };
    let places: Option<Vec<[f64; 2]>> = lines.map(place).collect();
    places.filter(|places| !places.is_empty())
}
