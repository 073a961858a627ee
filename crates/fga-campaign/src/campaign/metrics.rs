//! Metrics of the field: near mid-air collision, well clear, severity, alerts, and the geometry of the
//! encounter.
//!
//! The list below gives the names, units and meanings of the columns, the fields of
//! [`Metrics`], and the description inside a results file.

use fga_sim::own::FailureKind;

/// The type of a metric.
#[derive(Debug, Clone, Copy)]
pub enum Access {
    /// A number.
    Real(fn(&Metrics) -> Option<f64>, fn(&mut Metrics, Option<f64>)),
    /// Yes or no.
    Flag(fn(&Metrics) -> Option<bool>, fn(&mut Metrics, Option<bool>)),
    /// A failure by its word.
    Failure(
        fn(&Metrics) -> Option<FailureKind>,
        fn(&mut Metrics, Option<FailureKind>),
    ),
}

/// A metric as a column.
#[derive(Debug, Clone, Copy)]
pub struct Field {
    /// Name of the column.
    pub name: &'static str,
    /// What it means, with the unit last.
    pub meaning: &'static str,
    /// Its type.
    pub access: Access,
}

macro_rules! metrics {
    (@type Real) => { Option<f64> };
    (@type Flag) => { Option<bool> };
    (@type Failure) => { Option<FailureKind> };
    ($($name:ident: $kind:ident, $meaning:literal;)*) => {
        /// Metrics of one encounter under one policy; all but the last four are `None` for obstacles of families
        /// and encounter files, which are no recorded or modeled aircraft.
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        pub struct Metrics {
            $(#[doc = $meaning] pub $name: metrics!(@type $kind),)*
        }

        /// All metrics in the order of their columns.
        pub const ALL_FIELDS: &[Field] = &[
            $(Field {
                name: stringify!($name),
                meaning: $meaning,
                access: Access::$kind(|metrics| metrics.$name, |metrics, value| metrics.$name = value),
            },)*
        ];
    };
}

metrics! {
    nominal_nmac: Flag, "whether the encounter without any avoidance has a near mid-air collision (closer than 500 ft and 100 ft at once)";
    nmac: Flag, "whether the flown encounter has one";
    nominal_lowc: Flag, "whether the encounter without avoidance loses well clear of ASTM F3442 (closer than 2,000 ft and 250 ft at once)";
    lowc: Flag, "whether the flown encounter loses it";
    nominal_do365: Flag, "whether the encounter without avoidance loses well clear of DO-365B en route (0.66 nmi, 35 s, 450 ft)";
    do365: Flag, "whether the flown encounter loses it";
    nominal_severity: Real, "highest severity of that loss without avoidance (that of DO-365), 0 to 1; empty without a loss";
    severity: Real, "highest severity of that loss as flown, 0 to 1; empty without a loss";
    nominal_horizontal_m: Real, "least horizontal separation without avoidance, m";
    nominal_vertical_m: Real, "vertical separation at that time, m";
    horizontal_m: Real, "least horizontal separation as flown, m";
    vertical_m: Real, "vertical separation at that time, m";
    cpa_s: Real, "time of the closest approach in space without avoidance, s from the start";
    corrective_s: Real, "first corrective alert of DO-365B en route before that time, without avoidance; the lead before it, s";
    warning_s: Real, "first warning alert, in the same way; the lead, s";
    action_s: Real, "first maneuver; the lead before the closest approach without avoidance, s (negative after it)";
    changes: Real, "times that the track turned from going away from its line to coming back, or the reverse";
    ownship_mps: Real, "speed over the ground of the ownship at the closest approach without avoidance, m/s";
    intruder_mps: Real, "speed over the ground of the intruder there, m/s";
    closing_mps: Real, "relative speed there, m/s";
    crossing_deg: Real, "difference of the horizontal directions there, 0 (same) to 180 (opposite), degrees";
    intruder_turn_deg: Real, "largest change of the intruder's direction from its first one before the closest approach, degrees";
    intruder_climb_mps: Real, "climb of the intruder there, m/s";
    nominal_nmac_scale: Real, "least over time of the larger of horizontal separation / 500 ft and vertical separation / 100 ft, without avoidance; below 1 is a near mid-air collision";
    nmac_scale: Real, "the same as flown";
    altitude_m: Real, "height of the ownship there in the frame of the recording or model, m";
    work: Real, "largest work of a decision, in units of the core's meter; empty for a policy that counts none";
    policy_failure: Failure, "how a policy of one's own failed, after which it flew the mission: raised, timed-out, not-finite, wrong-shape or ended; empty without a failure";
    min_terrain_clearance_m: Real, "least height above the ground where it is known, m; empty without ground";
    min_zone_margin_m: Real, "least distance of the zones, m; negative on the wrong side; empty without zones";
}

/// The metrics of every campaign; the last two of all belong to campaigns with ground or zones.
pub const FIELDS: &[Field] = ALL_FIELDS.split_at(ALL_FIELDS.len() - 2).0;

/// A class of geometry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum EncounterGeometry {
    /// Directions at least 150° apart.
    HeadOn,
    /// In between.
    Crossing,
    /// Directions at most 30° apart.
    Overtaking,
}

impl EncounterGeometry {
    /// All classes.
    pub const ALL: [Self; 3] = [Self::HeadOn, Self::Crossing, Self::Overtaking];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::HeadOn => "head-on",
            Self::Crossing => "crossing",
            Self::Overtaking => "overtaking",
        }
    }
}

impl Metrics {
    /// With rounded numbers: six decimals.
    pub(super) fn rounded(mut self) -> Self {
        for field in ALL_FIELDS {
            if let Access::Real(get, set) = field.access {
                let value = get(&self).filter(|value| value.is_finite()).map(kept);
                set(&mut self, value);
            }
        }
        self
    }

    /// The class of the geometry.
    pub fn geometry(&self) -> Option<EncounterGeometry> {
        let degrees = self.crossing_deg?;
        Some(if degrees >= 150.0 {
            EncounterGeometry::HeadOn
        } else if degrees <= 30.0 {
            EncounterGeometry::Overtaking
        } else {
            EncounterGeometry::Crossing
        })
    }
}

/// A length or time with six decimals, without negative zero.
pub(super) fn kept(value: f64) -> f64 {
    libm::rint(value * 1e6) / 1e6 + 0.0
}
