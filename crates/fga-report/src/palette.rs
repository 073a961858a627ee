//! The colours of Okabe and Ito, and the neutral ones for text, axes and paper.

pub(crate) const BLACK: &str = "#000000";
pub(crate) const ORANGE: &str = "#e69f00";
pub(crate) const SKY: &str = "#56b4e9";
pub(crate) const GREEN: &str = "#009e73";
pub(crate) const BLUE: &str = "#0072b2";
pub(crate) const VERMILION: &str = "#d55e00";
pub(crate) const PURPLE: &str = "#cc79a7";

/// Text and axis lines.
pub(crate) const INK: &str = "#1f2328";
/// Secondary text.
pub(crate) const MUTED: &str = "#59636e";
/// The picture's background, so that it is readable on a dark page too.
pub(crate) const PAPER: &str = "#ffffff";
