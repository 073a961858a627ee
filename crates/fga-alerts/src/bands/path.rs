//! The ownship's path during a manoeuvre, and its straight line afterwards.
//!
//! A manoeuvre consists of steps of its quantity: after each step the ownship may fly straight.
//! Source: Narkawicz, Muñoz, Dutle, "Coordination Logic for Repulsive Resolution
//! Maneuvers", and Muñoz et al., "DAIDALUS: Detect and Avoid Alerting Logic for Unmanned
//! Systems", DASC 2015.

use crate::aircraft::State;
use crate::bands::span::{Quantity, Span};
use crate::plane::{Crossing, root};
use crate::settings::Settings;
use alloc::vec::Vec;
use glam::DVec3;

/// A straight line of the ownship from a time on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    /// Start of the line, seconds from now.
    pub(crate) since_s: f64,
    /// Its state on the line, extrapolated back to now.
    pub(crate) state: State,
}

impl Line {
    /// The line of a state at a time.
    #[inline]
    fn at(since_s: f64, position_m: DVec3, velocity_mps: DVec3) -> Self {
        let position_m = if since_s == 0.0 {
            position_m
        } else {
            position_m - velocity_mps * since_s
        };
        Self {
            since_s,
            state: State {
                position_m,
                velocity_mps,
            },
        }
    }
}

/// Standard gravity, m/s².
const GRAVITY_MPS2: f64 = 9.806_65;

/// The lines of ways, as volumes are looked for along them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lines<'a> {
    pub(crate) sides: [&'a [Line]; 2],
    /// Time from one line to the next, seconds; 0 where the lines are no steps of one way.
    pub(crate) step_s: f64,
}

/// Lines step by step, to the low and to the high side; index 0 is the current state.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Fan {
    pub(crate) sides: [Vec<Line>; 2],
    /// Time of one step, seconds; 0 for an instantaneous manoeuvre.
    pub(crate) step_s: f64,
    /// Sines and cosines of the multiples of a step, the same from time to time.
    turns: Turns,
}

/// Sines and cosines of the multiples of an angle.
#[derive(Debug, Clone, PartialEq, Default)]
struct Turns {
    step_rad: f64,
    table: Vec<(f64, f64)>,
}

impl Turns {
    fn fill(&mut self, step_rad: f64, count: usize) {
        if self.step_rad.to_bits() != step_rad.to_bits() {
            self.step_rad = step_rad;
            self.table.clear();
        }
        for k in self.table.len()..=count {
            self.table.push(libm::sincos(k as f64 * step_rad));
        }
    }
}

/// Speed for the computation of turns: a standing aircraft turns nowhere.
fn turning_speed_mps(settings: &Settings, ownship: &State) -> f64 {
    settings
        .horizontal_speed
        .step
        .max(settings.least_airspeed_mps)
        .max(ownship.speed_mps())
}

impl Fan {
    pub(crate) fn lines(&self) -> Lines<'_> {
        let [low, high] = &self.sides;
        Lines {
            sides: [low, high],
            step_s: self.step_s,
        }
    }

    /// The lines of a direction or speed maneuver.
    pub(crate) fn fill(&mut self, range: &Range<'_>) {
        let Range {
            quantity,
            settings,
            ownship,
            span,
            turns_at_once,
        } = *range;
        let instantaneous = quantity.is_instantaneous(settings, turns_at_once);
        self.step_s = if instantaneous {
            0.0
        } else {
            step_s(quantity, settings, ownship)
        };
        let step_s = self.step_s;
        let [low, high] = &mut self.sides;
        low.clear();
        high.clear();
        let steps = span.steps_down.max(span.steps_up);
        if quantity == Quantity::Direction {
            self.turns.fill(span.step, steps);
        }
        let now_mps = ownship.speed_mps();
        let maneuver = Maneuver {
            position_m: ownship.position_m,
            velocity_mps: match quantity {
                Quantity::Direction => {
                    with_speed(ownship, now_mps, turning_speed_mps(settings, ownship))
                }
                _ => ownship.velocity_mps,
            },
            ownship,
            now_mps,
            instantaneous,
        };
        for (lines, count, sign) in [(low, span.steps_down, -1.0), (high, span.steps_up, 1.0)] {
            lines.push(maneuver.unchanged());
            let changes = (1..=count).map(|k| (k as f64 * span.step, step_s * k as f64));
            match quantity {
                Quantity::Direction => {
                    let turns = self.turns.table.iter().skip(1);
                    let changes = changes.zip(turns);
                    lines.extend(
                        changes.map(|((change, t), turn)| maneuver.turns(change, t, *turn, sign)),
                    );
                }
                Quantity::HorizontalSpeed => {
                    let acceleration = settings.horizontal_acceleration_mps2;
                    let ahead = maneuver.ahead();
                    lines.extend(changes.map(|(change, t)| {
                        maneuver.accelerates(sign * change, t, sign * acceleration, ahead)
                    }));
                }
                Quantity::VerticalSpeed => {
                    let acceleration = settings.vertical_acceleration_mps2;
                    lines.extend(
                        changes.map(|(change, t)| {
                            maneuver.climbs(sign * change, t, sign * acceleration)
                        }),
                    );
                }
                Quantity::Altitude => {}
            }
        }
    }
}

/// Time of one step, seconds.
fn step_s(quantity: Quantity, settings: &Settings, ownship: &State) -> f64 {
    match quantity {
        Quantity::Direction => {
            let rate = if settings.turn_rate_radps == 0.0 {
                GRAVITY_MPS2 * libm::tan(settings.bank_rad.min(core::f64::consts::FRAC_PI_2))
                    / turning_speed_mps(settings, ownship)
            } else {
                settings.turn_rate_radps
            };
            settings.direction_step_rad / rate
        }
        Quantity::HorizontalSpeed => {
            settings.horizontal_speed.step / settings.horizontal_acceleration_mps2
        }
        Quantity::VerticalSpeed => {
            settings.vertical_speed.step / settings.vertical_acceleration_mps2
        }
        Quantity::Altitude => 1.0,
    }
}

/// The velocity with another horizontal speed than it has now.
fn with_speed(state: &State, now_mps: f64, speed_mps: f64) -> DVec3 {
    let v = state.velocity_mps;
    if now_mps > 0.0 {
        let factor = speed_mps / now_mps;
        DVec3::new(v.x * factor, v.y * factor, v.z)
    } else {
        // Without a direction, north.
        DVec3::new(0.0, speed_mps, v.z)
    }
}

/// Where a maneuver begins; its lines go to the low and to the high side.
struct Maneuver<'a> {
    position_m: DVec3,
    velocity_mps: DVec3,
    ownship: &'a State,
    now_mps: f64,
    instantaneous: bool,
}

impl Maneuver<'_> {
    fn unchanged(&self) -> Line {
        Line::at(0.0, self.position_m, self.velocity_mps)
    }

    #[inline]
    fn turns(&self, change: f64, t: f64, (sin, cos): (f64, f64), side: f64) -> Line {
        let (s, v) = (self.position_m, self.velocity_mps);
        // Right turns are clockwise from above; a left turn mirrors the sine.
        let sin = sin * side;
        let turned = DVec3::new(v.x * cos + v.y * sin, v.y * cos - v.x * sin, v.z);
        if self.instantaneous {
            return Line::at(0.0, s, turned);
        }
        let rate = change / t * side;
        let position_m = DVec3::new(
            s.x + (v.y - turned.y) / rate,
            s.y + (turned.x - v.x) / rate,
            s.z + v.z * t,
        );
        Line::at(t, position_m, turned)
    }

    /// The direction of flight, without one north.
    fn ahead(&self) -> DVec3 {
        if self.now_mps > 0.0 {
            self.velocity_mps / self.now_mps
        } else {
            DVec3::Y
        }
    }

    #[inline]
    fn accelerates(&self, change: f64, t: f64, acceleration_mps2: f64, ahead: DVec3) -> Line {
        let (s, v, now_mps) = (self.position_m, self.velocity_mps, self.now_mps);
        let faster_mps = now_mps + change;
        if faster_mps < 0.0 {
            // No aircraft flies backwards: the line never meets anything.
            return Line::at(t, s, DVec3::NAN);
        }
        let faster = with_speed(self.ownship, now_mps, faster_mps);
        if self.instantaneous {
            return Line::at(0.0, s, faster);
        }
        let way_m = now_mps * t + 0.5 * acceleration_mps2 * t * t;
        let position_m = DVec3::new(s.x + ahead.x * way_m, s.y + ahead.y * way_m, s.z + v.z * t);
        Line::at(t, position_m, faster)
    }

    #[inline]
    fn climbs(&self, change: f64, t: f64, acceleration_mps2: f64) -> Line {
        let (s, v) = (self.position_m, self.velocity_mps);
        let turned = DVec3::new(v.x, v.y, v.z + change);
        if self.instantaneous {
            return Line::at(0.0, s, turned);
        }
        let climbed_m = v.z * t + 0.5 * acceleration_mps2 * t * t;
        let position_m = DVec3::new(s.x + v.x * t, s.y + v.y * t, s.z + climbed_m);
        Line::at(t, position_m, turned)
    }
}

/// A climb or descent to an altitude: accelerate, hold the rate, level out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LevelChange {
    ownship: State,
    target_m: f64,
    /// First and second acceleration, m/s².
    first_mps2: f64,
    second_mps2: f64,
    /// End of the first acceleration, seconds.
    pub(crate) rate_since_s: f64,
    /// Start of the second one.
    pub(crate) rate_until_s: f64,
    /// Time of arrival at the altitude.
    pub(crate) level_since_s: f64,
}

/// Vertical distance during an acceleration, metres.
fn way_m(climb_mps: f64, acceleration: f64, time_s: f64) -> f64 {
    climb_mps * time_s + 0.5 * acceleration * time_s * time_s
}

/// Vertical distance until a climb has stopped, metres.
fn braking_way_m(climb_mps: f64, acceleration: f64) -> f64 {
    way_m(climb_mps, acceleration, -climb_mps / acceleration)
}

impl LevelChange {
    /// The change to an altitude at the settings' vertical rate and acceleration, both
    /// positive.
    pub(crate) fn to(target_m: f64, settings: &Settings, ownship: &State) -> Self {
        let acceleration = settings.vertical_acceleration_mps2;
        let height_m = ownship.position_m.z;
        let climb_mps = ownship.velocity_mps.z;
        let goes_up = target_m >= height_m;
        let (towards, against) = if goes_up {
            (acceleration, -acceleration)
        } else {
            (-acceleration, acceleration)
        };
        let same_way = (climb_mps >= 0.0) == goes_up
            || crate::almost::Closeness::Rounding.same(climb_mps, 0.0);
        let way_to_go_m = target_m - height_m;
        let mut change = Self {
            ownship: *ownship,
            target_m,
            first_mps2: towards,
            second_mps2: against,
            rate_since_s: 0.0,
            rate_until_s: 0.0,
            level_since_s: 0.0,
        };
        if same_way && way_to_go_m.abs() >= braking_way_m(climb_mps, against).abs() {
            change.plan(settings, height_m, climb_mps, 0.0);
        } else {
            // First the climb stops; then the change starts from rest.
            let stopping = if same_way { against } else { towards };
            let rest_m = height_m + braking_way_m(climb_mps, stopping);
            change.plan(settings, rest_m, 0.0, -climb_mps / stopping);
        }
        change
    }

    /// Fills accelerations and times for a change that begins at a height and climb, later by
    /// `delay_s`.
    fn plan(&mut self, settings: &Settings, height_m: f64, climb_mps: f64, delay_s: f64) {
        let acceleration = settings.vertical_acceleration_mps2;
        let goes_up = self.target_m >= height_m;
        let sign = if goes_up { 1.0 } else { -1.0 };
        let rate_mps = sign * settings.vertical_rate_mps.abs().max(climb_mps.abs());
        let to_go_m = self.target_m - height_m;
        let first = if rate_mps >= climb_mps {
            acceleration
        } else {
            -acceleration
        };
        let second = -sign * acceleration;
        let reached_s = (rate_mps - climb_mps) / first;
        let reached_mps = climb_mps + first * reached_s;
        let accelerating_m = way_m(climb_mps, first, reached_s);
        let braking_m = braking_way_m(reached_mps, second);
        let (since_s, until_s, level_s);
        if to_go_m.abs() >= (accelerating_m + braking_m).abs() {
            let hold_s = (to_go_m - accelerating_m - braking_m) / rate_mps;
            since_s = reached_s;
            until_s = reached_s + hold_s;
            level_s = until_s + -rate_mps / second;
        } else {
            // The rate is out of reach: brake from the peak.
            let ratio = first / second;
            let a = 0.5 * first * (1.0 - ratio);
            let b = climb_mps * (1.0 - ratio);
            let c = -climb_mps * climb_mps / (2.0 * second) - to_go_m;
            let late = root(a, b, c, Crossing::Exit);
            let early = root(a, b, c, Crossing::Entry);
            since_s = match (late, early) {
                (Some(late), Some(early)) if late >= 0.0 && early >= 0.0 => late.min(early),
                (Some(late), _) if late >= 0.0 => late,
                (_, Some(early)) => early,
                _ => f64::NAN,
            };
            until_s = since_s;
            level_s = since_s + -(climb_mps + first * since_s) / second;
        }
        self.first_mps2 = first;
        self.second_mps2 = second;
        self.rate_since_s = delay_s + since_s;
        self.rate_until_s = delay_s + until_s;
        self.level_since_s = delay_s + level_s;
    }

    /// Whether this change, of the same ownship, has the same lines as another until it reaches its rate: there the
    /// line depends only on the first acceleration.
    pub(crate) fn begins_as(&self, other: &Self) -> bool {
        let is_ordered = |change: &Self| {
            change.rate_since_s >= 0.0 && change.rate_since_s <= change.level_since_s
        };
        self.rate_since_s.to_bits() == other.rate_since_s.to_bits()
            && self.first_mps2.to_bits() == other.first_mps2.to_bits()
            && is_ordered(self)
            && is_ordered(other)
    }

    /// The ownship's line at a time.
    pub(crate) fn line_at(&self, time_s: f64) -> Line {
        let (s, v) = (self.ownship.position_m, self.ownship.velocity_mps);
        let (t1, t2, t3) = (self.rate_since_s, self.rate_until_s, self.level_since_s);
        let reached_s = if t1 < 0.0 { 0.0 } else { t3 };
        let (height_m, climb_mps) = if time_s > reached_s {
            (self.target_m, 0.0)
        } else if time_s <= t1 {
            (
                s.z + way_m(v.z, self.first_mps2, time_s),
                v.z + self.first_mps2 * time_s,
            )
        } else {
            let rate_mps = v.z + self.first_mps2 * t1;
            let reached_m = s.z + way_m(v.z, self.first_mps2, t1);
            if time_s <= t2 {
                (reached_m + rate_mps * (time_s - t1), rate_mps)
            } else {
                let braking_s = time_s - t2;
                (
                    reached_m + rate_mps * (t2 - t1) + way_m(rate_mps, self.second_mps2, braking_s),
                    rate_mps + self.second_mps2 * braking_s,
                )
            }
        };
        let position_m = DVec3::new(s.x + v.x * time_s, s.y + v.y * time_s, height_m);
        Line::at(time_s, position_m, DVec3::new(v.x, v.y, climb_mps))
    }

    /// The line of an altitude reached at once.
    pub(crate) fn instantly(target_m: f64, ownship: &State) -> Line {
        let (s, v) = (ownship.position_m, ownship.velocity_mps);
        Line::at(
            0.0,
            DVec3::new(s.x, s.y, target_m),
            DVec3::new(v.x, v.y, 0.0),
        )
    }
}

/// The values of a quantity that an ownship flies to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Range<'a> {
    pub(crate) quantity: Quantity,
    pub(crate) settings: &'a Settings,
    pub(crate) ownship: &'a State,
    pub(crate) span: &'a Span,
    /// Whether turns take no time.
    pub(crate) turns_at_once: bool,
}
