//! Another aircraft.

/// Another aircraft on a separate path.
#[derive(Debug, Clone, Copy)]
pub struct Intruder {
    pub icao: u32,
    /// Position at time 0 of the world, metres.
    pub position_m: [f64; 3],
    /// Velocity at time 0, metres per second.
    pub velocity_mps: [f64; 3],
    /// It turns at this rate (clockwise positive, radians per second) …
    pub turn_rate_radps: f64,
    /// … between these times, seconds.
    pub turn_s: [f64; 2],
    /// Its first report comes at this distance, metres.
    pub shown_m: f64,
}

impl Intruder {
    pub fn straight(icao: u32, position_m: [f64; 3], velocity_mps: [f64; 3]) -> Self {
        Self {
            icao,
            position_m,
            velocity_mps,
            turn_rate_radps: 0.0,
            turn_s: [0.0, 0.0],
            shown_m: f64::INFINITY,
        }
    }

    /// It meets a vehicle of these tests after a minute, a little to one side, and is shown late.
    pub fn head_on() -> Self {
        Self {
            shown_m: 1200.0,
            ..Self::straight(0x00AB_CDEF, [5.0, 3000.0, 100.0], [0.0, -25.0, 0.0])
        }
    }

    pub(super) fn step(&mut self, time_s: f64, by_s: f64) {
        if time_s >= self.turn_s[0] && time_s < self.turn_s[1] {
            let (sin, cos) = (self.turn_rate_radps * by_s).sin_cos();
            let [east, north, _] = self.velocity_mps;
            self.velocity_mps[0] = east * cos + north * sin;
            self.velocity_mps[1] = north * cos - east * sin;
        }
        for (position, rate) in self.position_m.iter_mut().zip(self.velocity_mps) {
            *position += rate * by_s;
        }
    }
}

pub fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt()
}
