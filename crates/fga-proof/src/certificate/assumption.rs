//! What is assumed where something is kept clear of.

/// What a hazard stands for, the strongest assumption first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Assumption {
    /// An obstacle as it was reported, with its uncertainty, that keeps its velocity.
    Reported,
    /// One motion out of all that its aircraft may fly.
    Possible,
    /// An extent that somebody else answers for.
    Given,
    /// A volume that the aircraft is already in, made smaller so that a way out of it keeps clear of the rest.
    Leaving,
    /// A volume to compare manoeuvres by: nothing is proven against it.
    Compared,
}
