//! The data of an overview, and the choice of the obstacles that it follows.

use fga::Vec3;
use fga::avoider::State;
use fga::situation::ProtectedVolume;

use super::look::Shape;
use crate::zone::DrawnZone;

/// The aircraft's position at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathSample {
    /// Seconds from the start of the run.
    pub time_s: f64,
    /// Position, metres, local frame.
    pub position_m: Vec3,
    /// Its state from this sample to the next.
    pub state: State,
}

/// An obstacle's position at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OverviewPoint {
    /// Seconds from the start of the run.
    pub time_s: f64,
    /// Centre of the protected volume, metres, local frame.
    pub position_m: Vec3,
}

/// The closest approach to one obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestApproach {
    /// Seconds from the start of the run.
    pub time_s: f64,
    /// Distance to the obstacle's centre, metres.
    pub separation_m: f64,
    /// Signed distance to its protected volume, metres; negative inside.
    pub margin_m: f64,
}

/// An obstacle and its track.
#[derive(Debug, Clone, PartialEq)]
pub struct OverviewObstacle {
    /// Its number in the run; moments refer to it.
    pub id: u32,
    /// Its name for people; any text.
    pub name: String,
    /// The protected volume around it.
    pub volume: ProtectedVolume,
    /// Its track, linear between points; a single point is an obstacle at rest for the whole run.
    /// Outside the times of a longer track the obstacle is absent.
    pub track: Vec<OverviewPoint>,
    /// The closest approach over continuous time, if known; else the samples give it.
    pub closest: Option<ClosestApproach>,
}

/// A kind of critical moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MomentKind {
    /// A threat was recognised.
    ThreatSeen,
    /// The avoiding manoeuvre began.
    ManeuverBegun,
    /// The aircraft was back on its route.
    Rejoined,
}

impl MomentKind {
    /// All kinds in the order in which they occur.
    pub const ALL: [Self; 3] = [Self::ThreatSeen, Self::ManeuverBegun, Self::Rejoined];

    /// Lower-case English name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ThreatSeen => "threat seen",
            Self::ManeuverBegun => "manoeuvre begun",
            Self::Rejoined => "rejoined",
        }
    }

    pub(super) const fn shape(self) -> Shape {
        match self {
            Self::ThreatSeen => Shape::Seen,
            Self::ManeuverBegun => Shape::Begun,
            Self::Rejoined => Shape::Rejoined,
        }
    }
}

/// A critical moment of the run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OverviewMoment {
    /// Seconds from the start of the run.
    pub time_s: f64,
    /// The kind of moment.
    pub kind: MomentKind,
    /// The obstacle concerned, by its number.
    pub obstacle: Option<u32>,
}

/// The data of one run that its picture needs.
///
/// # Examples
///
/// ```
/// use fga::{Vec3, situation::ProtectedVolume};
/// use fga::avoider::State;
/// use fga_report::overview::{Overview, OverviewObstacle, OverviewPoint, PathSample};
///
/// let overview = Overview {
///     title: "Past a mast".into(),
///     mission_m: vec![Vec3::ZERO, Vec3::new(400.0, 0.0, 0.0)],
///     samples: (0..27)
///         .map(|second| PathSample {
///             time_s: f64::from(second),
///             position_m: Vec3::new(15.0 * f64::from(second), 0.0, 50.0),
///             state: State::Cruise,
///         })
///         .collect(),
///     obstacles: vec![OverviewObstacle {
///         id: 1,
///         name: "mast".into(),
///         volume: ProtectedVolume::Sphere { radius_m: 30.0 },
///         track: vec![OverviewPoint { time_s: 0.0, position_m: Vec3::new(200.0, 40.0, 50.0) }],
///         closest: None,
///     }],
///     ..Overview::default()
/// };
/// assert!(overview.to_svg().contains("least margin 10."));
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Overview {
    /// Heading of the picture.
    pub title: String,
    /// The mission's waypoints in order, metres, local frame.
    pub mission_m: Vec<Vec3>,
    /// The flown track, in time order.
    pub samples: Vec<PathSample>,
    /// The obstacles.
    pub obstacles: Vec<OverviewObstacle>,
    /// The zones.
    pub zones: Vec<DrawnZone>,
    /// Critical moments; the picture draws the closest approaches without an entry here.
    pub moments: Vec<OverviewMoment>,
}

impl Overview {
    /// The aircraft's position at a time: linear between samples, constant beyond the ends.
    pub(crate) fn position_at_m(&self, time_s: f64) -> Option<Vec3> {
        if !time_s.is_finite() {
            return None;
        }
        let first = self.samples.first()?;
        let after = self.samples.partition_point(|s| s.time_s <= time_s);
        let Some(before) = after.checked_sub(1).and_then(|i| self.samples.get(i)) else {
            return Some(first.position_m);
        };
        let Some(next) = self.samples.get(after) else {
            return Some(before.position_m);
        };
        let span = next.time_s - before.time_s;
        let share = if span > 0.0 {
            (time_s - before.time_s) / span
        } else {
            0.0
        };
        Some(before.position_m + (next.position_m - before.position_m) * share)
    }

    /// Start and end of the run, seconds.
    pub(crate) fn times_s(&self) -> (f64, f64) {
        let start = self.samples.first().map_or(0.0, |s| s.time_s);
        let end = self.samples.last().map_or(1.0, |s| s.time_s);
        (start, end)
    }

    /// The finite samples.
    pub(crate) fn finite_samples(&self) -> impl Iterator<Item = &PathSample> {
        self.samples
            .iter()
            .filter(|s| s.time_s.is_finite() && s.position_m.is_finite())
    }
}

impl OverviewObstacle {
    /// Its position at a time; `None` while it is absent.
    pub(crate) fn position_at_m(&self, time_s: f64) -> Option<Vec3> {
        if let [only] = self.track.as_slice() {
            return Some(only.position_m);
        }
        let after = self.track.partition_point(|p| p.time_s <= time_s);
        let before = self.track.get(after.checked_sub(1)?)?;
        let Some(next) = self.track.get(after) else {
            return (before.time_s == time_s).then_some(before.position_m);
        };
        let share = (time_s - before.time_s) / (next.time_s - before.time_s);
        Some(before.position_m + (next.position_m - before.position_m) * share)
    }

    /// Whether it moves.
    pub(crate) fn moves(&self) -> bool {
        self.track
            .windows(2)
            .any(|pair| pair[0].position_m.distance(pair[1].position_m) > 1e-3)
    }
}

/// The distance of the aircraft from an obstacle at a moment.
#[derive(Debug, Clone, Copy)]
pub(super) struct CurvePoint {
    pub(super) time_s: f64,
    pub(super) separation_m: f64,
    pub(super) margin_m: f64,
}

impl CurvePoint {
    /// Margin or separation.
    pub(super) const fn shown(&self, by_margin: bool) -> f64 {
        if by_margin {
            self.margin_m
        } else {
            self.separation_m
        }
    }
}

/// An obstacle with a name and a curve in the picture.
pub(super) struct FollowedTrack<'a> {
    pub(super) obstacle: &'a OverviewObstacle,
    pub(super) closest: ClosestApproach,
    /// One point for each sample at which it exists.
    pub(super) curve: Vec<CurvePoint>,
}

/// The followed obstacles, closest first, and a summary of the others.
pub(super) struct Focus<'a> {
    pub(super) followed: Vec<FollowedTrack<'a>>,
    /// The others with the time of their closest approach.
    pub(super) others: Vec<(&'a OverviewObstacle, f64)>,
    /// The least margin of the others at each sample.
    pub(super) least_other: Vec<CurvePoint>,
}

/// Most obstacles with a name and a curve.
const MOST_FOLLOWED: usize = 6;

impl<'a> Focus<'a> {
    pub(super) fn new(overview: &'a Overview) -> Self {
        let samples: Vec<&PathSample> = overview.finite_samples().collect();
        // About two samples a pixel are enough for the curves and for the ranking.
        let stride = (samples.len() / 2400).max(1);
        let mut all: Vec<FollowedTrack> = Vec::new();
        let mut least: Vec<CurvePoint> = Vec::new();
        for obstacle in &overview.obstacles {
            let Some(followed) = follow(obstacle, &samples, stride) else {
                continue;
            };
            all.push(followed);
        }
        all.sort_by(|a, b| a.closest.margin_m.total_cmp(&b.closest.margin_m));
        let rest = all.split_off(all.len().min(MOST_FOLLOWED));
        if let Some(longest) = rest.iter().map(|f| f.curve.len()).max() {
            least.reserve(longest);
            let mut points: Vec<&CurvePoint> = rest.iter().flat_map(|f| &f.curve).collect();
            points.sort_by(|a, b| {
                a.time_s
                    .total_cmp(&b.time_s)
                    .then(a.margin_m.total_cmp(&b.margin_m))
            });
            for point in points {
                if least.last().is_none_or(|last| last.time_s != point.time_s) {
                    least.push(*point);
                }
            }
        }
        Self {
            followed: all,
            others: rest
                .iter()
                .map(|f| (f.obstacle, f.closest.time_s))
                .collect(),
            least_other: least,
        }
    }
}

fn follow<'a>(
    obstacle: &'a OverviewObstacle,
    samples: &[&PathSample],
    stride: usize,
) -> Option<FollowedTrack<'a>> {
    let last = samples.len().checked_sub(1)?;
    let curve: Vec<CurvePoint> = samples
        .iter()
        .enumerate()
        .filter(|(index, _)| index % stride == 0 || *index == last)
        .filter_map(|(_, sample)| {
            let offset = sample.position_m - obstacle.position_at_m(sample.time_s)?;
            offset.is_finite().then(|| CurvePoint {
                time_s: sample.time_s,
                separation_m: offset.length(),
                margin_m: obstacle.volume.margin_m(offset),
            })
        })
        .collect();
    let sampled = curve
        .iter()
        .min_by(|a, b| a.margin_m.total_cmp(&b.margin_m))?;
    let closest = obstacle.closest.unwrap_or(ClosestApproach {
        time_s: sampled.time_s,
        separation_m: sampled.separation_m,
        margin_m: sampled.margin_m,
    });
    Some(FollowedTrack {
        obstacle,
        closest,
        curve,
    })
}
