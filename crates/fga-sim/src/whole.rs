//! Counts and indices that are computed as real numbers.

/// The whole part of a number, within the range of its type.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the whole part is wanted, and the cast keeps it in range"
)]
pub fn whole(number: f64) -> u32 {
    number as u32
}

/// The value at a share of the way through a sorted list, the nearest one.
pub fn nearest<T: Copy>(sorted: &[T], share: f64) -> Option<T> {
    let last = sorted.len().saturating_sub(1) as f64;
    sorted.get(whole((share * last).round()) as usize).copied()
}
