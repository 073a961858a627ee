//! Messages that the autopilot sends by itself, and how often.

/// A periodic message.
#[derive(Debug, Clone, Copy)]
struct MessageStream {
    message_id: u32,
    interval_s: f64,
    due_s: f64,
}

pub(crate) const HEARTBEAT: u32 = 0;
pub(crate) const SYS_STATUS: u32 = 1;
pub(crate) const SYSTEM_TIME: u32 = 2;
pub(crate) const GPS_RAW_INT: u32 = 24;
pub(crate) const SCALED_PRESSURE: u32 = 29;
pub(crate) const ATTITUDE: u32 = 30;
pub(crate) const GLOBAL_POSITION_INT: u32 = 33;
pub(crate) const MISSION_CURRENT: u32 = 42;
pub(crate) const NAV_CONTROLLER_OUTPUT: u32 = 62;
pub(crate) const VFR_HUD: u32 = 74;
pub(crate) const POSITION_TARGET_GLOBAL_INT: u32 = 87;
pub(crate) const WIND: u32 = 168;
pub(crate) const ADSB_VEHICLE: u32 = 246;

/// Mode number in heartbeats before the autopilot has started.
pub(crate) const INITIALISING: u32 = 16;

/// The periodic messages and their intervals.
#[derive(Debug)]
pub(crate) struct Streams(Vec<MessageStream>);

/// Messages that a companion can request.
const KNOWN: [u32; 13] = [
    HEARTBEAT,
    SYS_STATUS,
    SYSTEM_TIME,
    GPS_RAW_INT,
    SCALED_PRESSURE,
    ATTITUDE,
    GLOBAL_POSITION_INT,
    MISSION_CURRENT,
    NAV_CONTROLLER_OUTPUT,
    VFR_HUD,
    POSITION_TARGET_GLOBAL_INT,
    WIND,
    ADSB_VEHICLE,
];

impl Streams {
    /// Heartbeats and the list of aircraft each second, everything else at `interval_s`.
    pub(crate) fn new(interval_s: Option<f64>) -> Self {
        let rows = KNOWN.into_iter().filter_map(|message_id| {
            let always = matches!(message_id, HEARTBEAT | ADSB_VEHICLE).then_some(1.0);
            Some(MessageStream {
                message_id,
                interval_s: always.or(interval_s)?,
                due_s: 0.0,
            })
        });
        Self(rows.collect())
    }

    /// The interval of a message, seconds.
    pub(crate) fn interval_s(&self, message_id: u32) -> Option<f64> {
        let mut rows = self.0.iter();
        rows.find(|stream| stream.message_id == message_id)
            .map(|stream| stream.interval_s)
    }

    /// Sets an interval, seconds; `false` for an unknown message.
    pub(crate) fn set(&mut self, message_id: u32, interval_s: Option<f64>, now_s: f64) -> bool {
        if !KNOWN.contains(&message_id) {
            return false;
        }
        self.0.retain(|stream| stream.message_id != message_id);
        if let Some(interval_s) = interval_s {
            self.0.push(MessageStream {
                message_id,
                interval_s,
                due_s: now_s,
            });
        }
        true
    }

    pub(crate) fn due(&mut self, now_s: f64, fastest_s: f64) -> Vec<u32> {
        let mut due = Vec::new();
        for stream in &mut self.0 {
            if now_s >= stream.due_s - 1e-9 {
                let interval_s = stream.interval_s.max(fastest_s);
                stream.due_s = (stream.due_s + interval_s).max(now_s);
                due.push(stream.message_id);
            }
        }
        due
    }
}
