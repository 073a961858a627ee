//! `fga rc`: the keyboard as a transmitter, for tests on the bench.

use core::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use core::time::Duration;
use std::io::{self, IsTerminal as _, Read as _, Write as _};
use std::process::{Command, ExitCode, Stdio};
use std::thread;
use std::time::Instant;

use clap::Args;
use fga_link::endpoint::{Endpoint, LinkRead, open};
use fga_link::mavlink::MavHeader;
use fga_link::mavlink::dialects::ardupilotmega::MavMessage;
use fga_link::rc::{KeyEffect, Keyboard, mode_message};
use fga_link::wire::{Framer, encode};

use crate::failure::Failure;

/// Fly by keyboard: arrows are roll and pitch, +/- throttle, c centres, 1 FBWA, 2 FBWB,
/// 3 CRUISE, 4 AUTO, 5 RTL, x releases the channels, q ends.
#[derive(Args)]
#[command(
    after_help = "Keys: arrows are roll and pitch, + and - throttle, c centres, 1 FBWA, 2 FBWB, \
                        3 CRUISE, 4 AUTO, 5 RTL, x releases the channels, q ends."
)]
pub(crate) struct RcArgs {
    /// Endpoint of the vehicle.
    #[arg(long, value_name = "ENDPOINT")]
    connect: Endpoint,
    /// System id of the sender: the vehicle takes overrides only from its ground station's id.
    #[arg(long, value_name = "ID", default_value_t = 255)]
    system: u8,
}

/// Interval of overrides; the vehicle drops them after three seconds.
const PERIOD: Duration = Duration::from_millis(100);

/// The terminal without line buffering and echo, until dropped.
struct RawTerminal;

impl RawTerminal {
    fn new() -> io::Result<Self> {
        stty(&["-icanon", "-echo", "-isig", "min", "0", "time", "1"])?;
        Ok(Self)
    }
}

impl Drop for RawTerminal {
    fn drop(&mut self) {
        // A missing terminal cannot be restored.
        let _ = stty(&["sane"]);
    }
}

fn stty(words: &[&str]) -> io::Result<()> {
    let status = Command::new("stty")
        .args(words)
        .stdin(Stdio::inherit())
        .status()?;
    if status.success() {
        Ok(())
    } else {
        Err(io::Error::other("standard input is no terminal"))
    }
}

pub(crate) fn run(args: &RcArgs) -> Result<ExitCode, Failure> {
    let failed = |error: io::Error| Failure::Input(format!("rc: {error}"));
    let (mut reader, writer) = open(&args.connect).map_err(failed)?;
    let terminal = RawTerminal::new().map_err(failed)?;
    let vehicle = AtomicU8::new(1);
    let ended = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            let mut framer = Framer::new(None);
            let mut buffer = [0; 2048];
            while !ended.load(Ordering::Relaxed) {
                if let LinkRead::Bytes(count) = reader.read(&mut buffer) {
                    framer.push(buffer.get(..count).unwrap_or_default(), |frame| {
                        if let MavMessage::HEARTBEAT(_) = frame.message
                            && frame.header.component_id == 1
                        {
                            let system = u8::try_from(frame.header.system_id).unwrap_or(1);
                            vehicle.store(system, Ordering::Relaxed);
                        }
                    });
                }
            }
        });
        let mut keyboard = Keyboard::default();
        let mut sequence = 0_u8;
        let mut sent = Instant::now();
        let mut send = |message: &MavMessage| {
            let header = MavHeader {
                system_id: u32::from(args.system),
                component_id: 190,
                sequence,
            };
            sequence = sequence.wrapping_add(1);
            writer.write(encode(header, message, None).raw_bytes());
        };
        let mut input = io::stdin().lock();
        let mut byte = [0; 1];
        loop {
            let system = vehicle.load(Ordering::Relaxed);
            let count = input.read(&mut byte).unwrap_or(0);
            if count > 0 {
                match keyboard.take(byte[0]) {
                    KeyEffect::Nothing => {}
                    KeyEffect::Mode(mode) => send(&mode_message(mode, system)),
                    KeyEffect::Quit => break,
                }
            }
            if count > 0 || sent.elapsed() >= PERIOD {
                sent = Instant::now();
                send(&keyboard.message(system));
                let words = keyboard.sticks().map_or("transmitter".to_owned(), |s| {
                    format!(
                        "roll {} pitch {} throttle {}",
                        s.roll_us, s.pitch_us, s.throttle_us
                    )
                });
                if io::stderr().is_terminal() {
                    eprint!("\r\x1b[K{words}");
                    let _ = io::stderr().flush();
                }
            }
        }
        let system = vehicle.load(Ordering::Relaxed);
        for _ in 0..3 {
            send(&Keyboard::default().message(system));
        }
        ended.store(true, Ordering::Relaxed);
    });
    drop(terminal);
    eprintln!();
    Ok(ExitCode::SUCCESS)
}
