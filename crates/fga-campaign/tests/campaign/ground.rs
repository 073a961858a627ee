//! Drawn flights in valleys: no certified one comes lower than it takes to clear the ground, and without traffic the ground changes nothing.
//!
//! 60 flights by default; `FGA_GROUND_FLIGHTS` sets another number.

use alloc::sync::Arc;

use fga::Vec2;
use fga::maneuver::Maneuver;
use fga_campaign::batch::empty_world;
use fga_sim::engine::{DecisionMoment, Engine, Observer};
use fga_sim::policy::PolicyChoice;
use fga_sim::world::{World, WorldGround};

use crate::drawn::{add_intruders, drawn_settings};
use crate::random::Random;

/// Vertical error and clearance, metres.
const ASKED_M: (f64, f64) = (5.0, 20.0);

impl Random {
    /// A valley around the line east with walls from 30 m beside it on, ridges into it, and holes.
    fn valley(&mut self) -> WorldGround {
        let (columns, rows, spacing) = (320, 96, 25.0);
        let corner = Vec2::new(-3000.0, -1200.0);
        let wide = [self.within(30.0, 200.0), self.within(30.0, 200.0)];
        let steep = [self.within(0.2, 3.0), self.within(0.2, 3.0)];
        let floor = self.within(-90.0, -40.0);
        let waves: Vec<[f64; 4]> = (0..6)
            .map(|_| {
                let length = self.within(60.0, 600.0);
                [
                    1.0 / length,
                    self.within(0.0, 6.0),
                    self.within(-40.0, 40.0),
                    self.within(-1.0, 1.0),
                ]
            })
            .collect();
        let mut heights = Vec::new();
        for row in 0..rows {
            for column in 0..columns {
                let at = corner + spacing * Vec2::new(f64::from(column), f64::from(row));
                let side = usize::from(at.y > 0.0);
                let winds: f64 = waves
                    .iter()
                    .map(|[k, phase, high, _]| high * (k * at.x + phase).sin())
                    .sum();
                let rough: f64 = waves
                    .iter()
                    .map(|[k, phase, _, high]| 8.0 * high * (k * (at.x + at.y) + phase).sin())
                    .sum();
                let beyond = (at.y.abs() - wide[side] + 0.3 * winds.min(0.0)).max(0.0);
                // The mission itself clears it.
                let most = if at.y.abs() < 30.0 { -30.0 } else { 300.0 };
                let height = (floor + rough + steep[side] * beyond).min(most);
                let is_hole = self.within(0.0, 1.0) < 0.002 && at.y.abs() > 60.0;
                #[expect(clippy::cast_possible_truncation, reason = "heights of a test")]
                let height = if is_hole { f32::NAN } else { height as f32 };
                heights.push(height);
            }
        }
        WorldGround::new((corner, Vec2::splat(spacing)), 320, heights, ASKED_M).unwrap()
    }
}

/// Whether some decision was not certified, and the commands.
#[derive(Default)]
struct Seen {
    unproven: bool,
    commands: Vec<Maneuver>,
}

impl Observer for Seen {
    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        self.unproven |= moment.decision.record.reason.is_unproven();
        self.commands.push(*moment.decision.command);
    }
}

fn fly(world: &World, policy: &PolicyChoice) -> (Engine, Seen, f64, bool) {
    let (mut engine, mut seen) = (Engine::new(), Seen::default());
    let mut pilot = policy.pilot(&world.settings, &world.vehicle).unwrap();
    let outcome = engine.fly(world, pilot.as_mut(), &mut seen);
    (
        engine,
        seen,
        outcome.min_margin_m,
        outcome.start_s.is_some(),
    )
}

#[test]
fn no_certified_flight_is_lower_than_it_takes_to_clear_the_ground() {
    let flights = std::env::var("FGA_GROUND_FLIGHTS").map_or(60, |text| text.parse().unwrap());
    let needed_m = ASKED_M.0 + ASKED_M.1;
    let (mut into, mut low, mut lost, mut lost_free, mut unproven, mut manoeuvres) =
        (0, 0, 0, 0, 0, 0);
    let mut into_free = 0;
    for number in 0..flights {
        let random = &mut Random(number);
        let settings = drawn_settings(number);
        let mut world = empty_world(&settings).unwrap();
        let ground = Arc::new(random.valley());
        // Without traffic the ground changes nothing.
        let (_, alone, ..) = fly(&world, &settings.policy);
        world.ground = Some(Arc::clone(&ground));
        let (engine, over_ground, ..) = fly(&world, &settings.policy);
        assert!(
            engine.ground_separation().unwrap().least.value_m >= needed_m,
            "{number}"
        );
        assert_eq!(alone.commands, over_ground.commands, "{number}");
        add_intruders(&mut world, &settings, number);
        let (engine, seen, margin_m, has_manoeuvre) = fly(&world, &settings.policy);
        let lowest_m = engine.ground_separation().unwrap().least.value_m;
        manoeuvres += u64::from(has_manoeuvre);
        unproven += u64::from(seen.unproven);
        into += u64::from(lowest_m < 0.0);
        low += u64::from(lowest_m < needed_m);
        lost += u64::from(margin_m < 0.0);
        assert!(
            seen.unproven || lowest_m >= needed_m - 1e-3,
            "{number}: {lowest_m} m"
        );
        // The same ground, of which the policy does not know.
        world.ground = None;
        let mut track = OverGround {
            ground: &ground,
            is_in: false,
        };
        let mut pilot = settings
            .policy
            .pilot(&world.settings, &world.vehicle)
            .unwrap();
        let outcome = Engine::new().fly(&world, pilot.as_mut(), &mut track);
        lost_free += u64::from(outcome.min_margin_m < 0.0);
        into_free += u64::from(track.is_in);
    }
    println!(
        "{flights} flights, {manoeuvres} with a manoeuvre, {unproven} with a decision that is not certified; {into} into the ground, \
         {low} below the clearance, {lost} inside a protected volume; unknown to the policy: {into_free} into the ground, {lost_free} \
         inside a protected volume"
    );
    assert!(
        manoeuvres > flights / 2 && into_free > flights / 100,
        "{manoeuvres} {into_free}"
    );
    assert!(into <= flights / 500, "{into}");
}

/// Whether a flight was below the ground at a decision.
struct OverGround<'a> {
    ground: &'a WorldGround,
    is_in: bool,
}

impl Observer for OverGround<'_> {
    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        let above_m = self.ground.above_m(moment.situation.ownship.position_m);
        self.is_in |= above_m.is_some_and(|above_m| above_m < 0.0);
    }
}
