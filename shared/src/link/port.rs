//! What a board provides to the server.

use super::hosted_drive::HostedDrive;
use super::message::AXES;
use crate::drive::DriveOutput;
use crate::scalar::Scalar;

/// A serial port that never waits.
pub trait BytePort {
    /// The next byte that has been received.
    fn read(&mut self) -> Option<u8>;

    /// Sends as many of the bytes as can be taken now. Returns their number.
    fn write(&mut self, bytes: &[u8]) -> usize;
}

/// Access to the drives, which the tick uses at any time.
pub trait SharedDrive<'m, S: Scalar> {
    /// The outputs to the drives.
    type Output: DriveOutput<S>;

    /// Runs `access` while no tick runs. It has to be short: ticks wait for it.
    fn with<R>(&mut self, access: impl FnOnce(&mut HostedDrive<'m, S, AXES, Self::Output>) -> R) -> R;
}

/// Without ticks beside it: on a host.
impl<'m, S: Scalar, O: DriveOutput<S>> SharedDrive<'m, S> for HostedDrive<'m, S, AXES, O> {
    type Output = O;

    fn with<R>(&mut self, access: impl FnOnce(&mut Self) -> R) -> R {
        access(self)
    }
}
