//! Where the obstacles of a decision lie.

use super::known::Known;
use crate::assumptions::MAX_HAZARDS;
use crate::certificate::Hazard;

/// Most obstacles of a decision: the most urgent ones.
pub const MAX_TRACKED: usize = MAX_HAZARDS - LIMITS;

/// Places that obstacles leave to the limits of altitude.
pub const LIMITS: usize = 2;

/// Room for obstacles and [`LIMITS`] more, and for hazards, no fewer and at most [`MAX_HAZARDS`]. An obstacle is one hazard, an
/// aircraft that may turn is up to 20: without room it counts as flying straight on.
pub trait Places {
    /// What is known of obstacles, and the hazards.
    fn all(&self) -> (&[Known], &[Hazard]);

    /// The same, to change it.
    fn all_mut(&mut self) -> (&mut [Known], &mut [Hazard]);
}

/// Room for as many as a decision can have.
pub type AllPlaces = ([Known; MAX_HAZARDS], [Hazard; MAX_HAZARDS]);

/// Room that the caller lends.
pub type Lent<'a> = (&'a mut [Known], &'a mut [Hazard]);

impl<K, H> Places for (K, H)
where
    K: AsRef<[Known]> + AsMut<[Known]>,
    H: AsRef<[Hazard]> + AsMut<[Hazard]>,
{
    fn all(&self) -> (&[Known], &[Hazard]) {
        (self.0.as_ref(), self.1.as_ref())
    }

    fn all_mut(&mut self) -> (&mut [Known], &mut [Hazard]) {
        (self.0.as_mut(), self.1.as_mut())
    }
}
