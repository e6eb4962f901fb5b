//! Where a joint is connected: a serial device or a socket.

use std::convert::Infallible;
use std::fmt;
use std::io::{self, Read, Write};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

/// Longest wait of a read: within it the command notices that it is to end.
const READ: Duration = Duration::from_millis(10);
/// Longest wait of a write: a frame takes 0.2 s at 1200 Bd.
const WRITE: Duration = Duration::from_secs(1);
/// Longest wait for a socket of another machine.
const OPEN: Duration = Duration::from_secs(5);

/// A port, as it is named on the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Port {
    /// A serial device.
    Serial(PathBuf),
    /// `HOST:PORT`.
    Tcp(String),
    /// A socket in the file system.
    Unix(PathBuf),
}

impl FromStr for Port {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text.split_once(':') {
            Some(("tcp", address)) => Self::Tcp(address.into()),
            Some(("unix", path)) => Self::Unix(path.into()),
            _ => Self::Serial(text.into()),
        })
    }
}

impl fmt::Display for Port {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial(path) => write!(formatter, "{}", path.display()),
            Self::Tcp(address) => write!(formatter, "tcp:{address}"),
            Self::Unix(path) => write!(formatter, "unix:{}", path.display()),
        }
    }
}

/// What a client reads and writes.
pub trait Transport: Read + Write {}

impl<T: Read + Write> Transport for T {}

impl Port {
    /// Opens it; a serial device with this baud rate, 8 bits, no parity, 1 stop bit, no flow control.
    pub fn open(&self, baud: u32) -> io::Result<Box<dyn Transport>> {
        match self {
            Self::Serial(path) => serial(path, baud),
            Self::Tcp(address) => tcp(address),
            Self::Unix(path) => unix(path),
        }
    }
}

fn serial(path: &Path, baud: u32) -> io::Result<Box<dyn Transport>> {
    let port = serialport::new(path.to_string_lossy(), baud).timeout(READ).open()?;
    // What a joint has said before is no answer.
    port.clear(serialport::ClearBuffer::Input)?;
    Ok(Box::new(port))
}

fn tcp(address: &str) -> io::Result<Box<dyn Transport>> {
    let mut failed = io::Error::new(io::ErrorKind::InvalidInput, "it has no address");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, OPEN) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(READ))?;
                stream.set_write_timeout(Some(WRITE))?;
                return Ok(Box::new(stream));
            }
            Err(error) => failed = error,
        }
    }
    Err(failed)
}

fn unix(path: &Path) -> io::Result<Box<dyn Transport>> {
    let stream = UnixStream::connect(path)?;
    stream.set_read_timeout(Some(READ))?;
    stream.set_write_timeout(Some(WRITE))?;
    Ok(Box::new(stream))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_is_told_by_its_name_and_named_by_it() {
        for (name, port) in [
            ("/dev/ttyUSB0", Port::Serial("/dev/ttyUSB0".into())),
            ("/dev/serial/by-path/pci:0", Port::Serial("/dev/serial/by-path/pci:0".into())),
            ("tcp:[::1]:4000", Port::Tcp("[::1]:4000".into())),
            ("unix:a/b", Port::Unix("a/b".into())),
        ] {
            assert_eq!(name.parse(), Ok(port.clone()));
            assert_eq!(port.to_string(), name);
        }
    }
}
