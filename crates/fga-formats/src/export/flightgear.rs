//! FlightGear over UDP: the generic protocol, one line of text for each state.
//!
//! Start FlightGear with [`PROTOCOL_XML`] in its `Protocol` folder:
//!
//! ```text
//! fgfs --fdm=null --generic=socket,in,30,,5500,udp,fga
//! ```
//!
//! Units of FlightGear: latitude and longitude in degrees, altitude in feet above mean
//! sea level; roll positive with the right wing down, pitch positive with the nose up, heading
//! from true north.

use crate::flight::FlightSample;
use crate::geodesy::LocalFrame;
use crate::number::push_fixed;
use crate::units::{FOOT_M, KNOT_MPS};
use core::net::SocketAddr;
use std::io;
use std::net::{ToSocketAddrs, UdpSocket};

/// The protocol file, to be saved as `fga.xml` in FlightGear's `Protocol` folder.
pub const PROTOCOL_XML: &str = include_str!("flightgear-protocol.xml");

/// One line of the protocol for a sample, ending with a newline.
pub fn line(frame: &LocalFrame, sample: &FlightSample, airspeed_mps: f64) -> Vec<u8> {
    let place = frame.to_geodetic(sample.position_m);
    let mut out = Vec::with_capacity(96);
    for (value, decimals) in [
        (place.latitude_deg, 8),
        (place.longitude_deg, 8),
        (place.altitude_m / FOOT_M, 2),
        (sample.roll_deg(), 3),
        (sample.climb_deg(), 3),
        (sample.compass_deg(), 3),
        (airspeed_mps / KNOT_MPS, 2),
    ] {
        if !out.is_empty() {
            out.push(b'\t');
        }
        push_fixed(&mut out, value, decimals);
    }
    out.push(b'\n');
    out
}

/// Sends states to a FlightGear.
#[derive(Debug)]
pub struct FlightGearSender {
    socket: UdpSocket,
    target: SocketAddr,
}

impl FlightGearSender {
    /// A sender to `host:port`.
    ///
    /// # Errors
    /// A host without an address, or no free socket.
    pub fn new(target: &str) -> io::Result<Self> {
        let target = target
            .to_socket_addrs()?
            .next()
            .ok_or(io::ErrorKind::AddrNotAvailable)?;
        let local = if target.is_ipv4() {
            "0.0.0.0:0"
        } else {
            "[::]:0"
        };
        let socket = UdpSocket::bind(local)?;
        socket.set_nonblocking(true)?;
        Ok(Self { socket, target })
    }

    /// Sends one state. An absent listener or a full queue is no error: the next state follows.
    pub fn send(&self, frame: &LocalFrame, sample: &FlightSample, airspeed_mps: f64) {
        let line = line(frame, sample, airspeed_mps);
        let _ = self.socket.send_to(&line, self.target);
    }
}
