//! Time in which a tick changes nothing.

use super::HostedDrive;
use crate::capture::CaptureState;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize> HostedDrive<'_, S, N> {
    /// Whether the drives are off and nothing waits for a tick: no direction check, no stream, no recording.
    #[must_use]
    pub fn rests(&self) -> bool {
        !self.machine().power().is_on()
            && !self.is_checking()
            && self.stream.decimation() == 0
            && self.capture.state() != CaptureState::Recording
    }

    /// Lets ticks pass that are not run, as on an emulated board that sleeps. No effect unless the drive rests.
    pub fn skip(&mut self, ticks: u32) {
        if self.rests() {
            self.tick += u64::from(ticks);
            self.watch.skip(ticks);
        }
    }
}
