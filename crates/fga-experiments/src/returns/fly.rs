//! The flight of all aircraft of a drawn flight, and what went wrong.

use fga::avoider::State;
use fga::situation::{Obstacle, ProtectedVolume};

use super::ReturnCount;
use super::draw::{ReturnFlight, Straight};
use super::flier::{Flier, STUCK_S, distance_m};
use crate::common::PERIOD_S;

impl ReturnFlight {
    /// Flies until every mission has ended, or for too long.
    pub(super) fn fly_on(&mut self, shows: bool) {
        let volume = ProtectedVolume::Sphere {
            radius_m: self.radius_m,
        };
        let mut rows = Vec::new();
        let mut step = 0_u32;
        while f64::from(step) * PERIOD_S < self.until_s {
            let time_s = f64::from(step) * PERIOD_S;
            step += 1;
            if self.fliers.iter().all(Flier::has_landed) {
                break;
            }
            let fleet: Vec<Option<Obstacle>> = self
                .fliers
                .iter()
                .zip(1000..)
                .map(|(flier, id)| flier.seen(id, volume))
                .collect();
            for (index, flier) in self.fliers.iter_mut().enumerate() {
                rows.clear();
                let present = |straight: &&Straight| {
                    time_s >= straight.present_s.0 && time_s <= straight.present_s.1
                };
                rows.extend(self.others.iter().filter(present).map(|straight| Obstacle {
                    position_m: straight.obstacle.position_m
                        + straight.obstacle.velocity_mps * time_s,
                    ..straight.obstacle
                }));
                let others = fleet
                    .iter()
                    .enumerate()
                    .filter(|(other, _)| *other != index);
                rows.extend(others.filter_map(|(_, other)| *other));
                if flier.has_landed() {
                    continue;
                }
                flier.step(time_s, &rows, self.wind_mps);
                flier.judge(
                    (step, time_s),
                    &rows,
                    (&self.vehicle, self.wind_mps, self.surveillance_m),
                );
                if shows
                    && step.is_multiple_of(if flier.state == State::Cruise {
                        300
                    } else {
                        50
                    })
                {
                    let own = flier.plant.ownship();
                    println!(
                        "{time_s:.1} {index}: {:?} {:.0} course {:.2} {:.0} m off, {} near",
                        flier.state,
                        own.position_m,
                        own.course_rad,
                        distance_m(&flier.mission_m, own.position_m),
                        rows.len(),
                    );
                }
            }
        }
        if shows {
            println!(
                "{:?} wind {} others {}",
                self.vehicle,
                self.wind_mps,
                self.others.len()
            );
            for flier in &self.fliers {
                println!("mission {:?}", flier.mission_m);
            }
        }
    }

    /// Flies, and counts what went wrong.
    pub(super) fn fly(mut self, number: u64, shows: bool) -> ReturnCount {
        self.fly_on(shows);
        let mut count = ReturnCount {
            flights: 1,
            ..ReturnCount::default()
        };
        for flier in &self.fliers {
            count.aircraft += 1;
            count.longest_s = count.longest_s.max(flier.alone_s.1);
            count.entered += usize::from(flier.has_entered);
            count.given_up += flier.given_up;
            let [end_missed, kept_off] = flier.misses();
            let faults = [
                (flier.alone_s.1 > STUCK_S, &mut count.stuck),
                (flier.has_strayed, &mut count.strayed),
                (!flier.is_complete && !flier.is_adrift, &mut count.open),
                (end_missed, &mut count.end_missed),
                (kept_off, &mut count.kept_off),
                (flier.lowest_m < flier.floor_m() - 0.1, &mut count.low),
            ];
            for (is_fault, numbers) in faults {
                if is_fault {
                    numbers.push(number);
                }
            }
        }
        count
    }
}
