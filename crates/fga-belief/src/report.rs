//! Reports of an aircraft, and their errors.

use fga_proof::Vec3;

/// Where a σ comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Source {
    /// The report itself, as by `NACp` and `NACv` of ADS-B.
    Report,
    /// The file of the sensor.
    Sensor,
    /// A standard that every such sensor keeps.
    Standard,
    /// Nobody said: a default.
    #[default]
    Assumed,
}

/// A standard deviation along one axis, and who said it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sigma {
    /// The standard deviation, in the unit of the field that has it.
    pub value: f32,
    /// Where it comes from.
    pub source: Source,
}

impl Sigma {
    /// A standard deviation and who said it.
    pub const fn new(value: f32, source: Source) -> Self {
        Self { value, source }
    }

    /// Its variance, at least that of `floor`.
    pub(crate) fn variance(self, floor: f32) -> f32 {
        let sigma = self.value.max(floor);
        sigma * sigma
    }
}

/// The errors of a report: those of each report by itself, and those that last from report to report.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    /// Of the horizontal position, metres.
    pub position_m: Sigma,
    /// Of the altitude, metres.
    pub altitude_m: Sigma,
    /// Of the horizontal velocity, metres per second.
    pub velocity_mps: Sigma,
    /// Of the climb rate, metres per second.
    pub climb_mps: Sigma,
    /// The lasting error of the horizontal position, metres.
    pub lasting_position_m: Sigma,
    /// The lasting error of the altitude, metres, as of pressure altitude.
    pub lasting_altitude_m: Sigma,
}

impl Errors {
    /// The errors that an ADS-B report states, by `NACp` and `NACv` (RTCA DO-260B, tables 2-69 and 2-21: bounds of 95 in
    /// 100 cases, σ = bound / 2.45 in the plane), and those of pressure altitude (14 CFR 91.217: 125 ft in 95 of 100 cases,
    /// lasting; steps of 25 ft). A category without a bound counts as the worst with one.
    pub fn of_adsb(nac_p: u8, nac_v: u8) -> Self {
        let position_m = match nac_p {
            11.. => 3.0,
            10 => 10.0,
            9 => 30.0,
            8 => 92.6,
            7 => 185.2,
            6 => 555.6,
            5 => 926.0,
            4 => 1852.0,
            3 => 3704.0,
            2 => 7408.0,
            0 | 1 => 18_520.0,
        };
        let velocity_mps = match nac_v {
            4.. => 0.3,
            3 => 1.0,
            2 => 3.0,
            0 | 1 => 10.0,
        };
        let reported = |bound: f32| Sigma::new(bound / 2.448, Source::Report);
        Self {
            position_m: reported(position_m),
            altitude_m: Sigma::new(2.2, Source::Standard),
            velocity_mps: reported(velocity_mps),
            climb_mps: reported(velocity_mps),
            lasting_position_m: Sigma::default(),
            lasting_altitude_m: Sigma::new(19.4, Source::Standard),
        }
    }

    /// Every σ.
    const fn all(&self) -> [Sigma; 6] {
        [
            self.position_m,
            self.altitude_m,
            self.velocity_mps,
            self.climb_mps,
            self.lasting_position_m,
            self.lasting_altitude_m,
        ]
    }

    /// Whether every σ is a finite number, none negative.
    pub fn is_valid(&self) -> bool {
        let mut all = self.all().into_iter();
        all.all(|sigma| sigma.value.is_finite() && sigma.value >= 0.0)
    }

    /// Whether the reports have no errors at all.
    pub fn is_exact(&self) -> bool {
        self.all().into_iter().all(|sigma| sigma.value == 0.0)
    }
}

/// A report of an aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// The time at which it holds, seconds; its delay is the time since then.
    pub time_s: f64,
    /// Position, metres.
    pub position_m: Vec3,
    /// Velocity over the ground, metres per second, if it is known.
    pub velocity_mps: Option<Vec3>,
    /// For how long the position was carried on along the velocity, from the time at which it holds, seconds.
    pub carried_s: f32,
    /// Its errors.
    pub errors: Errors,
}

impl Report {
    /// Whether every number is finite, and no error is negative.
    pub fn is_valid(&self) -> bool {
        self.time_s.is_finite()
            && self.position_m.is_finite()
            && self.velocity_mps.is_none_or(Vec3::is_finite)
            && self.carried_s.is_finite()
            && self.carried_s >= 0.0
            && self.errors.is_valid()
    }
}
