//! Flies one encounter of a campaign alone and logs everything.

use fga_formats::daa::Recording;
use fga_sim::policy::PolicyChoice;
use fga_sim::reaction::{Reacted, react};
use fga_sim::run::{Plan, RunLog, fly};
use fga_sim::world::World;

use super::opened::CampaignScene;
use super::{Campaign, CampaignError};
use crate::batch;
use crate::recorded::plan_of;

impl Campaign {
    /// The encounter with this number as a plan.
    ///
    /// # Errors
    /// A number past the last.
    pub fn plan(&self, number: u64) -> Result<Plan, CampaignError> {
        let drawn = self.draw(number)?;
        let source = self
            .source_names()
            .get(drawn.source as usize)
            .map_or("", String::as_str);
        let description = format!("{source}, seed {}", drawn.seed);
        let plan = match drawn.scene {
            CampaignScene::Rows(encounter) => {
                let mut world = self.world()?;
                world.seed = drawn.seed;
                drawn.scenery.place(&mut world);
                batch::plan(world, &encounter, &self.model)
            }
            CampaignScene::Tracks(recording) => {
                let name = drawn
                    .name
                    .and_then(|name| self.encounter_names().get(name as usize));
                let name = name.map_or_else(|| format!("encounter {number}"), Clone::clone);
                let mut plan =
                    plan_of(&recording, &name, &self.model).map_err(CampaignError::Other)?;
                plan.world.seed = drawn.seed;
                plan.world.stream = drawn.stream;
                plan
            }
        };
        Ok(Plan {
            name: format!("{}, {}", self.configuration.name, plan.name),
            description,
            ..plan
        })
    }

    /// A recorded world with the intruders' answers to a policy, if they react.
    pub(super) fn reacted(
        &self,
        world: &World,
        recording: &Recording,
        policy: &PolicyChoice,
    ) -> Result<Option<Reacted>, CampaignError> {
        let Some(intruders) = &self.intruders else {
            return Ok(None);
        };
        react(world.clone(), recording, &self.model, policy, intruders)
            .map(Some)
            .map_err(CampaignError::Other)
    }

    /// Flies one encounter exactly as the campaign does and logs everything.
    ///
    /// # Errors
    /// A number past the last, or settings that the core refuses.
    pub fn show(&self, number: u64, policy: &PolicyChoice) -> Result<RunLog, CampaignError> {
        let mut plan = self.plan(number)?;
        if self.intruders.is_some()
            && let CampaignScene::Tracks(recording) = self.draw(number)?.scene
            && let Some(reacted) = self.reacted(&plan.world, &recording, policy)?
        {
            plan.world = reacted.world;
        }
        Ok(if plan.world.recorded.is_some() {
            fly(plan, policy, &mut |_| ())?
        } else {
            batch::show(plan, policy)?
        })
    }
}
