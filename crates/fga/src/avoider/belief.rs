//! Among aircraft that are known by uncertain reports: the least expected cost flies, proven against what is expected.
//!
//! Reports become beliefs, beliefs become futures, and each plan is weighed by its chance of a loss (`fga-choice`). Whether a manoeuvre
//! begins is decided by the least cost. Of the plans that cost little more the cheapest one flies that is proven to keep clear of the expected
//! motion of every aircraft, of zones, ground and limits, in continuous time. Where none is proven, the cheapest one of these that keeps clear
//! of what is fixed flies; below that, the manoeuvre of an [`Avoider`] among the expected motions.

use core::f64::consts::TAU;

use fga_belief::future::{Future, Futures};
pub use fga_belief::{Errors, Report, Sigma, Source};
pub use fga_choice::Beliefs;
use fga_choice::{Chooser, Plan, Ranked, Scene, Up, Way};

use crate::avoider::intruders::Freedom;
use crate::avoider::turn_aware::ENOUGH_M;
use crate::avoider::{
    Avoider, Candidate, Decision, Now, Places, Reason, Settings, SettingsError, State, Threat,
    Verdict,
};
use crate::certificate::{Hazard, certify_set};
use crate::list::List;
use crate::maneuver::Maneuver;
use crate::meter::Meter;
use crate::mission::Route;
use crate::situation::{MovementBounds, Obstacle, Obstacles, ProtectedVolume, Situation};
use crate::vehicle::Vehicle;
use crate::{Vec3, assumptions::Assumptions};

/// Shortest and longest time between two choices, seconds: at a report, or without one.
const PERIOD_S: (f64, f64) = (0.45, 0.95);

/// A plan that is proven may cost this share of a loss more than the cheapest one. Among the first 1,000 encounters of
/// `campaigns/low-altitude-adsb.toml` (seed 2) one in 200 and one in 60 left the same losses.
const PROVEN: f64 = 1.0 / 86.0;

/// Most obstacles that are looked at.
const MOST_SEEN: usize = 64;

/// Decides on beliefs about aircraft: call it each cycle with a [`Situation`] of reports and fly its [`Decision`]. Among obstacles that are
/// no aircraft it is an [`Avoider`]. `examples/beliefs.rs` shows one decision.
#[derive(Debug, Clone)]
pub struct BeliefAvoider {
    avoider: Avoider,
    decider: BeliefDecider,
}

/// What decides on beliefs, beside an [`Avoider`] that lives elsewhere.
#[derive(Debug, Clone)]
pub struct BeliefDecider {
    errors: Errors,
    beliefs: Beliefs,
    chooser: Chooser,
    choice: Choice,
    seen: List<Obstacle, MOST_SEEN>,
    /// What the avoider's clock, which never goes back, is ahead of the situation's, seconds.
    ahead_s: f64,
}

/// What was chosen last.
#[derive(Debug, Clone, Copy)]
struct Choice {
    plan: Plan,
    /// When, seconds on the situation's clock.
    at_s: f64,
    /// Chance of a loss on the mission, and of the plan.
    p_loss: [f64; 2],
    /// Weight of the futures that its certificate covers, if it was proven then and no aircraft is left out.
    proven_share: Option<f64>,
    cost_m: f64,
    /// When it left the mission, seconds on the situation's clock: now, while it is on it.
    departed_s: f64,
    /// When the way back began that is flown, and when it is on its leg, seconds on the situation's clock.
    back_s: (f64, f64),
    /// Whether something was heard since.
    has_news: bool,
    /// What the mission enters by its expected motion, as seen then.
    threat: Option<Threat>,
    /// Whether it was proven then.
    is_proven: bool,
    /// Whether the avoider decides alone, because no plan keeps clear of what is fixed.
    is_delegated: bool,
}

impl Choice {
    const NONE: Self = Self {
        plan: Plan::Mission,
        at_s: f64::NEG_INFINITY,
        p_loss: [0.0; 2],
        proven_share: None,
        cost_m: 0.0,
        departed_s: f64::INFINITY,
        has_news: false,
        back_s: (f64::NEG_INFINITY, f64::NEG_INFINITY),
        threat: None,
        is_proven: false,
        is_delegated: false,
    };
}

impl BeliefAvoider {
    /// For a vehicle, in cruise on the first leg; reports of aircraft have these errors. A σ that nobody said ([`Source::Assumed`]) is that
    /// of the [`Obstacle`], where it has one.
    ///
    /// # Errors
    /// A setting or a limit of the vehicle that is not finite or out of range.
    pub fn new(
        settings: Settings,
        vehicle: Vehicle,
        errors: Errors,
    ) -> Result<Self, SettingsError> {
        Ok(Self {
            avoider: Avoider::new(settings, vehicle)?,
            decider: BeliefDecider::new(errors),
        })
    }

    /// The avoider among what is exact: its limits, its state, and the leg that is flown.
    pub const fn avoider(&self) -> &Avoider {
        &self.avoider
    }

    /// The avoider among what is exact, to change its limits or its mission.
    pub const fn avoider_mut(&mut self) -> &mut Avoider {
        &mut self.avoider
    }

    /// What it believes of the aircraft around.
    pub const fn beliefs(&self) -> &Beliefs {
        &self.decider.beliefs
    }

    /// Forgets the aircraft that the next situation does not have, as where a tracker says which reports are of one aircraft. Without it an
    /// aircraft without reports is believed to be there for 8 s.
    pub fn forget_absent(&mut self, situation: &Situation<'_>) {
        self.decider.beliefs.forget_absent(situation);
    }

    /// Forgets everything but its settings, its errors and the limits of its vehicle.
    pub(crate) fn forget_flight(&mut self) {
        self.avoider.forget_flight();
        self.decider.beliefs.forget();
        self.decider.restart();
    }

    /// Decides.
    pub fn step(&mut self, situation: &Situation<'_>) -> Decision {
        let mut decision = Decision::default();
        self.step_into(situation, &mut decision);
        decision
    }

    /// Decides into the place of another decision, which is large.
    pub fn step_into(&mut self, situation: &Situation<'_>, decision: &mut Decision) {
        self.decider
            .step_into(&mut self.avoider, situation, decision);
    }
}

impl BeliefDecider {
    /// One that knows nobody; reports of aircraft in a situation have these errors, as of [`BeliefAvoider::new`].
    pub const fn new(errors: Errors) -> Self {
        const NOBODY: Obstacle = Obstacle::straight(
            0,
            Vec3::ZERO,
            Vec3::ZERO,
            ProtectedVolume::Sphere { radius_m: 0.0 },
        );
        Self {
            errors,
            beliefs: Beliefs::new(),
            chooser: Chooser::new(),
            choice: Choice::NONE,
            seen: List::new(NOBODY),
            ahead_s: 0.0,
        }
    }

    /// Forgets what was chosen, as at the beginning of another flight; who is around stays known.
    pub const fn restart(&mut self) {
        self.chooser.forget();
        self.choice = Choice::NONE;
    }

    /// Takes a report that is in no situation, of an aircraft with a volume; its time is on the clock of the situations. Returns and requires what
    /// [`Beliefs::take`] does.
    pub fn hear(
        &mut self,
        aircraft: (u32, ProtectedVolume),
        report: &Report,
        bounds: &MovementBounds,
        own_m: Vec3,
    ) -> Option<bool> {
        let report = Report {
            time_s: report.time_s + self.ahead_s,
            ..*report
        };
        let heard = self.beliefs.take(aircraft, &report, bounds, own_m);
        self.choice.has_news |= heard != Some(false);
        heard
    }

    /// Decides what an avoider flies, into the place of another decision, which is large. Returns whether all that is around had room.
    pub fn step_into<P: Places + 'static>(
        &mut self,
        avoider: &mut Avoider<P>,
        situation: &Situation<'_>,
        decision: &mut Decision,
    ) -> bool {
        if !situation.is_usable() {
            avoider.step_into(situation, decision);
            return true;
        }
        let (time_s, is_far) = avoider.in_order_s(situation.time_s);
        self.ahead_s = time_s - situation.time_s;
        if is_far {
            self.beliefs.forget();
            self.choice = Choice::NONE;
        }
        let ordered = &Situation {
            time_s,
            ..*situation
        };
        self.choice.has_news |= self.beliefs.hear(ordered, &self.errors);
        if self.beliefs.is_empty() {
            self.choice = Choice::NONE;
            avoider.step_into(situation, decision);
            return true;
        }
        self.seen.clear();
        let mut is_left_out = self.beliefs.leaves_out(time_s);
        let reported = situation.obstacles.iter().filter(Obstacle::is_valid);
        let expected = reported.map(|obstacle| self.beliefs.expected(&obstacle, time_s));
        let own = &situation.ownship;
        let soonest_s = |one: &Obstacle| {
            let gap_m = one.volume.margin_m(own.position_m - one.position_m);
            gap_m / (own.airspeed_mps + one.velocity_mps.length())
        };
        for expected in self.beliefs.absent(ordered).chain(expected) {
            if self.seen.push(expected).is_some() {
                continue;
            }
            // Those stay that it could meet first.
            is_left_out = true;
            let seen = self.seen.iter_mut();
            let last = seen.max_by(|a, b| soonest_s(a).total_cmp(&soonest_s(b)));
            if let Some(last) = last.filter(|last| soonest_s(&expected) < soonest_s(last)) {
                *last = expected;
            }
        }
        let expected = Situation {
            obstacles: Obstacles::Rows(&self.seen),
            ..*situation
        };
        let mut chooses = Chooses {
            beliefs: &self.beliefs,
            chooser: &mut self.chooser,
            choice: &mut self.choice,
        };
        avoider.step_by(
            &expected,
            decision,
            &mut |avoider, situation, now, decision| {
                chooses.step(avoider, situation, now, decision);
            },
        );
        is_left_out |= avoider.tracks.overflow;
        if is_left_out {
            decision.record.proven_share = None;
        }
        decision.record.work.limit_met |= is_left_out || self.chooser.left_out() > 0;
        !is_left_out
    }
}

/// One step among aircraft.
struct Chooses<'a> {
    beliefs: &'a Beliefs,
    chooser: &'a mut Chooser,
    choice: &'a mut Choice,
}

impl Chooses<'_> {
    #[inline(never)]
    fn step(
        &mut self,
        avoider: &mut Avoider<dyn Places + '_>,
        situation: &Situation<'_>,
        now: &Now<'_>,
        decision: &mut Decision,
    ) {
        let (time_s, horizon_s) = (situation.time_s, avoider.settings.horizon_s);
        // Futures reach farther than the tracks: a manoeuvre may begin while none of them is near.
        avoider.load_tracks(situation, None, true);
        avoider.ends_before_walls(situation, now);
        let mut mission = Maneuver::hold();
        // A way back keeps its turns until it ends. Laid anew in each step it might never end.
        let (began_s, until_s) = self.choice.back_s;
        let lays_guidance = avoider.state != State::Recovering
            || time_s >= until_s
            || avoider.progress.is_off_turn();
        if lays_guidance {
            let joined_s = avoider.guide((situation, now), horizon_s, &mut mission);
            self.choice.back_s = (time_s, time_s + joined_s);
        } else {
            mission.set_later(&avoider.flown, time_s - began_s);
        }
        let (vehicle, flyer, progress) = (avoider.vehicle, avoider.flyer, avoider.progress);
        let meter = Meter::unlimited();
        let leg = progress.leg(now);
        let is_off = self.choice.plan.way_at(time_s).is_some();
        let (leg_rad, turns_rad) =
            (self.chooser).courses(now.course_rad, leg.air_course_rad, is_off);
        let scene = Scene {
            route: &Route {
                mission: now.mission,
                flyer: &flyer,
                wind_mps: situation.wind_mps,
                climb_limits_rad: (vehicle.climb_min_rad, vehicle.climb_max_rad),
                meter: &meter,
            },
            mission: &mission,
            progress: &progress,
            time_s,
            now: now.state,
            climbs_rad: avoider.maneuver_climbs_rad(),
            leg_rad,
            turns_rad,
            loss_m: avoider.settings.loss_price_m,
            surveillance_radius_m: avoider.settings.surveillance_radius_m,
            altitude_m: leg.point_m(leg.position(now.position_m, 0.0).along_m).z,
        };
        avoider.withstand(&|_| Freedom::Expected, (0.0, avoider.settings.margin_m));
        // A manoeuvre that the avoider began alone ends by it: two that take turns keep clear of nothing.
        if self.choice.is_delegated && avoider.state.is_away() {
            return avoider.step_turn_aware(situation, now, None, decision);
        }
        let since_s = time_s - self.choice.at_s;
        let is_due =
            since_s < 0.0 || since_s >= PERIOD_S.1 || self.choice.has_news && since_s >= PERIOD_S.0;
        let before = self.choice.plan;
        let is_kept = !is_due && !self.choice.is_delegated && {
            scene.set(&before, decision.command.edit());
            let asked = (&before, self.choice.is_proven);
            keeps(avoider, asked, decision, now)
        };
        if !is_kept && (is_due || !self.choice.is_delegated) {
            self.choose(avoider, situation, &scene, now, decision);
        }
        if self.choice.is_delegated {
            return avoider.step_turn_aware(situation, now, None, decision);
        }
        self.report(avoider, situation, now, &before, decision);
        if lays_guidance {
            avoider.flown.edit().set(mission.stages().iter().copied());
        }
    }

    /// Chooses a plan, and sets the command to it.
    #[inline(never)]
    fn choose(
        &mut self,
        avoider: &mut Avoider<dyn Places + '_>,
        situation: &Situation<'_>,
        scene: &Scene<'_>,
        now: &Now<'_>,
        decision: &mut Decision,
    ) {
        let others = (self.beliefs, &situation.obstacles);
        let is_away = avoider.state.is_away();
        let departed_s = if is_away {
            self.choice.departed_s.min(scene.time_s)
        } else {
            scene.time_s
        };
        let present = (&self.choice.plan, scene.time_s - departed_s);
        let hold = (self.chooser).weigh(scene, others, present, &mut avoider.path);
        let threat = (hold.loss > 0.0).then(|| {
            let demand = avoider.first_demand();
            avoider.first_threat(scene.mission, now, &demand)
        });
        let ranked = self.chooser.ranked();
        let mut choice = Choice {
            at_s: scene.time_s,
            departed_s,
            back_s: self.choice.back_s,
            threat: threat.flatten().map(|(threat, _)| threat),
            ..Choice::NONE
        };
        // The least cost decides whether a manoeuvre begins. Among plans that cost little more, a proof decides which one flies. A plan
        // that keeps clear of what is fixed and costs much more flies through the others.
        let is_off = |one: &Ranked| one.plan.way_at(scene.time_s).is_some();
        let cheapest = ranked.first().copied();
        let is_near = |one: &&Ranked| {
            cheapest.is_some_and(|cheapest| {
                one.cost_m <= cheapest.cost_m + PROVEN * scene.loss_m
                    && is_off(one) == is_off(&cheapest)
            })
        };
        for is_wanted in [true, false] {
            choice.is_proven = is_wanted;
            for one in ranked.iter().filter(is_near) {
                scene.set(&one.plan, decision.command.edit());
                if keeps(avoider, (&one.plan, is_wanted), decision, now) {
                    choice.plan = one.plan;
                    choice.cost_m = one.cost_m;
                    choice.p_loss = [hold.loss, one.chance.loss].map(|p| p.min(1.0));
                    if is_wanted && !self.beliefs.leaves_out(scene.time_s) {
                        choice.proven_share = Some(proven_share(avoider, self.beliefs, situation));
                    }
                    *self.choice = choice;
                    return;
                }
            }
        }
        // Where traffic is in the way, the present way goes on, or a turn to the leg's course, while that is proven. Where zones, ground or
        // limits alone block the way back, the avoider looks for another one.
        let present = self.choice.plan;
        if present != Plan::Mission && cheapest.as_ref().is_some_and(is_off) {
            let to_leg = [0.0, TAU, -TAU].map(|turns_rad| {
                let course_rad = scene.leg_rad + turns_rad;
                let up = Up::Level;
                Plan::Off(Way { course_rad, up }, scene.time_s)
            });
            let to_leg = (to_leg.into_iter()).filter(|_| is_away);
            for plan in [present].into_iter().chain(to_leg) {
                scene.set(&plan, decision.command.edit());
                if keeps(avoider, (&plan, true), decision, now) {
                    *self.choice = Choice {
                        plan,
                        is_proven: true,
                        cost_m: self.choice.cost_m,
                        p_loss: self.choice.p_loss,
                        ..choice
                    };
                    return;
                }
            }
        }
        // Then as among exact reports of the expected motions.
        *self.choice = Choice {
            is_delegated: true,
            p_loss: [hold.loss.min(1.0); 2],
            ..choice
        };
        avoider.plan = None;
    }

    /// Puts the plan on record, and the state that follows from it.
    fn report(
        &self,
        avoider: &mut Avoider<dyn Places + '_>,
        situation: &Situation<'_>,
        now: &Now<'_>,
        before: &Plan,
        decision: &mut Decision,
    ) {
        let (time_s, choice) = (situation.time_s, *self.choice);
        let is_proven = decision.command.proof().is_some();
        avoider.plan = None;
        let was = avoider.state;
        let (state, reason) = match (choice.plan, choice.plan.way_at(time_s)) {
            (_, Some(_)) if !is_proven => (State::Avoiding, avoider.unproven()),
            (_, Some(_)) if was != State::Avoiding => (State::Avoiding, Reason::ManeuverChosen),
            (_, Some(way)) if before.way_at(time_s) != Some(way) => {
                (State::Avoiding, Reason::ManeuverReplaced)
            }
            (_, Some(_)) => (State::Avoiding, Reason::ManeuverKept),
            (Plan::Off(..), None) if !was.is_away() => (State::Threatened, Reason::WaitingForStart),
            (_, None) if was == State::Avoiding => (State::Recovering, Reason::RejoinChosen),
            (_, None) if was == State::Recovering => {
                if avoider.progress.is_back(now, avoider.can_climb()) {
                    (State::Cruise, Reason::Rejoined)
                } else {
                    (State::Recovering, Reason::RejoinKept)
                }
            }
            (_, None) => (State::Cruise, Reason::Clear),
        };
        avoider.state = state;
        avoider.say(decision, reason);
        let record = &mut decision.record;
        [record.p_loss_hold, record.p_loss] = choice.p_loss.map(Some);
        record.proven_share = choice.proven_share.filter(|_| is_proven);
        let elapsed_s = time_s - choice.at_s;
        record.threat = choice.threat.and_then(|threat| threat.later(elapsed_s));
        record.work.threats = u32::from(choice.threat.is_some());
        if let Plan::Off(_, from_s) = choice.plan {
            record.start_s = Some(from_s - time_s);
        }
        if choice.plan != Plan::Mission {
            let asked = (avoider.settings.horizon_s, f64::MIN, ENOUGH_M);
            record.chosen = Some(Candidate {
                margin_m: match decision.command.proof() {
                    Some(proof) => proof.bound().margin_m,
                    None => avoider.margin_of(&decision.command, now, asked),
                },
                cost: choice.cost_m,
                verdict: if is_proven {
                    Verdict::Chosen
                } else {
                    Verdict::Rejected
                },
            });
        }
    }
}

/// Weight of the futures of which the path that was predicted last keeps clear, each aircraft deciding for itself.
#[inline(never)]
fn proven_share(
    avoider: &Avoider<dyn Places + '_>,
    beliefs: &Beliefs,
    situation: &Situation<'_>,
) -> f64 {
    let shares = beliefs.each().map(|(id, volume, belief)| {
        let futures = belief.futures(situation.time_s);
        let clear = futures.each().filter(|future| {
            keeps_clear(
                avoider,
                (id, volume),
                (&futures, future),
                situation.wind_mps,
            )
        });
        clear.map(|future| f64::from(future.weight)).sum::<f64>()
    });
    shares.product::<f64>().min(1.0)
}

/// Whether the path that was predicted last keeps clear of an aircraft in one of its futures.
fn keeps_clear(
    avoider: &Avoider<dyn Places + '_>,
    aircraft: (u32, ProtectedVolume),
    (futures, future): (&Futures, &Future),
    wind_mps: Vec3,
) -> bool {
    let (horizon_s, margin_m) = (avoider.settings.horizon_s, avoider.settings.margin_m);
    let at = |after_s: f32| {
        let [x, y, z] = future.position_m(after_s).map(f64::from);
        futures.origin_m + Vec3::new(x, y, z)
    };
    let mut chords = future.chords(horizon_s);
    let mut until_s = 0.0;
    let are_clear = chords.all(|([from_s, to_s], bow_m)| {
        until_s = to_s.into();
        let window_s = (from_s.into(), until_s);
        let places = (at(from_s), at(to_s));
        let hazard = Hazard::passing(aircraft, places, window_s, bow_m.into(), wind_mps);
        let one = Assumptions::only(core::slice::from_ref(&hazard));
        let asked = (horizon_s, margin_m, ENOUGH_M);
        let meter = Meter::unlimited();
        certify_set(&avoider.flyer, &avoider.path, &one, asked, &meter).holds(margin_m)
    });
    // A future whose numbers make no sense ends early.
    are_clear && until_s > horizon_s - 0.001
}

/// Whether the command of a decision keeps clear of what is fixed; where a proof is wanted, of what is expected too, and then it has its proof.
fn keeps(
    avoider: &mut Avoider<dyn Places + '_>,
    (plan, is_proof_wanted): (&Plan, bool),
    decision: &mut Decision,
    now: &Now<'_>,
) -> bool {
    let is_mission = *plan == Plan::Mission;
    if !is_proof_wanted && is_mission && !avoider.state.is_away() {
        // On its leg the mission is never avoided for what is fixed.
        return true;
    }
    let (horizon_s, margin_m) = (avoider.settings.horizon_s, avoider.settings.margin_m);
    let asked = (horizon_s, margin_m, ENOUGH_M);
    let until_s = if is_mission {
        avoider.guidance_walls_s(&decision.command, now)
    } else {
        avoider.tracks.walls_s()
    };
    avoider.within_walls(until_s, |avoider| {
        if is_proof_wanted {
            return avoider.prove(&mut decision.command, now, asked);
        }
        avoider.predict(&decision.command, now, horizon_s);
        let mut limits = avoider.tracks.limits();
        avoider.keeps_walls(now, asked)
            && limits.all(|limit| avoider.certify_one(limit, asked).holds(margin_m))
    })
}
