//! An open port.

use std::io::{self, Read, Write};
use std::path::Path;

use serialport::SerialPort;
use shared::link::port::BAUD;

use crate::broker::Broker;
use crate::byte_stream::{ByteStream, READ_TIMEOUT, receive};
use crate::port_lock::PortLock;
use crate::share::{self, Shared};

struct Serial(Box<dyn SerialPort>);

impl Read for Serial {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.0.read(bytes)
    }
}

impl Write for Serial {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl ByteStream for Serial {
    fn another(&self) -> io::Result<Box<dyn ByteStream>> {
        Ok(Box::new(Self(self.0.try_clone()?)))
    }
}

/// An open port.
pub struct Port {
    stream: Stream,
    /// Ends before the lock: a port that is free has no socket.
    _broker: Option<Broker>,
    /// Held while the port is open.
    _lock: Option<PortLock>,
}

enum Stream {
    Own(Box<dyn ByteStream>),
    Shared(Shared),
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
        Ok(Self::of(socket::connect(path)?))
    }

    /// A serial port.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn serial(path: &str) -> serialport::Result<Self> {
        // Opened for this program only.
        let port = serialport::new(path, BAUD).timeout(READ_TIMEOUT).open()?;
        Ok(Self::of(Box::new(Serial(port))))
    }

    fn of(stream: Box<dyn ByteStream>) -> Self {
        Self { stream: Stream::Own(stream), _broker: None, _lock: None }
    }

    /// This port with a lock that other programs respect, and a socket beside it at which they can ask for what needs no session.
    /// Without a lock, or where the socket cannot be made, it is used without one.
    #[must_use]
    pub fn held_by(self, lock: Option<PortLock>) -> Self {
        let Stream::Own(stream) = self.stream else { return self };
        let Some(lock) = lock else { return Self::of(stream) };
        match share::share(stream) {
            Ok((shared, guests)) => {
                let broker = Broker::start(lock.path(), guests).ok();
                Self { stream: Stream::Shared(shared), _broker: broker, _lock: Some(lock) }
            }
            Err(stream) => Self { _lock: Some(lock), ..Self::of(stream) },
        }
    }

    /// Sends bytes, in one piece.
    ///
    /// # Errors
    /// The failure of the port.
    pub fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        match &mut self.stream {
            Stream::Own(stream) => {
                stream.write_all(bytes)?;
                stream.flush()
            }
            Stream::Shared(shared) => shared.send(bytes),
        }
    }

    /// Receives what has arrived; waits at most 20 ms. 0: nothing has.
    ///
    /// # Errors
    /// The failure of the port, or its end.
    pub fn receive(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match &mut self.stream {
            Stream::Own(stream) => receive(stream.as_mut(), bytes),
            Stream::Shared(shared) => shared.receive(bytes),
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

    use crate::byte_stream::{ByteStream, READ_TIMEOUT};

    impl ByteStream for UnixStream {
        fn another(&self) -> io::Result<Box<dyn ByteStream>> {
            Ok(Box::new(self.try_clone()?))
        }
    }

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

    use crate::byte_stream::ByteStream;

    pub fn connect(_path: &Path) -> io::Result<Box<dyn ByteStream>> {
        Err(io::Error::new(io::ErrorKind::Unsupported, "the emulated board needs Linux or macOS"))
    }

    pub fn is_at(_path: &Path) -> bool {
        false
    }
}
