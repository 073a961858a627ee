//! A head-on, step by step, as the pilot sees it.
//!
//! An aircraft flies east along its leg at 15 m/s. Another one comes head-on at 20 m/s. Each tenth of a
//! second the avoider takes the situation and gives a decision; the aircraft flies it. Whenever a decision says something
//! new, this program prints it as a pilot would say it.
//!
//! `cargo run --release -p fga --example head_on`

use fga::Vec3;
use fga::avoider::{Avoider, Reason, Settings, State};
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::{Mission, Obstacle, Obstacles, Ownship, ProtectedVolume, Situation};
use fga::vehicle::Vehicle;

fn main() -> Result<(), fga::avoider::SettingsError> {
    // The aircraft: 15 m/s, turns of 30 m, climbs and descents of 15 degrees.
    let vehicle = Vehicle::table_4();
    let flyer = Flyer::new(&vehicle);
    let mut path = FlightPath::new();
    let mut avoider = Avoider::new(Settings::default(), vehicle)?;

    // Its mission: one leg to the east, 100 m up. x is east, y north, z up, in metres.
    let waypoints_m = [Vec3::new(0.0, 0.0, 100.0), Vec3::new(1500.0, 0.0, 100.0)];
    let mut ownship = Ownship {
        position_m: waypoints_m[0],
        course_rad: 0.0,
        climb_rad: 0.0,
        bank_rad: 0.0,
        airspeed_mps: vehicle.airspeed_mps,
    };

    // The intruder, with a protected sphere of 30 m around it.
    let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
    let mut intruder = Obstacle::straight(
        7,
        Vec3::new(900.0, 0.0, 100.0),
        Vec3::new(-20.0, 0.0, 0.0),
        volume,
    );

    let period_s = 0.1;
    let mut said = None;
    let mut least_m = f64::INFINITY;
    for step in 0..900 {
        let time_s = f64::from(step) * period_s;
        let obstacles = [intruder];
        let decision = avoider.step(&Situation {
            time_s,
            ownship,
            obstacles: Obstacles::Rows(&obstacles),
            mission: Mission::new(&waypoints_m),
            wind_mps: Vec3::ZERO,
        });

        let distance_m = ownship.position_m.distance(intruder.position_m);
        least_m = least_m.min(distance_m);
        let news = (decision.state, decision.record.reason);
        let repeats =
            said == Some(news) || matches!(news.1, Reason::ManeuverKept | Reason::RejoinKept);
        if !repeats {
            let sees = match decision.state {
                State::Cruise => "on the leg".to_owned(),
                State::Threatened => format!(
                    "traffic at 12 o'clock, {distance_m:.0} m, a turn is ready and waits {:.1} s",
                    decision.record.start_s.unwrap_or(0.0)
                ),
                State::Avoiding => {
                    let turn_rad = decision
                        .command
                        .stages()
                        .first()
                        .map_or(0.0, |stage| stage.course_rad - ownship.course_rad);
                    format!(
                        "traffic {distance_m:.0} m, turning {:.0} degrees {}, {:.2} m to spare",
                        turn_rad.abs().to_degrees(),
                        if turn_rad > 0.0 { "left" } else { "right" },
                        decision.record.chosen.map_or(0.0, |chosen| chosen.margin_m)
                    )
                }
                State::Recovering => "clear of traffic, back to the leg".to_owned(),
            };
            println!("{time_s:5.1} s  {sees}");
            said = Some(news);
        }

        // The aircraft flies the command for one period; the intruder flies on.
        let now = MotionState::of(&ownship);
        path.predict(&flyer, &now, &decision.command, 2.0 * period_s);
        let next = path.state_at(&flyer, period_s).unwrap_or(now);
        ownship = Ownship {
            position_m: next.position_m,
            course_rad: next.course_rad,
            climb_rad: next.climb_rad,
            bank_rad: next.bank_rad,
            ..ownship
        };
        intruder.position_m += intruder.velocity_mps * period_s;
    }
    println!(
        "closest: {least_m:.1} m between the centres, 30 m are protected; {:.1} m beside the leg at the end",
        ownship.position_m.y.abs()
    );
    Ok(())
}
