use super::*;
use crate::situation::Ownship;

/// At the origin, along x, among some obstacles, without a mission.
fn among(rows: &[Obstacle]) -> Situation<'_> {
    Situation {
        time_s: 0.0,
        ownship: Ownship {
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: 20.0,
        },
        obstacles: Obstacles::Rows(rows),
        mission: Mission::NONE,
        wind_mps: Vec3::ZERO,
    }
}

/// In an earlier version some of more than sixty aircraft had no hazard at all.
#[test]
fn each_of_many_aircraft_keeps_a_hazard() {
    let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
    for count in [1_u32, 6, 7, 50, 62, 64, 107, 108, 126] {
        let rows: alloc::vec::Vec<Obstacle> = (0..count)
            .map(|id| Obstacle {
                movement: Movement::CREWED,
                // Pairs at one distance.
                ..Obstacle::straight(
                    id,
                    Vec3::new(300.0 + f64::from(id / 2), 0.0, 0.0),
                    Vec3::new(-40.0, 0.0, 0.0),
                    volume,
                )
            })
            .collect();
        let situation = among(&rows);
        let mut tracks = Tracks::new();
        tracks.load(&situation, f64::INFINITY, 60.0, 3.0);
        let exact = Clearance {
            beyond_m: 0.0,
            margin_m: 0.0,
            is_unproven: false,
        };
        let meter = Meter::unlimited();
        tracks.withstand(&|_| Freedom::Share(1.0, 0.0), exact, &meter);
        for id in 0..count {
            let has = tracks.rows().iter().any(|hazard| hazard.id() == id);
            assert!(has, "{id} of {count}");
        }
        // The nearest may turn.
        let of_first = tracks.rows().iter().filter(|h| h.id() == 0);
        assert!(of_first.count() > 2 || count > 107, "{count}");
    }
}

/// Limits of altitude without room would be no limits.
#[test]
fn obstacles_leave_room_to_the_limits_of_altitude() {
    let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
    let obstacle = |id| Obstacle::straight(id, Vec3::X * 300.0, -Vec3::X, volume);
    let rows = [1, 2, 3, 4, 5, 6, 7, 8, 9].map(obstacle);
    let situation = among(&rows);
    let (known, hazards) = (&mut [Known::NONE; 3 + LIMITS], &mut [Hazard::NONE; 5]);
    let mut tracks = Tracks::within((known.as_mut(), hazards.as_mut()));
    for _ in 0..2 {
        tracks.load(&situation, f64::INFINITY, 60.0, 3.0);
        tracks.stay_between([-50.0, 50.0]);
        assert!(tracks.overflow);
        let flat = tracks
            .rows()
            .iter()
            .map(|row| row.volume.radius_m() == FLAT_M);
        assert!(flat.eq([false, false, false, true, true]));
    }
}
