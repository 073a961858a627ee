//! One encounter of a campaign as a flight of its own, with everything logged.

use super::{Campaign, CampaignError};
use crate::batch;
use crate::policy::PolicyChoice;
use crate::run::{Plan, RunLog};

impl Campaign {
    /// The encounter of this number as a plan for [`batch::show`].
    ///
    /// # Errors
    /// A number past the last.
    pub fn plan(&self, number: u64) -> Result<Plan, CampaignError> {
        let drawn = self.draw(number)?;
        let mut world = self.world()?;
        world.seed = drawn.seed;
        let source = self
            .source_names()
            .get(drawn.source as usize)
            .map_or("", String::as_str);
        let plan = batch::plan(world, &drawn.encounter, &self.model);
        Ok(Plan {
            name: format!("{}, {}", self.configuration.name, plan.name),
            description: format!("{source}, seed {}", drawn.seed),
            ..plan
        })
    }

    /// Flies one encounter exactly as the campaign does and logs everything.
    ///
    /// # Errors
    /// A number past the last, or settings that the core refuses.
    pub fn show(&self, number: u64, policy: &PolicyChoice) -> Result<RunLog, CampaignError> {
        Ok(batch::show(self.plan(number)?, policy)?)
    }
}
