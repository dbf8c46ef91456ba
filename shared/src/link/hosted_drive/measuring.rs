//! The sums of which the rms of an axis is computed.

use super::HostedDrive;
use crate::scalar::Scalar;
use crate::units::{PER_NM, Position};

impl<S: Scalar, const N: usize> HostedDrive<'_, S, N> {
    /// The part of a tick: adds the squares of following errors and forces, with the drives on.
    pub(super) fn measure(&mut self, commands: &[Position; N]) {
        if !self.machine().power().is_on() {
            return self.rms_meter.clear();
        }
        let mut values = [[0; 2]; N];
        for (((values, command), reading), force) in
            values.iter_mut().zip(commands).zip(&self.readings).zip(self.forces)
        {
            // 1 N is 2³⁰ units of [`Scalar::distance`], and 1/64 N 2²⁴.
            *values = [(*command - reading.motor) >> PER_NM.trailing_zeros(), force.distance() >> 24];
        }
        self.rms_meter.add(&values);
    }
}
