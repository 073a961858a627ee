//! What the vehicle flies by.

use crate::plant::VehiclePlant;

/// The state of AUTO, CRUISE and fly-by-wire.
#[derive(Debug, Default)]
pub(crate) struct GuidedTarget {
    pub(crate) item: u16,
    pub(crate) previous_m: [f64; 3],
    pub(crate) done: bool,
    pub(crate) crosstrack: bool,
    /// Start of the circles at the present item, seconds.
    pub(crate) circling_since_s: Option<f64>,
    /// The jumps made.
    pub(crate) jumps: Vec<u16>,
    /// An item before the present one, set outside of AUTO: it runs first when AUTO begins.
    pub(crate) resume_at: Option<u16>,
    /// The items without a place that ran, and when, seconds.
    pub(crate) ran: Vec<(f64, u16)>,
    pub(crate) stick_altitude_m: f64,
    pub(crate) locked_heading_rad: Option<f64>,
    pub(crate) line_from_m: [f64; 3],
    pub(crate) centred_since_s: Option<f64>,
}

impl GuidedTarget {
    /// Begins to fly to an item: along the leg, or from the aircraft's position.
    pub(crate) fn begin_item(&mut self, item: u16, plant: &VehiclePlant, along_leg: bool) {
        self.item = item;
        self.resume_at = None;
        self.circling_since_s = None;
        self.crosstrack = true;
        if !along_leg {
            self.previous_m = plant.position_m();
        }
    }

    pub(crate) fn enter_stick_mode(&mut self, plant: &VehiclePlant) {
        self.stick_altitude_m = plant.position_m()[2];
        self.locked_heading_rad = None;
        self.centred_since_s = None;
    }
}

/// Targets of GUIDED and their times.
#[derive(Debug, Default)]
pub(crate) struct Guided {
    pub(crate) point_m: [f64; 3],
    pub(crate) altitude_m: f64,
    pub(crate) bank: Option<(f64, f64)>,
    pub(crate) pitch: Option<(f64, f64)>,
    pub(crate) heading: Option<HeadingTarget>,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct HeadingTarget {
    pub(crate) heading_rad: f64,
    pub(crate) is_course: bool,
    pub(crate) acceleration_mps2: f64,
}

impl Guided {
    pub(crate) fn at(plant: &VehiclePlant, _time_s: f64) -> Self {
        let point_m = plant.position_m();
        Self {
            point_m,
            altitude_m: point_m[2],
            ..Self::default()
        }
    }
}

/// `RC_CHANNELS_OVERRIDE`: value and time, by channel.
#[derive(Debug, Default)]
pub(crate) struct RcOverrides(pub(crate) [Option<(u16, f64)>; 8]);

impl RcOverrides {
    pub(crate) fn channel(&self, number: usize, time_s: f64, lifetime_s: f64) -> Option<u16> {
        let (value, heard_s) = (*self.0.get(number - 1)?)?;
        (time_s - heard_s <= lifetime_s).then_some(value)
    }
}
