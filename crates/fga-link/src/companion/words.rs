//! The moment in words and as a picture: the threat, a line for a terminal, what a viewer draws.

use fga::avoider::{Decision, Threat};
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::ObstacleKind;
use fga_formats::words::chance_words;

use super::Companion;
use super::picture::FlightPicture;
use crate::authority::Severity;
use crate::ground::{AboveGround, each_second};

impl Companion {
    /// The threat of the last decision with its name.
    fn threat(&self) -> Option<(String, Threat)> {
        let threat = self.decisions.threat()?;
        Some((self.around.name(threat.id), threat))
    }

    pub(super) fn tell_threat(&mut self) {
        let words = self.threat().map(|(name, threat)| {
            let entry_s = threat.entry_s.max(0.0);
            format!("fga: avoiding {name}, {entry_s:.0} s away")
        });
        self.voice.warn(words.as_deref().unwrap_or("fga: avoiding"));
        if let Some(chances) = self.chances() {
            self.voice
                .tell(Severity::Notice, &format!("fga: {chances}"));
        }
    }

    /// The chances in words to enter a protected volume on the mission and as it flies; `None` of a policy that has none.
    fn chances(&self) -> Option<String> {
        let record = &self.decisions.last()?.decision.record;
        let [hold, flies] = [record.p_loss_hold?, record.p_loss?].map(chance_words);
        Some(format!("{hold} to enter, flown {flies}"))
    }

    /// Name of the obstacle that a decision is about.
    pub(super) fn threat_name(&self, decision: &Decision) -> String {
        let threat = decision.record.threat;
        threat.map_or("?".to_owned(), |threat| self.around.name(threat.id))
    }

    /// One line for a terminal.
    pub fn status_line(&self, now_s: f64) -> String {
        let Some((system, mode)) = self.session.system().zip(self.session.mode()) else {
            return match self.session.instead() {
                Some(heard) => format!("waiting for a vehicle: {heard}"),
                // On a link where nothing is believed, the terminal is all that the operator has.
                None => match self.voice.trouble() {
                    "" => "waiting for a vehicle".to_owned(),
                    trouble => format!("waiting for a vehicle | {trouble}"),
                },
            };
        };
        let age = self
            .ownship
            .age_s(now_s)
            .map_or("no position".to_owned(), |age_s| {
                format!("telemetry {:.0} ms", (age_s * 1e3).max(0.0))
            });
        let decided = self.decisions.last();
        let state = decided.map_or("-", |decided| decided.decision.state.name());
        let threat = self.threat().map_or(String::new(), |(name, threat)| {
            format!(" | {name} in {:.0} s", threat.entry_s.max(0.0))
        });
        let chances = self.chances();
        let chances = chances.map_or(String::new(), |chances| format!(" | {chances}"));
        let unseen = match self.reports.defects().unseen() {
            0 => String::new(),
            count => format!(", {count} unseen"),
        };
        let above = self.above_ground();
        let above = above.map_or(String::new(), |above| format!(" | {above}"));
        format!(
            "vehicle {} {} {} | {}{} | {state} | {} tracks{unseen} | {age}{above}{threat}{chances}",
            system,
            mode,
            if self.session.is_armed() {
                "armed"
            } else {
                "disarmed"
            },
            self.keeper.state().name(),
            if self.session.is_dry_run() {
                " (dry run)"
            } else {
                ""
            },
            self.around.tracks().tracks().len(),
        )
    }

    /// Time of the last decision's state, seconds.
    pub fn decided_for_s(&self) -> Option<f64> {
        self.decisions.last().map(|decided| decided.for_s)
    }

    /// The picture of the last decision; `None` before the first.
    pub fn picture(&self) -> Option<FlightPicture> {
        let decided = self.decisions.last()?;
        let beings = self
            .around
            .obstacles()
            .iter()
            .filter(|obstacle| obstacle.kind != ObstacleKind::NaturalBarrier);
        Some(FlightPicture {
            time_s: decided.for_s,
            own: decided.own,
            decision: decided.decision,
            threat_name: self.threat().map(|(name, _)| name),
            authority: self.keeper.state(),
            vehicle: *self.vehicle()?,
            obstacles: beings
                .map(|obstacle| (*obstacle, self.around.name(obstacle.id)))
                .collect(),
            waypoints_m: self.route.waypoints_m().to_vec(),
            horizon_s: self.config.protection.horizon_s,
            margin_m: self.config.protection.margin_m,
            above_ground: self.above_ground(),
            ground: self.over.known().cloned(),
        })
    }

    /// The height above the ground of the last decision's state, and the least on the way that is flown from there within the horizon;
    /// `None` where no ground is known.
    fn above_ground(&self) -> Option<AboveGround> {
        let (ground, decided) = (self.over.known()?, self.decisions.last()?);
        let own = self.lasting(&decided.own);
        let horizon_s = self.config.protection.horizon_s;
        if !self.keeper.commands() {
            let at_m = own.ownship.position_m;
            let speed_mps = own.ground_velocity_mps.length();
            let way = each_second(at_m, self.route.left_m(at_m).1, speed_mps, horizon_s);
            return AboveGround::along(ground, way);
        }
        let flyer = Flyer::new(self.vehicle()?);
        let mut path = Box::new(FlightPath::new());
        let (start, command) = (MotionState::of(&own.ownship), &decided.decision.command);
        path.predict(&flyer, &start, command, horizon_s);
        let seconds = (0_u32..).map(f64::from);
        let seconds = seconds.take_while(|ahead_s| *ahead_s <= horizon_s);
        let way = seconds.map_while(|ahead_s| {
            let at_m = path.state_at(&flyer, ahead_s)?.position_m;
            Some((ahead_s, at_m + own.wind_mps * ahead_s))
        });
        AboveGround::along(ground, way)
    }
}
