//! The path of a manoeuvre: nodes on the predicted flight, close enough for tight chords.

use core::iter::Peekable;
use core::slice::Iter;

use crate::Vec3;
use crate::limit::whole;
use crate::list::List;
use crate::maneuver::{Maneuver, Stage};
use crate::meter::{Meter, SETUP};
use crate::prediction::drift::DriftBounds;
use crate::prediction::{Flyer, MotionState, Piece};

/// Most nodes of a path: a slow turn round and its rolls, twice over. A flight that needs more is not proven.
pub const MAX_NODES: usize = 192;

/// Largest bow of the path from the chord between two nodes, metres.
///
/// The certificate subtracts this bow and splits the chords that matter, so it sets speed, not truth.
pub const CHORD_BOW_M: f64 = 0.16;

/// A moment of the predicted flight and the constant rates until the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// The aircraft.
    pub state: MotionState,
    /// Course rate from here on, radians per second.
    pub course_rate_radps: f64,
    /// Slope of the course rate from here on, radians per second squared.
    pub course_growth_radps2: f64,
    /// Slope of that slope until the next node, radians per second cubed.
    pub course_curve_radps3: f64,
    /// Rate of the climb angle from here to the next node, radians per second.
    pub climb_rate_radps: f64,
    /// Bound of the acceleration from here to the next node, metres per second squared.
    pub acceleration_mps2: f64,
}

impl Node {
    /// The node from which the aircraft flies straight on.
    const fn straight(state: MotionState) -> Self {
        Self {
            state,
            course_rate_radps: 0.0,
            course_growth_radps2: 0.0,
            course_curve_radps3: 0.0,
            climb_rate_radps: 0.0,
            acceleration_mps2: 0.0,
        }
    }

    /// The piece of flight from here to the next node.
    pub(crate) const fn piece(&self) -> Piece {
        let (turning, climbing) = (self.course_rate_radps, self.climb_rate_radps);
        Piece {
            course_growth_radps2: self.course_growth_radps2,
            course_curve_radps3: self.course_curve_radps3,
            ..Piece::steady(f64::INFINITY, turning, climbing, self.state.bank_rad)
        }
    }

    /// The node `after_s` seconds into a piece, at a state.
    fn on(flyer: &Flyer, state: &MotionState, piece: &Piece, after_s: f64) -> Self {
        let curve = piece.course_curve_radps3;
        let growth = piece.course_growth_radps2 + 0.5 * curve * after_s;
        Self {
            state: *state,
            course_rate_radps: piece.course_rate_radps + growth * after_s,
            course_growth_radps2: piece.course_growth_radps2 + curve * after_s,
            course_curve_radps3: curve,
            climb_rate_radps: piece.climb_rate_radps,
            acceleration_mps2: flyer.acceleration_mps2(piece),
        }
    }
}

/// The number of chords on which a flight of a duration, seconds, bows no more than [`CHORD_BOW_M`], from 1 to `most`.
fn chords(acceleration_mps2: f64, duration_s: f64, most: usize) -> usize {
    let bows = acceleration_mps2 * duration_s * duration_s / (8.0 * CHORD_BOW_M);
    if bows > 1.0 {
        whole(libm::sqrt(bows), most)
    } else {
        1
    }
}

/// The pieces of constant rates of a manoeuvre's flight.
struct Pieces<'a> {
    flyer: &'a Flyer,
    stages: Peekable<Iter<'a, Stage>>,
    command: Stage,
}

impl<'a> Pieces<'a> {
    fn new(flyer: &'a Flyer, start: &MotionState, stages: &'a [Stage]) -> Self {
        Self {
            flyer,
            stages: stages.iter().peekable(),
            command: Stage::turn(0.0, start.course_rad, start.climb_rad),
        }
    }

    /// The piece that begins at a state, its duration, seconds (infinite for the last one),
    /// and its latest end: at the next command, or at `limit_s`.
    fn next(&mut self, state: &MotionState, limit_s: f64) -> (Piece, f64, f64) {
        while let Some(stage) = self.stages.next_if(|stage| stage.start_s <= state.time_s) {
            self.command = *stage;
        }
        let next_s = self.stages.peek().map_or(f64::INFINITY, |s| s.start_s);
        let until_s = next_s.min(limit_s);
        let left_s = until_s - state.time_s;
        let piece = self.flyer.next_piece(state, &self.command, left_s);
        (piece, piece.duration_s.min(left_s), until_s)
    }
}

/// The aircraft at the end of the flight of some stages up to `limit_s`, with its pieces counted; before it if the meter refuses
/// one. Without a limit, where its last piece begins.
#[inline(never)]
pub fn flown(
    flyer: &Flyer,
    start: &MotionState,
    stages: &[Stage],
    limit_s: f64,
    meter: &Meter,
) -> MotionState {
    let work = flyer.piece_work();
    let mut state = *start;
    let mut pieces = Pieces::new(flyer, start, stages);
    for _ in 0..MAX_NODES {
        if state.time_s >= limit_s {
            break;
        }
        let (piece, duration_s, until_s) = pieces.next(&state, limit_s);
        if !meter.take(work) || duration_s == f64::INFINITY {
            break;
        }
        let ends = duration_s >= until_s - state.time_s;
        state = flyer.advance(&state, &piece, duration_s);
        if ends {
            state.time_s = until_s;
        }
    }
    state
}

/// A predicted flight: nodes in time, then straight on from the last one.
#[derive(Debug, Clone)]
pub struct FlightPath {
    nodes: List<Node, MAX_NODES>,
    end_velocity_mps: Vec3,
    complete: bool,
    remainder_m: f64,
}

impl Default for FlightPath {
    fn default() -> Self {
        Self::new()
    }
}

impl FlightPath {
    /// A path without nodes, for [`Self::predict`]. It is large: keep and reuse it.
    pub const fn new() -> Self {
        Self {
            nodes: List::new(Node::straight(MotionState::ahead(0.0))),
            end_velocity_mps: Vec3::ZERO,
            complete: false,
            remainder_m: 0.0,
        }
    }

    /// The nodes, first to last; the aircraft flies straight on from the last one.
    #[inline]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Velocity after the last node, metres per second.
    pub const fn end_velocity_mps(&self) -> Vec3 {
        self.end_velocity_mps
    }

    /// Whether the path follows the manoeuvre up to the horizon: false if the nodes ran out, or
    /// if the manoeuvre lost a stage ([`Maneuver::is_whole`]).
    #[inline]
    pub const fn is_complete(&self) -> bool {
        self.complete
    }

    /// Bound of the distance of the flight from its nodes and from the pieces between them, metres (proof.md §7): that of
    /// rounding without bank lag.
    #[inline]
    pub const fn remainder_m(&self) -> f64 {
        self.remainder_m
    }

    /// Appends the nodes of one piece of constant rates and returns the state at its end;
    /// `None` if the nodes ran out, or the meter refuses them.
    #[inline(never)]
    fn fly_piece(
        &mut self,
        flyer: &Flyer,
        from: &MotionState,
        piece: &Piece,
        duration_s: f64,
        meter: &Meter,
    ) -> Option<MotionState> {
        let acceleration = flyer.acceleration_mps2(piece);
        let count = chords(acceleration, duration_s, MAX_NODES + 1);
        let work = count.min(MAX_NODES - self.nodes.len()) * flyer.node_work();
        if !meter.take(work) {
            return None;
        }
        // Where the nodes run out, those there are keep their distance.
        let step_s = if count > MAX_NODES {
            libm::sqrt(8.0 * CHORD_BOW_M / acceleration)
        } else {
            duration_s / count as f64
        };
        for step in 0..count {
            let after_s = step_s * step as f64;
            let state = flyer.advance(from, piece, after_s);
            self.nodes.push(Node::on(flyer, &state, piece, after_s))?;
        }
        Some(flyer.advance(from, piece, duration_s))
    }

    /// Predicts the flight of `maneuver` from `start` up to `horizon_s` (Eq. 10–12 with the
    /// vehicle's limits and response), replacing the old path.
    pub fn predict(
        &mut self,
        flyer: &Flyer,
        start: &MotionState,
        maneuver: &Maneuver,
        horizon_s: f64,
    ) {
        let meter = Meter::unlimited();
        self.predict_within(flyer, start, maneuver, horizon_s, &meter);
    }

    /// The same as far as a meter allows: the path is not complete if it refuses a piece.
    pub fn predict_within(
        &mut self,
        flyer: &Flyer,
        start: &MotionState,
        maneuver: &Maneuver,
        horizon_s: f64,
        meter: &Meter,
    ) {
        self.nodes.clear();
        self.complete = false;
        // The last node comes on top of those of the pieces.
        if !meter.take(SETUP + flyer.node_work()) {
            return;
        }
        let mut state = *start;
        let mut pieces = Pieces::new(flyer, start, maneuver.stages());
        let mut drift = DriftBounds::new(flyer, start);
        loop {
            let (piece, duration_s, until_s) = pieces.next(&state, f64::INFINITY);
            let is_last = duration_s == f64::INFINITY || state.time_s >= horizon_s;
            let flown =
                (!is_last).then(|| self.fly_piece(flyer, &state, &piece, duration_s, meter));
            let Some(mut end) = flown.flatten() else {
                break;
            };
            drift.fly(flyer, &pieces.command, &piece, duration_s);
            if duration_s >= until_s - state.time_s {
                end.time_s = until_s;
            }
            state = end;
        }
        self.remainder_m = drift.remainder_m(flyer, horizon_s, state.time_s);
        self.end_velocity_mps = flyer.velocity_mps(&state);
        let has_end = self.nodes.push(Node::straight(state)).is_some();
        // Where the nodes run out beyond the horizon, as in a slow turn, what they lack decides nothing.
        let is_past = (self.nodes().last()).is_some_and(|last| last.state.time_s >= horizon_s);
        let is_bounded = !meter.is_spent() && self.remainder_m.is_finite();
        self.complete = (has_end || is_past) && maneuver.is_whole() && is_bounded;
    }

    /// The aircraft `at_s` seconds from the decision.
    pub fn state_at(&self, flyer: &Flyer, at_s: f64) -> Option<MotionState> {
        let index = self
            .nodes()
            .partition_point(|node| node.state.time_s <= at_s);
        let node = self.nodes().get(index.saturating_sub(1))?;
        let piece = node.piece();
        let since_s = (at_s - node.state.time_s).max(0.0);
        let mut state = flyer.advance(&node.state, &piece, since_s);
        if let Some(next) = self.nodes().get(index).filter(|_| !flyer.is_ideal()) {
            state.bank_rad = flyer.bank_between_rad(&node.state, &next.state, since_s);
        }
        Some(state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limit::Limit as _;
    use crate::vehicle::{Response, Vehicle};

    fn paper() -> Vehicle {
        Vehicle {
            airspeed_mps: 15.0,
            turn_radius_m: 30.0,
            climb_min_rad: -15.0_f64.to_radians(),
            climb_max_rad: 15.0_f64.to_radians(),
            climb_rate_radps: 0.2,
            response: Response::default(),
        }
    }

    fn start() -> MotionState {
        MotionState::ahead(0.0)
    }

    /// Eq. 10–12 by small Euler-midpoint steps, the limits applied step by step.
    fn integrate(vehicle: &Vehicle, maneuver: &Maneuver, until_s: f64) -> (Vec3, f64, f64) {
        let dt = 1e-4;
        let (mut position, mut course, mut climb) = (Vec3::ZERO, 0.0, 0.0);
        let mut step = 0;
        while f64::from(step) * dt < until_s {
            let time = f64::from(step) * dt;
            let (course_target, climb_target) = maneuver
                .stage_at(time + 1e-9)
                .map_or((course, climb), |stage| (stage.course_rad, stage.climb_rad));
            let turn = vehicle.course_rate_radps() * dt;
            let pitch = vehicle.climb_rate_radps * dt;
            let d_course: f64 = (course_target - course).limited(-turn, turn);
            let d_climb: f64 = (climb_target - climb).limited(-pitch, pitch);
            let direction = crate::angle::direction(course + 0.5 * d_course, climb + 0.5 * d_climb);
            position += direction * vehicle.airspeed_mps * dt;
            course += d_course;
            climb += d_climb;
            step += 1;
        }
        (position, course, climb)
    }

    #[test]
    fn the_path_is_eq_10_to_12_integrated() {
        let vehicle = paper();
        let flyer = Flyer::new(&vehicle);
        let mut maneuver = Maneuver::turn(0.7, 1.9, 0.2);
        maneuver.push(crate::maneuver::Stage {
            start_s: 6.0,
            course_rad: -0.4,
            climb_rad: -0.1,
            rate_share: 1.0,
        });
        let mut path = FlightPath::new();
        path.predict(&flyer, &start(), &maneuver, 60.0);
        assert!(path.is_complete());
        for at in [0.5, 1.0, 3.0, 6.5, 9.0, 15.0] {
            let state = path.state_at(&flyer, at).unwrap();
            let (position, course, climb) = integrate(&vehicle, &maneuver, at);
            assert!(
                state.position_m.distance(position) < 5e-3,
                "{at}: {state:?} {position}"
            );
            assert!((state.course_rad - course).abs() < 1e-3);
            assert!((state.climb_rad - climb).abs() < 1e-3);
        }
    }

    /// Where the nodes run out decides nothing beyond the horizon, and is no certificate within it.
    #[test]
    fn a_turn_of_an_hour_is_complete_up_to_its_horizon() {
        let flyer = Flyer::new(&paper());
        let mut path = FlightPath::new();
        // From the last one that has room for all of its nodes.
        for rate_share in [0.0059, 0.00585, 0.0058, 0.005, 0.001] {
            let mut maneuver = Maneuver::hold();
            maneuver.push(crate::maneuver::Stage {
                start_s: 0.0,
                course_rad: 3.0,
                climb_rad: 0.0,
                rate_share,
            });
            path.predict(&flyer, &start(), &maneuver, 60.0);
            assert!(
                path.nodes().len() > MAX_NODES - 10,
                "{rate_share}: {}",
                path.nodes().len()
            );
            assert!(path.is_complete(), "{rate_share}");
        }
        path.predict(&flyer, &start(), &Maneuver::turn(0.0, 1e4, 0.0), 1e5);
        assert!(!path.is_complete());
    }

    #[test]
    fn nodes_bow_from_their_chords_no_more_than_said() {
        let flyer = Flyer::new(&paper());
        let mut path = FlightPath::new();
        path.predict(&flyer, &start(), &Maneuver::turn(0.0, 3.0, 0.2), 60.0);
        for pair in path.nodes().windows(2) {
            let duration = pair[1].state.time_s - pair[0].state.time_s;
            let bow = pair[0].acceleration_mps2 * duration * duration / 8.0;
            assert!(bow <= CHORD_BOW_M * 1.001);
            for share in [0.25, 0.5, 0.75] {
                let at = pair[0].state.time_s + share * duration;
                let chord = pair[0]
                    .state
                    .position_m
                    .lerp(pair[1].state.position_m, share);
                let exact = path.state_at(&flyer, at).unwrap().position_m;
                assert!(exact.distance(chord) <= bow + 1e-9);
            }
        }
    }

    #[test]
    fn a_lagged_bank_reaches_the_course_without_overshoot() {
        let mut vehicle = paper();
        vehicle.response.bank_time_constant_s = 0.6;
        let flyer = Flyer::new(&vehicle);
        let mut path = FlightPath::new();
        for target in [0.05, 0.3, 1.0, -2.5] {
            path.predict(&flyer, &start(), &Maneuver::turn(0.0, target, 0.0), 60.0);
            assert!(path.is_complete());
            let end = path.nodes().last().unwrap();
            assert!(
                (end.state.course_rad - target).abs() < 0.02,
                "{target}: {:?}",
                end.state
            );
            let beyond = path
                .nodes()
                .iter()
                .map(|node| (node.state.course_rad - target) * target.signum())
                .fold(f64::MIN, f64::max);
            assert!(beyond < 0.02, "{target} overshoots by {beyond}");
        }
    }
}
