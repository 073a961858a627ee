//! Ground asked of a ground station, in the way of ArduPilot: `TERRAIN_REQUEST` names a block and its missing pieces, each
//! `TERRAIN_DATA` has one. Neither names a receiver, so that the vehicle passes them on between its links. Or asked of the vehicle, post
//! by post. What never comes stays unknown.

mod checked;

use alloc::sync::Arc;
use std::path::PathBuf;

use fga_formats::geodesy::Geodetic;
use fga_formats::terrain::{Datum, RequestedBlock, Stated, Taken, Terrain, TerrainFile};
use mavlink::dialects::ardupilotmega::{
    TERRAIN_CHECK_DATA, TERRAIN_DATA_DATA, TERRAIN_REPORT_DATA, TERRAIN_REQUEST_DATA,
};

use self::checked::{CheckedPiece, PostAnswer, UNKNOWN_S};

/// Distance between posts, metres: ArduPilot's `TERRAIN_SPACING` where nobody changes it, so that one answer serves the vehicle too.
const SPACING_M: u16 = 100;
/// Vertical error of what ground stations send, metres: they have SRTM.
const ERROR_M: f64 = 16.0;
/// ArduPilot asks this often, seconds; without an answer the pause doubles …
const PAUSE_S: f64 = 2.0;
/// … up to this, seconds: then nobody seems to answer.
const LONGEST_PAUSE_S: f64 = 32.0;
/// The operator reads it once the vehicle has not known this many pieces in a row; one is asked for each second.
const MOST_UNKNOWN: usize = 30;
/// Most blocks in memory.
const MOST_BLOCKS: usize = 64;
/// New pieces become ground this often, seconds.
const LAID_S: f64 = 5.0;

/// What came of the requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Answers {
    /// Pieces that changed the ground.
    pub(crate) taken: u32,
    /// Pieces of asked blocks whose heights are no ground.
    pub(crate) wrong: u32,
    /// Pieces that contradict earlier ones by more than the errors of both: the higher ground counts.
    pub(crate) contradicting: u32,
}

/// The blocks that are asked for.
#[derive(Debug, Clone)]
pub(crate) struct AskedBlocks {
    /// The wanted ones first, the most urgent at the front.
    blocks: Vec<RequestedBlock>,
    wanted: usize,
    due_s: f64,
    pause_s: f64,
    /// How many requests in a row, or pieces that the vehicle was asked for, were not answered.
    unanswered: usize,
    /// Whether the last request waits for an answer.
    waits: bool,
    answers: Answers,
    /// The piece that the vehicle is asked for, post by post.
    checked: Option<CheckedPiece>,
    /// The pieces of the last ground, its number, and when it was made, seconds.
    laid: (u32, u32, f64),
}

impl Default for AskedBlocks {
    fn default() -> Self {
        Self {
            blocks: Vec::new(),
            wanted: 0,
            due_s: f64::NEG_INFINITY,
            pause_s: PAUSE_S,
            unanswered: 0,
            waits: false,
            answers: Answers::default(),
            checked: None,
            laid: (0, 0, f64::NEG_INFINITY),
        }
    }
}

impl AskedBlocks {
    /// The next request, where one is due; `places` gives latitudes and longitudes whose ground is wanted, degrees, the most urgent first.
    pub(crate) fn request(
        &mut self,
        now_s: f64,
        places: impl FnOnce() -> Vec<[f64; 2]>,
    ) -> Option<TERRAIN_REQUEST_DATA> {
        if now_s < self.due_s {
            return None;
        }
        self.want(&places());
        (self.pause_s, self.unanswered) = if self.waits {
            (
                (2.0 * self.pause_s).min(LONGEST_PAUSE_S),
                self.unanswered + 1,
            )
        } else {
            (PAUSE_S, 0)
        };
        self.due_s = now_s + self.pause_s;
        let wanted = || self.blocks.iter().take(self.wanted);
        let missing = || wanted().filter(|block| block.mask() != 0);
        // What has no answer, a hole, holds up no other block.
        let turn = self.unanswered.checked_rem(missing().count());
        let block = turn.and_then(|turn| missing().nth(turn));
        self.waits = block.is_some();
        let block = block?;
        let [lat, lon] = block.corner_e7();
        Some(TERRAIN_REQUEST_DATA {
            mask: block.mask(),
            lat,
            lon,
            grid_spacing: SPACING_M,
        })
    }

    /// The next posts to ask the vehicle for; `places` gives latitudes and longitudes whose ground is wanted, degrees, and how many of
    /// them are here or on the way: what is nearest to these comes first.
    pub(crate) fn checks(
        &mut self,
        now_s: f64,
        places: impl FnOnce() -> (Vec<[f64; 2]>, usize),
    ) -> Vec<TERRAIN_CHECK_DATA> {
        if now_s < self.due_s {
            return Vec::new();
        }
        if self.checked.as_mut().is_some_and(|piece| !piece.goes_on()) {
            self.checked = None;
            self.unanswered += 1;
            self.waits = true;
            self.pause_s = (2.0 * self.pause_s).min(LONGEST_PAUSE_S);
        }
        if self.checked.is_none() {
            let (places, on_way) = places();
            self.want(&places);
            let wanted = self.blocks.iter().take(self.wanted);
            let way = places.get(..on_way).unwrap_or_default();
            self.checked = CheckedPiece::nearest(wanted, SPACING_M, way, self.unanswered);
        }
        let piece = self.checked.as_mut();
        let (checks, pause_s) = piece.map_or((Vec::new(), PAUSE_S), |it| it.checks(self.pause_s));
        // From when it was due: calls come some milliseconds early or late.
        self.due_s = (self.due_s + pause_s).max(now_s);
        checks
    }

    /// Takes an answer of the vehicle; what the operator reads of it, if that is new.
    pub(crate) fn take_report(&mut self, data: &TERRAIN_REPORT_DATA) -> Option<&'static str> {
        let answer = self.checked.as_mut()?.take(data)?;
        self.pause_s = PAUSE_S;
        self.waits = matches!(answer, PostAnswer::Unknown);
        match answer {
            PostAnswer::Known => return None,
            // Another piece comes before it.
            PostAnswer::Unknown => {
                self.unanswered += 1;
                self.due_s += UNKNOWN_S;
            }
            PostAnswer::Whole(_) => {
                self.unanswered = 0;
                self.due_s = f64::NEG_INFINITY;
            }
        }
        self.checked = None;
        match answer {
            PostAnswer::Whole(data) => self.take(&data),
            _ => None,
        }
    }

    /// Asks for all that is known again; it counts until the new heights come.
    pub(crate) fn ask_again(&mut self) {
        self.blocks.iter_mut().for_each(RequestedBlock::ask_again);
        self.checked = None;
    }

    /// Puts the blocks of these places first, and keeps as many of the others as there is room for.
    fn want(&mut self, places: &[[f64; 2]]) {
        let mut left = core::mem::take(&mut self.blocks);
        for place in places {
            let Some(block) = RequestedBlock::around(*place, SPACING_M) else {
                continue;
            };
            let is_it = |other: &RequestedBlock| other.corner_e7() == block.corner_e7();
            if self.blocks.len() == MOST_BLOCKS || self.blocks.iter().any(is_it) {
                continue;
            }
            let known = left.iter().position(is_it);
            let known = known.map(|index| left.swap_remove(index));
            self.blocks.push(known.unwrap_or(block));
        }
        self.wanted = self.blocks.len();
        let room = MOST_BLOCKS - self.wanted;
        let known = left.into_iter().filter(|block| block.field().is_some());
        self.blocks.extend(known.take(room));
    }

    /// Takes a piece; what the operator reads of it, if that is new.
    pub(crate) fn take(&mut self, data: &TERRAIN_DATA_DATA) -> Option<&'static str> {
        let corner_e7 = [data.lat, data.lon];
        let takes = |block: &mut RequestedBlock| {
            let taken = block.take(corner_e7, data.grid_spacing, data.gridbit, &data.data);
            (taken != Taken::Other).then_some(taken)
        };
        match self.blocks.iter_mut().find_map(takes)? {
            Taken::Other => None,
            Taken::NoGround => {
                self.answers.wrong += 1;
                (self.answers.wrong == 1).then_some("fga: terrain answers that are no ground")
            }
            Taken::New => {
                self.waits = false;
                self.answers.taken += 1;
                None
            }
            Taken::Again { higher_m } => {
                self.answers.taken += u32::from(higher_m != 0);
                let contradicts = f64::from(higher_m.unsigned_abs()) > 2.0 * ERROR_M;
                self.answers.contradicting += u32::from(contradicts);
                (contradicts && self.answers.contradicting == 1)
                    .then_some("fga: terrain answers contradict, higher counts")
            }
        }
    }

    /// What came so far.
    pub(crate) const fn answers(&self) -> Answers {
        self.answers
    }

    /// The number of the ground that the pieces make now: another one where pieces came since, but not often.
    pub(crate) fn number(&mut self, now_s: f64) -> u32 {
        let (pieces, number, at_s) = self.laid;
        if pieces != self.answers.taken && now_s - at_s >= LAID_S {
            self.laid = (self.answers.taken, number + 1, now_s);
        }
        self.laid.1
    }

    /// Whether the ground of a place that is still unknown was asked for and will not come: all that is wanted has, or nobody answers.
    pub(crate) fn is_settled(&self, place: &Geodetic) -> bool {
        let block = RequestedBlock::around([place.latitude_deg, place.longitude_deg], SPACING_M);
        let corner_e7 = block.map(|block| block.corner_e7());
        let mut wanted = self.blocks.iter().take(self.wanted);
        let is_wanted = wanted
            .clone()
            .any(|block| Some(block.corner_e7()) == corner_e7);
        is_wanted && (self.is_unanswered() || wanted.all(|block| block.mask() == 0))
    }

    /// Whether requests have stayed without an answer for long.
    pub(crate) fn is_unanswered(&self) -> bool {
        self.waits && (self.pause_s >= LONGEST_PAUSE_S || self.unanswered >= MOST_UNKNOWN)
    }

    /// What is known so far; `None` before the first piece.
    pub(crate) fn terrain(&self) -> Option<Arc<Terrain>> {
        let fields = self.blocks.iter().filter_map(RequestedBlock::field);
        let file = TerrainFile {
            path: PathBuf::from("the ground station"),
            format: "TERRAIN_DATA",
            fields: fields.collect(),
            datum: Stated {
                value: Datum::Egm96,
                source: "the protocol",
            },
            vertical_error_m: Stated {
                value: ERROR_M,
                source: "the specification of SRTM, 90 %",
            },
            empty_blocks: 0,
        };
        if file.fields.is_empty() {
            return None;
        }
        Terrain::new(vec![file]).ok().map(Arc::new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A piece of ground at a height of 100 m answers each missing one of a request.
    fn answer(asked: &mut AskedBlocks, request: &TERRAIN_REQUEST_DATA) {
        for gridbit in (0..56).filter(|bit| request.mask >> bit & 1 == 1) {
            let told = asked.take(&TERRAIN_DATA_DATA {
                lat: request.lat,
                lon: request.lon,
                grid_spacing: request.grid_spacing,
                gridbit,
                data: [100; 16],
            });
            assert_eq!(told, None);
        }
    }

    #[test]
    fn ground_that_was_not_asked_for_is_not_settled() {
        let here = Geodetic::new(37.62, -122.37, 0.0).expect("a place");
        let far = Geodetic::new(37.80, -122.37, 0.0).expect("a place");
        let mut asked = AskedBlocks::default();
        let request = asked.request(0.0, || vec![[here.latitude_deg, here.longitude_deg]]);
        assert!(!asked.is_settled(&here) && !asked.is_settled(&far));
        answer(&mut asked, &request.expect("a request"));
        assert!(asked.is_settled(&here) && !asked.is_settled(&far));
    }
}
