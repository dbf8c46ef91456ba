//! An open port.

use std::io::{self, Read, Write};
use std::path::Path;
use std::time::Duration;

use shared::link::port::BAUD;

use crate::port_lock::PortLock;

/// Longest wait of a single read.
const READ_TIMEOUT: Duration = Duration::from_millis(20);

/// Bytes in both directions.
trait ByteStream: Read + Write + Send {}

impl<T: Read + Write + Send> ByteStream for T {}

/// An open port.
pub struct Port {
    stream: Box<dyn ByteStream>,
    /// Held while the port is open.
    _lock: Option<PortLock>,
}

impl std::fmt::Debug for Port {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Port")
    }
}

impl Port {
    /// A socket, as of the emulated board.
    ///
    /// # Errors
    /// If nothing listens there; on systems without sockets in the file system, always.
    pub fn socket(path: &Path) -> io::Result<Self> {
        Ok(Self { stream: socket::connect(path)?, _lock: None })
    }

    /// A serial port.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn serial(path: &str) -> serialport::Result<Self> {
        // Opened for this program only.
        let port = serialport::new(path, BAUD).timeout(READ_TIMEOUT).open()?;
        Ok(Self { stream: Box::new(port), _lock: None })
    }

    /// This port with a lock that other programs respect.
    #[must_use]
    pub fn held_by(self, lock: Option<PortLock>) -> Self {
        Self { _lock: lock, ..self }
    }

    /// Sends bytes.
    ///
    /// # Errors
    /// The failure of the port.
    pub fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.stream.write_all(bytes)?;
        self.stream.flush()
    }

    /// Receives what has arrived; waits at most 20 ms. 0: nothing has.
    ///
    /// # Errors
    /// The failure of the port, or its end.
    pub fn receive(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self.stream.read(bytes) {
            Ok(0) => Err(io::ErrorKind::UnexpectedEof.into()),
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
                ) =>
            {
                Ok(0)
            }
            other => other,
        }
    }
}

/// Whether a path is a socket.
#[must_use]
pub fn is_socket(path: &Path) -> bool {
    socket::is_at(path)
}

#[cfg(unix)]
mod socket {
    use std::io;
    use std::os::unix::fs::FileTypeExt;
    use std::os::unix::net::UnixStream;
    use std::path::Path;

    use super::{ByteStream, READ_TIMEOUT};

    pub fn connect(path: &Path) -> io::Result<Box<dyn ByteStream>> {
        let stream = UnixStream::connect(path)?;
        stream.set_read_timeout(Some(READ_TIMEOUT))?;
        Ok(Box::new(stream))
    }

    pub fn is_at(path: &Path) -> bool {
        std::fs::metadata(path).is_ok_and(|file| file.file_type().is_socket())
    }
}

#[cfg(not(unix))]
mod socket {
    use std::io;
    use std::path::Path;

    use super::ByteStream;

    pub fn connect(_path: &Path) -> io::Result<Box<dyn ByteStream>> {
        Err(io::Error::new(io::ErrorKind::Unsupported, "the emulated board needs Linux or macOS"))
    }

    pub fn is_at(_path: &Path) -> bool {
        false
    }
}
