//! A serial port, which is opened again when it was pulled out.

use core::time::Duration;
use std::io::{self, Write as _};

use serialport::{ClearBuffer, SerialPort};

use super::stream::{ByteStream, Halves, LinkRead, READ_TIMEOUT, ReadingHalf, WritingHalf, locked};

/// An open port.
type Port = Box<dyn SerialPort>;

#[derive(Debug)]
pub(super) struct SerialReader {
    path: String,
    baud: u32,
    stream: ByteStream<Port>,
}

#[derive(Debug)]
pub(super) struct SerialWriter(Halves<Port>);

/// Opens a port.
pub(super) fn open(path: &str, baud: u32) -> io::Result<(SerialReader, SerialWriter)> {
    let (mut stream, shared) = ByteStream::closed();
    stream.take(open_port(path, baud)?);
    let path = path.to_owned();
    Ok((SerialReader { path, baud, stream }, SerialWriter(shared)))
}

/// The port and its copy.
fn open_port(path: &str, baud: u32) -> io::Result<(Port, Port)> {
    let port = serialport::new(path, baud).timeout(READ_TIMEOUT).open()?;
    let copy = port.try_clone()?;
    Ok((port, copy))
}

impl ReadingHalf for SerialReader {
    fn read(&mut self, buffer: &mut [u8], _is_silent: bool) -> LinkRead {
        let (path, baud) = (&self.path, self.baud);
        self.stream.read(buffer, false, || open_port(path, baud))
    }

    /// Discards what waits to be read, all at once.
    fn wait_for(&self, _time: Duration) -> bool {
        if let Some(port) = self.stream.own() {
            // The next read opens a failed port again.
            let _ = port.clear(ClearBuffer::Input);
        }
        false
    }

    fn discard(&mut self, _buffer: &mut [u8]) -> bool {
        false
    }
}

impl WritingHalf for SerialWriter {
    fn write(&self, bytes: &[u8]) -> bool {
        let mut port = locked(&self.0);
        port.as_mut()
            .is_some_and(|port| port.write_all(bytes).is_ok())
    }
}
