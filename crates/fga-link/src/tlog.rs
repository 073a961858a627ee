//! Telemetry logs (`.tlog`): every frame with the time at which it came or went.
//!
//! The format of the ground stations: a big-endian count of microseconds since 1970, then the
//! frame, again and again. The crate `mavlink` says how long a frame is and reads it.

use std::io::{self, BufRead as _, BufReader, Read, Write};

use fga_formats::tally::{LeftOut, Tally};
use mavlink::consts::MAX_FRAME_SIZE;
use mavlink::dialects::ardupilotmega::MavMessage;
use mavlink::{MAV_STX, MAV_STX_V2, MAVLinkV1MessageRaw, MAVLinkV2MessageRaw};

use crate::config::TrafficConfig;
use crate::traffic::{PlaceReport, ReportSender, ReportSource};
use crate::wire::{Framer, WireFrame};

/// Writes a telemetry log.
#[derive(Debug)]
pub struct TlogWriter<W: Write> {
    to: W,
}

impl<W: Write> TlogWriter<W> {
    /// A log that writes to `to`.
    pub const fn new(to: W) -> Self {
        Self { to }
    }

    /// Appends a frame.
    ///
    /// # Errors
    /// Errors of the writer.
    pub fn write(&mut self, unix_us: u64, frame: &[u8]) -> io::Result<()> {
        self.to.write_all(&unix_us.to_be_bytes())?;
        self.to.write_all(frame)
    }

    /// Hands buffered data to the system.
    ///
    /// # Errors
    /// Errors of the writer.
    pub fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

/// What a telemetry log holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Contents {
    /// Intelligible frames.
    pub frames: u64,
    /// What the companion would use of the `ADSB_VEHICLE` reports, and why not of the others.
    pub traffic: Tally,
}

impl Contents {
    /// Reads a log to its end.
    ///
    /// # Errors
    /// Errors of the reader, or data that is no telemetry log.
    pub fn read(log: impl Read) -> io::Result<Self> {
        let mut reader = TlogReader::new(log);
        let mut contents = Self::default();
        let config = TrafficConfig::default();
        while let Some(Logged { frame, .. }) = reader.next_frame()? {
            contents.frames += 1;
            let MavMessage::ADSB_VEHICLE(data) = &frame.message else {
                continue;
            };
            let sender = ReportSender::mavlink(ReportSource::Mavlink, 0, frame.header.component_id);
            let report = PlaceReport::from_adsb(data, sender, 0.0, config.position_sigma_m);
            contents.traffic.take(&match report {
                Ok(report) if -report.valid_s > config.drop_after_s => Err(LeftOut::TooOld),
                Ok(_) => Ok(()),
                Err(_) => Err(LeftOut::NoPosition),
            });
        }
        Ok(contents)
    }
}

/// A frame of a log and its time.
#[derive(Debug, Clone, PartialEq)]
pub struct Logged {
    /// Microseconds since 1970.
    pub unix_us: u64,
    /// The frame.
    pub frame: WireFrame,
}

/// Reads a telemetry log; skips unintelligible frames, and damaged parts up to the next frame.
#[derive(Debug)]
pub struct TlogReader<R: Read> {
    from: BufReader<R>,
    /// Number of unintelligible frames and damaged parts, among them a frame that is cut off at the end.
    pub skipped: u64,
    /// Whether a frame was intelligible: the file is a telemetry log.
    is_one: bool,
}

/// Whether a frame begins with a byte.
const fn begins(byte: u8) -> bool {
    matches!(byte, MAV_STX | MAV_STX_V2)
}

/// Length of a frame of which the first three bytes are known, bytes.
fn frame_length(frame: &[u8; MAX_FRAME_SIZE]) -> usize {
    if let ([MAV_STX, ..], Some(version1)) = (frame, frame.first_chunk()) {
        MAVLinkV1MessageRaw::from_bytes_unparsed(*version1)
            .raw_bytes()
            .len()
    } else {
        MAVLinkV2MessageRaw::from_bytes_unparsed(*frame)
            .raw_bytes()
            .len()
    }
}

impl<R: Read> TlogReader<R> {
    /// A log that reads from `from`.
    pub fn new(from: R) -> Self {
        Self {
            from: BufReader::new(from),
            skipped: 0,
            is_one: false,
        }
    }

    /// The next frame; `None` at the end, also at a cut frame.
    ///
    /// # Errors
    /// Errors of the reader, or data that is no telemetry log from its first frame on.
    pub fn next_frame(&mut self) -> io::Result<Option<Logged>> {
        while !self.from.fill_buf()?.is_empty() {
            let (mut stamp, mut begin) = ([0; 8], [0; 3]);
            if !self.fill(&mut stamp)? || !self.fill(&mut begin)? {
                break;
            }
            if !begins(begin[0]) {
                if !self.is_one {
                    let message = format!(
                        "no telemetry log: a frame begins with {:#04x}, expected 0xfd or 0xfe",
                        begin[0]
                    );
                    return Err(io::Error::new(io::ErrorKind::InvalidData, message));
                }
                self.skipped += 1;
                if !self.find_frame(&mut stamp, &mut begin)? {
                    break;
                }
            }
            let unix_us = u64::from_be_bytes(stamp);
            let mut frame = [0; MAX_FRAME_SIZE];
            for (to, byte) in frame.iter_mut().zip(begin) {
                *to = byte;
            }
            let length = frame_length(&frame);
            let bytes = frame.get_mut(..length).unwrap_or_default();
            if !self.fill(bytes.get_mut(begin.len()..).unwrap_or_default())? {
                break;
            }
            let mut found = None;
            Framer::new(None).push(bytes, |frame| found = Some(frame));
            match found {
                Some(frame) => {
                    self.is_one = true;
                    return Ok(Some(Logged { unix_us, frame }));
                }
                None => self.skipped += 1,
            }
        }
        Ok(None)
    }

    /// Goes on byte by byte until a frame may begin after its time; `false` at the end of the file.
    fn find_frame(&mut self, stamp: &mut [u8; 8], begin: &mut [u8; 3]) -> io::Result<bool> {
        while !begins(begin[0])
            && let Some(next) = self.from.by_ref().bytes().next().transpose()?
        {
            stamp.rotate_left(1);
            stamp[7] = begin[0];
            begin.rotate_left(1);
            begin[2] = next;
        }
        Ok(begins(begin[0]))
    }

    /// Fills a buffer; `false` at the end of the file, which cuts a frame off.
    fn fill(&mut self, buffer: &mut [u8]) -> io::Result<bool> {
        match self.from.read_exact(buffer) {
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                self.skipped += 1;
                Ok(false)
            }
            filled => filled.map(|()| true),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::encode;
    use mavlink::MavHeader;
    use mavlink::dialects::ardupilotmega::{MavMessage, PING_DATA};

    #[test]
    fn each_frame_is_as_long_as_its_kind() {
        let (mut file, ping) = (Vec::new(), MavMessage::PING(PING_DATA::DEFAULT));
        let mut writer = TlogWriter::new(&mut file);
        // Ids of 8 and of 32 bits.
        for system_id in [1, 70_000, 2] {
            let header = MavHeader {
                system_id,
                ..MavHeader::default()
            };
            let raw = encode(header, &ping, None);
            writer
                .write(1_700_000_000_000_000, raw.raw_bytes())
                .unwrap();
        }
        let mut reader = TlogReader::new(file.as_slice());
        let mut next = || {
            reader
                .next_frame()
                .unwrap()
                .map(|logged| logged.frame.header.system_id)
        };
        let heard = [next(), next(), next(), next()];
        assert_eq!(heard, [Some(1), Some(70_000), Some(2), None]);
        assert_eq!(reader.skipped, 0);
    }

    #[test]
    fn a_written_log_is_read_and_a_cut_end_is_an_end() {
        let mut file = Vec::new();
        let mut writer = TlogWriter::new(&mut file);
        for seq in 0..3_u32 {
            let ping = MavMessage::PING(PING_DATA {
                seq,
                ..PING_DATA::DEFAULT
            });
            let raw = encode(MavHeader::default(), &ping, None);
            writer
                .write(1_700_000_000_000_000 + u64::from(seq), raw.raw_bytes())
                .unwrap();
        }
        file.truncate(file.len() - 1);
        let mut reader = TlogReader::new(file.as_slice());
        let first = reader.next_frame().unwrap().unwrap();
        assert_eq!(first.unix_us, 1_700_000_000_000_000);
        assert!(reader.next_frame().unwrap().is_some());
        assert!(reader.next_frame().unwrap().is_none());
        assert_eq!(reader.skipped, 1, "the cut frame is counted");
        // A damaged part costs what it covers, not the rest of the log.
        let whole = file.len() / 3;
        for damaged in [
            whole..whole + 20,
            whole + 8..whole + 9,
            whole - 5..2 * whole - 1,
        ] {
            let mut file = file.clone();
            file[damaged.clone()].fill(0x55);
            for _ in 0..20 {
                let frame = file[..whole].to_vec();
                file.extend(frame);
            }
            let mut reader = TlogReader::new(file.as_slice());
            let mut frames = 0;
            while reader.next_frame().unwrap().is_some() {
                frames += 1;
            }
            assert!(frames >= 15 && reader.skipped > 0, "{damaged:?}: {frames}");
        }
        assert!(
            TlogReader::new(&b"12345678not a log"[..])
                .next_frame()
                .is_err()
        );
    }
}
