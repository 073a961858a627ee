//! Endpoints as they are written, and sockets and ports that come and go.

use std::io::{Read as _, Write as _};
use std::net::TcpListener;

use super::*;

#[test]
fn endpoints_are_read() {
    assert_eq!(
        "udpin:0.0.0.0:14550".parse(),
        Ok(Endpoint::UdpIn("0.0.0.0:14550".into()))
    );
    assert_eq!(
        "tcp:127.0.0.1:5760".parse(),
        Ok(Endpoint::Tcp("127.0.0.1:5760".into()))
    );
    assert_eq!(
        "serial:/dev/ttyAMA0:921600".parse(),
        Ok(Endpoint::Serial {
            path: "/dev/ttyAMA0".into(),
            baud: 921_600
        })
    );
    assert_eq!(
        "serial:/dev/ttyS1".parse(),
        Ok(Endpoint::Serial {
            path: "/dev/ttyS1".into(),
            baud: 115_200
        })
    );
    for wrong in [
        "",
        "udpin",
        "udpin:host",
        "tcp:host:port",
        "serial::9600",
        "smoke:a:1",
    ] {
        assert!(wrong.parse::<Endpoint>().is_err(), "{wrong}");
    }
}

#[test]
fn a_waiting_port_answers_its_senders() {
    let (mut waiting, answer) = udp::open("127.0.0.1:0".parse().unwrap(), None).unwrap();
    let port = waiting.socket.local_addr().unwrap();
    assert!(!answer.write(b"nobody"));
    let (mut calling, call) = open(&Endpoint::UdpOut(port.to_string())).unwrap();
    assert!(call.write(b"here"));
    let mut buffer = [0; 64];
    while waiting.read(&mut buffer, false) == LinkRead::Nothing {}
    assert!(answer.write(b"there"));
    while calling.read(&mut buffer) == LinkRead::Nothing {}
    assert_eq!(&buffer[..5], b"there");
}

#[cfg(all(feature = "serial", unix))]
#[test]
fn a_serial_port_carries_bytes_both_ways() {
    use serialport::{SerialPort as _, TTYPort};

    let (mut other_end, port) = TTYPort::pair().unwrap();
    let path = port.name().unwrap();
    let (mut reader, writer) = open(&format!("serial:{path}:57600").parse().unwrap()).unwrap();
    other_end.write_all(b"from the vehicle").unwrap();
    let (mut buffer, mut heard) = ([0; 64], Vec::new());
    while heard.len() < 16 {
        if let LinkRead::Bytes(count) = reader.read(&mut buffer) {
            heard.extend_from_slice(&buffer[..count]);
        }
    }
    assert_eq!(heard, b"from the vehicle");
    assert!(writer.write(b"to the vehicle"));
    let mut heard = [0; 14];
    other_end.read_exact(&mut heard).unwrap();
    assert_eq!(&heard, b"to the vehicle");
}

/// An adapter that is pulled out and comes back is another device under the same name.
#[cfg(all(feature = "serial", unix))]
#[test]
fn a_serial_port_that_was_pulled_out_is_opened_again() {
    use serialport::{SerialPort as _, TTYPort};

    let name = format!("fga-serial-{}", std::process::id());
    let link = std::env::temp_dir().join(name);
    let plug_in = || {
        let (vehicle, port) = TTYPort::pair().unwrap();
        let _ = std::fs::remove_file(&link);
        std::os::unix::fs::symlink(port.name().unwrap(), &link).unwrap();
        (vehicle, port)
    };
    let first = plug_in();
    let endpoint = format!("serial:{}:57600", link.display());
    let (mut reader, writer) = open(&endpoint.parse().unwrap()).unwrap();
    drop(first);
    let (mut vehicle, _port) = plug_in();
    let mut buffer = [0; 64];
    while reader.read(&mut buffer) != LinkRead::NewConnection {}
    vehicle.write_all(b"again").unwrap();
    while reader.read(&mut buffer) == LinkRead::Nothing {}
    assert_eq!(&buffer[..5], b"again");
    assert!(writer.write(b"heard"));
    let mut heard = [0; 5];
    vehicle.read_exact(&mut heard).unwrap();
    assert_eq!(&heard, b"heard");
    std::fs::remove_file(&link).unwrap();
}

#[test]
fn a_lost_connection_is_made_again() {
    let server = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = server.local_addr().unwrap().to_string();
    let (mut reader, writer) = open(&Endpoint::Tcp(address)).unwrap();
    let mut buffer = [0; 8];
    for word in [b"one", b"two"] {
        while reader.read(&mut buffer) != LinkRead::NewConnection {}
        let (mut stream, _) = server.accept().unwrap();
        stream.write_all(word).unwrap();
        while reader.read(&mut buffer) != LinkRead::Bytes(3) {}
        assert_eq!(&buffer[..3], word);
        assert!(writer.write(b"heard"));
    }
}

#[test]
fn a_port_that_is_taken_says_what_to_do() {
    let (tcp, udp) = (
        TcpListener::bind("127.0.0.1:0"),
        std::net::UdpSocket::bind("127.0.0.1:0"),
    );
    let (tcp, udp) = (tcp.expect("a port"), udp.expect("a port"));
    for endpoint in [
        Endpoint::TcpIn(tcp.local_addr().expect("an address").to_string()),
        Endpoint::UdpIn(udp.local_addr().expect("an address").to_string()),
    ] {
        let error = open(&endpoint).expect_err("it is taken").to_string();
        assert!(
            error.starts_with("another program uses this port, expected a free one"),
            "{error}"
        );
    }
}
