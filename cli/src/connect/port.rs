//! Where a joint is connected: a serial device, a socket, or an emulated board.

use std::convert::Infallible;
use std::fmt;
use std::io::{self, Read, Write};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use strainwave_desktop::GearFile;
use strainwave_emulator::served::ServedBoard;
use strainwave_service::tuning::client::Patience;

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
    /// An emulated board, its flash in a file.
    Emulated(Option<PathBuf>),
}

impl FromStr for Port {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text.split_once(':') {
            Some(("tcp", address)) => Self::Tcp(address.into()),
            Some(("unix", path)) => Self::Unix(path.into()),
            Some(("emulated", flash)) => Self::Emulated(Some(flash.into())),
            None if text == "emulated" => Self::Emulated(None),
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
            Self::Emulated(None) => formatter.write_str("emulated"),
            Self::Emulated(Some(flash)) => write!(formatter, "emulated:{}", flash.display()),
        }
    }
}

/// What a client reads and writes.
pub trait Transport: Read + Write {}

impl<T: Read + Write> Transport for T {}

impl Port {
    /// How long its joint has for an answer: the clock of an emulated one stands still while the machine has other work.
    pub fn patience(&self) -> Patience {
        match self {
            Self::Emulated(_) => Patience {
                answer: Duration::from_secs(3),
                flash: Duration::from_secs(10),
                ..Patience::default()
            },
            _ => Patience::default(),
        }
    }

    /// Opens it: a serial device with this baud rate, 8 bits, no parity, 1 stop bit, no flow control; an emulated board with this joint.
    pub fn open(&self, baud: u32, gear: &GearFile) -> Result<Box<dyn Transport>, String> {
        let opened = match self {
            Self::Serial(path) => serial(path, baud),
            Self::Tcp(address) => tcp(address),
            Self::Unix(path) => unix(path).map(|stream| Box::new(stream) as Box<dyn Transport>),
            Self::Emulated(flash) => return Emulated::start(gear, flash.as_deref()),
        };
        opened.map_err(|error| format!("cannot be opened: {error}"))
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

fn unix(path: &Path) -> io::Result<UnixStream> {
    let stream = UnixStream::connect(path)?;
    stream.set_read_timeout(Some(READ))?;
    stream.set_write_timeout(Some(WRITE))?;
    Ok(stream)
}

/// The link of an emulated board, which ends with it.
struct Emulated {
    stream: UnixStream,
    _board: ServedBoard,
}

impl Emulated {
    fn start(gear: &GearFile, flash: Option<&Path>) -> Result<Box<dyn Transport>, String> {
        let board = ServedBoard::start(gear, flash).map_err(|error| error.to_string())?;
        let stream = unix(board.socket()).map_err(|error| format!("its socket: {error}"))?;
        Ok(Box::new(Self { stream, _board: board }))
    }
}

impl Read for Emulated {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.stream.read(bytes)
    }
}

impl Write for Emulated {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
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
            ("emulated", Port::Emulated(None)),
            ("emulated:flash.bin", Port::Emulated(Some("flash.bin".into()))),
        ] {
            assert_eq!(name.parse(), Ok(port.clone()));
            assert_eq!(port.to_string(), name);
        }
    }
}
