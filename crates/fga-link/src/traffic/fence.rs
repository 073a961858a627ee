//! The vehicle's fence as zones, and the floor and the ceiling as obstacles at rest.
//!
//! Circles and polygons bind exactly as the vehicle stores them. The ground below the floor and the sky above the ceiling are very
//! wide cylinders.

use fga::certificate::Line;
use fga::situation::{Movement, Obstacle, ObstacleKind, ProtectedVolume};
use fga::zone::{ALL_HEIGHTS_M, Outline, Zone};
use fga::{Vec2, Vec3};
use fga_formats::geodesy::{Geodetic, LocalFrame};
use fga_formats::zones::MAX_CORNERS;
use mavlink::dialects::ardupilotmega::MavCmd;

use crate::mission::ListItem;
use crate::number::degrees_from_e7;

/// Identifiers of floor and ceiling.
pub const FLOOR_ID: u32 = 1;
/// See [`FLOOR_ID`].
pub const CEILING_ID: u32 = 2;

/// The outline of a part of a fence, metres east and north.
#[derive(Debug, Clone, PartialEq)]
enum FencePart {
    Polygon(Vec<Vec2>),
    Circle(Vec2, f64),
}

/// A fence in the local frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VehicleFence {
    /// Each with whether the vehicle keeps within it.
    parts: Vec<(bool, FencePart)>,
    /// Whether some items were unintelligible, or no polygon.
    pub incomplete: bool,
}

impl VehicleFence {
    /// Lays the items of a fence download.
    pub fn new(items: &[ListItem], frame: &LocalFrame) -> Self {
        let mut fence = Self::default();
        let mut corners_m: Vec<Vec2> = Vec::new();
        for item in items {
            let place = item.as_ref().and_then(|item| {
                let place = Geodetic::new(degrees_from_e7(item.x), degrees_from_e7(item.y), 0.0);
                Some((item, frame.to_local_m(place?).truncate()))
            });
            let Some((item, at_m)) = place else {
                fence.incomplete = true;
                continue;
            };
            let number = f64::from(item.param1);
            let keep_in = matches!(
                item.command,
                MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION
                    | MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION
            );
            match item.command {
                MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION
                | MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION => {
                    corners_m.push(at_m);
                    // Each vertex has the number of the polygon's vertices.
                    if (corners_m.len() as f64) >= number {
                        // Its edges may cross: the vehicle counts them.
                        if (3..=MAX_CORNERS).contains(&corners_m.len()) {
                            let corners_m = core::mem::take(&mut corners_m);
                            fence.parts.push((keep_in, FencePart::Polygon(corners_m)));
                        } else {
                            fence.incomplete = true;
                            corners_m.clear();
                        }
                    }
                }
                MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION
                | MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION
                    if number > 0.0 && number.is_finite() && at_m.is_finite() =>
                {
                    fence.parts.push((keep_in, FencePart::Circle(at_m, number)));
                }
                MavCmd::MAV_CMD_NAV_FENCE_RETURN_POINT => {}
                _ => fence.incomplete = true,
            }
        }
        fence.incomplete |= !corners_m.is_empty();
        fence
    }

    /// Its circles and polygons, at all heights.
    pub fn zones(&self) -> impl Iterator<Item = Zone<'_>> {
        self.parts.iter().map(|(keep_in, part)| Zone {
            keep_in: *keep_in,
            outline: match part {
                FencePart::Polygon(corners_m) => Outline::Polygon(corners_m),
                FencePart::Circle(center_m, radius_m) => Outline::Circle(*center_m, *radius_m),
            },
            heights_m: ALL_HEIGHTS_M,
        })
    }

    /// The zones that bind a vehicle at a place, metres: all; but where several areas to stay in are joined, only the one of them
    /// that the vehicle is deepest in, or nearest to. Within that one it is within their union.
    pub fn binding(&self, joined: bool, own_m: Vec3) -> Vec<Zone<'_>> {
        let (within, mut zones): (Vec<_>, Vec<_>) = self.zones().partition(|zone| zone.keep_in);
        let depth_m = |zone: &Zone<'_>| {
            if zone.is_entered(own_m) {
                -zone.way_out_m(own_m).length()
            } else {
                zone.nearest_m(&Line::at(own_m), f64::INFINITY)
            }
        };
        let deepest = |one: &&Zone<'_>, other: &&Zone<'_>| depth_m(one).total_cmp(&depth_m(other));
        if joined {
            zones.extend(within.iter().max_by(deepest));
        } else {
            zones.extend(within);
        }
        zones
    }

    /// Whether a way crosses it; of areas to stay in that are joined, it may go from one to another one where these overlap.
    pub fn is_crossed(&self, joined: bool, way_m: &[Vec3]) -> bool {
        let (within, beside): (Vec<_>, Vec<_>) = self.zones().partition(|zone| zone.keep_in);
        let mut legs = way_m.iter().zip(way_m.iter().skip(1));
        legs.any(|(from_m, to_m)| {
            let is_clear = |zone: &Zone<'_>| keeps(zone, *from_m, *to_m);
            let is_within = if joined && !within.is_empty() {
                keep_in_any(&within, *from_m, *to_m)
            } else {
                within.iter().all(is_clear)
            };
            !(is_within && beside.iter().all(is_clear))
        })
    }
}

/// Whether a leg is on the right side of a zone.
fn keeps(zone: &Zone<'_>, from_m: Vec3, to_m: Vec3) -> bool {
    zone.nearest_m(&Line::between(from_m, to_m), 0.0) >= 0.0
}

/// Whether each part of a leg, to half a metre, is within one of some zones.
fn keep_in_any(zones: &[Zone<'_>], from_m: Vec3, to_m: Vec3) -> bool {
    let middle_m = from_m.midpoint(to_m);
    zones.iter().any(|zone| keeps(zone, from_m, to_m))
        || from_m.distance(to_m) > 0.5
            && keep_in_any(zones, from_m, middle_m)
            && keep_in_any(zones, middle_m, to_m)
}

/// The forbidden air below `height_m` (or above it) as an obstacle; heights in the local frame.
pub fn layer(id: u32, height_m: f64, below: bool, own_m: Vec3) -> Obstacle {
    const DEPTH_M: f64 = 2_000.0;
    const WIDTH_M: f64 = 100_000.0;
    let z = if below {
        height_m - DEPTH_M
    } else {
        height_m + DEPTH_M
    };
    let volume = ProtectedVolume::Cylinder {
        radius_m: WIDTH_M,
        half_height_m: DEPTH_M,
    };
    let mut obstacle = Obstacle::straight(id, Vec3::new(own_m.x, own_m.y, z), Vec3::ZERO, volume);
    obstacle.kind = ObstacleKind::NaturalBarrier;
    obstacle.movement = Movement::AtRest;
    obstacle
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga_formats::geodesy::Earth;
    use mavlink::dialects::ardupilotmega::MISSION_ITEM_INT_DATA;

    fn frame() -> LocalFrame {
        LocalFrame::new(Geodetic::new(37.0, -122.0, 0.0).unwrap(), Earth::Wgs84)
    }

    fn vertex(
        command: MavCmd,
        frame: &LocalFrame,
        x: f64,
        y: f64,
        param1: f32,
    ) -> MISSION_ITEM_INT_DATA {
        let place = frame.to_geodetic(Vec3::new(x, y, 0.0));
        MISSION_ITEM_INT_DATA {
            command,
            param1,
            x: crate::number::degrees_to_e7(place.latitude_deg),
            y: crate::number::degrees_to_e7(place.longitude_deg),
            ..MISSION_ITEM_INT_DATA::DEFAULT
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "small counts and radii")]
    fn laid(items: &[(MavCmd, f64, f64, f64)]) -> VehicleFence {
        let frame = frame();
        let items: Vec<ListItem> = (items.iter())
            .map(|(command, x, y, number)| Some(vertex(*command, &frame, *x, *y, *number as f32)))
            .collect();
        VehicleFence::new(&items, &frame)
    }

    /// Whether a place, metres east and north, is on the allowed side of all.
    fn allows(fence: &VehicleFence, x: f64, y: f64) -> bool {
        let at_m = Vec3::new(x, y, 300.0);
        fence.zones().all(|zone| !zone.is_entered(at_m))
    }

    const IN: MavCmd = MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION;
    const OUT: MavCmd = MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION;

    /// Rows of cylinders held a boundary to within 4 m.
    #[test]
    fn polygons_bind_to_the_centimetre_at_their_edges_in_either_order() {
        let mut corners = [
            (-500.0, -500.0),
            (500.0, -500.0),
            (500.0, 500.0),
            (0.0, 0.0),
            (-500.0, 500.0),
        ];
        for _ in 0..2 {
            for (command, keep_in) in [(IN, true), (OUT, false)] {
                let fence = laid(&corners.map(|(x, y)| (command, x, y, 5.0)));
                assert!(!fence.incomplete && fence.zones().count() == 1);
                for (x, y, inside) in [
                    (0.0, -499.98, true),
                    (0.0, -500.02, false),
                    (0.0, -0.02, true),
                    (0.0, 0.03, false),
                ] {
                    assert_eq!(allows(&fence, x, y), inside == keep_in, "{x} {y}");
                }
            }
            corners.reverse();
        }
    }

    /// A vehicle accepts them, and counts edges.
    #[test]
    fn a_polygon_that_crosses_itself_binds_as_the_vehicle_counts() {
        // A bow tie with its first corner again at the end.
        let tie = [
            (0.0, 0.0),
            (100.0, 100.0),
            (100.0, 0.0),
            (0.0, 100.0),
            (0.0, 0.0),
        ];
        for (command, keep_in) in [(IN, true), (OUT, false)] {
            let fence = laid(&tie.map(|(x, y)| (command, x, y, 5.0)));
            assert!(!fence.incomplete && fence.zones().count() == 1);
            for (x, y, inside) in [(10.0, 50.0, true), (90.0, 50.0, true), (50.0, 10.0, false)] {
                assert_eq!(allows(&fence, x, y), inside == keep_in, "{x} {y}");
            }
            // Along the ground from lobe to lobe it crosses, and over the knot as well.
            assert!(fence.is_crossed(
                false,
                &[Vec3::new(-50.0, 50.0, 0.0), Vec3::new(150.0, 50.0, 0.0)]
            ));
            let beside_m = Vec3::new(50.0, 30.0, 9.0);
            assert_eq!(
                fence.is_crossed(false, &[beside_m, beside_m + Vec3::X]),
                keep_in
            );
        }
    }

    #[test]
    fn circles_bind_to_the_centimetre() {
        let around = laid(&[(MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION, 0.0, 0.0, 800.0)]);
        assert!(allows(&around, 799.98, 0.0) && !allows(&around, 0.0, 800.02));
        let beside = laid(&[(MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION, 0.0, 0.0, 100.0)]);
        assert!(!allows(&beside, 99.98, 0.0) && allows(&beside, 0.0, 100.02));
    }

    #[test]
    fn a_way_across_is_known() {
        let fence = laid(&[(MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION, 0.0, 0.0, 100.0)]);
        let way_m = |y: f64| [Vec3::new(-900.0, y, 50.0), Vec3::new(900.0, y, 50.0)];
        assert!(fence.is_crossed(false, &way_m(99.0)) && !fence.is_crossed(false, &way_m(101.0)));
        assert!(!fence.is_crossed(false, &[]));
    }

    /// Together no place is within both: nothing was certified.
    #[test]
    fn of_joined_areas_the_one_that_the_vehicle_is_in_binds() {
        let fence = laid(&[
            (MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION, 0.0, 0.0, 300.0),
            (
                MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION,
                500.0,
                0.0,
                300.0,
            ),
            (MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION, 0.0, 900.0, 50.0),
        ]);
        for (x, is_second) in [(0.0, false), (240.0, false), (260.0, true), (900.0, true)] {
            let zones = fence.binding(true, Vec3::new(x, 0.0, 80.0));
            let [beside, within] = zones.as_slice() else {
                panic!("{zones:?}");
            };
            let east = Vec3::new(700.0, 0.0, 80.0);
            assert!(!beside.keep_in && within.keep_in);
            assert_eq!(!within.is_entered(east), is_second, "{x}");
        }
        assert_eq!(fence.binding(false, Vec3::ZERO).len(), 3);
        let way_m = |y: f64| [Vec3::new(-200.0, y, 80.0), Vec3::new(700.0, y, 80.0)];
        // The circles meet at 166 m from the line between their centres.
        for (y, crosses) in [(0.0, false), (160.0, false), (170.0, true)] {
            assert_eq!(fence.is_crossed(true, &way_m(y)), crosses, "{y}");
            assert!(fence.is_crossed(false, &way_m(y)));
        }
    }

    #[test]
    fn an_unusable_fence_is_reported() {
        let frame = frame();
        assert!(VehicleFence::new(&[None], &frame).incomplete);
        assert!(laid(&[(IN, 0.0, 0.0, 4.0)]).incomplete);
        // Two corners, and a circle without a radius: the rest counts.
        let mut items = vec![(IN, 0.0, 0.0, 2.0), (IN, 100.0, 0.0, 2.0)];
        items.push((MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION, 0.0, 0.0, 0.0));
        items.push((MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION, 0.0, 0.0, 9.0));
        let fence = laid(&items);
        assert!(fence.incomplete && fence.zones().count() == 1);
    }
}
