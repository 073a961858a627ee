//! From a replay to the data of its page: JSON with base64 arrays.
//!
//! The code that reads this data describes it: `viewer/src/data.ts`.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use super::thin;
use super::{
    Replay, ReplayBands, ReplayDecision, ReplayGround, ReplayGuidance, ReplayObstacle,
    ReplayPathKind, ReplayRun, ReplaySample,
};
use crate::page::json;
use crate::zone::DrawnZone;

/// The built viewer; `npm run build` in `viewer/` writes it.
pub(super) const TEMPLATE: &str = include_str!("../../assets/replay.html");

#[derive(Serialize)]
struct Page<'a> {
    title: &'a str,
    runs: Vec<EncodedRun<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ground: Option<EncodedGround>,
}

/// The ground: a height is `low` and as many steps, two bytes little endian, the largest number where it is unknown.
#[derive(Serialize)]
pub(super) struct EncodedGround {
    corner: [f64; 2],
    spacing: [f64; 2],
    columns: usize,
    low: f64,
    step: f64,
    heights: String,
}

#[derive(Serialize)]
pub(super) struct EncodedRun<'a> {
    name: &'a str,
    samples: Samples,
    mission: &'a [[f64; 3]],
    obstacles: Vec<EncodedObstacle<'a>>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    zones: &'a [DrawnZone],
    motion: String,
    decisions: Vec<EncodedDecision<'a>>,
    points: String,
    interval: f64,
    times: EncodedTimes,
    events: Vec<EncodedEvent<'a>>,
    outcome: Option<EncodedOutcome>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    guidance: Vec<EncodedGuidance>,
    #[serde(skip_serializing_if = "is_zero")]
    levels: usize,
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde asks for a reference"
)]
const fn is_zero(levels: &usize) -> bool {
    *levels == 0
}

/// Alerts and bands: `who` holds obstacle, level and time to the violation; `bands` from, to and
/// region.
#[derive(Serialize)]
struct EncodedGuidance {
    t: f64,
    level: usize,
    who: Vec<(u32, usize, Option<f64>)>,
    values: [f64; 4],
    bands: [Vec<(f64, f64, u8)>; 4],
    recovery: [Option<f64>; 4],
}

/// Columns as base64: `f32` little endian, the state one byte.
#[derive(Serialize)]
struct Samples {
    t: String,
    x: String,
    y: String,
    z: String,
    course: String,
    climb: String,
    bank: String,
    state: String,
}

#[derive(Serialize)]
pub(super) struct EncodedObstacle<'a> {
    id: u32,
    name: &'a str,
    /// Radius, metres.
    r: f64,
    /// Half height, metres, of a cylinder.
    h: Option<f64>,
    present: Option<[f64; 2]>,
    known: Option<f64>,
    /// Number of pieces of its motion.
    pieces: usize,
}

#[derive(Serialize)]
pub(super) struct EncodedDecision<'a> {
    t: f64,
    state: u8,
    lines: &'a [String],
    threat: Option<u32>,
    latest: Option<f64>,
    /// Origin of its points, metres.
    origin: [f64; 3],
    /// Length of one step of its points, metres.
    step: f64,
    paths: Vec<EncodedPath>,
    #[serde(skip_serializing_if = "Option::is_none")]
    loss: Option<[f64; 2]>,
    /// For each aircraft its identifier, and of each future the weight and the number of its points.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    futures: Vec<(u32, Vec<(f64, usize)>)>,
}

#[derive(Serialize)]
struct EncodedPath {
    kind: u8,
    margin: Option<f64>,
    /// Number of its points.
    n: usize,
}

#[derive(Serialize)]
struct EncodedTimes {
    t: String,
    us: String,
}

#[derive(Serialize)]
struct EncodedEvent<'a> {
    t: f64,
    text: &'a str,
}

#[derive(Serialize)]
struct EncodedOutcome {
    margin: f64,
    t: f64,
    id: u32,
}

pub(super) fn replay_json(replay: &Replay) -> String {
    let count = replay.runs.len();
    json(&Page {
        title: &replay.title,
        runs: replay.runs.iter().map(|r| run(r, count)).collect(),
        ground: replay.ground.as_ref().map(ground),
    })
}

pub(super) fn run(run: &ReplayRun, runs: usize) -> EncodedRun<'_> {
    let (kept, interval) = thin::decisions(&run.decisions, runs);
    let mut points = Vec::new();
    let decisions = kept.into_iter().map(|d| decision(d, &mut points)).collect();
    let mut motion = Vec::new();
    let obstacles = run
        .obstacles
        .iter()
        .map(|o| obstacle(o, &mut motion))
        .collect();
    EncodedRun {
        name: &run.name,
        samples: samples(&thin::samples(&run.samples, runs)),
        mission: &run.mission_m,
        obstacles,
        zones: &run.zones,
        motion: floats(motion.into_iter()),
        decisions,
        points: bytes(&points),
        interval,
        times: EncodedTimes {
            t: floats(run.decision_times.iter().map(|d| d.t_s)),
            us: floats(run.decision_times.iter().map(|d| d.decision_us)),
        },
        events: run
            .events
            .iter()
            .map(|e| EncodedEvent {
                t: e.t_s,
                text: &e.text,
            })
            .collect(),
        outcome: run.outcome.map(|o| EncodedOutcome {
            margin: o.min_margin_m,
            t: o.t_s,
            id: o.obstacle,
        }),
        guidance: run.guidance.iter().map(guidance).collect(),
        levels: run.alert_levels,
    }
}

pub(super) fn ground(all: &ReplayGround) -> EncodedGround {
    let ReplayGround {
        corner_m: corner,
        spacing_m: spacing,
        columns,
        heights_m,
    } = thin::ground(all);
    let known = heights_m.iter().filter(|height_m| height_m.is_finite());
    let known = known.map(|height_m| f64::from(*height_m));
    let low = known.clone().fold(f64::INFINITY, f64::min);
    let high = known.fold(f64::NEG_INFINITY, f64::max);
    let low = if low.is_finite() { low } else { 0.0 };
    let step = (high - low).max(1.0) / f64::from(u16::MAX - 1);
    let steps = heights_m.iter().map(|height_m| {
        if !height_m.is_finite() {
            return u16::MAX;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the step is chosen to fit"
        )]
        let steps = ((f64::from(*height_m) - low) / step).round() as u16;
        steps
    });
    EncodedGround {
        corner,
        spacing,
        columns,
        low,
        step,
        heights: bytes(&steps.flat_map(u16::to_le_bytes).collect::<Vec<u8>>()),
    }
}

/// Four decimals: a display shows no more.
fn short(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

fn guidance(guidance: &ReplayGuidance) -> EncodedGuidance {
    let aircraft = guidance.aircraft.iter();
    let quantities = guidance.quantities.each_ref();
    let parts = |bands: &ReplayBands| {
        let parts = bands.bands.iter();
        parts
            .map(|band| (short(band.low), short(band.high), band.region.code()))
            .collect()
    };
    EncodedGuidance {
        t: guidance.t_s,
        level: guidance.level,
        who: aircraft
            .map(|alert| (alert.obstacle, alert.level, alert.violation_s.map(short)))
            .collect(),
        values: quantities.map(|bands| short(bands.value)),
        bands: quantities.map(parts),
        recovery: quantities.map(|bands| bands.recovery_s.map(short)),
    }
}

fn samples(samples: &[&ReplaySample]) -> Samples {
    let column = |value: fn(&ReplaySample) -> f64| floats(samples.iter().map(|s| value(s)));
    Samples {
        t: column(|s| s.t_s),
        x: column(|s| s.position_m[0]),
        y: column(|s| s.position_m[1]),
        z: column(|s| s.position_m[2]),
        course: column(|s| s.course_rad),
        climb: column(|s| s.climb_rad),
        bank: column(|s| s.bank_rad),
        state: STANDARD.encode(samples.iter().map(|s| s.state.code()).collect::<Vec<u8>>()),
    }
}

/// An obstacle without its motion, whose pieces (start, position, velocity) go to the pool.
pub(super) fn obstacle<'a>(
    obstacle: &'a ReplayObstacle,
    pool: &mut Vec<f64>,
) -> EncodedObstacle<'a> {
    let pieces = thin::motion(&obstacle.motion);
    for piece in &pieces {
        pool.push(piece.start_s);
        pool.extend(piece.position_m);
        pool.extend(piece.velocity_mps);
    }
    EncodedObstacle {
        id: obstacle.id,
        name: &obstacle.name,
        r: obstacle.volume.radius_m(),
        h: match obstacle.volume {
            fga::situation::ProtectedVolume::Sphere { .. } => None,
            fga::situation::ProtectedVolume::Cylinder { half_height_m, .. } => Some(half_height_m),
        },
        present: obstacle.present_s,
        known: obstacle.known_from_s,
        pieces: pieces.len(),
    }
}

/// A record without its points, which go to the pool in steps just large enough for the farthest.
pub(super) fn decision<'a>(
    decision: &'a ReplayDecision,
    pool: &mut Vec<u8>,
) -> EncodedDecision<'a> {
    let ways = decision.futures.iter().flat_map(|one| &one.ways);
    let lines: Vec<Vec<[f64; 3]>> = (decision.paths.iter().map(|path| &path.points_m))
        .chain(ways.map(|(_, points_m)| points_m))
        .map(|points_m| thin::polyline(points_m))
        .collect();
    let mut numbers = lines.iter().skip(decision.paths.len()).map(Vec::len);
    let futures = decision.futures.iter().map(|one| {
        let ways = one.ways.iter().zip(&mut numbers);
        (
            one.obstacle,
            ways.map(|((weight, _), n)| (short(*weight), n)).collect(),
        )
    });
    let origin = lines.iter().flatten().next().copied().unwrap_or_default();
    let reach_m = lines
        .iter()
        .flatten()
        .flat_map(|point| (0..3).map(|axis| (point[axis] - origin[axis]).abs()))
        .fold(1.0, f64::max);
    let step = reach_m / f64::from(i16::MAX);
    for point in lines.iter().flatten() {
        for axis in 0..3 {
            let steps = (point[axis] - origin[axis]) / step;
            #[expect(clippy::cast_possible_truncation, reason = "the step is chosen to fit")]
            pool.extend((steps.round() as i16).to_le_bytes());
        }
    }
    EncodedDecision {
        t: decision.t_s,
        state: decision.state.code(),
        lines: &decision.lines,
        threat: decision.threat,
        latest: decision.latest_start_s,
        origin,
        step,
        paths: decision
            .paths
            .iter()
            .zip(&lines)
            .map(|(path, points)| EncodedPath {
                kind: match path.kind {
                    ReplayPathKind::Certified => 0,
                    ReplayPathKind::Rejected => 1,
                    ReplayPathKind::Chosen => 2,
                    ReplayPathKind::WayBack => 3,
                },
                margin: path.margin_m,
                n: points.len(),
            })
            .collect(),
        loss: decision.p_loss.map(|both| both.map(short)),
        futures: futures.collect(),
    }
}

pub(super) fn bytes(bytes: &[u8]) -> String {
    STANDARD.encode(bytes)
}

/// Single precision, little endian, base64: 1 mm at 10 km.
pub(super) fn floats(values: impl Iterator<Item = f64>) -> String {
    #[expect(clippy::cast_possible_truncation, reason = "enough for a picture")]
    let bytes: Vec<u8> = values.flat_map(|v| (v as f32).to_le_bytes()).collect();
    STANDARD.encode(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hostile_name_stays_text() {
        let name = "</script><img src=x onerror=alert(1)>&\u{2028}<!--fga:data-->";
        let replay = Replay {
            title: name.into(),
            runs: vec![ReplayRun::named(name)],
            ground: None,
        };
        let page = super::super::render(&replay);
        assert!(!page.contains("<img"));
        assert!(page.contains("&lt;/script&gt;&lt;img"));
        let data = replay_json(&replay);
        assert!(!data.contains(['<', '>', '&', '\u{2028}']));
        let read: serde_json::Value = serde_json::from_str(&data).expect("JSON");
        assert_eq!(read["runs"][0]["name"], name);
    }

    #[test]
    fn points_come_back_within_a_decimetre() {
        let path = super::super::ReplayPath {
            kind: ReplayPathKind::Chosen,
            margin_m: Some(1.5),
            points_m: vec![[100.0, 50.0, 10.0], [900.0, -700.0, 60.0]],
        };
        let record = ReplayDecision {
            paths: vec![path],
            ..ReplayDecision::default()
        };
        let mut pool = Vec::new();
        let written = decision(&record, &mut pool);
        let steps: Vec<i16> = pool
            .chunks_exact(2)
            .map(|b| i16::from_le_bytes([b[0], b[1]]))
            .collect();
        let y_m = written.origin[1] + f64::from(steps[4]) * written.step;
        assert!((y_m + 700.0).abs() < 0.1, "{y_m}");
        assert_eq!(written.paths[0].n, 2);
    }

    #[test]
    fn the_ground_is_written_to_centimetres_with_its_holes() {
        let written = ground(&ReplayGround {
            corner_m: [-100.0, 50.0],
            spacing_m: [30.0, 20.0],
            columns: 2,
            heights_m: vec![-20.0, 500.0, f32::NAN, 76.25],
        });
        let read = STANDARD.decode(&written.heights).expect("base64");
        let steps: Vec<u16> = (read.chunks_exact(2))
            .map(|b| u16::from_le_bytes([b[0], b[1]]))
            .collect();
        let height_m = |post: usize| written.low + f64::from(steps[post]) * written.step;
        assert_eq!(steps[2], u16::MAX);
        for (post, expected_m) in [(0, -20.0), (1, 500.0), (3, 76.25)] {
            assert!((height_m(post) - expected_m).abs() < 0.01, "{post}");
        }
    }

    #[test]
    fn of_too_many_posts_the_highest_stay() {
        let side = 1000;
        let mut heights_m = vec![10.0; side * side];
        heights_m[417 * side + 333] = 250.0;
        heights_m[900 * side + 15] = f32::NAN;
        let thinned = thin::ground(&ReplayGround {
            corner_m: [0.0, 0.0],
            spacing_m: [10.0, 10.0],
            columns: side,
            heights_m,
        });
        assert_eq!(thinned.spacing_m, [40.0, 40.0]);
        assert_eq!(thinned.columns, 251);
        assert_eq!(thinned.heights_m.len(), 251 * 251);
        let at = |x: usize, y: usize| thinned.heights_m[y * thinned.columns + x];
        // The peak at 3,330 and 4,170 m lies between 3,320 and 3,360, and 4,160 and 4,200.
        assert_eq!(at(83, 104), 250.0);
        assert!(at(4, 225).is_nan());
        assert_eq!(at(250, 250), 10.0);
    }

    #[test]
    fn floats_are_little_endian_singles() {
        // 1.0 is 0x3f800000.
        assert_eq!(floats([1.0].into_iter()), "AACAPw==");
    }
}
