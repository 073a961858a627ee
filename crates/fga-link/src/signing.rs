//! MAVLink 2 message signing, with timestamps that survive the program.
//!
//! A signed frame carries an increasing time for each stream of a link, a system and a component.
//! A frame that is not newer than the last of its stream is a replay. The disk keeps the last times
//! ([`Timestamps`]), so that a restarted program refuses what it heard before.
//!
//! This computer's clock decides about no received frame: the clock may be years wrong, as on a computer without a battery before
//! it receives the time. Times sent follow the newest time heard, as the protocol asks, and no less than the clock.
//!
//! The crate `mavlink` computes the signatures. Its `SigningData` refuses by this computer's clock, keeps no times for a later run and says
//! of no frame why it was refused; so which frames are new is decided here.

use alloc::collections::BTreeMap;
use alloc::sync::Arc;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use mavlink::MAVLinkV2MessageRaw;
use mavlink::consts::v2::IFLAG_SIGNED;
use serde::{Deserialize, Serialize};

/// Timestamps count tens of microseconds since the beginning of 2015.
const BEGIN_UNIX_US: u128 = 1_420_070_400_000_000;
const TICKS_PER_S: u64 = 100_000;
/// A new stream may be this much behind the newest of all.
const NEW_STREAM_BEHIND: u64 = 60 * TICKS_PER_S;
/// The saved timestamps are ahead of the heard ones by this: more than the time to the next saving,
/// so that no frame from before a sudden end is new afterwards.
const KEPT_AHEAD: u64 = TICKS_PER_S;
/// The operator reads nothing of up to this many old frames.
const MOST_COPIES: u64 = 20;
/// Most remembered streams; only a holder of the key can begin one.
const MOST_STREAMS: usize = 256;

/// The newest timestamps, as saved on the disk.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Timestamps {
    /// Of a frame sent.
    pub sent: u64,
    /// Of frames heard: link, system, component, timestamp.
    pub heard: Vec<(u8, u8, u8, u64)>,
}

/// Why a frame is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// It has no signature.
    Unsigned,
    /// Its signature is of another key.
    OtherKey,
    /// Its time is not later than the times heard before.
    Old,
}

impl Refusal {
    /// All reasons.
    pub const ALL: [Self; 3] = [Self::Unsigned, Self::OtherKey, Self::Old];

    /// What the operator reads.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Unsigned => "fga: unsigned messages refused",
            Self::OtherKey => "fga: messages with another signing key refused",
            Self::Old => "fga: messages with an old signing time refused",
        }
    }
}

/// Frames accepted, and refused by reason.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SigningCounts {
    /// Accepted.
    pub accepted: u64,
    refused: [u64; Refusal::ALL.len()],
}

impl SigningCounts {
    /// Frames refused for a reason.
    pub fn refused(&self, reason: Refusal) -> u64 {
        self.refused.get(reason as usize).copied().unwrap_or(0)
    }
}

#[derive(Default)]
struct SigningState {
    counts: SigningCounts,
    told: [bool; Refusal::ALL.len()],
    sent: u64,
    /// After a restart a new stream must be newer than this.
    floor: u64,
    heard: BTreeMap<(u8, u8, u8), u64>,
}

impl SigningState {
    /// The newest timestamp heard; 0 before any.
    fn newest(&self) -> u64 {
        self.heard.values().copied().max().unwrap_or(0)
    }
}

struct SigningInner {
    /// Added to this computer's clock, s.
    clock_off_s: i64,
    key: [u8; 32],
    link_id: u8,
    allow_unsigned: bool,
    state: Mutex<SigningState>,
}

/// Key and state of MAVLink 2 message signing, and whether it accepts unsigned frames.
#[derive(Clone)]
pub struct Signing(Arc<SigningInner>);

impl core::fmt::Debug for Signing {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Signing(key hidden)")
    }
}

impl SigningInner {
    /// The present time as a timestamp; 0 before 2015.
    fn clock(&self) -> u64 {
        let since = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .unwrap_or_default();
        let ticks = u64::try_from(since.as_micros().saturating_sub(BEGIN_UNIX_US) / 10);
        let off = self.clock_off_s.saturating_mul(TICKS_PER_S.cast_signed());
        ticks.unwrap_or(0).saturating_add_signed(off)
    }
}

impl Signing {
    /// Signs outgoing frames with `key` and refuses frames without its signature, unless `allow_unsigned`.
    pub fn new(key: [u8; 32], link_id: u8, allow_unsigned: bool) -> Self {
        Self::with_clock_off(key, link_id, allow_unsigned, 0)
    }

    /// The same with a clock that is off by some seconds, for tests.
    pub fn with_clock_off(
        key: [u8; 32],
        link_id: u8,
        allow_unsigned: bool,
        clock_off_s: i64,
    ) -> Self {
        Self(Arc::new(SigningInner {
            clock_off_s,
            key,
            link_id,
            allow_unsigned,
            state: Mutex::default(),
        }))
    }

    fn state(&self) -> MutexGuard<'_, SigningState> {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Continues from the saved timestamps of an earlier run.
    pub fn go_on_from(&self, kept: &Timestamps) {
        let mut state = self.state();
        state.sent = state.sent.max(kept.sent);
        for (link, system, component, timestamp) in kept.heard.iter().take(MOST_STREAMS) {
            let newest = state.heard.entry((*link, *system, *component)).or_default();
            *newest = (*newest).max(*timestamp);
            state.floor = state.floor.max(*timestamp);
        }
    }

    /// The timestamps for a later run.
    pub fn timestamps(&self) -> Timestamps {
        let state = self.state();
        Timestamps {
            sent: state.sent + KEPT_AHEAD,
            heard: state
                .heard
                .iter()
                .map(|((link, system, component), newest)| {
                    (*link, *system, *component, newest + KEPT_AHEAD)
                })
                .collect(),
        }
    }

    /// The counts so far.
    pub fn counts(&self) -> SigningCounts {
        self.state().counts
    }

    /// A reason of refusals for the operator, once each. A link with a detour delivers old copies of accepted frames:
    /// old copies are a reason only where most frames are old copies.
    pub fn refusal_to_tell(&self) -> Option<Refusal> {
        let mut state = self.state();
        let counts = state.counts;
        let reason = Refusal::ALL.into_iter().find(|reason| {
            let least = match reason {
                Refusal::Old => counts.accepted.max(MOST_COPIES),
                Refusal::Unsigned | Refusal::OtherKey => 0,
            };
            let told = state.told.get(*reason as usize).copied().unwrap_or(true);
            !told && counts.refused(*reason) > least
        })?;
        if let Some(told) = state.told.get_mut(reason as usize) {
            *told = true;
        }
        Some(reason)
    }

    /// Whether to believe a frame; a believed signed frame counts as heard.
    pub fn accepts(&self, raw: &MAVLinkV2MessageRaw) -> bool {
        let refusal = self.refusal(raw);
        let mut state = self.state();
        let count = match refusal {
            None => Some(&mut state.counts.accepted),
            Some(reason) => state.counts.refused.get_mut(reason as usize),
        };
        if let Some(count) = count {
            *count = count.saturating_add(1);
        }
        refusal.is_none()
    }

    fn refusal(&self, raw: &MAVLinkV2MessageRaw) -> Option<Refusal> {
        if raw.incompatibility_flags() & IFLAG_SIGNED == 0 {
            return (!self.0.allow_unsigned).then_some(Refusal::Unsigned);
        }
        let mut signature = [0; 6];
        raw.calculate_signature(&self.0.key, &mut signature);
        if signature != raw.signature_value() {
            return Some(Refusal::OtherKey);
        }
        let Ok(system_id) = u8::try_from(raw.system_id()) else {
            return Some(Refusal::OtherKey);
        };
        let stream = (raw.signature_link_id(), system_id, raw.component_id());
        let timestamp = raw.signature_timestamp();
        let mut state = self.state();
        let newest_of_all = state.newest();
        let is_new = match state.heard.get(&stream) {
            Some(newest) => timestamp > *newest,
            None => {
                timestamp > state.floor
                    && timestamp.saturating_add(NEW_STREAM_BEHIND) >= newest_of_all
                    && state.heard.len() < MOST_STREAMS
            }
        };
        if is_new {
            state.heard.insert(stream, timestamp);
        }
        (!is_new).then_some(Refusal::Old)
    }

    /// Signs a serialized frame.
    pub fn sign(&self, raw: &mut MAVLinkV2MessageRaw) {
        let timestamp = {
            let mut state = self.state();
            state.sent = self.0.clock().max(state.sent.max(state.newest()) + 1);
            state.sent
        };
        let bytes = timestamp.to_le_bytes();
        raw.signature_timestamp_bytes_mut()
            .copy_from_slice(bytes.get(..6).unwrap_or_default());
        *raw.signature_link_id_mut() = self.0.link_id;
        let mut signature = [0; 6];
        raw.calculate_signature(&self.0.key, &mut signature);
        raw.signature_value_mut().copy_from_slice(&signature);
    }
}

#[cfg(test)]
mod tests {
    use mavlink::MavHeader;
    use mavlink::dialects::ardupilotmega::{MavMessage, PING_DATA};

    use super::*;
    use crate::wire::encode;

    fn frame(vehicle: &Signing, component_id: u8) -> MAVLinkV2MessageRaw {
        let header = MavHeader {
            system_id: 1,
            component_id,
            sequence: 0,
        };
        let ping = MavMessage::PING(PING_DATA::DEFAULT);
        encode(header, &ping, Some(vehicle))
    }

    #[test]
    fn signed_frames_of_the_last_minute_replayed_after_a_restart_are_refused() {
        let vehicle = Signing::new([7; 32], 1, false);
        let before = Signing::new([7; 32], 1, false);
        let heard: Vec<_> = (0..100).map(|_| frame(&vehicle, 1)).collect();
        // Recorded on another link: the companion never heard this stream.
        let overheard = frame(&vehicle, 2);
        let kept = before.timestamps();
        assert!(heard.iter().all(|raw| before.accepts(raw)));
        let kept_later = before.timestamps();
        // Without the saved timestamps, all of it would be new.
        let forgetful = Signing::new([7; 32], 1, false);
        forgetful.go_on_from(&kept);
        assert!(forgetful.accepts(&heard[99]));
        let after = Signing::new([7; 32], 1, false);
        after.go_on_from(&kept_later);
        assert!(!heard.iter().any(|raw| after.accepts(raw)));
        assert!(!after.accepts(&overheard));
        // Also frames from after the last saving, within a second.
        let later = frame(&vehicle, 1);
        assert!(before.accepts(&later));
        assert!(!after.accepts(&later));
    }

    #[test]
    fn the_vehicle_is_heard_again_a_second_after_a_restart() {
        let vehicle = Signing::new([7; 32], 1, false);
        let before = Signing::new([7; 32], 1, false);
        assert!(before.accepts(&frame(&vehicle, 1)));
        let after = Signing::new([7; 32], 1, false);
        after.go_on_from(&before.timestamps());
        vehicle.state().sent += 2 * TICKS_PER_S;
        assert!(after.accepts(&frame(&vehicle, 1)));
    }

    #[test]
    fn frames_sent_after_a_restart_are_newer_than_all_before() {
        let before = Signing::new([7; 32], 1, false);
        let last = frame(&before, 196);
        let after = Signing::new([7; 32], 1, false);
        after.go_on_from(&before.timestamps());
        assert!(frame(&after, 196).signature_timestamp() > last.signature_timestamp());
        let text = serde_json::to_string(&before.timestamps()).unwrap();
        let read: Timestamps = serde_json::from_str(&text).unwrap();
        assert_eq!(read.heard, before.timestamps().heard);
    }

    /// 1970, an hour behind and an hour ahead: both sides hear each other.
    #[test]
    fn l5_a_wrong_clock_hears_and_is_heard() {
        for off_s in [-2_000_000_000, -3600, 0, 3600] {
            // The vehicle refuses what is a minute behind the newest that it knows.
            let vehicle = Signing::new([7; 32], 0, false);
            let ours = Signing::with_clock_off([7; 32], 1, false, off_s);
            assert!(vehicle.accepts(&frame(&vehicle, 1)), "its own time");
            for _ in 0..3 {
                assert!(ours.accepts(&frame(&vehicle, 1)), "{off_s} s");
                assert!(vehicle.accepts(&frame(&ours, 196)), "{off_s} s");
            }
            let heard = ours.state().newest();
            assert!(frame(&ours, 196).signature_timestamp() > heard);
        }
    }

    #[test]
    fn l5_each_reason_of_refusals_is_told_once() {
        let ours = Signing::new([7; 32], 1, false);
        let vehicle = Signing::new([7; 32], 0, false);
        let copy = frame(&vehicle, 1);
        assert!(ours.accepts(&copy));
        assert!(!ours.accepts(&copy));
        assert_eq!(ours.refusal_to_tell(), None, "a copy");
        for _ in 0..MOST_COPIES {
            assert!(!ours.accepts(&copy));
        }
        assert_eq!(ours.refusal_to_tell(), Some(Refusal::Old));
        assert!(!ours.accepts(&frame(&Signing::new([8; 32], 0, false), 1)));
        assert_eq!(ours.refusal_to_tell(), Some(Refusal::OtherKey));
        assert_eq!(ours.refusal_to_tell(), None);
        assert_eq!(ours.counts().refused(Refusal::Old), MOST_COPIES + 1);
        for reason in Refusal::ALL {
            assert!(reason.words().len() <= 50);
        }
    }

    #[test]
    fn a_new_stream_may_not_be_old() {
        let receiver = Signing::new([7; 32], 1, false);
        let stale = Signing::new([7; 32], 1, false);
        assert!(receiver.accepts(&frame(&stale, 1)));
        let mut old = frame(&stale, 9);
        let timestamp = (stale.0.clock() - 2 * NEW_STREAM_BEHIND).to_le_bytes();
        old.signature_timestamp_bytes_mut()
            .copy_from_slice(&timestamp[..6]);
        let mut signature = [0; 6];
        old.calculate_signature(&[7; 32], &mut signature);
        old.signature_value_mut().copy_from_slice(&signature);
        assert!(!receiver.accepts(&old));
    }
}
