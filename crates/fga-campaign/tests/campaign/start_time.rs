//! Waiting is never too long: after any wait of the policy a certified manoeuvre exists.
//!
//! Random encounters fly in closed loop with the latest start and with a share of it. Every waiting
//! cycle certifies the plan again, here and for the whole horizon; an encounter that was certified once
//! stays so until it is over and ends without an entry.

use fga::Vec3;
use fga::assumptions::Assumptions;
use fga::avoider::{Reason, Start, State, Verdict};
use fga::certificate::{Hazard, certify_set};
use fga::meter::Meter;
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::Obstacles;
use fga::vehicle::Vehicle;
use fga_campaign::batch::{BatchSettings, empty_world};
use fga_campaign::encounters::EncounterSource;
use fga_sim::engine::{DecisionMoment, Engine, Observer};
use fga_sim::policy::PolicyChoice;
use fga_sim::track::Track;
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::world::WorldObstacle;

/// Longest prediction, seconds: the policy's own horizon.
const HORIZON_S: f64 = 60.0;

/// Certifies the waiting manoeuvre again.
struct Watch {
    flyer: Flyer,
    path: FlightPath,
    what: String,
    /// Whether a certified manoeuvre existed before any loss.
    certified: bool,
    waits: u32,
    /// First time without a certified manoeuvre.
    lost_s: Option<f64>,
}

impl Watch {
    fn new(vehicle: &Vehicle, what: String) -> Self {
        Self {
            flyer: Flyer::new(vehicle),
            path: FlightPath::new(),
            what,
            certified: false,
            waits: 0,
            lost_s: None,
        }
    }
}

impl Observer for Watch {
    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        let (situation, record) = (moment.situation, &moment.decision.record);
        let chosen = record.chosen.filter(|c| c.verdict == Verdict::Chosen);
        match record.reason {
            Reason::BestAvailable | Reason::InsideVolume => {
                self.lost_s.get_or_insert(moment.time_s);
            }
            _ => self.certified |= chosen.is_some() && self.lost_s.is_none(),
        }
        if moment.decision.state != State::Threatened {
            return;
        }
        self.waits += 1;
        assert!(chosen.is_some(), "{}: waits for nothing", self.what);
        let Obstacles::Rows(rows) = situation.obstacles else {
            panic!("the engine gives rows");
        };
        let hazards: Vec<Hazard> = rows
            .iter()
            .map(|row| Hazard::new(row, Vec3::ZERO, 0.0))
            .collect();
        let now = MotionState::of(&situation.ownship);
        let command = &moment.decision.command;
        self.path.predict(&self.flyer, &now, command, HORIZON_S);
        let certificate = certify_set(
            &self.flyer,
            &self.path,
            &Assumptions::only(&hazards),
            (HORIZON_S, f64::MIN, 1.0),
            &Meter::unlimited(),
        );
        assert!(
            certificate.holds(0.0),
            "{}, {:.1} s: waits for {certificate:?}",
            self.what,
            moment.time_s
        );
    }
}

/// Flies `count` encounters of a cell; returns how many were certified and how often it waited.
fn fly_cell(cell: &str, start: Start, count: u64) -> (u32, u32) {
    let source = EncounterSource::parse(cell, 77).unwrap();
    let mut model = VehicleModel::built_in().unwrap();
    if source.planar {
        (model.vehicle.climb_min_rad, model.vehicle.climb_max_rad) = (0.0, 0.0);
    }
    let settings = BatchSettings {
        model,
        policy: PolicyChoice::Avoider(start),
        horizon_s: HORIZON_S,
        seed: 0,
        tracks: false,
    };
    let mut world = empty_world(&settings).unwrap();
    let mut engine = Engine::new();
    let (mut certified, mut waits) = (0, 0);
    for number in 0..count {
        world.obstacles = source
            .encounter(number)
            .unwrap()
            .obstacles
            .iter()
            .map(|o| {
                let track = Track::straight(o.position_m, o.velocity_mps);
                WorldObstacle::new(o.id, track, o.volume)
            })
            .collect();
        let mut pilot = settings
            .policy
            .pilot(&world.settings, &world.vehicle)
            .unwrap();
        let what = format!("{cell} {start:?} encounter {number}");
        let mut watch = Watch::new(&world.vehicle, what);
        let outcome = engine.fly(&world, pilot.as_mut(), &mut watch);
        if watch.certified {
            certified += 1;
            assert_eq!(watch.lost_s, None, "{}: certified no longer", watch.what);
            assert!(outcome.separated(), "{}: {outcome:?}", watch.what);
        }
        waits += watch.waits;
    }
    (certified, waits)
}

#[test]
fn a_wait_ends_with_a_certified_manoeuvre() {
    for (cell, count) in [
        ("threats:1:100-500:0", 20),
        ("threats:1:100-500:15-30,planar", 20),
        ("threats:2:300:15-30,planar", 15),
        ("threats:3:100-500:0-15", 10),
        ("threats:3:300:45-60,planar", 10),
    ] {
        for start in [Start::Latest, Start::Score(0.6), Start::Free] {
            let (certified, waits) = fly_cell(cell, start, count);
            assert!(
                u64::from(certified) * 10 >= count * 3,
                "{cell}: {certified}"
            );
            assert!(start != Start::Latest || waits > 0, "{cell} never waits");
        }
    }
}
