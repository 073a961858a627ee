//! One flight, closed loop: look, decide, fly until the next decision, measure.
//!
//! | question | answer |
//! |---|---|
//! | who flies it? | [`Engine`], or step by step [`SteppedFlight`] |
//! | what does it show? | [`Observer`] |
//! | how did it end? | [`Outcome`] |

mod flight;
mod measured;
mod observer;
mod stands;
mod stepped;
mod steps;

pub use flight::Engine;
pub use measured::Outcome;
pub use observer::{DecisionMoment, Observer, Sample};
pub use stepped::SteppedFlight;
