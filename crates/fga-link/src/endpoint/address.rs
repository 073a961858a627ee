//! The text form of an endpoint.

use core::str::FromStr;

/// The endpoint of the vehicle.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Endpoint {
    /// Waits for datagrams on an address.
    UdpIn(String),
    /// Sends datagrams to an address.
    UdpOut(String),
    /// Connects to an address.
    Tcp(String),
    /// Waits for a connection on an address.
    TcpIn(String),
    /// A serial port.
    Serial {
        /// Device.
        path: String,
        /// Rate, baud.
        baud: u32,
    },
}

/// Text that names no endpoint.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "'{0}' is no endpoint, expected udpin:HOST:PORT, udpout:HOST:PORT, tcp:HOST:PORT, \
     tcpin:HOST:PORT or serial:PATH[:BAUD]"
)]
pub struct EndpointError(String);

impl FromStr for Endpoint {
    type Err = EndpointError;

    fn from_str(text: &str) -> Result<Self, EndpointError> {
        let error = || EndpointError(text.to_owned());
        let (kind, rest) = text.split_once(':').ok_or_else(error)?;
        if kind == "serial" {
            let (path, baud) = match rest.rsplit_once(':') {
                Some((path, baud)) => (path, baud.parse().map_err(|_| error())?),
                None => (rest, 115_200),
            };
            if path.is_empty() || baud == 0 {
                return Err(error());
            }
            return Ok(Self::Serial {
                path: path.to_owned(),
                baud,
            });
        }
        let (host, port) = rest.rsplit_once(':').ok_or_else(error)?;
        if host.is_empty() || port.parse::<u16>().is_err() {
            return Err(error());
        }
        let address = rest.to_owned();
        match kind {
            "udpin" => Ok(Self::UdpIn(address)),
            "udpout" => Ok(Self::UdpOut(address)),
            "tcp" | "tcpout" => Ok(Self::Tcp(address)),
            "tcpin" => Ok(Self::TcpIn(address)),
            _ => Err(error()),
        }
    }
}
