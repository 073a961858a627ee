//! Intruders with random motions, or with motions chosen against the aircraft.

use fga::Vec3;

use super::setting::{PERIOD_S, RADIUS_M, VEHICLE};

/// `SplitMix64` (Steele, Lea and Flood 2014): the same cases on every machine.
pub(crate) struct SplitMix64(pub(crate) u64);

impl SplitMix64 {
    /// Of a flight with a number, drawn with a seed.
    pub(crate) fn of(seed: u64, number: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9).wrapping_add(number) << 8)
    }

    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn gaussian(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (core::f64::consts::TAU * self.unit()).cos()
    }

    pub(crate) fn gaussian3(&mut self) -> Vec3 {
        Vec3::new(self.gaussian(), self.gaussian(), self.gaussian())
    }
}

/// Time between two rows of a track, seconds.
const ROW_S: f64 = 0.05;

/// Rows of a period.
const ROWS: usize = 2;

/// Time between two choices of a pursuing intruder, seconds.
const CHOOSES_S: f64 = 0.5;

/// A turn with a change of speed and of climb for some time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TurnPiece {
    pub(crate) until_s: f64,
    pub(crate) turn_radps: f64,
    pub acceleration_mps2: f64,
    pub climb_mps2: f64,
}

/// The motion of an intruder.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TrafficLimits {
    pub(crate) speed_mps: (f64, f64),
    pub(crate) climb_mps: f64,
}

/// An intruder: its track, row by row.
#[derive(Debug, Clone)]
pub(crate) struct Intruder {
    rows: Vec<(Vec3, Vec3)>,
    /// Its pieces; after the last one it flies straight.
    pub(crate) pieces: Vec<TurnPiece>,
    limits: TrafficLimits,
    /// Turn rate of the pursuit, radians per second.
    pursues_radps: Option<f64>,
}

impl Intruder {
    pub(crate) fn new(
        position_m: Vec3,
        velocity_mps: Vec3,
        limits: TrafficLimits,
        pieces: Vec<TurnPiece>,
    ) -> Self {
        Self {
            rows: vec![(position_m, velocity_mps)],
            pieces,
            limits,
            pursues_radps: None,
        }
    }

    pub(crate) fn pursuing(self, turn_radps: f64) -> Self {
        Self {
            pursues_radps: Some(turn_radps),
            ..self
        }
    }

    fn moved(&self, row: (Vec3, Vec3), piece: Option<&TurnPiece>) -> (Vec3, Vec3) {
        let (position_m, v) = row;
        let mut next = v;
        if let Some(piece) = piece {
            let speed_mps = v.x.hypot(v.y);
            let (low, high) = self.limits.speed_mps;
            let faster_mps = (speed_mps + piece.acceleration_mps2 * ROW_S).clamp(low, high);
            let course_rad = v.y.atan2(v.x) + piece.turn_radps * ROW_S;
            let most = self.limits.climb_mps;
            let climb_mps = (v.z + piece.climb_mps2 * ROW_S).clamp(-most, most);
            next = Vec3::new(
                faster_mps * course_rad.cos(),
                faster_mps * course_rad.sin(),
                climb_mps,
            );
        }
        (position_m + (v + next) * (0.5 * ROW_S), next)
    }

    /// Decides its motion in the next period from the aircraft's state.
    pub(crate) fn decide(&mut self, time_s: f64, own_m: Vec3, own_mps: Vec3) {
        let choice = (time_s / CHOOSES_S).round() * CHOOSES_S;
        if let Some(rate_radps) = self.pursues_radps
            && (time_s - choice).abs() < 1e-6
        {
            let last = self.rows[self.rows.len() - 1];
            let piece = |turn_radps: f64| TurnPiece {
                until_s: time_s + CHOOSES_S,
                turn_radps,
                acceleration_mps2: 0.0,
                climb_mps2: 0.0,
            };
            let miss_m = |turn_radps: f64| {
                let piece = piece(turn_radps);
                let mut row = last;
                for _ in 0..(CHOOSES_S / ROW_S).round() as u32 {
                    row = self.moved(row, Some(&piece));
                }
                let offset = row.0 - own_m - own_mps * CHOOSES_S;
                let relative = row.1 - own_mps;
                let when_s = -offset.dot(relative) / relative.length_squared().max(1e-9);
                (offset + relative * when_s.max(0.0)).length()
            };
            let turns = [0.0, -rate_radps, rate_radps];
            let best = turns
                .into_iter()
                .min_by(|a, b| miss_m(*a).total_cmp(&miss_m(*b)));
            self.pieces = vec![piece(best.unwrap_or(0.0))];
        }
        for row in 0..ROWS {
            let at_s = time_s + row as f64 * ROW_S;
            let next = self.moved(self.rows[self.rows.len() - 1], self.piece_at(at_s));
            self.rows.push(next);
        }
    }

    fn piece_at(&self, time_s: f64) -> Option<&TurnPiece> {
        self.pieces
            .iter()
            .find(|piece| time_s < piece.until_s - 1e-9)
    }

    /// Position and velocity at a time that it has already flown.
    pub(crate) fn at(&self, time_s: f64) -> (Vec3, Vec3) {
        let row = (time_s / ROW_S).max(0.0);
        let place = (row as usize).min(self.rows.len() - 1);
        let (position_m, velocity_mps) = self.rows[place];
        (
            position_m + velocity_mps * ((row - place as f64) * ROW_S),
            velocity_mps,
        )
    }

    /// Its first position and velocity.
    pub(crate) fn begins(&self) -> (Vec3, Vec3) {
        self.rows[0]
    }

    /// Start times of its pieces.
    pub(crate) fn changes_s(&self) -> impl Iterator<Item = f64> + '_ {
        self.pieces.iter().map(|piece| piece.until_s)
    }

    /// Its future track, row by row from a time on, if its present piece ends as planned and it then flies
    /// straight.
    pub(crate) fn expected_m(&self, from_s: f64, for_s: f64, every: usize) -> Vec<Vec3> {
        let piece = self.piece_at(from_s).copied();
        let mut row = self.at(from_s);
        let count = (for_s / ROW_S).round() as usize;
        let mut places_m = Vec::with_capacity(count / every + 1);
        for k in 0..=count {
            if k % every == 0 {
                places_m.push(row.0);
            }
            let at_s = from_s + k as f64 * ROW_S;
            row = self.moved(row, piece.as_ref().filter(|p| at_s < p.until_s - 1e-9));
        }
        places_m
    }

    /// Flies all its pieces at once.
    pub(crate) fn fly_until(&mut self, until_s: f64) {
        let mut time_s = 0.0;
        while time_s < until_s {
            self.decide(time_s, Vec3::ZERO, Vec3::ZERO);
            time_s += PERIOD_S;
        }
    }
}

/// A start from which an intruder with these pieces meets the aircraft on its mission within the sphere,
/// and begins some way off.
pub(crate) fn meeting(
    random: &mut SplitMix64,
    limits: TrafficLimits,
    meets_s: (f64, f64),
    pieces: &[TurnPiece],
) -> Intruder {
    loop {
        let when_s = (random.within(meets_s.0, meets_s.1) / PERIOD_S).round() * PERIOD_S;
        let speed_mps = random.within(limits.speed_mps.0, limits.speed_mps.1);
        let course_rad = random.within(-core::f64::consts::PI, core::f64::consts::PI);
        let climb_mps = random.within(-1.0, 1.0);
        let velocity = Vec3::new(
            speed_mps * course_rad.cos(),
            speed_mps * course_rad.sin(),
            climb_mps,
        );
        let mut trial = Intruder::new(Vec3::ZERO, velocity, limits, pieces.to_vec());
        trial.fly_until(when_s + 1.0);
        let miss = random.gaussian3() * (0.3 * RADIUS_M);
        let place = Vec3::X * (VEHICLE.airspeed_mps * when_s) + miss - trial.at(when_s).0;
        if place.length() > 4.0 * RADIUS_M {
            return Intruder::new(place, velocity, limits, pieces.to_vec());
        }
    }
}

/// Random pieces up to a time, with turns at some rate at most.
pub(crate) fn pieces(random: &mut SplitMix64, until_s: f64, most_radps: f64) -> Vec<TurnPiece> {
    let mut pieces = Vec::new();
    let mut time_s = random.within(0.0, 4.0);
    pieces.push(TurnPiece {
        until_s: time_s,
        turn_radps: 0.0,
        acceleration_mps2: 0.0,
        climb_mps2: 0.0,
    });
    while time_s < until_s {
        time_s += random.within(2.0, 8.0);
        let straight = random.unit() < 0.25;
        pieces.push(TurnPiece {
            until_s: time_s,
            turn_radps: if straight {
                0.0
            } else {
                random.within(-most_radps, most_radps)
            },
            acceleration_mps2: random.within(-2.0, 2.0),
            climb_mps2: random.within(-0.5, 0.5),
        });
    }
    pieces
}
