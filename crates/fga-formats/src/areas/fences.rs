//! The fences of a mission.

use super::{AreaOutline, Areas};
use crate::error::InputError;
use crate::missions::{self, FenceOutline};

impl Areas<'_> {
    pub(super) fn take_fences(&mut self, text: &str) -> Result<(), InputError> {
        for (fence, number) in missions::parse(text, self.path)?.fences.iter().zip(1..) {
            self.like.name = Some(format!("fence {number}"));
            self.like.keep_in = Some(fence.keep_in);
            match &fence.outline {
                FenceOutline::Circle {
                    center_deg: [latitude_deg, longitude_deg],
                    radius_m,
                } => self.take_circle(&[*longitude_deg, *latitude_deg], *radius_m)?,
                FenceOutline::Polygon { corners_deg } => {
                    self.push(AreaOutline::Polygon(vec![corners_deg.clone()]));
                }
            }
        }
        Ok(())
    }
}
