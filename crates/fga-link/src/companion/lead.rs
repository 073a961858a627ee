//! When does a command act, and how is the aircraft then?
//!
//! A command that is sent now acts after the dead time of the vehicle and the link; until then the aircraft follows earlier
//! commands.

use fga::vehicle::Response;
use mavlink::dialects::ardupilotmega::{ATTITUDE_DATA, MavMessage, TIMESYNC_DATA};

use super::trips::Trips;
use crate::commanded::Commanded;
use crate::config::ResponseConfig;
use crate::ownship::{OwnState, OwnshipEstimate, turn_rate_radps};
use crate::response::ResponseEstimate;

/// How fast the moment of a decision follows the estimated dead time, as a share of the clock's pace.
const AHEAD_PACE: f64 = 0.5;
/// Assumed duration of the bank before a manoeuvre, seconds.
const KEPT_BEFORE_S: f64 = 2.0;
/// A bank beyond the normal limit by this is a steep one, radians (1°).
const STEEPER_RAD: f64 = 0.017;

/// The commands under way, and what the vehicle makes of them.
#[derive(Debug)]
pub(super) struct Lead {
    /// How far ahead of the clock decisions are, seconds, and the time of that setting.
    ahead_s: f64,
    ahead_at_s: f64,
    trips: Trips,
    /// The dead time that the link adds to the vehicle's, seconds.
    link_dead_time_s: f64,
    response: ResponseEstimate,
    /// The same for banks steeper than the normal one.
    steep_response: ResponseEstimate,
    /// The last commanded bank, radians.
    commanded_rad: f64,
    commanded_lately: Commanded,
    /// The bank to which the commands so far lead a vehicle that follows them with the estimated response, radians, and when, seconds.
    followed: Option<(f64, f64)>,
    /// Since when the bank is neither the commanded one nor that one, seconds.
    apart_since_s: Option<f64>,
}

impl Lead {
    pub(super) fn new(config: &ResponseConfig) -> Self {
        Self {
            ahead_s: config.dead_time_s,
            ahead_at_s: 0.0,
            trips: Trips::default(),
            link_dead_time_s: 0.0,
            response: ResponseEstimate::new(config),
            steep_response: ResponseEstimate::new(config),
            commanded_rad: 0.0,
            commanded_lately: Commanded::default(),
            followed: None,
            apart_since_s: None,
        }
    }

    /// When a command of `now_s` acts, seconds.
    pub(super) fn acts_s(&self, now_s: f64) -> f64 {
        now_s + self.ahead_s
    }

    /// The state at the moment at which a command sent now acts.
    pub(super) fn state(
        &self,
        ownship: &mut OwnshipEstimate,
        in_need: bool,
        now_s: f64,
    ) -> Option<OwnState> {
        let response = if in_need {
            self.steep_response()
        } else {
            self.response()
        };
        ownship.state_at(self.acts_s(now_s), &self.commanded_lately, &response)
    }

    /// The state at this moment.
    pub(super) fn state_now(&self, ownship: &mut OwnshipEstimate, now_s: f64) -> Option<OwnState> {
        ownship.state_at(now_s, &self.commanded_lately, &self.response.response())
    }

    /// How the vehicle follows over the link.
    pub(super) fn response(&self) -> Response {
        let response = self.response.response();
        Response {
            dead_time_s: response.dead_time_s + self.link_dead_time_s,
            ..response
        }
    }

    /// How the vehicle follows over the link at banks steeper than the normal one.
    pub(super) fn steep_response(&self) -> Response {
        self.steep_response.steep_response(self.response())
    }

    /// How far a turn with this bank, radians, may be off the plan after some seconds by what is not known of the response, metres; 0
    /// where nothing is learned.
    pub(super) fn off_m(&self, bank_rad: f64, after_s: f64) -> f64 {
        if self.response.is_enabled() {
            self.response.known().off_m(bank_rad, after_s)
        } else {
            0.0
        }
    }

    /// The aircraft did not fly as known.
    pub(super) fn forget(&mut self) {
        self.response.forget();
        self.steep_response.forget();
    }

    /// Follows the estimated dead time, slower than the clock: the moment of a decision never goes back,
    /// because the avoider would forget its plan.
    pub(super) fn follow(&mut self, now_s: f64) {
        let most_s = AHEAD_PACE * (now_s - self.ahead_at_s).max(0.0);
        self.link_dead_time_s = self.trips.dead_time_s();
        let off_s = self.response().dead_time_s - self.ahead_s;
        self.ahead_s += off_s.clamp(-most_s, most_s);
        self.ahead_at_s = now_s;
    }

    /// Asks what the vehicle's clock reads, when that is due.
    pub(super) fn request(&mut self, age_s: f64, system: u8, now_s: f64) -> Option<MavMessage> {
        self.trips.request(age_s, system, now_s)
    }

    /// Takes the answer.
    pub(super) fn take_round_trip(&mut self, data: &TIMESYNC_DATA, now_s: f64) {
        self.trips.take(data, now_s);
    }

    /// Whether the link answers too late to follow a manoeuvre.
    pub(super) fn is_too_long(&self, now_s: f64) -> bool {
        self.trips.is_too_long(now_s)
    }

    /// A manoeuvre begins: until its first command acts, the aircraft keeps its bank, radians.
    pub(super) fn begin(&mut self, bank_rad: Option<f64>, now_s: f64) {
        self.apart_since_s = None;
        self.followed = bank_rad.map(|bank_rad| (bank_rad, now_s));
        self.commanded_lately.clear();
        if let Some(bank_rad) = bank_rad {
            self.commanded_lately.push(now_s - KEPT_BEFORE_S, bank_rad);
        }
    }

    /// A bank is commanded, radians; without one the last command counts again.
    pub(super) fn command(&mut self, bank_rad: Option<f64>, now_s: f64) {
        self.commanded_rad = bank_rad.unwrap_or(self.commanded_rad);
        self.commanded_lately.push(now_s, self.commanded_rad);
    }

    /// Somebody else flies.
    pub(super) fn end(&mut self) {
        self.commanded_lately.clear();
    }

    /// For how long the bank has been farther than `tolerance_rad` from the commanded one, and from where the commands so far lead,
    /// seconds: commands that reverse faster than a bank rolls are followed all the same. Without a bank nobody looks.
    pub(super) fn apart_s(&mut self, bank_rad: Option<f64>, tolerance_rad: f64, now_s: f64) -> f64 {
        let response = self.response();
        let (before_rad, before_s) = self.followed.unwrap_or((self.commanded_rad, now_s));
        let commanded = &self.commanded_lately;
        let followed_rad = commanded.bank_at(before_rad, before_s, now_s, &response);
        self.followed = Some((followed_rad, now_s));
        let is_apart = |bank_rad: f64| {
            let off_rad = |rad: f64| (rad - bank_rad).abs();
            off_rad(self.commanded_rad).min(off_rad(followed_rad)) > tolerance_rad
        };
        if !bank_rad.is_some_and(is_apart) {
            self.apart_since_s = None;
            return 0.0;
        }
        now_s - *self.apart_since_s.get_or_insert(now_s)
    }

    /// Learns from an attitude, measured at `measured_s` of the local clock, at an airspeed in metres per second; banks
    /// beyond `normal_rad` are steep.
    pub(super) fn learn(
        &mut self,
        data: &ATTITUDE_DATA,
        measured_s: f64,
        airspeed_mps: f64,
        normal_rad: f64,
    ) {
        let bank_rad = -f64::from(data.roll);
        // What the link adds is known; the rest is estimated.
        let measured_s = measured_s - self.link_dead_time_s;
        let commanded_rad = self.commanded_lately.at(measured_s);
        let is_steep = |bank_rad: f64| bank_rad.abs() > normal_rad + STEEPER_RAD;
        let estimate = if is_steep(bank_rad) || commanded_rad.is_some_and(is_steep) {
            &mut self.steep_response
        } else {
            &mut self.response
        };
        estimate.observe(
            f64::from(data.time_boot_ms) * 1e-3,
            bank_rad,
            -turn_rate_radps(data),
            airspeed_mps,
            |before_s| self.commanded_lately.at(measured_s - before_s),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lead() -> Lead {
        Lead::new(&ResponseConfig {
            dead_time_s: 0.3,
            estimate: false,
            ..ResponseConfig::default()
        })
    }

    #[test]
    fn a_command_acts_later_over_a_slow_link_and_never_before_an_earlier_one() {
        let mut lead = lead();
        assert_eq!(lead.acts_s(10.0), 10.3);
        // The vehicle answers a second late: 0.3 s of that is ordinary.
        let answer = TIMESYNC_DATA {
            ts1: 9_000_000_000,
            tc1: 1,
            ..TIMESYNC_DATA::DEFAULT
        };
        lead.take_round_trip(&answer, 10.0);
        lead.follow(10.0);
        assert_eq!(lead.response().dead_time_s, 1.0);
        assert_eq!(lead.acts_s(10.0), 11.0);
        // The link is quick again: decisions go on at half of the clock's pace until then.
        for n in 0..5_i64 {
            let answer = TIMESYNC_DATA {
                ts1: 10_000_000_000 + n,
                ..answer
            };
            lead.take_round_trip(&answer, 10.1);
        }
        lead.follow(10.5);
        assert!((lead.acts_s(10.5) - 11.25).abs() < 1e-9);
        lead.follow(20.0);
        assert!((lead.acts_s(20.0) - 20.3).abs() < 1e-9);
    }

    #[test]
    fn a_bank_is_apart_for_as_long_as_it_stays_beyond_the_tolerance() {
        let mut lead = lead();
        lead.begin(Some(0.0), 0.0);
        lead.command(Some(0.5), 0.0);
        assert_eq!(lead.apart_s(Some(0.0), 0.2, 1.0), 0.0);
        assert_eq!(lead.apart_s(Some(0.1), 0.2, 2.5), 1.5);
        assert_eq!(lead.apart_s(Some(0.4), 0.2, 3.0), 0.0);
        assert_eq!(lead.apart_s(Some(0.0), 0.2, 3.5), 0.0);
        // Nobody looks, and another manoeuvre begins: each time the count begins again.
        assert_eq!(lead.apart_s(None, 0.2, 4.0), 0.0);
        assert_eq!(lead.apart_s(Some(0.0), 0.2, 5.0), 0.0);
        lead.begin(None, 6.0);
        assert_eq!(lead.apart_s(Some(0.0), 0.2, 6.0), 0.0);
    }
}
