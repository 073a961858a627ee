//! Field faults drawn over the recorded feed of an encounter with an ArduPlane: whatever field is wrong, from whatever moment
//! on, the manoeuvre begins with at least 80 % of the lead that true reports give.

use std::io::Read as _;

use crate::claims::{HEIGHTS, LEAD_SHARE, MOTIONS, Wrong};
use crate::common::{Random, data};
use fga_link::outgoing::OWN_COMPONENT;
use fga_link::replay::replay;
use fga_link::tlog::{Logged, TlogReader, TlogWriter};
use fga_link::{Companion, Config};
use mavlink::dialects::ardupilotmega::{ADSB_VEHICLE_DATA, AdsbAltitudeType, MavMessage};

/// The recorded aircraft meet then, seconds.
const CONTACT_S: f64 = 67.5;
/// A fault begins before this, seconds: the threat is not known yet.
const LATEST_FAULT_S: f64 = 50.0;

/// The recorded log, and the configuration of the flight.
fn log() -> Option<(Vec<u8>, Config)> {
    let log = std::fs::read(data("trials/2026-11-25/adsb_baseline.tlog.gz")?).expect("a log");
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(log.as_slice())
        .read_to_end(&mut bytes)
        .expect("gzip");
    let text = std::fs::read_to_string(data("trials/2026-11-25/fly.toml")?).expect("a text");
    Some((bytes, Config::parse(&text).expect("a configuration")))
}

/// Its frames.
fn recorded() -> Option<(Vec<Logged>, Config)> {
    let (bytes, config) = log()?;
    let mut reader = TlogReader::new(bytes.as_slice());
    let mut frames = Vec::new();
    while let Some(frame) = reader.next_frame().expect("frames") {
        frames.push(frame);
    }
    Some((frames, config))
}

/// Wrong units that nothing in a report shows: feet for metres put this aircraft 1,500 m higher, where many fly.
const NOT_BOUNDED: [&str; 1] = ["in feet"];

/// When the manoeuvre begins if the reports are wrong from `from_s` on, seconds.
fn begins_s(
    frames: &[Logged],
    config: &Config,
    from_s: f64,
    wrong: impl Fn(&mut ADSB_VEHICLE_DATA),
) -> Option<f64> {
    let mut companion = Companion::new(config.clone(), false).expect("a companion");
    companion.set_recorded();
    let begin_us = frames.first()?.unix_us;
    let mut now_s = 0.0;
    for logged in frames {
        let micros = logged.unix_us.saturating_sub(begin_us);
        let at_s = f64::from(u32::try_from(micros).expect("an hour")) * 1e-6;
        while now_s + 0.02 < at_s {
            now_s += 0.02;
            companion.tick(now_s);
            drop(companion.outbox());
        }
        now_s = now_s.max(at_s);
        let mut message = logged.frame.message.clone();
        if let MavMessage::ADSB_VEHICLE(data) = &mut message
            && now_s >= from_s
        {
            wrong(data);
        }
        if logged.frame.header.component_id != OWN_COMPONENT {
            companion.receive(&logged.frame.header, &message, now_s);
            drop(companion.outbox());
        }
        companion.take_log();
        if companion.flies() {
            return Some(now_s);
        }
    }
    None
}

/// Faults of a label or an altitude beside those of [`HEIGHTS`].
const LABELS: [(&str, Wrong); 4] = [
    ("altitude of the other sign", |d| d.altitude = -d.altitude),
    ("altitude over 100", |d| d.altitude /= 100),
    ("altitude times 100", |d| {
        d.altitude = d.altitude.saturating_mul(100);
    }),
    ("190 m above as pressure", |d| {
        d.altitude += 190_000;
        d.altitude_type = AdsbAltitudeType::ADSB_ALTITUDE_TYPE_GEOMETRIC;
    }),
];

#[test]
fn t3_a_field_wrong_from_any_moment_on_in_the_recorded_feed_costs_a_fifth_of_the_lead_at_most() {
    let Some((frames, config)) = recorded() else {
        return;
    };
    let lead_s = |from_s, wrong: Wrong| {
        begins_s(&frames, &config, from_s, wrong).map_or(0.0, |s| CONTACT_S - s)
    };
    let control_s = lead_s(0.0, |_| {});
    assert!(control_s > 8.0, "{control_s} s");
    let mut random = Random::new(335);
    let mut late = Vec::new();
    for (name, wrong) in MOTIONS.into_iter().chain(HEIGHTS).chain(LABELS) {
        for from_s in [0.0, random.uniform(0.0, LATEST_FAULT_S)] {
            let lead_s = lead_s(from_s, wrong);
            eprintln!("{name} from {from_s:.1} s: {lead_s:.1} s of {control_s:.1} s");
            if lead_s < LEAD_SHARE * control_s && !NOT_BOUNDED.contains(&name) {
                late.push(format!("{name} from {from_s:.1} s: {lead_s:.1} s"));
            }
        }
    }
    assert!(late.is_empty(), "of {control_s:.1} s: {late:#?}");
}

/// The clock of the log is set from 1970 to now and an hour back, and some of its bytes are damaged: the replay decides the
/// same at the same times.
#[test]
fn l5_a_clock_that_is_set_and_damage_change_no_replay() {
    let Some((bytes, config)) = log() else {
        return;
    };
    let maneuvers = |log: &[u8]| {
        let mut companion = Companion::new(config.clone(), false).expect("a companion");
        let mut found = Vec::new();
        let mut last = String::new();
        let replayed = replay(log, &mut companion, |line| {
            let state = line["state"].as_str().unwrap_or(&last).to_owned();
            if state != last {
                found.push((state.clone(), line["t_s"].as_f64().expect("a time")));
                last = state;
            }
            Ok(())
        });
        (found, replayed.expect("a log"))
    };
    let (control, whole) = maneuvers(&bytes);
    assert!(control.len() > 2, "{control:?}");
    let mut set = Vec::new();
    let mut writer = TlogWriter::new(&mut set);
    let (frames, _) = recorded().expect("frames");
    let begin_us = frames[0].unix_us;
    for frame in &frames {
        let after_us = frame.unix_us - begin_us;
        let from_us = match after_us / 1_000_000 {
            0..20 => 0,
            20..40 => begin_us,
            _ => begin_us - 3_600_000_000,
        };
        writer
            .write(from_us + after_us, frame.frame.bytes())
            .expect("written");
    }
    // Zeros between two frames.
    let middle = set.len() / 3;
    set.splice(middle..middle + 40, [0; 40]);
    let (found, replayed) = maneuvers(&set);
    assert!(
        replayed.skipped > 0 && replayed.frames + 10 > whole.frames,
        "{replayed:?}"
    );
    assert_eq!(found.len(), control.len(), "{found:?} {control:?}");
    for ((state, at_s), (control, control_s)) in found.iter().zip(&control) {
        assert_eq!(state, control);
        assert!(
            (at_s - control_s).abs() < 1.0,
            "{state} at {at_s} s, {control_s} s"
        );
    }
}
