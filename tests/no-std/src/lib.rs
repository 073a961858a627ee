//! The crates `fga` and `fga-paper` linked into a static library without the standard library and without an
//! allocator, as an autopilot would. Each function here keeps one entry of the algorithm alive.
#![no_std]

use core::panic::PanicInfo;

use fga::Vec3;
use fga::avoider::belief::{BeliefAvoider, Errors};
use fga::avoider::{Avoider, Block, Kept, Settings, Start};
use fga::certificate::Hazard;
use fga::pilot::Pilot;
use fga::situation::{Mission, Obstacle, Obstacles, Ownship, ProtectedVolume, Situation};
use fga::vehicle::Vehicle;
use fga_paper::algorithm_4::Plan;
use fga_paper::bounds::HeadingSet;
use fga_paper::conflict::detect;
use fga_paper::dubins::{ClimbLimits, DubinsPath, Pose};
use fga_paper::grid::{Grid, select};
use fga_paper::pilot::{PaperPilot, PaperSettings, Rule};
use fga_paper::timing::{Geometry, Times};


#[panic_handler]
fn stop(_: &PanicInfo<'_>) -> ! {
    loop {}
}

fn ownship(x_m: f64, y_m: f64, course_rad: f64) -> Ownship {
    Ownship {
        position_m: Vec3::new(x_m, y_m, 0.0),
        course_rad,
        climb_rad: 0.0,
        bank_rad: 0.0,
        airspeed_mps: Vehicle::table_4().airspeed_mps,
    }
}

fn hazard(x_m: f64, y_m: f64, radius_m: f64) -> Hazard {
    let volume = ProtectedVolume::Sphere { radius_m };
    Hazard::exact(1, Vec3::new(x_m, y_m, 0.0), Vec3::ZERO, volume)
}

/// Critical time of a static sphere, seconds; infinite where it is no threat.
#[unsafe(no_mangle)]
pub extern "C" fn fga_critical_s(x_m: f64, y_m: f64, radius_m: f64) -> f64 {
    let (own, obstacles) = (ownship(0.0, 0.0, 0.0), [hazard(x_m, y_m, radius_m)]);
    detect(&own, &obstacles, f64::INFINITY)
        .filter_map(|found| Geometry::spatial(&found.relative, radius_m))
        .filter_map(|encounter| Times::of(&encounter, Vehicle::table_4().turn_radius_m, 0.0))
        .map(|times| times.critical_s)
        .fold(f64::INFINITY, f64::min)
}

/// Change of course of Algorithm 2, radians; 0 where nothing must be done.
#[unsafe(no_mangle)]
pub extern "C" fn fga_heading_change_rad(x_m: f64, y_m: f64, radius_m: f64) -> f64 {
    let own = ownship(0.0, 0.0, 0.0);
    select(&Grid::default(), &own, &[hazard(x_m, y_m, radius_m)], 0.0)
        .map_or(0.0, |choice| choice.entry().heading_change_rad)
}

/// Width of the admissible set of courses, radians.
#[unsafe(no_mangle)]
pub extern "C" fn fga_admissible_rad(x_m: f64, y_m: f64, radius_m: f64) -> f64 {
    HeadingSet::of_all(&ownship(0.0, 0.0, 0.0), &[hazard(x_m, y_m, radius_m)]).width_rad()
}

/// Length of the shortest path from the origin along +x to a pose, metres; negative without one.
#[unsafe(no_mangle)]
pub extern "C" fn fga_dubins_length_m(x_m: f64, y_m: f64, course_rad: f64, radius_m: f64) -> f64 {
    let pose = |x, y, course_rad| Pose {
        position_m: Vec3::new(x, y, 0.0),
        course_rad,
    };
    let (start, end) = (pose(0.0, 0.0, 0.0), pose(x_m, y_m, course_rad));
    DubinsPath::shortest(start, end, radius_m, ClimbLimits::LEVEL)
        .map_or(-1.0, |path| path.length_m())
}

/// Largest deviation α of Algorithm 4, radians; negative where no collision is projected.
#[unsafe(no_mangle)]
pub extern "C" fn fga_deviation_rad(x_m: f64, y_m: f64, radius_m: f64, bank_rad: f64) -> f64 {
    let place = Vec3::new(x_m, y_m, 0.0);
    Plan::of(&ownship(0.0, 0.0, 0.0), place, radius_m, bank_rad)
        .map_or(-1.0, |plan| plan.round.away.angle_rad)
}

/// The start of what a pilot commands on a mission along +x with one obstacle ahead, seconds from
/// now; negative where it commands nothing.
fn start_s(pilot: &mut dyn Pilot, x_m: f64, y_m: f64, radius_m: f64) -> f64 {
    let volume = ProtectedVolume::Sphere { radius_m };
    let place = Vec3::new(x_m, y_m, 0.0);
    let decision = pilot.step(&Situation {
        time_s: 0.0,
        ownship: ownship(0.0, 0.0, 0.0),
        obstacles: Obstacles::Rows(&[Obstacle::straight(1, place, Vec3::ZERO, volume)]),
        mission: Mission::new(&[Vec3::ZERO, Vec3::new(1000.0, 0.0, 0.0)]),
        wind_mps: Vec3::ZERO,
    });
    let first = decision.command.stages().first();
    first.map_or(-1.0, |stage| stage.start_s)
}

/// One decision of the avoider.
#[unsafe(no_mangle)]
pub extern "C" fn fga_step_start_s(x_m: f64, y_m: f64, radius_m: f64) -> f64 {
    let Ok(mut avoider) = Avoider::new(Settings::default(), Vehicle::table_4()) else {
        return -1.0;
    };
    start_s(&mut avoider, x_m, y_m, radius_m)
}

/// One decision on beliefs.
#[unsafe(no_mangle)]
pub extern "C" fn fga_belief_start_s(x_m: f64, y_m: f64, radius_m: f64, nac_p: u8) -> f64 {
    let errors = Errors::of_adsb(nac_p, nac_p);
    let Ok(mut avoider) = BeliefAvoider::new(Settings::default(), Vehicle::table_4(), errors) else {
        return -1.0;
    };
    start_s(&mut avoider, x_m, y_m, radius_m)
}

/// One decision among kept obstacles; the number of those looked at.
#[unsafe(no_mangle)]
pub extern "C" fn fga_kept_looked(x_m: f64, y_m: f64, radius_m: f64, id: u32) -> usize {
    let Ok(mut avoider) = Avoider::new(Settings::default(), Vehicle::table_4()) else {
        return 0;
    };
    let mut blocks = [const { Block::EMPTY }; 20];
    let mut kept = Kept::new(&mut blocks);
    let volume = ProtectedVolume::Sphere { radius_m };
    let obstacle = Obstacle::straight(id, Vec3::new(x_m, y_m, 0.0), Vec3::ZERO, volume);
    let put = kept.put(&obstacle, x_m).is_ok();
    let situation = Situation {
        time_s: 0.0,
        ownship: ownship(0.0, 0.0, 0.0),
        obstacles: Obstacles::Rows(&[]),
        mission: Mission::new(&[]),
        wind_mps: Vec3::ZERO,
    };
    avoider.step_kept(&situation, &mut kept);
    let removed = kept.remove(id);
    kept.looked() + usize::from(put) + usize::from(removed)
}

/// One decision by each rule of the paper: the earliest start.
#[unsafe(no_mangle)]
pub extern "C" fn fga_paper_start_s(x_m: f64, y_m: f64, radius_m: f64, score: f64) -> f64 {
    let rules = [
        Rule::Corrected(Start::Score(score)),
        Rule::AsPrinted,
        Rule::Circle,
    ];
    rules.into_iter().fold(f64::INFINITY, |first, rule| {
        match PaperPilot::new(PaperSettings::new(rule), Vehicle::table_4()) {
            Ok(mut pilot) => first.min(start_s(&mut pilot, x_m, y_m, radius_m)),
            Err(_) => first,
        }
    })
}
