//! One encounter of a campaign as a flight of its own, with everything logged.

use fga::Vec3;
use fga::avoider::SettingsError;

use super::{Campaign, CampaignError};
use crate::batch;
use crate::policy::PolicyChoice;
use crate::run::{Plan, RunLog, fly};

impl Campaign {
    /// The encounter of this number as a plan for [`fly`].
    ///
    /// # Errors
    /// A number past the last.
    pub fn plan(&self, number: u64) -> Result<Plan, CampaignError> {
        let drawn = self.draw(number)?;
        let mut world = self.world()?;
        world.seed = drawn.seed;
        batch::populate(&mut world, &drawn.encounter, &self.model.protection);
        let source = self
            .source_names()
            .get(drawn.source as usize)
            .map_or("", String::as_str);
        Ok(Plan {
            name: format!("{}, encounter {number}", self.configuration.name),
            description: format!("{source}, seed {}", drawn.seed),
            names: drawn
                .encounter
                .obstacles
                .iter()
                .map(|obstacle| format!("obstacle {}", obstacle.id))
                .collect(),
            frame: None,
            time_offset_s: 0.0,
            model: self.model.clone(),
            world,
        })
    }

    /// Flies one encounter exactly as the campaign does and logs everything.
    ///
    /// # Errors
    /// A number past the last, or settings that the core refuses.
    pub fn show(&self, number: u64, policy: &PolicyChoice) -> Result<RunLog, CampaignError> {
        let mut log = fly(self.plan(number)?, policy, &mut |_| ())
            .map_err(|error: SettingsError| CampaignError::Settings(error))?;
        // The line goes on for ever; shown is what was flown of it and a little more.
        let farthest_m = log
            .samples
            .iter()
            .map(|sample| sample.position_m.x)
            .fold(100.0, f64::max);
        log.plan.world.mission_m = vec![Vec3::ZERO, Vec3::X * (farthest_m * 1.1)];
        Ok(log)
    }
}
