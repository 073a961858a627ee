//! Who sent a report, and of which aircraft is it?

/// The source of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ReportSource {
    /// A receiver or a player on the MAVLink network.
    Mavlink,
    /// The autopilot's own list, sent about once a second and late.
    AutopilotList,
    /// A BaseStation stream.
    Sbs,
    /// A Beast stream.
    Beast,
    /// GDL 90 messages.
    Gdl90,
    /// Sentences of FLARM.
    Flarm,
    /// A radar or a camera on board.
    Sensor,
    /// A receiver of Remote ID.
    RemoteId,
}

impl ReportSource {
    /// Name in logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mavlink => "mavlink",
            Self::AutopilotList => "autopilot",
            Self::Sbs => "sbs",
            Self::Beast => "beast",
            Self::Gdl90 => "gdl90",
            Self::Flarm => "flarm",
            Self::Sensor => "sensor",
            Self::RemoteId => "remote-id",
        }
    }
}

/// The sender of a report. Each sender has its share of the table of tracks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ReportSender {
    /// Kind of source.
    pub source: ReportSource,
    /// System and component of a MAVLink message, or a number of the receiver.
    pub number: u16,
}

impl ReportSender {
    /// The sender of a MAVLink message.
    pub const fn mavlink(source: ReportSource, system: u8, component: u8) -> Self {
        Self {
            source,
            number: u16::from_be_bytes([system, component]),
        }
    }

    /// A receiver on the network at an address.
    pub fn receiver(source: ReportSource, address: &str) -> Self {
        let number = address.bytes().fold(0x811C_u16, |number, byte| {
            (number ^ u16::from(byte)).wrapping_mul(0x0193)
        });
        Self { source, number }
    }
}

/// The identity of an aircraft. Several tracks can have one key: an address is a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum TrackKey {
    /// A 24-bit ICAO address.
    Address(u32),
    /// A call sign without an address, of one sender.
    Callsign(ReportSender, [u8; LONGEST_CALLSIGN]),
    /// A transmitter of Remote ID.
    Transmitter(Transmitter),
    /// A sensor's detection, with the sensor's number.
    Seen(ReportSender, u16),
    /// Neither: only the position identifies it.
    Unnamed(ReportSender),
}

/// The identity of a transmitter: its hardware address or its identifier.
pub type Transmitter = [u8; 20];

/// Longest stored call sign.
pub const LONGEST_CALLSIGN: usize = 9;

/// A call sign without blanks and control characters, of bounded length.
pub fn tidy_callsign(text: &str) -> String {
    text.chars()
        .filter(char::is_ascii_graphic)
        .take(LONGEST_CALLSIGN)
        .collect()
}
