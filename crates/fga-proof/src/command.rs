//! A command with what is proven about it.
//!
//! A [`Command`] owns its manoeuvre. [`Command::prove`] predicts exactly that manoeuvre and keeps the proof beside it; whoever
//! changes the manoeuvre loses the proof:
//!
//! | proof | what it says |
//! |---|---|
//! | [`Certified`] | the flight keeps a separation from everything that is assumed |
//! | [`Leaving`] | the aircraft is already in a volume: the flight keeps a separation from what is left of it, and leads out |
//! | none | nothing is proven |

use crate::assumptions::{Assumption, Assumptions};
use crate::certificate::{Closest, MOST_SPLITS, bounded};
use crate::maneuver::Maneuver;
use crate::meter::Meter;
use crate::prediction::{FlightPath, Flyer, MotionState};

/// Longest horizon, seconds.
pub const LONGEST_HORIZON_S: f64 = 1e5;

/// Largest separation that is asked for, metres.
pub const LARGEST_TARGET_M: f64 = 1e6;

/// What is asked of a manoeuvre: a separation for a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terms {
    horizon_s: f64,
    target_m: f64,
    enough_m: f64,
}

impl Terms {
    /// A horizon, seconds from the decision, above 0; a separation beyond the volumes, metres, 0 or more; and the separation at
    /// which margins are capped, metres, at least that. `None` for numbers out of range.
    pub fn new(horizon_s: f64, target_m: f64, enough_m: f64) -> Option<Self> {
        let is_ahead = horizon_s > 0.0 && horizon_s <= LONGEST_HORIZON_S;
        let is_apart = (0.0..=LARGEST_TARGET_M).contains(&target_m) && enough_m >= target_m;
        (is_ahead && is_apart).then_some(Self {
            horizon_s,
            target_m,
            enough_m,
        })
    }
}

/// A separation for a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Lower bound of the separation beyond the volumes, metres; at least the target.
    pub margin_m: f64,
    /// Separation that was asked for, metres.
    pub target_m: f64,
    /// Horizon, seconds from the decision.
    pub horizon_s: f64,
    /// How much less than the target is kept from zones and ground, metres: the mission, or the aircraft, is that near to them.
    pub spared_m: f64,
    /// Zones and ground are kept clear of up to this moment, seconds from the decision.
    pub fixed_s: f64,
    /// Number of hazards that are kept clear of; an aircraft that may turn is several.
    pub hazards: u32,
}

/// A proven separation from everything that is assumed, each volume in its full size. Only [`Command::prove`] makes one:
///
/// ```compile_fail,E0423
/// use fga_proof::command::{Bound, Certified};
/// fn made(bound: Bound) -> Certified {
///     Certified(bound)
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certified(Bound);

/// The same for an aircraft that is already in a volume, or in what an uncertainty adds to it: from a smaller one around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leaving(Bound);

/// What is proven about a manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Proof {
    /// It keeps clear of everything.
    Certified(Certified),
    /// It leads out of what the aircraft is in, and keeps clear of everything else.
    Leaving(Leaving),
}

impl Proof {
    /// The separation.
    pub const fn bound(&self) -> &Bound {
        match self {
            Self::Certified(Certified(bound)) | Self::Leaving(Leaving(bound)) => bound,
        }
    }
}

/// A manoeuvre to fly, with its proof if it has one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command {
    maneuver: Maneuver,
    proof: Option<Proof>,
}

impl core::ops::Deref for Command {
    type Target = Maneuver;

    #[inline]
    fn deref(&self) -> &Maneuver {
        &self.maneuver
    }
}

impl From<Maneuver> for Command {
    fn from(maneuver: Maneuver) -> Self {
        let proof = None;
        Self { maneuver, proof }
    }
}

impl Command {
    /// Hold course and climb angle: zeros, which are written without a copy.
    pub const fn hold() -> Self {
        Self {
            maneuver: Maneuver::hold(),
            proof: None,
        }
    }

    /// The manoeuvre, to be changed: nothing is proven about it any more.
    #[inline]
    pub const fn edit(&mut self) -> &mut Maneuver {
        self.proof = None;
        &mut self.maneuver
    }

    /// What is proven about it, from the start and the moment of [`Self::prove`].
    pub const fn proof(&self) -> Option<&Proof> {
        self.proof.as_ref()
    }

    /// The separation that is certified, if it is.
    pub const fn certified(&self) -> Option<&Bound> {
        match &self.proof {
            Some(Proof::Certified(Certified(bound))) => Some(bound),
            _ => None,
        }
    }

    /// Proves that the flight of its manoeuvre from a start keeps what is asked, in continuous time, if it does. It predicts the
    /// flight into a path.
    ///
    /// # Errors
    /// What is known of the least separation, where nothing is proven.
    #[inline(never)]
    pub fn prove(
        &mut self,
        (flyer, path): (&Flyer, &mut FlightPath),
        start: &MotionState,
        assumptions: &Assumptions<'_>,
        terms: &Terms,
        meter: &Meter,
    ) -> Result<Proof, Closest> {
        let (horizon_s, target_m) = (terms.horizon_s, terms.target_m);
        self.proof = None;
        path.predict_within(flyer, start, &self.maneuver, horizon_s, meter);
        let asked = (horizon_s, target_m, terms.enough_m);
        let found = bounded(flyer, path, assumptions, asked, (MOST_SPLITS, meter));
        let weakest = assumptions.weakest();
        if !found.holds(target_m) || weakest == Assumption::Compared {
            return Err(found);
        }
        let bound = Bound {
            margin_m: found.margin_m,
            target_m,
            horizon_s,
            spared_m: assumptions.fixed.spared_m(),
            fixed_s: assumptions.fixed.zones.until_s,
            hazards: u32::try_from(assumptions.rows.len()).unwrap_or(u32::MAX),
        };
        let proof = if weakest == Assumption::Leaving {
            Proof::Leaving(Leaving(bound))
        } else {
            Proof::Certified(Certified(bound))
        };
        self.proof = Some(proof);
        Ok(proof)
    }
}
