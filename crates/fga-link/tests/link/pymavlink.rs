//! The codec against an independent one: pymavlink decodes our messages and encodes them again, and our
//! codec decodes the result.
//!
//! Needs Python with `pymavlink`; `FGA_PYTHON` names the interpreter. Without it the test is skipped,
//! except in CI.

use std::io::Write as _;
use std::process::{Command, Stdio};

use fga_link::authority::Severity;
use fga_link::hand::attitude::attitude_message;
use fga_link::hand::sticks::override_message;
use fga_link::player::{PlayerLine, adsb_message};
use fga_link::telling;
use fga_link::wire::{Framer, Signing, encode};
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{
    COMMAND_INT_DATA, COMMAND_LONG_DATA, HEARTBEAT_DATA, MISSION_REQUEST_INT_DATA, MavCmd,
    MavFrame, MavMessage, MavMissionType, PARAM_REQUEST_READ_DATA,
};

fn messages() -> Vec<MavMessage> {
    let line: PlayerLine = "ABC123,37.6279,-122.375,104,180,25"
        .parse()
        .expect("a line");
    let sample = line.0.at(1.0).expect("a sample");
    vec![
        MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT),
        attitude_message(30.0_f64.to_radians(), Some(0.1), 1234, 1),
        override_message(Some([2000, 1500, 1400]), 1),
        adsb_message(0x00AB_C123, "FGA1", &sample),
        telling::text(Severity::Warning, "fga: avoiding TEST, 12 s away"),
        telling::value("FGA_MARGIN", 61.5, 99),
        MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            command: MavCmd::MAV_CMD_DO_SET_MODE,
            param1: 1.0,
            param2: 15.0,
            target_system: 1,
            target_component: 1,
            ..COMMAND_LONG_DATA::DEFAULT
        }),
        MavMessage::COMMAND_INT(COMMAND_INT_DATA {
            command: MavCmd::MAV_CMD_GUIDED_CHANGE_HEADING,
            frame: MavFrame::MAV_FRAME_GLOBAL,
            param2: 123.0,
            target_system: 1,
            ..COMMAND_INT_DATA::DEFAULT
        }),
        MavMessage::PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA {
            param_index: -1,
            param_id: "ROLL_LIMIT_DEG".into(),
            target_system: 1,
            target_component: 1,
        }),
        MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
            seq: 3,
            mission_type: MavMissionType::MAV_MISSION_TYPE_FENCE,
            target_system: 1,
            target_component: 1,
        }),
    ]
}

/// pymavlink's view of frames: their fields, and its own frames with the same messages. `None`
/// if it is not installed.
fn echoed(bytes: &[u8], key: Option<&str>) -> Option<(Vec<serde_json::Value>, Vec<u8>)> {
    let python = std::env::var("FGA_PYTHON").unwrap_or_else(|_| "python3".into());
    let present = Command::new(&python)
        .args(["-c", "import pymavlink.dialects.v20.ardupilotmega"])
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success());
    if !present {
        let missing = format!("{python} has no module pymavlink (FGA_PYTHON names another)");
        assert!(std::env::var("CI").is_err(), "{missing}");
        eprintln!("skipped: {missing}");
        return None;
    }
    let mut peer = Command::new(&python)
        .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/peer/echo.py"))
        .args(key)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("python starts");
    peer.stdin
        .take()
        .expect("piped")
        .write_all(bytes)
        .expect("written");
    let output = peer.wait_with_output().expect("ends");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    let fields = told
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    Some((fields, output.stdout))
}

fn encoded(messages: &[MavMessage], signing: Option<&Signing>) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (sequence, message) in (0_u8..).zip(messages) {
        let header = MavHeader {
            system_id: 1,
            component_id: 196,
            sequence,
        };
        bytes.extend_from_slice(encode(header, message, signing).raw_bytes());
    }
    bytes
}

#[test]
fn signatures_are_those_of_pymavlink() {
    let key = "0f".repeat(32);
    let signing = || Signing::new([0x0F; 32], 1, false);
    let sent = messages();
    let Some((fields, back)) = echoed(&encoded(&sent, Some(&signing())), Some(&key)) else {
        return;
    };
    assert_eq!(fields.len(), sent.len());
    let (mut framer, mut heard) = (Framer::new(Some(signing())), Vec::new());
    framer.push(&back, |frame| heard.push(frame.message));
    assert_eq!(heard, sent);
    // Neither takes what is not signed, or signed otherwise.
    let other = Signing::new([0x1F; 32], 1, false);
    let mut refused = encoded(&sent, None);
    refused.extend(encoded(&sent, Some(&other)));
    let (fields, _) = echoed(&refused, Some(&key)).expect("installed");
    assert!(fields.is_empty(), "{fields:?}");
    let mut framer = Framer::new(Some(other));
    framer.push(&back, |frame| panic!("{frame:?}"));
    assert_eq!(framer.counts().refused, sent.len() as u64);
}

#[test]
fn pymavlink_reads_what_is_sent_and_is_read() {
    let sent = messages();
    let Some((fields, echoed)) = echoed(&encoded(&sent, None), None) else {
        return;
    };
    assert_eq!(fields.len(), sent.len());
    assert!(
        fields
            .iter()
            .all(|f| f["system"] == 1 && f["component"] == 196)
    );
    // Numbers as pymavlink names and reads them.
    assert_eq!(fields[1]["mavpackettype"], "SET_ATTITUDE_TARGET");
    assert_eq!(fields[1]["type_mask"], 0b1100_0100);
    assert_eq!(fields[2]["chan1_raw"], 2000);
    assert_eq!(fields[3]["ICAO_address"], 0x00AB_C123);
    assert_eq!(fields[3]["callsign"], "FGA1");
    assert_eq!(fields[3]["heading"], 18_000);
    assert_eq!(fields[4]["text"], "fga: avoiding TEST, 12 s away");
    assert_eq!(fields[5]["name"], "FGA_MARGIN");
    assert_eq!(fields[6]["command"], 176);
    assert_eq!(fields[7]["command"], 43_002);
    assert_eq!(fields[8]["param_id"], "ROLL_LIMIT_DEG");
    assert_eq!(fields[9]["mission_type"], 1);
    let mut back = Vec::new();
    Framer::new(None).push(&echoed, |frame| back.push(frame.message));
    assert_eq!(back, sent);
}
