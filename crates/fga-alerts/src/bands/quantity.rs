//! The bands of one quantity.

use crate::bands::colors::Band;
use crate::bands::memory::Memory;
use crate::bands::picture::Contribution;
use crate::bands::pool::WindowPool;
use crate::bands::recovered::Recovery;
use crate::bands::span::{Quantity, Span};
use crate::bands::ways::Ways;
use alloc::vec::Vec;

/// The bands of one quantity.
#[derive(Debug, Clone)]
pub struct QuantityBands {
    pub(super) quantity: Quantity,
    pub(super) bands: Vec<Band>,
    pub(super) peripheral: [Vec<Contribution>; 3],
    pub(super) recovery: Recovery,
    pub(super) memory: Memory,
    pub(super) ways: Ways,
    pub(super) pool: WindowPool,
    pub(super) span: Option<Span>,
}
