//! Ground asked of the vehicle itself: it answers each `TERRAIN_CHECK` with a `TERRAIN_REPORT` of the height at that place, from its
//! memory card or from what its own ground station has sent it. The posts of a piece together are the content of a `TERRAIN_DATA`.

use fga_formats::terrain::RequestedBlock;
use mavlink::dialects::ardupilotmega::{
    TERRAIN_CHECK_DATA, TERRAIN_DATA_DATA, TERRAIN_REPORT_DATA,
};

/// Posts of a piece.
const POSTS: usize = 16;
/// Most unanswered pieces that are asked for, those nearest to the way. A block of ArduPilot has this many pieces; its memory holds
/// twelve blocks.
const NEAREST: usize = 56;
/// Where some posts of a piece were answered the others are asked for again after this, seconds.
const AGAIN_S: f64 = 0.5;
/// Time after an answer that a height is not known, seconds.
pub(super) const UNKNOWN_S: f64 = 1.0;
/// Posts asked for at once …
const AT_ONCE: usize = 2;
/// … and how often, seconds: 20 a second, 1 kB with the answers.
const EVERY_S: f64 = 0.1;

/// What lies ahead on the way counts as nearer than what lies beside it: by this share of its distance along the way.
const AHEAD: f64 = 0.5;

/// How far apart two places are, latitudes and longitudes, degrees of latitude.
fn apart_deg(one: [f64; 2], other: [f64; 2]) -> f64 {
    let level = libm::cos(one[0].to_radians());
    let east_deg = level * libm::remainder(other[1] - one[1], 360.0);
    (other[0] - one[0]).hypot(east_deg)
}

/// A piece whose posts are asked for.
#[derive(Debug, Clone)]
pub(super) struct CheckedPiece {
    corner_e7: [i32; 2],
    spacing_m: u16,
    number: u8,
    posts_e7: [[i32; 2]; POSTS],
    heights_m: [Option<i16>; POSTS],
    /// The next post of this round.
    next: usize,
    /// Whether an answer came in this round.
    is_heard: bool,
}

impl CheckedPiece {
    /// The missing piece of some blocks that is nearest to the way, latitudes and longitudes in degrees; where pieces before it were not
    /// known, as many are left out.
    pub(super) fn nearest<'a>(
        blocks: impl Iterator<Item = &'a RequestedBlock>,
        spacing_m: u16,
        way: &[[f64; 2]],
        left_out: usize,
    ) -> Option<Self> {
        let off = |block: &RequestedBlock, number: u8| {
            let post = block.posts_e7(number)[5].map(|e7| 1e-7 * f64::from(e7));
            let (mut along_deg, mut before) = (0.0, None);
            let off_deg = way.iter().map(|place| {
                let from = before.replace(*place).unwrap_or(*place);
                along_deg += AHEAD * apart_deg(from, *place);
                along_deg + apart_deg(*place, post)
            });
            off_deg.fold(f64::INFINITY, f64::min)
        };
        let mut missing: Vec<(f64, &RequestedBlock, u8)> = blocks
            .flat_map(|block| (0..56).map(move |number| (block, number)))
            .filter(|(block, number)| block.mask() >> number & 1 == 1)
            .map(|(block, number)| (off(block, number), block, number))
            .collect();
        missing.sort_by(|one, other| one.0.total_cmp(&other.0));
        let turn = left_out.checked_rem(missing.len().min(NEAREST))?;
        let (_, block, number) = missing.get(turn)?;
        Some(Self {
            corner_e7: block.corner_e7(),
            spacing_m,
            number: *number,
            posts_e7: block.posts_e7(*number),
            heights_m: [None; POSTS],
            next: 0,
            is_heard: false,
        })
    }

    /// Begins another round where one has ended; `false` if that one was not answered at all.
    pub(super) fn goes_on(&mut self) -> bool {
        if self.next < POSTS {
            return true;
        }
        self.next = 0;
        core::mem::take(&mut self.is_heard)
    }

    /// The next posts to ask for, and the time until the next call, seconds; at the end of a round without any answer `pause_s`.
    pub(super) fn checks(&mut self, pause_s: f64) -> (Vec<TERRAIN_CHECK_DATA>, f64) {
        let posts = (0..).zip(self.posts_e7).zip(self.heights_m);
        let missing = posts
            .skip(self.next)
            .filter(|(_, height_m)| height_m.is_none());
        let asked: Vec<_> = missing.take(AT_ONCE).map(|(post, _)| post).collect();
        let last = asked.get(AT_ONCE - 1);
        self.next = last.map_or(POSTS, |(index, _)| index + 1);
        let due_s = match (self.next == POSTS, self.is_heard) {
            (false, _) => EVERY_S,
            (true, true) => AGAIN_S,
            (true, false) => pause_s,
        };
        let checks = asked.into_iter();
        let checks = checks.map(|(_, [lat, lon])| TERRAIN_CHECK_DATA { lat, lon });
        (checks.collect(), due_s)
    }

    /// Takes an answer about one of its posts; `None` about another place.
    pub(super) fn take(&mut self, data: &TERRAIN_REPORT_DATA) -> Option<PostAnswer> {
        let index = (self.posts_e7.iter()).position(|post| *post == [data.lat, data.lon])?;
        if data.spacing == 0 {
            return Some(PostAnswer::Unknown);
        }
        self.is_heard = true;
        #[expect(
            clippy::cast_possible_truncation,
            reason = "larger heights are no ground either"
        )]
        let height_m = libm::rintf(data.terrain_height) as i16;
        *self.heights_m.get_mut(index)? = Some(height_m);
        if self.heights_m.contains(&None) {
            return Some(PostAnswer::Known);
        }
        let ([lat, lon], gridbit) = (self.corner_e7, self.number);
        Some(PostAnswer::Whole(TERRAIN_DATA_DATA {
            lat,
            lon,
            grid_spacing: self.spacing_m,
            gridbit,
            data: self.heights_m.map(Option::unwrap_or_default),
        }))
    }
}

/// What an answer of the vehicle is to a piece.
#[derive(Debug)]
pub(super) enum PostAnswer {
    /// The vehicle does not know the height, or reads it first.
    Unknown,
    /// A height, with others missing.
    Known,
    /// The last height that was missing.
    Whole(TERRAIN_DATA_DATA),
}
