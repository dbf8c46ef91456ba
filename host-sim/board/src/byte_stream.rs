//! Bytes in both directions, read with a timeout.

use std::io::{self, Read, Write};
use std::time::Duration;

/// Longest wait of a single read.
pub(crate) const READ_TIMEOUT: Duration = Duration::from_millis(20);

/// Bytes in both directions.
pub(crate) trait ByteStream: Read + Write + Send {
    /// Another handle of the same stream.
    fn another(&self) -> io::Result<Box<dyn ByteStream>>;
}

/// Receives what has arrived at a stream with a timeout. 0: nothing has.
pub(crate) fn receive(stream: &mut (impl Read + ?Sized), bytes: &mut [u8]) -> io::Result<usize> {
    match stream.read(bytes) {
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
