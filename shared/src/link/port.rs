//! What a board provides to the server.

use super::hosted_drive::HostedDrive;
use super::message::AXES;
use super::report::UsbState;
use crate::scalar::Scalar;

/// A serial port that never waits.
pub trait BytePort {
    /// The next byte that has been received.
    fn read(&mut self) -> Option<u8>;

    /// Sends as many of the bytes as can be taken now. Returns their number.
    fn write(&mut self, bytes: &[u8]) -> usize;

    /// The USB port of the board, for its status.
    fn usb(&self) -> UsbState {
        UsbState::None
    }
}

/// Access to the drives, which the tick uses at any time.
pub trait SharedDrive<'m, S: Scalar> {
    /// Runs `access` while no tick runs. It has to be short: ticks wait for it.
    fn with<R>(&mut self, access: impl FnOnce(&mut HostedDrive<'m, S, AXES>) -> R) -> R;
}

/// Without ticks beside it: on a host.
impl<'m, S: Scalar> SharedDrive<'m, S> for HostedDrive<'m, S, AXES> {
    fn with<R>(&mut self, access: impl FnOnce(&mut Self) -> R) -> R {
        access(self)
    }
}
