//! Bytes to MAVLink 2 messages and back.
//!
//! [`Framer`] takes bytes from a socket or a serial port, in pieces of any size, with
//! noise between the frames, and yields whole messages with a right checksum (and signature, if a key
//! is set). The crate `mavlink` finds the frames; it never holds more than one frame and a read.

use alloc::collections::VecDeque;

use mavlink::dialects::ardupilotmega::{
    ADSB_VEHICLE_DATA, MavMessage, OPEN_DRONE_ID_BASIC_ID_DATA, OPEN_DRONE_ID_LOCATION_DATA,
};
use mavlink::{
    MAV_STX, MAVLinkMessageRaw, MAVLinkV2MessageRaw, MavHeader, MavlinkReader, MavlinkVersion,
    Message as _, MessageData as _,
};

pub use crate::signing::{Refusal, Signing, SigningCounts, Timestamps};

/// Longest frame, bytes.
const LONGEST_FRAME: usize = mavlink::consts::MAX_FRAME_SIZE;

/// A message with its sender and its bytes as received.
#[derive(Debug, Clone, PartialEq)]
pub struct WireFrame {
    /// Sender and sequence number.
    pub header: MavHeader,
    /// The message.
    pub message: MavMessage,
    raw: MAVLinkV2MessageRaw,
}

impl WireFrame {
    /// The frame's bytes.
    pub fn bytes(&self) -> &[u8] {
        self.raw.raw_bytes()
    }
}

/// The counts of a [`Framer`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FrameCounts {
    /// Messages passed on.
    pub good: u64,
    /// Frames with a wrong or missing signature.
    pub refused: u64,
    /// The sender of a MAVLink 1 frame, where no MAVLink 2 frame came before it.
    pub version1: Option<u8>,
}

/// The sender of the first whole MAVLink 1 frame in some bytes: what begins like a longer frame hides none behind it.
fn version1_sender(bytes: &[u8]) -> Option<u8> {
    let starts = (0..bytes.len()).filter(|from| bytes.get(*from) == Some(&MAV_STX));
    starts
        .filter_map(|from| bytes.get(from..))
        .find_map(|rest| {
            let mut reader = MavlinkReader::with_capacity(LONGEST_FRAME, rest);
            match reader.read_raw_message::<MavMessage>(MavlinkVersion::V1) {
                Ok(MAVLinkMessageRaw::V1(raw)) => Some(raw.system_id()),
                _ => None,
            }
        })
}

/// Messages about traffic: the places of listed words in their payloads, and the word that replaces an unlisted one.
/// An altitude of an unknown kind counts as geometric, which holds for every kind.
const WORDS: [(u32, &[(usize, u8)]); 3] = [
    (ADSB_VEHICLE_DATA::ID, &[(26, 1), (36, 0)]),
    (OPEN_DRONE_ID_BASIC_ID_DATA::ID, &[(22, 0), (23, 0)]),
    (
        OPEN_DRONE_ID_LOCATION_DATA::ID,
        &[
            (52, 0),
            (53, 0),
            (54, 0),
            (55, 0),
            (56, 0),
            (57, 0),
            (58, 0),
        ],
    ),
];

/// The message in a payload. A word that the dialect does not know hides no traffic.
fn message_of(id: u32, payload: &[u8]) -> Option<MavMessage> {
    let parse = |payload: &[u8]| MavMessage::parse(MavlinkVersion::V2, id, payload).ok();
    parse(payload).or_else(|| {
        let (_, words) = WORDS.iter().find(|(other, _)| *other == id)?;
        let mut payload = payload.to_vec();
        for (at, word) in *words {
            // A shorter payload has zeros there.
            if let Some(place) = payload.get_mut(*at) {
                *place = *word;
            }
        }
        parse(&payload)
    })
}

/// Finds frames in a stream of bytes.
pub struct Framer {
    reader: MavlinkReader<VecDeque<u8>>,
    signing: Option<Signing>,
    counts: FrameCounts,
}

impl Framer {
    /// A framer; with `signing` it checks signatures.
    pub fn new(signing: Option<Signing>) -> Self {
        Self {
            reader: Self::reader(),
            signing,
            counts: FrameCounts::default(),
        }
    }

    fn reader() -> MavlinkReader<VecDeque<u8>> {
        MavlinkReader::with_capacity(LONGEST_FRAME, VecDeque::new())
    }

    /// The counts so far.
    pub const fn counts(&self) -> FrameCounts {
        self.counts
    }

    /// Forgets a begun frame: for the end of a datagram or a connection.
    pub fn reset(&mut self) {
        self.reader = Self::reader();
    }

    /// Takes bytes and calls `sink` for each whole message in them.
    pub fn push(&mut self, bytes: &[u8], mut sink: impl FnMut(WireFrame)) {
        if self.counts.good == 0 && self.counts.version1.is_none() {
            self.counts.version1 = version1_sender(bytes);
        }
        self.reader.get_mut().extend(bytes);
        while let Ok(MAVLinkMessageRaw::V2(raw)) = self
            .reader
            .read_raw_message::<MavMessage>(MavlinkVersion::V2)
        {
            self.take_frame(&raw, &mut sink);
        }
    }

    fn take_frame(&mut self, raw: &MAVLinkV2MessageRaw, sink: &mut impl FnMut(WireFrame)) {
        if let Some(signing) = &self.signing
            && !signing.accepts(raw)
        {
            self.counts.refused += 1;
            return;
        }
        let Some(message) = message_of(raw.message_id(), raw.payload()) else {
            return;
        };
        self.counts.good += 1;
        let header = MavHeader {
            system_id: raw.system_id(),
            component_id: raw.component_id(),
            sequence: raw.sequence(),
        };
        sink(WireFrame {
            header,
            message,
            raw: *raw,
        });
    }
}

/// The bytes of a message, signed if a key is set.
pub fn encode(
    header: MavHeader,
    message: &MavMessage,
    signing: Option<&Signing>,
) -> MAVLinkV2MessageRaw {
    let mut raw = MAVLinkV2MessageRaw::new();
    if let Some(signing) = signing {
        raw.serialize_message_for_signing(header, message);
        signing.sign(&mut raw);
    } else {
        raw.serialize_message(header, message);
    }
    raw
}

#[cfg(test)]
mod tests {
    use mavlink::MAVLinkV1MessageRaw;
    use mavlink::dialects::ardupilotmega::{ATTITUDE_DATA, AdsbAltitudeType, PING_DATA};

    use super::*;

    fn header(sequence: u8) -> MavHeader {
        MavHeader {
            system_id: 7,
            component_id: 196,
            sequence,
        }
    }

    fn attitude(yaw: f32) -> MavMessage {
        MavMessage::ATTITUDE(ATTITUDE_DATA {
            time_boot_ms: 5,
            yaw,
            ..ATTITUDE_DATA::DEFAULT
        })
    }

    fn all(framer: &mut Framer, bytes: &[u8]) -> Vec<WireFrame> {
        let mut frames = Vec::new();
        framer.push(bytes, |frame| frames.push(frame));
        frames
    }

    #[test]
    fn frames_are_found_in_any_pieces_and_between_noise() {
        let mut stream = vec![0xFD, 3, 0, 9, 0xFE];
        for n in 0..20_u8 {
            stream.extend_from_slice(encode(header(n), &attitude(f32::from(n)), None).raw_bytes());
            stream.extend_from_slice(&[0xFD; 3]);
        }
        // A whole frame's worth of anything lets the last false start be recognised.
        stream.extend_from_slice(&[0; 300]);
        for piece in [1, 2, 7, 64, 281, 5000] {
            let mut framer = Framer::new(None);
            let frames: Vec<WireFrame> = stream
                .chunks(piece)
                .flat_map(|chunk| all(&mut framer, chunk))
                .collect();
            assert_eq!(frames.len(), 20, "pieces of {piece}");
            assert_eq!(frames[19].message, attitude(19.0));
            assert!(
                framer.reader.get_ref().is_empty(),
                "at most one frame waits"
            );
        }
    }

    #[test]
    fn l14_mavlink_1_is_noticed_before_any_mavlink_2() {
        let mut raw = MAVLinkV1MessageRaw::new();
        raw.serialize_message(header(3), &attitude(1.0));
        let mut framer = Framer::new(None);
        let noise = [0xFE, 0xFE, 1, 9];
        let stream: Vec<u8> = noise.iter().chain(raw.raw_bytes()).copied().collect();
        assert!(all(&mut framer, &stream).is_empty());
        assert_eq!(framer.counts().version1, Some(7));
        let mut framer = Framer::new(None);
        all(
            &mut framer,
            encode(header(0), &attitude(1.0), None).raw_bytes(),
        );
        all(&mut framer, &stream);
        assert_eq!(framer.counts().version1, None, "MAVLink 2 is heard");
        for length in 0..raw.raw_bytes().len() {
            assert_eq!(version1_sender(&raw.raw_bytes()[..length]), None);
        }
    }

    /// A category or a kind of altitude that came later than the dialect: every field besides them is read.
    #[test]
    fn t4_an_unknown_word_hides_no_traffic() {
        let adsb = MavMessage::ADSB_VEHICLE(ADSB_VEHICLE_DATA {
            ICAO_address: 7,
            lat: 1,
            altitude_type: AdsbAltitudeType::ADSB_ALTITUDE_TYPE_GEOMETRIC,
            callsign: "N1".into(),
            tslc: 9,
            ..ADSB_VEHICLE_DATA::DEFAULT
        });
        let location = MavMessage::OPEN_DRONE_ID_LOCATION(OPEN_DRONE_ID_LOCATION_DATA {
            latitude: 1,
            id_or_mac: [9; 20],
            timestamp: 3.0,
            target_component: 4,
            ..OPEN_DRONE_ID_LOCATION_DATA::DEFAULT
        });
        let identity = MavMessage::OPEN_DRONE_ID_BASIC_ID(OPEN_DRONE_ID_BASIC_ID_DATA {
            id_or_mac: [9; 20],
            uas_id: [65; 20],
            ..OPEN_DRONE_ID_BASIC_ID_DATA::DEFAULT
        });
        for (message, words) in [adsb, identity, location].iter().zip(WORDS.map(|(_, w)| w)) {
            let raw = encode(header(0), message, None);
            let mut payload = raw.payload().to_vec();
            payload.resize(payload.len().max(words[words.len() - 1].0 + 1), 0);
            for (at, _) in words {
                payload[*at] = 200;
                assert_eq!(
                    message_of(raw.message_id(), &payload).as_ref(),
                    Some(message)
                );
            }
        }
    }

    #[test]
    fn a_flipped_bit_loses_one_frame_only() {
        let mut stream = Vec::new();
        for n in 0..3_u8 {
            stream.extend_from_slice(encode(header(n), &attitude(1.0), None).raw_bytes());
        }
        stream[15] ^= 4;
        stream.extend_from_slice(&[0; 300]);
        assert_eq!(all(&mut Framer::new(None), &stream).len(), 2);
    }

    #[test]
    fn signed_links_refuse_others() {
        let key = Signing::new([7; 32], 1, false);
        let receiver = || Some(Signing::new([7; 32], 1, false));
        let other = Signing::new([8; 32], 1, false);
        let ping = MavMessage::PING(PING_DATA {
            seq: 3,
            ..PING_DATA::DEFAULT
        });
        let good = encode(header(0), &ping, Some(&key));
        assert_eq!(all(&mut Framer::new(receiver()), good.raw_bytes()).len(), 1);
        let mut framer = Framer::new(receiver());
        assert!(
            all(
                &mut framer,
                encode(header(0), &ping, Some(&other)).raw_bytes()
            )
            .is_empty()
        );
        assert!(all(&mut framer, encode(header(0), &ping, None).raw_bytes()).is_empty());
        assert_eq!(framer.counts().refused, 2);
        // Twice the same frame is a replay.
        assert_eq!(all(&mut framer, good.raw_bytes()).len(), 1);
        assert_eq!(all(&mut framer, good.raw_bytes()).len(), 0);
    }
}
