//! The steps of the recorded channels in a message.

use serde::{Deserialize, Serialize};

use super::packet::PerAxis;
use crate::capture::ChannelSteps;

/// The steps of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AxisSteps {
    /// Step of the motor reading, position units.
    pub motor: i64,
    /// Step of the linear scale, position units.
    pub table: i64,
}

/// [`ChannelSteps`] of as many axes as the board has.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListedSteps {
    /// Step of the command, position units.
    pub command: i64,
    /// Steps of the axes.
    pub axes: PerAxis<AxisSteps>,
    /// A step of the force is 2^−this, N.
    pub force_bits: u8,
}

impl<const N: usize> From<&ChannelSteps<N>> for ListedSteps {
    /// The first [`MAX_AXES`](super::packet::MAX_AXES) axes: a board has no more.
    fn from(steps: &ChannelSteps<N>) -> Self {
        let axes = steps.motor.iter().zip(&steps.table).map(|(&motor, &table)| AxisSteps { motor, table });
        Self {
            command: steps.command,
            axes: axes.take(super::packet::MAX_AXES).collect(),
            force_bits: steps.force_bits,
        }
    }
}

impl ListedSteps {
    /// The steps of `N` axes; `None` if there is another number.
    #[must_use]
    pub fn of_axes<const N: usize>(&self) -> Option<ChannelSteps<N>> {
        let axes: &[AxisSteps; N] = self.axes.as_slice().try_into().ok()?;
        Some(ChannelSteps {
            command: self.command,
            motor: axes.map(|steps| steps.motor),
            table: axes.map(|steps| steps.table),
            force_bits: self.force_bits,
        })
    }
}
