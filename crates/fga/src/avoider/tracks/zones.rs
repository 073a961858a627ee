//! The zones that bind and what binds of the ground, and the way out of an entered zone, or up from the ground.

use core::f64::consts::TAU;

use super::{FLAT_M, LIMIT_ID, Places, Tracks};
use crate::Vec3;
use crate::assumptions::LEAVING_SHARE;
use crate::certificate::Line;
use crate::ground::{Binding, Ground};
use crate::limit::Limit as _;
use crate::meter::Meter;
use crate::prediction::Flyer;
use crate::situation::{Mission, Obstacle, ProtectedVolume, Situation};
use crate::zone::Zone;

/// Zones are known at least this far beyond the flight of a full circle, metres: margins are capped there.
const ZONE_REACH_M: f64 = 1e3;

/// Most legs ahead that decide whether a zone binds.
const MAX_LEGS_AHEAD: usize = 16;

/// A plane follows the aircraft out of a zone: its share of the airspeed, and its distance behind at the start, turn radii.
const OUT_SHARE: f64 = 0.9;
const TURNS_ROUND: f64 = 2.9;

/// Below what it takes to clear the ground a manoeuvre may come lower by this, metres: the way out takes a moment to begin.
const LOWER_M: f64 = 1.0;

/// Most work for what binds of the ground.
const GROUND_WORK: u32 = 4_000;

/// The aircraft begins to turn into a direction within this time, seconds, and this number of its bank's time constants.
const DECIDES_S: f64 = 1.0;
const ROLLS: f64 = 3.0;

impl<P: Places + ?Sized> Tracks<P> {
    /// Adds the zones of the mission, for the time of a full circle: so long the aircraft can turn back from a wall. One that the
    /// mission ahead is on the wrong side of within that time does not bind. Of one that the aircraft has entered, a plane follows
    /// it out.
    pub(in crate::avoider) fn add_zones(
        &mut self,
        leg: usize,
        (flyer, climb_limits_rad): (&Flyer, (f64, f64)),
        wanted_m: f64,
        situation: &Situation<'_>,
    ) {
        let mission = &situation.mission;
        if mission.zones.is_empty() && mission.ground.is_none() {
            return;
        }
        let own_m = situation.ownship.position_m;
        let circle_s = TAU / flyer.course_rate_radps();
        let reach_m = reach_m(flyer, situation.wind_mps, wanted_m);
        let ahead = mission_ahead(situation, leg, flyer);
        let legs = ahead.clone().count();
        let zones = &mut self.zones;
        zones.clear(situation.wind_mps, circle_s);
        // A manoeuvre comes no nearer to any than the mission leads, or the aircraft is.
        let mut least_m = wanted_m;
        for (index, zone) in mission.zones.iter().enumerate() {
            self.work += zone.edges().count() * (2 + legs);
            let of_mission_m = nearest_m(zone, ahead.clone(), least_m);
            if of_mission_m < 0.0 {
                continue;
            }
            let of_own_m = zone.nearest_m(&Line::at(own_m), of_mission_m);
            if of_own_m < 0.0 {
                self.lead_out(zone.way_out_m(own_m), (flyer, climb_limits_rad), wanted_m);
                continue;
            }
            least_m = of_own_m;
            if !self.zones.add(mission.zones, index, (own_m, reach_m)) {
                self.overflow = true;
                return;
            }
        }
        if let Some(ground) = mission.ground {
            let meter = Meter::new(GROUND_WORK, GROUND_WORK);
            let (binding, [of_mission_m, of_own_m]) = bound(ground, &ahead, own_m, least_m, &meter);
            self.work += meter.done() as usize;
            self.zones.binding = binding;
            // Only the aircraft itself is too low, not its mission.
            if of_own_m < 0.0 && of_mission_m >= 0.0 {
                self.lead_out(Vec3::Z * -of_own_m, (flyer, climb_limits_rad), wanted_m);
            }
            least_m = of_mission_m.min(of_own_m).max(0.0);
        }
        if least_m < wanted_m {
            self.zones.spare_m = wanted_m - LEAVING_SHARE * least_m;
        }
    }

    /// Adds a plane that follows the aircraft along a way out, metres.
    fn lead_out(
        &mut self,
        way_m: Vec3,
        (flyer, (low_rad, high_rad)): (&Flyer, (f64, f64)),
        wanted_m: f64,
    ) {
        let (own_m, speed_mps) = (self.seen_from.own_m, flyer.airspeed_mps());
        let climbs = libm::sin(if way_m.z > 0.0 { high_rad } else { -low_rad });
        let out_mps = OUT_SHARE * speed_mps * if way_m.z == 0.0 { 1.0 } else { climbs };
        let direction = way_m.normalize_or(Vec3::X);
        let behind_m = if way_m.z == 0.0 {
            // Turning round to the way out takes the aircraft back by less.
            let rolls_s = DECIDES_S + ROLLS * flyer.bank_time_constant_s();
            TURNS_ROUND * flyer.turn_radius_m() + rolls_s * speed_mps
        } else {
            // It sinks or climbs on until its climb angle is the other one.
            let rate_radps = flyer.climb_rate_radps().max(f64::MIN_POSITIVE);
            2.0 * out_mps * (DECIDES_S + (high_rad - low_rad) / rate_radps)
        };
        let center_m = own_m - direction * (FLAT_M + behind_m + wanted_m);
        let volume = ProtectedVolume::Sphere { radius_m: FLAT_M };
        let plane = Obstacle::straight(LIMIT_ID, center_m, direction * out_mps, volume);
        let out_s = (way_m.length() + behind_m + 2.0 * wanted_m) / out_mps;
        self.inside = true;
        if !self.add_limit(&plane, out_s) {
            self.zones.enter();
        }
    }
}

/// What of the ground binds, and the margins of the mission ahead and of the aircraft itself, at most one, metres; negative where it is
/// lower than it takes to clear the ground. A manoeuvre may be as low as these are, and over unknown ground where they are.
fn bound(
    ground: &Ground<'_>,
    ahead: &(impl Iterator<Item = Line> + Clone),
    own_m: Vec3,
    most_m: f64,
    meter: &Meter,
) -> (Binding, [f64; 2]) {
    let margins_m = |most_m, binding| {
        let lower_m =
            |least_m: f64, line: Line| match ground.least_on_line(&line, least_m, binding, meter) {
                Some((margin_m, _)) if margin_m < 0.0 => {
                    least_m.min(ground.deepest(&line, binding, meter).0)
                }
                found => found.map_or(least_m, |(margin_m, _)| margin_m),
            };
        [
            ahead.clone().fold(most_m, lower_m),
            lower_m(most_m, Line::at(own_m)),
        ]
    };
    let mut binding = Binding::ALL;
    let mut found_m = margins_m(most_m, binding);
    if found_m[0].min(found_m[1]) < 0.0 {
        binding.lowered_m = f64::INFINITY;
        let unknown_m = margins_m(0.0, binding);
        binding.spares_unknown = unknown_m[0].min(unknown_m[1]) < 0.0;
        binding.lowered_m = 0.0;
        found_m = margins_m(most_m, binding);
        let lowest_m = found_m[0].min(found_m[1]);
        // What is not known for lack of work lowers nothing.
        if lowest_m < 0.0 && lowest_m.is_finite() {
            binding.lowered_m = LOWER_M - lowest_m;
        }
    }
    (binding, found_m)
}

/// The lines of the mission from beside the aircraft on the leg that begins at a waypoint, for the way of a full circle.
fn mission_ahead(
    situation: &Situation<'_>,
    leg: usize,
    flyer: &Flyer,
) -> impl Iterator<Item = Line> + Clone {
    let (waypoints_m, own_m) = (situation.mission.waypoints_m, situation.ownship.position_m);
    let mut left_m = circle_m(flyer, situation.wind_mps);
    // After the last leg, where it ends.
    let leg = leg.min(waypoints_m.len().saturating_sub(2));
    let legs = waypoints_m.get(leg..).unwrap_or(&[]).windows(2);
    let lines = legs.enumerate().map_while(move |(index, ends_m)| {
        let (&[mut from_m, end_m], true) = (ends_m, left_m > 0.0) else {
            return None;
        };
        if index == 0 {
            let along_m = end_m - from_m;
            let flown_m2 = (own_m - from_m).dot(along_m);
            let share = flown_m2 / along_m.length_squared().max(f64::MIN_POSITIVE);
            from_m += along_m * share.limited(0.0, 1.0);
        }
        let rest_m = (end_m - from_m).clamp_length_max(left_m);
        left_m -= rest_m.length();
        Some(Line::between(from_m, from_m + rest_m))
    });
    lines.take(MAX_LEGS_AHEAD)
}

/// How far zones are known, metres.
fn reach_m(flyer: &Flyer, wind_mps: Vec3, wanted_m: f64) -> f64 {
    circle_m(flyer, wind_mps) + ZONE_REACH_M.max(2.0 * wanted_m)
}

/// How long a flight stays among the zones that are known, seconds.
pub(in crate::avoider) fn known_s(flyer: &Flyer, wind_mps: Vec3, wanted_m: f64) -> f64 {
    let speed_mps = flyer.airspeed_mps() + wind_mps.length();
    (reach_m(flyer, wind_mps, wanted_m) - 2.0 * wanted_m) / speed_mps
}

/// The way over the ground in the time of a full circle, at most, metres.
fn circle_m(flyer: &Flyer, wind_mps: Vec3) -> f64 {
    TAU / flyer.course_rate_radps() * (flyer.airspeed_mps() + wind_mps.length())
}

/// The least distance of some lines from a zone, metres; at most a given one, and negative on the wrong side.
fn nearest_m(zone: &Zone<'_>, lines: impl Iterator<Item = Line>, most_m: f64) -> f64 {
    lines.fold(most_m, |least_m, line| zone.nearest_m(&line, least_m))
}

/// Whether a line keeps a distance from a mission's zones, metres, and clears the ground, but for those that one of some places breaks.
pub(in crate::avoider) fn is_clear(
    mission: &Mission<'_>,
    (line, margin_m): (&Line, f64),
    spared_m: &[Vec3],
    meter: &Meter,
) -> bool {
    let is_clear_of = |zone: &Zone<'_>| {
        meter.take(zone.work())
            && (zone.nearest_m(line, margin_m) >= margin_m
                || spared_m.iter().any(|place_m| zone.is_entered(*place_m)))
    };
    let is_above = |ground: &Ground<'_>, line: &Line| {
        let (deepest_m, _) = ground.deepest(line, Binding::ALL, meter);
        deepest_m >= 0.0
    };
    mission.zones.iter().all(is_clear_of)
        && mission.ground.is_none_or(|ground| {
            let mut spared = spared_m.iter().map(|place_m| Line::at(*place_m));
            is_above(ground, line) || spared.any(|place| !is_above(ground, &place))
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec2;
    use crate::zone::{ALL_HEIGHTS_M, Outline};

    #[test]
    fn a_line_is_clear_beside_a_zone_and_where_the_mission_breaks_it() {
        let zones = [Zone {
            keep_in: false,
            outline: Outline::Circle(Vec2::new(100.0, 0.0), 20.0),
            heights_m: ALL_HEIGHTS_M,
        }];
        let mission = Mission {
            zones: &zones,
            ..Mission::new(&[])
        };
        let is_clear_at = |y_m: f64, margin_m: f64, spared_m: &[Vec3]| {
            let line = Line::between(Vec3::new(0.0, y_m, 0.0), Vec3::new(200.0, y_m, 0.0));
            is_clear(&mission, (&line, margin_m), spared_m, &Meter::unlimited())
        };
        assert!(is_clear_at(31.0, 10.0, &[]) && !is_clear_at(29.0, 10.0, &[]));
        assert!(is_clear_at(29.0, 0.0, &[]) && !is_clear_at(5.0, 0.0, &[Vec3::ZERO]));
        assert!(is_clear_at(5.0, 0.0, &[Vec3::new(100.0, 1.0, 0.0)]));
    }
}
