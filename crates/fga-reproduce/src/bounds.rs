//! Bounds 1 to 3 (Eq. 26–53): the share saved where a bound holds and where it does not; and bound 1
//! against the least distance from which an aircraft really avoids a static obstacle.

use core::fmt::Write as _;

use fga::Vec3;
use fga::certificate::Hazard;
use fga::situation::{Movement, Obstacle, Ownship, ProtectedVolume};
use fga_campaign::batch::{self, BatchSettings};
use fga_campaign::campaign::CampaignScene;
use fga_campaign::campaign::parse_policy;
use fga_campaign::oracle::{
    OracleObstacle, OracleSettings, OracleStart, OracleVehicle, best_margin,
};
use fga_formats::atomic;
use fga_formats::encounters::Encounter;
use fga_paper::bounds::{
    HeadingSet, admissible_fraction, distance_feasible, speed_feasible_2d, speed_feasible_3d,
};
use fga_paper::conflict::Relative;
use fga_paper::timing::Geometry;
use fga_report::interval::Estimate;
use fga_report::plot::{Axis, BarChart, BarSeries};
use fga_report::report::{Cell, Column, Reading, Section, SectionBlock, Table};
use fga_sim::engine::Engine;
use fga_sim::policy::PolicyChoice;
use fga_sim::vehicle_file::VehicleModel;
use rayon::prelude::*;

use crate::ReproduceError;
use crate::Setting;
use crate::flights::{Flights, PLANAR, fly};

/// The policies in their order.
const POLICIES: [&str; 3] = ["published --start tc", "published --start t0", "turn-aware"];

/// The names of the policies and the oracle in the tables.
const NAMES: [&str; 4] = ["published, t_c", "published, t_0", "turn-aware", "oracle"];

/// Number of directions over the sphere for bound 3 in space.
const DIRECTIONS: u32 = 4000;

/// Both sections.
pub(crate) fn sections(
    setting: &Setting<'_>,
    model: &VehicleModel,
) -> Result<Vec<Section>, ReproduceError> {
    Ok(vec![distances(setting, model)?, shares(setting)?])
}

/// An encounter at the start of a flight along +x, as input of the bounds.
struct SeenEncounter {
    ownship: Ownship,
    climb_rad: (f64, f64),
    turn_radius_m: f64,
    obstacles: Vec<Hazard>,
}

impl SeenEncounter {
    fn of(model: &VehicleModel, obstacles: &[Obstacle]) -> Self {
        let vehicle = &model.vehicle;
        Self {
            ownship: Ownship {
                position_m: Vec3::ZERO,
                course_rad: 0.0,
                climb_rad: 0.0,
                bank_rad: 0.0,
                airspeed_mps: vehicle.airspeed_mps,
            },
            climb_rad: (vehicle.climb_min_rad, vehicle.climb_max_rad),
            turn_radius_m: vehicle.turn_radius_m,
            obstacles: (0..)
                .zip(obstacles)
                .map(|(id, o)| {
                    Hazard::exact(id, o.position_m, o.velocity_mps - model.wind_mps, o.volume)
                })
                .collect(),
        }
    }

    /// Bound 1, corrected: each threat leaves time for the turn.
    fn distance(&self) -> bool {
        let geometries = self.obstacles.iter().filter_map(|obstacle| {
            Geometry::of(&Relative::of(&self.ownship, obstacle)?, &obstacle.volume)
        });
        distance_feasible(geometries, self.turn_radius_m)
    }

    /// Bound 2: for each obstacle some direction is clear.
    fn speed(&self, planar: bool) -> bool {
        let rows = self
            .obstacles
            .iter()
            .map(|o| (o.position_m, o.velocity_mps, o.volume.radius_m()));
        let speed_mps = self.ownship.airspeed_mps;
        if planar {
            speed_feasible_2d(speed_mps, rows)
        } else {
            speed_feasible_3d(speed_mps, rows)
        }
    }

    /// Bound 3: one direction is clear of all obstacles, within the climb angles.
    fn direction(&self, planar: bool) -> bool {
        if planar {
            return !HeadingSet::of_all(&self.ownship, &self.obstacles).is_empty();
        }
        let speed_mps = self.ownship.airspeed_mps;
        let (at_m, climb_rad) = (self.ownship.position_m, self.climb_rad);
        admissible_fraction(at_m, speed_mps, climb_rad, &self.obstacles, DIRECTIONS)
            .is_some_and(|fraction| fraction > 0.0)
    }
}

/// The saved ones of some encounters.
#[derive(Clone, Copy, Default)]
struct Saved {
    encounters: u64,
    /// By each policy and by the oracle.
    saved: [u64; NAMES.len()],
}

impl Saved {
    fn share(&self, series: usize) -> Option<Estimate> {
        Estimate::wilson(*self.saved.get(series)?, self.encounters)
    }
}

/// A bound in the plane or in space: the share saved where it holds and where it does not.
struct Bound {
    name: String,
    /// Encounters within it, and outside.
    sides: [Saved; 2],
}

const HOLDS: usize = 0;
const FAILS: usize = 1;
const ORACLE: usize = NAMES.len() - 1;
const TURN_AWARE: usize = ORACLE - 1;

/// A bound and its test.
type BoundsDecider = fn(&SeenEncounter, bool) -> bool;

fn count(flights: &Flights, planar: bool) -> Result<Vec<Bound>, ReproduceError> {
    let bounds: [(&str, BoundsDecider); 3] = [
        ("1, distance", |seen, _| seen.distance()),
        ("2, speed", SeenEncounter::speed),
        ("3, direction", SeenEncounter::direction),
    ];
    let place = if planar { "plane" } else { "space" };
    let mut counted: Vec<Bound> = bounds
        .iter()
        .map(|(name, _)| Bound {
            name: format!("{name}, {place}"),
            sides: [Saved::default(); 2],
        })
        .collect();
    for rows in &flights.rows {
        let Some(first) = rows.first() else { continue };
        let drawn = flights.campaign.draw(first.encounter)?;
        // The setting has only cells.
        let CampaignScene::Rows(encounter) = drawn.scene else {
            continue;
        };
        let seen = SeenEncounter::of(&flights.campaign.model, &encounter.obstacles);
        for ((_, holds), bound) in bounds.iter().zip(&mut counted) {
            let side = if holds(&seen, planar) { HOLDS } else { FAILS };
            let saved = &mut bound.sides[side];
            saved.encounters += 1;
            for row in rows {
                if let Some(count) = saved.saved.get_mut(row.policy as usize) {
                    *count += u64::from(row.separated);
                }
            }
            saved.saved[ORACLE] += u64::from(first.avoidable() == Some(true));
        }
    }
    Ok(counted)
}

fn shares(setting: &Setting<'_>) -> Result<Section, ReproduceError> {
    let title = "Bounds 1 to 3 (Eq. 26–53) against simulation";
    setting.begin(title)?;
    let cells = |ending: &str| -> Vec<String> {
        (1..=3)
            .map(|count| format!("threats:{count}:40-200:0-60{ending}"))
            .collect()
    };
    let mut bounds = count(&fly(setting, &cells(PLANAR), &POLICIES)?, true)?;
    bounds.extend(count(&fly(setting, &cells(""), &POLICIES)?, false)?);

    let mut csv = String::from("bound,holds,encounters,series,share,low,high\n");
    let mut rows = Vec::new();
    for bound in &bounds {
        for (side, holds) in [(HOLDS, "holds"), (FAILS, "does not")] {
            let saved = &bound.sides[side];
            let mut row = vec![
                Cell::Text(bound.name.clone()),
                Cell::Text(holds.into()),
                Cell::Number(saved.encounters as f64, 0),
            ];
            for (series, label) in NAMES.iter().enumerate() {
                let share = saved.share(series);
                row.push(share.map_or(Cell::Empty, Cell::Share));
                if let Some(e) = share {
                    let _ = writeln!(
                        csv,
                        "\"{}\",{},{},\"{label}\",{:.6},{:.6},{:.6}",
                        bound.name,
                        side == HOLDS,
                        saved.encounters,
                        e.value,
                        e.low,
                        e.high
                    );
                }
            }
            rows.push(row);
        }
    }
    atomic::write(&setting.data().join("bounds.csv"), csv)?;
    let columns = [
        Column::text("bound"),
        Column::text("at the start it"),
        Column::number("encounters"),
    ];
    Ok(Section {
        title: title.into(),
        blocks: vec![
            SectionBlock::Paragraph(
                "One to three threats, first seen at 40 to 200 m all round (farther away the bounds \
                 hold in nearly every encounter), 0 to 60 m/s; in the plane the aircraft is forbidden to \
                 climb. Each bound is evaluated once, at the \
                 start, by the core's own functions (errata applied), and each encounter is then \
                 flown."
                    .into(),
            ),
            SectionBlock::Figure {
                svg: chart(&bounds, HOLDS, "Where the bound holds").to_svg(),
                caption: "Share kept separated of the encounters within the bound, with 95 % \
                     intervals."
                    .into(),
            },
            SectionBlock::Figure {
                svg: chart(&bounds, FAILS, "Where the bound does not hold").to_svg(),
                caption: "The same for the encounters outside of it; a gap means that there are none.".into(),
            },
            SectionBlock::Table(Table {
                caption: "Kept separated (%), with 95 % intervals.".into(),
                columns: columns
                    .into_iter()
                    .chain(NAMES.map(Column::number))
                    .collect(),
                rows,
            }),
            SectionBlock::Reading(reading(&bounds)),
            SectionBlock::Files(vec![("data/bounds.csv".into(), "the shares".into())]),
        ],
    })
}

fn chart(bounds: &[Bound], side: usize, title: &str) -> BarChart {
    BarChart {
        title: title.into(),
        groups_label: "bound, in the plane and in space".into(),
        groups: bounds
            .iter()
            .map(|bound| bound.name.replace(", ", " "))
            .collect(),
        y: Axis::percent("kept separated (%)"),
        series: NAMES
            .iter()
            .enumerate()
            .map(|(series, name)| BarSeries {
                name: (*name).to_owned(),
                values: bounds
                    .iter()
                    .map(|bound| bound.sides[side].share(series))
                    .collect(),
            })
            .collect(),
    }
}

fn reading(bounds: &[Bound]) -> Reading {
    let told = |series: usize| {
        let told: Vec<String> = bounds
            .iter()
            .map(|bound| {
                let [holds, fails] = &bound.sides;
                format!(
                    "{}: {} of {} within, {} of {} outside",
                    bound.name,
                    holds.saved[series],
                    holds.encounters,
                    fails.saved[series],
                    fails.encounters
                )
            })
            .collect();
        told.join("; ") + "."
    };
    let names = |wanted: &dyn Fn(&Bound) -> bool| {
        let found: Vec<&str> = bounds
            .iter()
            .filter(|bound| wanted(bound))
            .map(|bound| bound.name.as_str())
            .collect();
        if found.is_empty() {
            "none of them".to_owned()
        } else {
            found.join("; ")
        }
    };
    let necessary = names(&|bound| bound.sides[FAILS].saved[ORACLE] == 0);
    let sufficient = names(&|bound| {
        let holds = &bound.sides[HOLDS];
        holds.saved[ORACLE] == holds.encounters
    });
    Reading {
        paper: "Bound 1 is to guarantee t_c > 0; bound 2 \"must\" be satisfied for successful \
             avoidance; bound 3 lets the solution exist."
            .into(),
        published: format!("Started at t_0. {}", told(1)),
        turn_aware: told(TURN_AWARE),
        oracle: told(ORACLE),
        reading: format!(
            "Nothing outside the bound could be saved for: {necessary}; everything within it could be \
             saved for: {sufficient}. Within a bound an encounter may still be lost: 2 and 3 are about a \
             direction that is taken up at once and then held, 1 is about one turn against an obstacle \
             that stands still."
        ),
    }
}

/// Lengths of a static encounter: turn radius, protected radius, distance from the course, metres.
const STATIC: [[f64; 3]; 6] = [
    [30.0, 30.0, 0.0],
    [30.0, 30.0, 15.0],
    [30.0, 30.0, 29.0],
    [60.0, 30.0, 0.0],
    [30.0, 150.0, 0.0],
    [30.0, 150.0, 75.0],
];

/// Resolution of a distance, m.
const FINEST_M: f64 = 0.1;

/// A static obstacle ahead, at its distance along the course; `None` if it is abeam.
fn ahead(distance_m: f64, radius_m: f64, across_m: f64) -> Option<Obstacle> {
    let along = distance_m * distance_m - across_m * across_m;
    (along > 0.0 && distance_m > radius_m).then(|| {
        let position_m = Vec3::new(libm::sqrt(along), -across_m, 0.0);
        let volume = ProtectedVolume::Sphere { radius_m };
        Obstacle {
            movement: Movement::AtRest,
            ..Obstacle::straight(1, position_m, Vec3::ZERO, volume)
        }
    })
}

/// The least distance from which `saved` holds for all larger ones, in steps of [`FINEST_M`]:
/// the search comes nearer in ever finer steps.
fn least_distance(farthest_m: f64, nearest_m: f64, saved: impl Fn(f64) -> bool) -> Option<f64> {
    if !saved(farthest_m) {
        return None;
    }
    let mut least_m = farthest_m;
    for step_m in [5.0, 1.0, FINEST_M] {
        while least_m - step_m > nearest_m && saved(least_m - step_m) {
            least_m -= step_m;
        }
    }
    Some(least_m)
}

fn distances(setting: &Setting<'_>, model: &VehicleModel) -> Result<Section, ReproduceError> {
    let title = "Bound 1 (Eq. 26–30): the least distance from a static obstacle";
    setting.begin(title)?;
    let columns = [
        "turn radius (m)",
        "protected radius (m)",
        "beside the course (m)",
        "Eq. 29 as printed (m)",
        "corrected (m)",
        "published, t_0 (m)",
        "turn-aware (m)",
        "oracle (m)",
        "turn-aware, climbing too (m)",
    ];
    let rows: Vec<[Option<f64>; 9]> = STATIC
        .into_par_iter()
        .map(|lengths| least_distances(lengths, model))
        .collect::<Result<_, ReproduceError>>()?;
    let mut csv = String::from(
        "turn_radius_m,protected_radius_m,across_m,eq_29_m,corrected_m,published_t0_m,turn_aware_m,oracle_m,turn_aware_in_space_m\n",
    );
    for row in &rows {
        let told: Vec<String> = row
            .iter()
            .map(|value| value.map_or_else(String::new, |v| format!("{v:.1}")))
            .collect();
        let _ = writeln!(csv, "{}", told.join(","));
    }
    atomic::write(&setting.data().join("bound-1.csv"), csv)?;
    // Distance of a column from the corrected bound, over all rows.
    let beyond = |column: usize| {
        rows.iter()
            .filter_map(|row| Some(row[column]? - row[4]?))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), off| {
                (least.min(off), most.max(off))
            })
    };
    let told = |column: usize| {
        let (least, most) = beyond(column);
        let never = rows.iter().filter(|row| row[column].is_none()).count();
        let never = if never == 0 {
            String::new()
        } else {
            format!(
                "; in {never} of {} not from any distance up to three times the bound",
                rows.len()
            )
        };
        format!("{least:+.1} to {most:+.1} m from the corrected bound{never}.")
    };
    let printed_short = rows
        .iter()
        .filter(|row| matches!((row[3], row[7]), (Some(printed), Some(oracle)) if oracle > printed + FINEST_M))
        .count();
    let corrected_short = rows
        .iter()
        .filter(|row| matches!((row[4], row[7]), (Some(bound), Some(oracle)) if oracle > bound + FINEST_M))
        .count();
    Ok(Section {
        title: title.into(),
        blocks: vec![
            SectionBlock::Paragraph(
                "One static obstacle ahead, known from the start. The least initial distance from which \
                 it, and every one farther away, is kept clear of, found by flying ever nearer in steps \
                 down to 0.1 m; single numbers without an interval, because nothing here is random. In \
                 the plane but for the last column."
                    .into(),
            ),
            SectionBlock::Table(Table {
                caption: "Least initial distance by bound 1 and in flight.".into(),
                columns: columns.map(Column::number).into(),
                rows: rows
                    .iter()
                    .map(|row| {
                        row.iter()
                            .map(|value| value.map_or(Cell::Empty, |v| Cell::Number(v, 1)))
                            .collect()
                    })
                    .collect(),
            }),
            SectionBlock::Reading(Reading {
                paper: "r_0 > (ρ_min + d_m) / (cos θ_t0 + sin θ_t0) lets t_c > 0 exist (Eq. 29).".into(),
                published: format!("Started at t_0: {}", told(5)),
                turn_aware: told(6),
                oracle: told(7),
                reading: format!(
                    "As printed the bound is shorter than what the oracle needs in {printed_short} of {} \
                     cases (where ρ < d_m/√2), corrected in {corrected_short}: corrected it is sufficient \
                     for an aircraft that turns at once and fully. It is not necessary: where Eq. 18 adds a \
                     buffer, or the aircraft may climb, nearer will do.",
                    rows.len()
                ),
            }),
            SectionBlock::Files(vec![("data/bound-1.csv".into(), "the distances".into())]),
        ],
    })
}

fn least_distances(
    [turn_m, radius_m, across_m]: [f64; 3],
    table_4: &VehicleModel,
) -> Result<[Option<f64>; 9], ReproduceError> {
    let in_space = {
        let mut model = table_4.clone();
        model.vehicle.turn_radius_m = turn_m;
        model
    };
    let planar = {
        let mut model = in_space.clone();
        (model.vehicle.climb_min_rad, model.vehicle.climb_max_rad) = (0.0, 0.0);
        model
    };
    // Eq. 28: r cos θ + r sin θ > ρ + d with r sin θ given.
    let printed_m = libm::hypot(turn_m + radius_m - across_m, across_m);
    let farthest_m = 3.0 * (turn_m + radius_m);
    let corrected_m = least_distance(farthest_m, radius_m, |r| {
        ahead(r, radius_m, across_m).is_some_and(|o| SeenEncounter::of(&planar, &[o]).distance())
    });
    let flown =
        |model: &VehicleModel, policy: PolicyChoice| -> Result<Option<f64>, ReproduceError> {
            let settings = BatchSettings::of(model.clone(), policy.clone());
            let Some(world) = batch::empty_world(&settings) else {
                return Ok(None);
            };
            policy
                .pilot(&world.settings, &world.vehicle)
                .map_err(|error| ReproduceError::of(&error))?;
            Ok(least_distance(farthest_m, radius_m, |r| {
                ahead(r, radius_m, across_m).is_some_and(|obstacle| {
                    let encounter = Encounter {
                        id: 0,
                        obstacles: vec![obstacle],
                    };
                    let mut world = world.clone();
                    let pilot = policy.pilot(&world.settings, &world.vehicle);
                    pilot.is_ok_and(|mut pilot| {
                        let engine = &mut Engine::new();
                        batch::fly_one(engine, &mut world, pilot.as_mut(), &encounter, &settings)
                            .separated()
                    })
                })
            }))
        };
    let (vehicle, settings) = (
        OracleVehicle::from(&planar.vehicle),
        OracleSettings::default(),
    );
    let allowed_m = least_distance(farthest_m, radius_m, |r| {
        ahead(r, radius_m, across_m).is_some_and(|o| {
            let obstacle = OracleObstacle::from(&o);
            best_margin(&OracleStart::ORIGIN, &vehicle, &[obstacle], &settings).best_margin_m >= 0.0
        })
    });
    let published = parse_policy("published --start t0").map_err(ReproduceError::Input)?;
    Ok([
        Some(turn_m),
        Some(radius_m),
        Some(across_m),
        Some(printed_m),
        corrected_m,
        flown(&planar, published)?,
        flown(&planar, PolicyChoice::default())?,
        allowed_m,
        flown(&in_space, PolicyChoice::default())?,
    ])
}
