//! Writes synthetic replays for the viewer's browser tests: `cargo run -p fga-report --example
//! replay_fixture -- DIR`. The flights are scripted, not simulated: they exercise the page.

use core::f64::consts::{FRAC_PI_4, PI, TAU};
use std::path::Path;
use std::{env, fs, io};

use fga::situation::ProtectedVolume;
use fga_report::replay::{
    Replay, ReplayDecision, ReplayDecisionTime, ReplayEvent, ReplayFutures, ReplayGround,
    ReplayObstacle, ReplayOutcome, ReplayPath, ReplayPathKind, ReplayPiece, ReplayRun,
    ReplaySample, ReplayState, render, render_live,
};

const AIRSPEED_MPS: f64 = 15.0;
const COURSE_RATE_RADPS: f64 = 0.5;
const STEP_S: f64 = 0.1;
const HEIGHT_M: f64 = 120.0;
/// One scripted encounter: straight, away, past, back.
const PERIOD_S: f64 = 60.0;

fn main() -> io::Result<()> {
    let dir = env::args().nth(1).unwrap_or_else(|| "out/fixtures".into());
    let dir = Path::new(&dir);
    fs::create_dir_all(dir)?;
    let encounter = |side: f64, name: &str| flight(name, 60.0, obstacles(4, 60.0), side);
    let pages = [
        (
            "encounter",
            vec![
                encounter(1.0, "turn-aware"),
                encounter(-0.8, "published"),
                encounter(0.0, "none"),
            ],
        ),
        (
            "short",
            vec![flight("turn-aware", 60.0, obstacles(50, 600.0), 1.0)],
        ),
        (
            "long",
            vec![flight("turn-aware", 600.0, obstacles(50, 600.0), 1.0)],
        ),
        ("hills", vec![encounter(1.0, "turn-aware")]),
        ("level", vec![encounter(1.0, "turn-aware")]),
        (
            "many",
            vec![flight("turn-aware", 60.0, obstacles(1_000, 60.0), 1.0)],
        ),
        ("empty", vec![flight("turn-aware", 60.0, Vec::new(), 1.0)]),
        ("nothing", Vec::new()),
        ("one", vec![one_sample()]),
        ("lost", vec![flight("none", 60.0, obstacles(4, 60.0), 0.0)]),
        ("hostile", vec![hostile()]),
        ("believed", vec![believed(), encounter(0.0, "none")]),
    ];
    for (name, runs) in pages {
        let title = match name {
            "hostile" => HOSTILE.to_owned(),
            _ => format!("Scripted flight: {name}"),
        };
        let ground = (name == "hills").then(hills);
        let page = render(&Replay {
            title,
            runs,
            ground,
        });
        println!("{name}.html {} kB", page.len() / 1000);
        fs::write(dir.join(format!("{name}.html")), page)?;
    }
    fs::write(dir.join("live.html"), render_live("Live flight", "/live"))
}

/// Waves that rise to the north, with a hole in them.
fn hills() -> ReplayGround {
    let columns = 120_u8;
    let heights_m = (0..columns).flat_map(|row| {
        (0..columns).map(move |column| {
            let is_hole = row > 90 && column > 90;
            let height_m = 0.5 * f32::from(row) - 20.0 + 8.0 * (f32::from(column) / 9.0).sin();
            if is_hole { f32::NAN } else { height_m }
        })
    });
    ReplayGround {
        corner_m: [-600.0, -1_500.0],
        spacing_m: [25.0, 25.0],
        columns: columns.into(),
        heights_m: heights_m.collect(),
    }
}

const HOSTILE: &str =
    "</script><img src=x onerror=\"document.title='owned'\">&amp;\u{2028}'\"`${1}";

fn hostile() -> ReplayRun {
    let mut run = flight(HOSTILE, 20.0, obstacles(2, 60.0), 1.0);
    for obstacle in &mut run.obstacles {
        HOSTILE.clone_into(&mut obstacle.name);
    }
    for decision in &mut run.decisions {
        decision.lines.push(HOSTILE.to_owned());
    }
    for event in &mut run.events {
        HOSTILE.clone_into(&mut event.text);
    }
    run
}

fn one_sample() -> ReplayRun {
    let mut run = flight("turn-aware", 60.0, obstacles(4, 60.0), 1.0);
    run.samples.truncate(1);
    run.decisions.truncate(1);
    run.decision_times.truncate(1);
    run.events.clear();
    run.outcome = None;
    run
}

/// From 5 to 30 s a chance of a loss is known, and once a second what N0 may do: three futures.
fn believed() -> ReplayRun {
    let mut run = flight("belief", 60.0, obstacles(4, 60.0), 1.0);
    let (meets, decisions) = (&run.obstacles[0].motion[0], &mut run.decisions);
    let weighed = decisions
        .iter_mut()
        .filter(|d| (5.0..30.0).contains(&d.t_s));
    for (n, decision) in weighed.enumerate() {
        let t_s = decision.t_s;
        decision.p_loss = Some([0.3, 0.01]);
        if !n.is_multiple_of(10) {
            continue;
        }
        let at = |after_s: f64, aside_m: f64| {
            let along =
                |axis: usize| meets.position_m[axis] + (t_s + after_s) * meets.velocity_mps[axis];
            [along(0) + aside_m, along(1) - aside_m, along(2)]
        };
        let ways = [(0.7, 0.0), (0.2, 150.0), (0.1, -150.0)];
        decision.futures = vec![ReplayFutures {
            obstacle: 0,
            ways: ways
                .map(|(weight, aside_m)| {
                    (weight, vec![at(0.0, 0.0), at(10.0, 0.0), at(60.0, aside_m)])
                })
                .into(),
        }];
    }
    run
}

/// A repeatable number in [0, 1).
fn unit(seed: u32) -> f64 {
    let mixed = seed.wrapping_mul(2_654_435_761) ^ seed.wrapping_mul(40_503).rotate_left(13);
    f64::from(mixed.wrapping_mul(2_246_822_519) >> 8) / f64::from(1_u32 << 24)
}

fn obstacles(count: u32, duration_s: f64) -> Vec<ReplayObstacle> {
    (0..count)
        .map(|i| {
            // The first ones meet the aircraft in the middle of each period.
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "small"
            )]
            let periods = (duration_s / PERIOD_S) as u32;
            if i < periods {
                return meeting(i);
            }
            let along_m = unit(3 * i) * duration_s * AIRSPEED_MPS;
            let side_m = (unit(3 * i + 1) - 0.5) * 1_600.0;
            let away_m = side_m + 120.0_f64.copysign(side_m);
            let heading = unit(3 * i + 2) * TAU;
            let moves = i % 3 != 0;
            let speed_mps = if moves { 4.0 + 8.0 * unit(7 * i) } else { 0.0 };
            obstacle(
                i,
                [along_m, away_m, HEIGHT_M - 40.0 + 80.0 * unit(11 * i)],
                [speed_mps * heading.cos(), speed_mps * heading.sin(), 0.0],
                if i % 4 == 1 {
                    cylinder(25.0 + 15.0 * unit(5 * i), 40.0)
                } else {
                    sphere(20.0 + 15.0 * unit(5 * i))
                },
            )
        })
        .collect()
}

fn meeting(i: u32) -> ReplayObstacle {
    let meet_s = f64::from(i) * PERIOD_S + 22.0;
    let velocity = [-6.0, if i.is_multiple_of(2) { -5.0 } else { 4.0 }, 0.0];
    let at = [meet_s * AIRSPEED_MPS, 4.0, HEIGHT_M + 3.0];
    let start = [
        at[0] - velocity[0] * meet_s,
        at[1] - velocity[1] * meet_s,
        at[2],
    ];
    let mut obstacle = obstacle(i, start, velocity, sphere(30.0));
    obstacle.known_from_s = Some(meet_s - 14.0);
    obstacle
}

const fn sphere(radius_m: f64) -> ProtectedVolume {
    ProtectedVolume::Sphere { radius_m }
}

const fn cylinder(radius_m: f64, half_height_m: f64) -> ProtectedVolume {
    ProtectedVolume::Cylinder {
        radius_m,
        half_height_m,
    }
}

fn obstacle(
    id: u32,
    position_m: [f64; 3],
    velocity_mps: [f64; 3],
    volume: ProtectedVolume,
) -> ReplayObstacle {
    ReplayObstacle {
        id,
        name: format!("N{id}"),
        volume,
        motion: vec![ReplayPiece {
            start_s: 0.0,
            position_m,
            velocity_mps,
        }],
        present_s: None,
        known_from_s: None,
    }
}

/// The scripted course at a time: away to `side` (a share of the full angle), past, back.
fn script(t_s: f64, side: f64) -> (ReplayState, f64) {
    let phase = t_s % PERIOD_S;
    let away = side * 0.9;
    match phase {
        _ if side == 0.0 => (ReplayState::Cruise, 0.0),
        p if p < 10.0 => (ReplayState::Cruise, 0.0),
        p if p < 14.0 => (ReplayState::Threatened, 0.0),
        p if p < 24.0 => (ReplayState::Avoiding, away),
        p if p < 36.0 => (ReplayState::Recovering, -away),
        _ => (ReplayState::Cruise, 0.0),
    }
}

fn flight(name: &str, duration_s: f64, obstacles: Vec<ReplayObstacle>, side: f64) -> ReplayRun {
    let mut run = ReplayRun::named(name);
    let end_m = duration_s * AIRSPEED_MPS;
    run.mission_m = (0..=4)
        .map(|k| [end_m * f64::from(k) / 4.0, 0.0, HEIGHT_M])
        .collect();
    let mut sample = ReplaySample {
        position_m: [0.0, 0.0, HEIGHT_M],
        ..ReplaySample::default()
    };
    let mut least: Option<ReplayOutcome> = None;
    let mut t_s = 0.0;
    for step in 0_u32.. {
        if t_s > duration_s + 1e-9 {
            break;
        }
        let (state, course_rad) = script(t_s, side);
        if state != sample.state {
            run.events.push(ReplayEvent {
                t_s,
                text: format!("{state:?} begins").to_lowercase(),
            });
        }
        let turn = (course_rad - sample.course_rad).clamp(-COURSE_RATE_RADPS, COURSE_RATE_RADPS);
        sample.t_s = t_s;
        sample.state = state;
        sample.bank_rad += (turn / COURSE_RATE_RADPS * FRAC_PI_4 - sample.bank_rad) * 0.4;
        sample.climb_rad = 0.12 * (TAU * t_s / PERIOD_S).sin() * side;
        run.samples.push(sample);
        for obstacle in &obstacles {
            let margin_m = margin(obstacle, &sample);
            if least.is_none_or(|l| margin_m < l.min_margin_m) {
                least = Some(ReplayOutcome {
                    min_margin_m: margin_m,
                    t_s,
                    obstacle: obstacle.id,
                });
            }
        }
        run.decisions.push(decide(&sample, &obstacles, side));
        run.decision_times.push(ReplayDecisionTime {
            t_s,
            decision_us: 8.0
                + 6.0 * unit(step)
                + if state == ReplayState::Cruise {
                    0.0
                } else {
                    40.0
                },
        });
        sample.course_rad += turn * STEP_S;
        let level = AIRSPEED_MPS * sample.climb_rad.cos() * STEP_S;
        sample.position_m[0] += level * sample.course_rad.cos();
        sample.position_m[1] += level * sample.course_rad.sin();
        sample.position_m[2] += AIRSPEED_MPS * sample.climb_rad.sin() * STEP_S;
        t_s = f64::from(step + 1) * STEP_S;
    }
    run.obstacles = obstacles;
    run.outcome = least;
    run
}

fn margin(obstacle: &ReplayObstacle, sample: &ReplaySample) -> f64 {
    let piece = obstacle.motion[0];
    let after_s = sample.t_s - piece.start_s;
    let offset = |axis: usize| {
        sample.position_m[axis] - piece.position_m[axis] - piece.velocity_mps[axis] * after_s
    };
    obstacle
        .volume
        .margin_m(fga::Vec3::new(offset(0), offset(1), offset(2)))
}

fn decide(sample: &ReplaySample, obstacles: &[ReplayObstacle], side: f64) -> ReplayDecision {
    let phase = sample.t_s % PERIOD_S;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "small"
    )]
    let threat = (sample.t_s / PERIOD_S) as u32;
    let mut decision = ReplayDecision {
        t_s: sample.t_s,
        state: sample.state,
        ..ReplayDecision::default()
    };
    if sample.state == ReplayState::Cruise || obstacles.is_empty() {
        decision.lines = vec!["Clear: nothing comes too close on the mission.".into()];
        return decision;
    }
    let entry_s = 22.0 - phase;
    decision.threat = Some(threat);
    if sample.state == ReplayState::Recovering {
        decision.lines = vec![
            "Flying back to the mission.".into(),
            format!("least margin on the way back {:.1} m", 9.0 + side),
        ];
        decision.paths = vec![path(ReplayPathKind::WayBack, sample, -0.9 * side, 9.0)];
        return decision;
    }
    decision.latest_start_s = Some((16.0 - phase).max(0.0));
    decision.lines = vec![
        format!("Threat: N{threat} in {entry_s:.1} s, 12 m inside."),
        format!("Latest safe start in {:.1} s.", (16.0 - phase).max(0.0)),
        format!(
            "{} 52°, least margin {:.1} m.",
            if side > 0.0 {
                "Turn left"
            } else {
                "Turn right"
            },
            4.2 + 0.1 * side
        ),
        "9 manoeuvres looked at, 4 certified.".into(),
    ];
    for k in -4_i32..=4 {
        let turn = f64::from(k) * 0.3;
        let (kind, margin_m) = match k {
            3 => (ReplayPathKind::Chosen, 4.2),
            _ if k.abs() >= 3 => (ReplayPathKind::Certified, 6.0 + f64::from(k)),
            _ => (ReplayPathKind::Rejected, f64::from(k.abs()) * 8.0 - 25.0),
        };
        decision
            .paths
            .push(path(kind, sample, turn * side.signum(), margin_m));
    }
    let mut back = path(ReplayPathKind::WayBack, sample, 0.9 * side, 4.2);
    if let Some([x, ..]) = back.points_m.last().copied() {
        back.points_m = vec![
            back.points_m[back.points_m.len() / 2],
            [x + 60.0, 0.0, HEIGHT_M],
            [x + 120.0, 0.0, HEIGHT_M],
        ];
    }
    decision.paths.push(back);
    decision
}

/// Turn to a course at the full rate, then straight on for 12 s.
fn path(kind: ReplayPathKind, sample: &ReplaySample, course_rad: f64, margin_m: f64) -> ReplayPath {
    let mut points_m = vec![sample.position_m];
    let mut position = sample.position_m;
    let mut course = sample.course_rad;
    for _ in 0..60 {
        let step_s = 0.2;
        let limit = COURSE_RATE_RADPS * step_s;
        course += (course_rad - course).clamp(-limit, limit).clamp(-PI, PI);
        position[0] += AIRSPEED_MPS * step_s * course.cos();
        position[1] += AIRSPEED_MPS * step_s * course.sin();
        points_m.push(position);
    }
    ReplayPath {
        kind,
        margin_m: Some(margin_m),
        points_m,
    }
}
