//! Zones and ground of a situation: what they change, and what is refused.

use core::ptr::null;

use fga_c::*;

use crate::Change;
use crate::flight::{Flight, Unit, mast, situation, size, sized, vehicle, words};

/// A zone to keep out of beside the leg: to the left, or to the right.
fn beside(left: bool) -> [fga_place; 4] {
    let far_m = if left { 400.0 } else { -400.0 };
    [(20.0, 0.02), (900.0, 0.02), (900.0, 1.0), (20.0, 1.0)].map(|(east_m, share)| fga_place {
        east_m,
        north_m: far_m * share,
    })
}

fn zone(corners: &[fga_place]) -> fga_zone {
    fga_zone {
        kind: fga_zone_kind::KeepOut as u32,
        corner_count: u32::try_from(corners.len()).unwrap(),
        corners: corners.as_ptr(),
        center: fga_place {
            east_m: 0.0,
            north_m: 0.0,
        },
        radius_m: 0.0,
        floor_m: f64::NEG_INFINITY,
        ceiling_m: f64::INFINITY,
    }
}

/// Heights of a square of 4 km around the start, 50 m apart, with their peaks: high on one side of the leg.
fn heights(left: bool) -> (Vec<f32>, Vec<f32>) {
    let is_high = |row: i32| if left { row > 40 } else { row < 40 };
    let rows = (0..81).flat_map(|row| vec![if is_high(row) { 300.0 } else { -100.0 }; 81]);
    let heights_m: Vec<f32> = rows.collect();
    let mut peaks_m = vec![0.0; fga_ground_peak_count(81, 81) as usize];
    // SAFETY: right pointers.
    let filled = unsafe { fga_ground_fill_peaks(81, 81, heights_m.as_ptr(), peaks_m.as_mut_ptr()) };
    assert_eq!(filled, fga_status::Ok);
    (heights_m, peaks_m)
}

fn ground((heights_m, peaks_m): &(Vec<f32>, Vec<f32>)) -> fga_ground {
    let place = |metres| fga_place {
        east_m: metres,
        north_m: metres,
    };
    fga_ground {
        size: size::<fga_ground>(),
        columns: 81,
        rows: 81,
        corner: place(-2000.0),
        spacing: place(50.0),
        heights_m: heights_m.as_ptr(),
        peaks_m: peaks_m.as_ptr(),
        error_m: 5.0,
        clearance_m: 20.0,
    }
}

/// To which side of a mast ahead the aircraft turns, positive to the left, and whether that is certified.
fn side(zones: &[fga_zone], ground: *const fga_ground) -> (f64, bool) {
    let masts = [mast(7, 200.0, 0.0)];
    let mut now = situation(0.0, &masts);
    now.zone_count = u32::try_from(zones.len()).unwrap();
    now.zones = zones.as_ptr();
    now.ground = ground;
    let (status, decision) = Flight::new(2).step_with(&now);
    assert_eq!(status, fga_status::Ok);
    assert!(decision.stage_count > 0);
    let certified = decision.has & FGA_HAS_CERTIFICATE != 0;
    (decision.stages[0].course_from_east_rad.sin(), certified)
}

#[test]
fn zones_and_ground_turn_a_manoeuvre_to_the_other_side() {
    for left in [true, false] {
        let away = if left { -1.0 } else { 1.0 };
        let corners = beside(left);
        let (turn, certified) = side(&[zone(&corners)], null());
        assert!(certified && turn * away > 0.0, "{left} {turn}");
        let lent = heights(left);
        let (turn, certified) = side(&[], &ground(&lent));
        assert!(certified && turn * away > 0.0, "{left} {turn}");
    }
}

#[test]
fn a_certificate_covers_zones_and_ground() {
    let mut storage = vec![Unit([0; FGA_ALIGN]); FGA_PROVER_BYTES.div_ceil(FGA_ALIGN)];
    let mut prover = core::ptr::null_mut();
    let mut why: fga_refusal = sized();
    // SAFETY: right pointers.
    let status = unsafe {
        fga_prover_init(
            storage.as_mut_ptr().cast(),
            FGA_PROVER_BYTES,
            FGA_ABI_VERSION,
            &vehicle(),
            &raw mut prover,
            &raw mut why,
        )
    };
    assert_eq!(status, fga_status::Ok);
    let question = fga_question {
        size: size::<fga_question>(),
        work_limit: 100_000,
        horizon_s: 20.0,
        target_m: 3.0,
        confidence_sigmas: 2.0,
    };
    let mut ask = |zones: &[fga_zone], ground: *const fga_ground| {
        let mut now = situation(0.0, &[]);
        now.zone_count = u32::try_from(zones.len()).unwrap();
        (now.zones, now.ground) = (zones.as_ptr(), ground);
        let mut certificate: fga_certificate = sized();
        // SAFETY: right pointers. No stages: the aircraft flies straight on.
        let status = unsafe {
            let (now, asked) = (&raw const now, &raw const question);
            fga_certify(
                prover,
                now,
                null(),
                0,
                asked,
                &raw mut certificate,
                &raw mut why,
            )
        };
        assert_eq!(status, fga_status::Ok);
        certificate
    };
    assert_eq!(ask(&[], null()).verdict, fga_verdict::Proven);
    // 8 m beside the way: 3 m are kept, over 8 m not asked.
    let corners = beside(true);
    assert_eq!(ask(&[zone(&corners)], null()).verdict, fga_verdict::Proven);
    let mut across = zone(&corners);
    (across.corner_count, across.radius_m) = (0, 50.0);
    across.center.east_m = 200.0;
    let found = ask(&[across], null());
    assert_eq!(found.verdict, fga_verdict::BelowTarget);
    assert!(found.margin_m < 0.0 && found.obstacle_id == 0);
    // 100 m above ground that rises to 300 m beyond the next post, 50 m beside the way; then a wall across it.
    let mut lent = heights(true);
    assert_eq!(ask(&[], &ground(&lent)).verdict, fga_verdict::Proven);
    lent.0
        .iter_mut()
        .skip(44)
        .step_by(81)
        .for_each(|post| *post = 300.0);
    // SAFETY: right pointers.
    let filled = unsafe { fga_ground_fill_peaks(81, 81, lent.0.as_ptr(), lent.1.as_mut_ptr()) };
    assert_eq!(filled, fga_status::Ok);
    let wall = ask(&[], &ground(&lent));
    assert_eq!(wall.verdict, fga_verdict::BelowTarget);
    assert!(wall.margin_m < 0.0);
}

#[test]
fn wrong_zones_and_a_wrong_ground_are_refused_with_their_names() {
    let corners = beside(true);
    let changes: [(Change<fga_zone>, &str, fga_status); 6] = [
        (|zone| zone.kind = 2, "kind", fga_status::UnknownValue),
        (
            |zone| zone.floor_m = f64::NAN,
            "floor_m",
            fga_status::OutOfRange,
        ),
        (
            |zone| zone.corner_count = 2,
            "corner_count",
            fga_status::OutOfRange,
        ),
        (
            |zone| zone.corner_count = 257,
            "corner_count",
            fga_status::OutOfRange,
        ),
        (
            |zone| zone.corner_count = 0,
            "radius_m",
            fga_status::OutOfRange,
        ),
        (|zone| zone.corners = null(), "", fga_status::Null),
    ];
    let lent = heights(true);
    let grounds: [(Change<fga_ground>, &str, fga_status); 8] = [
        (|ground| ground.size = 3, "", fga_status::WrongSize),
        (
            |ground| ground.columns = 1,
            "columns",
            fga_status::OutOfRange,
        ),
        (
            |ground| ground.rows = 40_000,
            "rows",
            fga_status::OutOfRange,
        ),
        (
            |ground| ground.spacing.east_m = 0.0,
            "spacing",
            fga_status::OutOfRange,
        ),
        (
            |ground| ground.corner.north_m = f64::NAN,
            "corner",
            fga_status::OutOfRange,
        ),
        (
            |ground| ground.clearance_m = -1.0,
            "clearance_m",
            fga_status::OutOfRange,
        ),
        (
            |ground| ground.error_m = f64::INFINITY,
            "error_m",
            fga_status::OutOfRange,
        ),
        (|ground| ground.heights_m = null(), "", fga_status::Null),
    ];
    let refused = |zones: &[fga_zone], ground: *const fga_ground, named: &str, expected| {
        let mut flight = Flight::new(2);
        let mut now = situation(0.0, &[]);
        now.zone_count = u32::try_from(zones.len()).unwrap();
        (now.zones, now.ground) = (zones.as_ptr(), ground);
        assert_eq!(flight.step_with(&now).0, expected, "{named}");
        assert_eq!(words(&flight.why).0, named);
    };
    for (change, named, expected) in changes {
        let mut wrong = zone(&corners);
        change(&mut wrong);
        refused(&[wrong], null(), named, expected);
    }
    for (change, named, expected) in grounds {
        let mut wrong = ground(&lent);
        change(&mut wrong);
        refused(&[], &raw const wrong, named, expected);
    }
    let many = [zone(&corners); FGA_ZONES_MOST + 1];
    refused(&many, null(), "zone_count", fga_status::TooMany);
    assert_eq!(fga_ground_peak_count(1, 5), 0);
}
