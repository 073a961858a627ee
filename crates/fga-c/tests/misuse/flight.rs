//! An avoider in a flight, and right structures to change.

use core::ffi::{CStr, c_char};
use core::ptr::{null, null_mut};

use fga_c::*;

pub(crate) fn size<T>() -> u32 {
    u32::try_from(size_of::<T>()).unwrap()
}

pub(crate) fn text(of: *const c_char) -> String {
    // SAFETY: a text of the library.
    unsafe { CStr::from_ptr(of) }.to_str().unwrap().to_owned()
}

/// A structure with its size; all else is zero.
pub(crate) fn sized<T: Copy>() -> T {
    // SAFETY: all structures of the interface begin with their size, and zeros are values of theirs.
    unsafe {
        let mut value: T = core::mem::zeroed();
        (&raw mut value).cast::<u32>().write(size::<T>());
        value
    }
}

pub(crate) fn vehicle() -> fga_vehicle {
    let mut vehicle = sized();
    // SAFETY: right pointers.
    let status = unsafe { fga_vehicle_from_bank(15.0, 0.7, &raw mut vehicle, null_mut()) };
    assert_eq!(status, fga_status::Ok);
    vehicle
}

pub(crate) fn settings() -> fga_settings {
    let mut settings = sized();
    // SAFETY: right pointers.
    assert_eq!(
        unsafe { fga_settings_default(&raw mut settings) },
        fga_status::Ok
    );
    settings
}

pub(crate) fn words(refusal: &fga_refusal) -> (String, String) {
    (
        text(refusal.field.as_ptr()),
        text(refusal.expected.as_ptr()),
    )
}

/// Storage of units with the alignment that the header asks for.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
pub(crate) struct Unit(pub(crate) [u8; FGA_ALIGN]);

/// An avoider that flies along a leg to the east.
pub(crate) struct Flight {
    pub(crate) storage: Vec<Unit>,
    pub(crate) avoider: *mut fga_avoider,
    pub(crate) why: fga_refusal,
    waypoints_most: u32,
}

impl Flight {
    pub(crate) fn new(obstacles_most: u32) -> Self {
        Self::with_room(obstacles_most, 2)
    }

    pub(crate) fn with_room(obstacles_most: u32, waypoints_most: u32) -> Self {
        let bytes = fga_avoider_size(obstacles_most, waypoints_most);
        let mut flight = Self {
            storage: vec![Unit([0; FGA_ALIGN]); bytes.div_ceil(FGA_ALIGN)],
            avoider: null_mut(),
            why: sized(),
            waypoints_most,
        };
        let status = flight.init(
            FGA_ABI_VERSION,
            bytes,
            obstacles_most,
            &settings(),
            &vehicle(),
        );
        assert_eq!(status, fga_status::Ok);
        let waypoints = [0.0, 1000.0].map(|east| fga_waypoint {
            position_m: fga_enu {
                east,
                north: 0.0,
                up: 100.0,
            },
            passing: fga_passing::FlyBy as u32,
        });
        assert_eq!(
            flight.set_mission(&waypoints, f64::NEG_INFINITY),
            fga_status::Ok
        );
        flight
    }

    pub(crate) fn init(
        &mut self,
        version: u32,
        bytes: usize,
        obstacles_most: u32,
        settings: &fga_settings,
        vehicle: &fga_vehicle,
    ) -> fga_status {
        let storage = self.storage.as_mut_ptr().cast();
        // SAFETY: right pointers.
        unsafe {
            fga_avoider_init(
                storage,
                bytes,
                version,
                obstacles_most,
                self.waypoints_most,
                settings,
                vehicle,
                &raw mut self.avoider,
                &raw mut self.why,
            )
        }
    }

    pub(crate) fn set_mission(&mut self, waypoints: &[fga_waypoint], floor_m: f64) -> fga_status {
        let mission = fga_mission {
            size: size::<fga_mission>(),
            waypoint_count: u32::try_from(waypoints.len()).unwrap(),
            waypoints: waypoints.as_ptr(),
            floor_m,
            ceiling_m: f64::INFINITY,
        };
        // SAFETY: right pointers.
        unsafe { fga_avoider_set_mission(self.avoider, &raw const mission, &raw mut self.why) }
    }

    pub(crate) fn step(
        &mut self,
        time_s: f64,
        obstacles: &[fga_obstacle],
    ) -> (fga_status, fga_decision) {
        self.step_with(&situation(time_s, obstacles))
    }

    pub(crate) fn step_with(&mut self, situation: &fga_situation) -> (fga_status, fga_decision) {
        let mut decision = sized();
        // SAFETY: right pointers.
        let status = unsafe {
            fga_avoider_step(
                self.avoider,
                situation,
                &raw mut decision,
                &raw mut self.why,
            )
        };
        (status, decision)
    }

    pub(crate) fn counts(&self) -> fga_counts {
        let mut counts = sized();
        // SAFETY: right pointers.
        let status = unsafe { fga_avoider_counts(self.avoider, &raw mut counts) };
        assert_eq!(status, fga_status::Ok);
        counts
    }
}

/// The aircraft on its leg, 15 m further each second.
pub(crate) fn situation(time_s: f64, obstacles: &[fga_obstacle]) -> fga_situation {
    fga_situation {
        size: size::<fga_situation>(),
        obstacle_count: u32::try_from(obstacles.len()).unwrap(),
        obstacles: obstacles.as_ptr(),
        time_s,
        ownship: fga_ownship {
            position_m: fga_enu {
                east: 15.0 * time_s,
                north: 0.0,
                up: 100.0,
            },
            course_from_east_rad: 0.0,
            climb_rad: 0.0,
            bank_left_rad: 0.0,
            airspeed_mps: 15.0,
        },
        wind_mps: fga_enu {
            east: 0.0,
            north: 0.0,
            up: 0.0,
        },
        zone_count: 0,
        zones: null(),
        ground: null(),
    }
}

pub(crate) fn mast(id: u32, east: f64, north: f64) -> fga_obstacle {
    fga_obstacle {
        id,
        position_m: fga_enu {
            east,
            north,
            up: 100.0,
        },
        volume: fga_volume::Sphere as u32,
        movement: fga_movement::AtRest as u32,
        radius_m: 30.0,
        ..sized()
    }
}
