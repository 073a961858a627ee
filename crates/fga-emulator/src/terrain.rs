//! The vehicle's own terrain: it answers `TERRAIN_CHECK` by the heights of its memory card, block by block.

use alloc::sync::Arc;
use core::fmt;

use mavlink::dialects::ardupilotmega::{TERRAIN_CHECK_DATA, TERRAIN_REPORT_DATA};

/// Blocks in memory, as many as ArduPilot has without a change of `TERRAIN_CACHE_SZ`.
const BLOCKS: usize = 12;
/// A block is read from the card within this, seconds.
const READ_S: f64 = 0.1;
/// Side of a block, degrees: 2.8 km.
const BLOCK_DEG: f64 = 0.025;
/// Distance between posts, metres.
const SPACING_M: u16 = 100;

/// The height of the ground above mean sea level at a latitude and a longitude, degrees, metres; `None` where the card has none.
type Height = dyn Fn([f64; 2]) -> Option<f32> + Send + Sync;

/// The memory card and the blocks in memory.
#[derive(Clone)]
pub(crate) struct Card {
    height_m: Arc<Height>,
    /// The blocks, with when they are there and when they were last asked for, seconds.
    blocks: Vec<([i32; 2], f64, f64)>,
}

impl fmt::Debug for Card {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Card")
            .field("blocks", &self.blocks)
            .finish_non_exhaustive()
    }
}

impl Card {
    pub(crate) fn new(height_m: Arc<Height>) -> Self {
        let blocks = Vec::new();
        Self { height_m, blocks }
    }

    /// The answer; a spacing of 0 says that the height is not known, or not yet.
    pub(crate) fn answer(&mut self, data: &TERRAIN_CHECK_DATA, now_s: f64) -> TERRAIN_REPORT_DATA {
        let place = [data.lat, data.lon].map(|e7| 1e-7 * f64::from(e7));
        let known_m = (self.height_m)(place).filter(|_| self.is_read(place, now_s));
        TERRAIN_REPORT_DATA {
            lat: data.lat,
            lon: data.lon,
            spacing: known_m.map_or(0, |_| SPACING_M),
            terrain_height: known_m.unwrap_or(0.0),
            ..TERRAIN_REPORT_DATA::DEFAULT
        }
    }

    /// Whether the block of a place is in memory. A missing block replaces the least recently requested one.
    fn is_read(&mut self, place: [f64; 2], now_s: f64) -> bool {
        #[expect(clippy::cast_possible_truncation, reason = "degrees of the earth")]
        let key = place.map(|degrees| libm::floor(degrees / BLOCK_DEG) as i32);
        if let Some((_, there_s, asked_s)) = self.blocks.iter_mut().find(|block| block.0 == key) {
            *asked_s = now_s;
            return now_s >= *there_s;
        }
        self.blocks.sort_by(|one, other| other.2.total_cmp(&one.2));
        self.blocks.truncate(BLOCKS - 1);
        self.blocks.push((key, now_s + READ_S, now_s));
        false
    }
}
