//! Reports: what is refused, what is counted, and what the filter makes of them.

use core::ptr::{null, null_mut};

use fga_c::*;

use crate::flight::{Unit, sized, words};

/// Room for two aircraft.
struct Listener {
    storage: Vec<Unit>,
    reports: *mut fga_reports,
    why: fga_refusal,
}

const HERE: fga_enu = fga_enu {
    east: 0.0,
    north: 0.0,
    up: 0.0,
};

impl Listener {
    fn new() -> Self {
        let bytes = fga_reports_size(2);
        let mut listener = Self {
            storage: vec![Unit([0; FGA_ALIGN]); bytes.div_ceil(FGA_ALIGN)],
            reports: null_mut(),
            why: sized(),
        };
        let status = listener.init(FGA_ABI_VERSION, bytes, 2, 20.0);
        assert_eq!(status, fga_status::Ok);
        listener
    }

    fn init(&mut self, version: u32, bytes: usize, most: u32, lifetime_s: f64) -> fga_status {
        let storage = self.storage.as_mut_ptr().cast();
        let (reports, why) = (&raw mut self.reports, &raw mut self.why);
        // SAFETY: right pointers; the storage is not smaller than `bytes` where these suffice.
        unsafe { fga_reports_init(storage, bytes, version, most, lifetime_s, reports, why) }
    }

    fn hear(&mut self, report: &fga_report, now_s: f64) -> fga_status {
        // SAFETY: right pointers.
        unsafe { fga_reports_hear(self.reports, report, now_s, HERE, &raw mut self.why) }
    }

    fn obstacles(&mut self, now_s: f64) -> Vec<fga_obstacle> {
        let (mut obstacles, mut count) = ([sized(); 2], 9);
        let place = obstacles.as_mut_ptr();
        let (count_place, why) = (&raw mut count, &raw mut self.why);
        // SAFETY: right pointers.
        let status = unsafe {
            fga_reports_obstacles(self.reports, now_s, 60.0, 0.0, place, 2, count_place, why)
        };
        assert_eq!(status, fga_status::Ok);
        obstacles[..count as usize].to_vec()
    }

    fn counts(&self) -> [u32; 4] {
        let mut counts: fga_report_counts = sized();
        // SAFETY: right pointers.
        let status = unsafe { fga_reports_counts(self.reports, &raw mut counts) };
        assert_eq!(status, fga_status::Ok);
        [counts.heard, counts.unusable, counts.late, counts.left_out]
    }
}

fn report(id: u32, time_s: f64, east_m: f64) -> fga_report {
    fga_report {
        id,
        movement: fga_movement::Crewed as u32,
        has_velocity: 1,
        time_s,
        position_m: fga_enu {
            east: east_m,
            ..HERE
        },
        velocity_mps: fga_enu { east: 10.0, ..HERE },
        position_sigma_m: 3.0,
        velocity_sigma_mps: 0.5,
        ..sized()
    }
}

#[test]
fn unusable_reports_are_refused_with_their_name_and_counted() {
    type Change = fn(&mut fga_report);
    let rows: [(Change, &str, fga_status); 7] = [
        (|r| r.movement = 5, "movement", fga_status::UnknownValue),
        (|r| r.movement = 0, "movement", fga_status::UnknownValue),
        (|r| r.time_s = 102.0, "time_s", fga_status::OutOfRange),
        (|r| r.time_s = f64::NAN, "time_s", fga_status::OutOfRange),
        (
            |r| r.position_m.up = f64::INFINITY,
            "position_m.up",
            fga_status::OutOfRange,
        ),
        (
            |r| r.velocity_mps.north = f64::NAN,
            "velocity_mps.north",
            fga_status::OutOfRange,
        ),
        (
            |r| r.position_sigma_m = -1.0,
            "position_sigma_m",
            fga_status::OutOfRange,
        ),
    ];
    let mut listener = Listener::new();
    for (change, field, status) in rows {
        let mut wrong = report(1, 100.0, 500.0);
        change(&mut wrong);
        assert_eq!(listener.hear(&wrong, 100.0), status, "{field}");
        assert_eq!(words(&listener.why).0, field);
    }
    assert_eq!(listener.counts(), [7, 7, 0, 0]);
    // A velocity that nobody reads may be anything.
    let mut silent = report(1, 100.0, 500.0);
    (silent.has_velocity, silent.velocity_mps.north) = (0, f64::NAN);
    assert_eq!(listener.hear(&silent, 100.0), fga_status::Ok);
    assert_eq!(listener.obstacles(100.0).len(), 1);
}

#[test]
fn late_reports_and_those_without_room_are_counted() {
    let mut listener = Listener::new();
    assert_eq!(
        listener.hear(&report(1, 100.0, 500.0), 100.0),
        fga_status::Ok
    );
    assert_eq!(
        listener.hear(&report(1, 99.0, 500.0), 100.0),
        fga_status::Ok
    );
    assert_eq!(
        listener.hear(&report(2, 79.0, 500.0), 100.0),
        fga_status::Ok
    );
    assert_eq!(
        listener.hear(&report(2, 100.0, 400.0), 100.0),
        fga_status::Ok
    );
    let far = report(3, 100.0, 600.0);
    assert_eq!(listener.hear(&far, 100.0), fga_status::Incomplete);
    let near = report(4, 100.0, 300.0);
    assert_eq!(listener.hear(&near, 100.0), fga_status::Incomplete);
    assert_eq!(listener.counts(), [6, 0, 2, 2]);
    let ids: Vec<u32> = listener.obstacles(102.0).iter().map(|o| o.id).collect();
    assert_eq!(ids, [4, 2]);
    assert_eq!(listener.obstacles(120.0).len(), 2);
    assert!(listener.obstacles(120.1).is_empty());
}

/// The filter knows the velocity better than each report, and without one in them.
#[test]
fn a_velocity_is_known_better_than_it_is_reported() {
    for has_velocity in [0, 1] {
        let mut listener = Listener::new();
        for second in 0..30 {
            let time_s = f64::from(second);
            // The position is off by 10 m, the velocity by 3 m/s, to one side and the other.
            let side = if second % 2 == 0 { 1.0 } else { -1.0 };
            let mut noisy = report(1, time_s, 2000.0 + 10.0 * time_s + 10.0 * side);
            noisy.velocity_mps.east += 3.0 * side;
            (noisy.position_sigma_m, noisy.velocity_sigma_mps) = (10.0, 3.0);
            noisy.has_velocity = has_velocity;
            assert_eq!(listener.hear(&noisy, time_s), fga_status::Ok);
        }
        let [obstacle] = listener.obstacles(31.0)[..] else {
            panic!("one aircraft");
        };
        assert!((obstacle.velocity_mps.east - 10.0).abs() < 1.0);
        assert!((obstacle.position_m.east - 2310.0).abs() < 10.0);
        assert!(obstacle.velocity_sigma_mps < 2.0 && obstacle.velocity_sigma_mps > 0.1);
        assert_eq!(obstacle.age_s, 2.0);
    }
}

#[test]
fn what_rests_stays_where_it_is_reported() {
    let mut listener = Listener::new();
    let mut mast = report(1, 0.0, 500.0);
    mast.movement = fga_movement::AtRest as u32;
    assert_eq!(listener.hear(&mast, 0.0), fga_status::Ok);
    let [obstacle] = listener.obstacles(1e4)[..] else {
        panic!("one mast");
    };
    assert_eq!((obstacle.position_m.east, obstacle.age_s), (500.0, 0.0));
}

#[test]
fn wrong_storage_versions_and_pointers_are_refused() {
    let mut listener = Listener::new();
    let bytes = fga_reports_size(2);
    assert_eq!(fga_reports_size(FGA_CAPACITY_MOST + 1), 0);
    let refused = [
        (2, bytes, 2, 20.0, fga_status::WrongVersion),
        (
            FGA_ABI_VERSION,
            bytes - 1,
            2,
            20.0,
            fga_status::StorageTooSmall,
        ),
        (
            FGA_ABI_VERSION,
            bytes,
            FGA_CAPACITY_MOST + 1,
            20.0,
            fga_status::TooMany,
        ),
        (FGA_ABI_VERSION, bytes, 2, 0.0, fga_status::OutOfRange),
        (FGA_ABI_VERSION, bytes, 2, f64::NAN, fga_status::OutOfRange),
    ];
    for (version, bytes, most, lifetime_s, status) in refused {
        assert_eq!(listener.init(version, bytes, most, lifetime_s), status);
    }
    let listener = Listener::new();
    let (right, why) = (report(1, 0.0, 1.0), null_mut());
    let (mut obstacle, mut count): (fga_obstacle, u32) = (sized(), 0);
    let (place, count_place) = (&raw mut obstacle, &raw mut count);
    let reports = listener.reports;
    let mut elsewhere = [Unit([0; FGA_ALIGN]); 80];
    let wrong = elsewhere.as_mut_ptr().cast::<fga_reports>();
    let unsized_report = fga_report { size: 1, ..right };
    // SAFETY: each pointer is null or leads to what its type says; what is wrong about the others is found.
    unsafe {
        let hear = |reports, report| fga_reports_hear(reports, report, 0.0, HERE, why);
        assert_eq!(hear(null_mut(), &raw const right), fga_status::Null);
        assert_eq!(hear(reports, null()), fga_status::Null);
        assert_eq!(hear(wrong, &raw const right), fga_status::NotInitialized);
        assert_eq!(
            hear(reports, &raw const unsized_report),
            fga_status::WrongSize
        );
        let within = |place, most, count| {
            fga_reports_obstacles(reports, 0.0, 60.0, 0.0, place, most, count, why)
        };
        assert_eq!(within(null_mut(), 1, count_place), fga_status::Null);
        assert_eq!(within(place, 1, null_mut()), fga_status::Null);
        assert_eq!(within(place, 1, place.cast()), fga_status::Aliased);
        assert_eq!(within(reports.cast(), 1, count_place), fga_status::Aliased);
        assert_eq!(hear(reports, &raw const right), fga_status::Ok);
        assert_eq!(within(place, 0, count_place), fga_status::TooMany);
        assert_eq!(fga_reports_counts(reports, null_mut()), fga_status::Null);
    }
}
