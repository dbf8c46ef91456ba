//! ±10 V to a torque drive, by a unipolar converter with an external stage.
//!
//! The stage turns 0 to full scale of the converter into −10 V to +10 V. Its offset and gain are set in counts:
//!
//! ```text
//! counts = zero + span·force/full-scale force        limited to 0 … maximum
//! ```
//!
//! `zero` are the counts at which the stage gives 0 V, ideally half of the range, `span` the counts from there to +10 V. Both are
//! measured with a voltmeter. What remains of the offset moves an axis without position loop: the enable signal of the drive,
//! not 0 V, is what switches it off.
//!
//! # Example
//!
//! A 12-bit converter whose stage gives 0 V at 2051 counts: −5 V for half of the force in the negative direction.
//!
//! ```
//! use shared::drive::analog::{AnalogOutput, AnalogSettings};
//! use shared::drive::output::{Demand, DriveOutput};
//! use shared::units::Position;
//!
//! let settings = AnalogSettings { full_scale_n: 300.0, zero: 2051, span: 2030, max: 4095 };
//! let mut output = AnalogOutput::<f64>::new(&settings).unwrap();
//! let counts = output.signal(&Demand { force: -150.0, command: Position(0) });
//! assert_eq!(counts, 2051 - 1015);
//! ```

use super::amplifier::{Amplifier, DriveError, Duty};
use super::output::{Demand, DriveOutput};
use crate::scalar::Scalar;

/// Converter and stage of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnalogSettings {
    /// Force at +10 V, N; negative if a positive voltage produces a negative force.
    pub full_scale_n: f64,
    /// Counts at 0 V.
    pub zero: u16,
    /// Counts from 0 V to +10 V.
    pub span: u16,
    /// Greatest count of the converter.
    pub max: u16,
}

/// An analogue output.
#[derive(Clone, Copy, Debug)]
pub struct AnalogOutput<S: Scalar> {
    amplifier: Amplifier<S>,
    zero: u16,
    max: u16,
}

impl<S: Scalar> AnalogOutput<S> {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`DriveError::FullScale`] unless the magnitude of the force is 1 mN to 131 kN; [`DriveError::Counts`] for a span of 0 or
    /// a zero beyond the range of the converter.
    pub fn new(settings: &AnalogSettings) -> Result<Self, DriveError> {
        let AnalogSettings { full_scale_n, zero, span, max } = *settings;
        if span == 0 || zero > max {
            return Err(DriveError::Counts);
        }
        Ok(Self { amplifier: Amplifier::new(full_scale_n, span)?, zero, max })
    }
}

impl<S: Scalar> DriveOutput<S> for AnalogOutput<S> {
    type Signal = u16;

    fn signal(&mut self, demand: &Demand<S>) -> u16 {
        let Duty { reverse, counts } = self.amplifier.duty(demand.force);
        if reverse {
            self.zero.saturating_sub(counts)
        } else {
            self.zero.saturating_add(counts).min(self.max)
        }
    }

    fn off(&mut self) -> u16 {
        self.zero
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::scalar::Fixed;
    use crate::units::Position;

    fn demand<S: Scalar>(force_n: f64) -> Demand<S> {
        Demand { force: S::signal(force_n), command: Position(0) }
    }

    proptest! {
        /// The voltage of an ideal stage is the force over the full-scale force, to half a count and the error of the gain.
        #[test]
        fn the_counts_are_the_nearest(full in 1.0..10_000.0f64, part in -1.5..1.5f64, zero in 1900u16..2200, span in 1800u16..2048, inverted: bool) {
            let full_scale_n = if inverted { -full } else { full };
            let settings = AnalogSettings { full_scale_n, zero, span, max: 4095 };
            let mut output = AnalogOutput::<Fixed>::new(&settings).unwrap();
            let sign = if inverted { -1.0 } else { 1.0 };
            let exact = (f64::from(zero) + sign * f64::from(span) * part.clamp(-1.0, 1.0)).clamp(0.0, 4095.0);
            let counts = f64::from(output.signal(&demand(part * full)));
            // A count of force is full/2048; a fixed-point force resolves 61 µN, up to an eighth of a count at 1 N.
            prop_assert!((counts - exact).abs() < 0.5 + 2048.0 * 61e-6 / full, "{counts}, {exact}");
        }
    }

    #[test]
    fn off_is_zero_volts_and_the_range_of_the_converter_is_kept() {
        let settings = AnalogSettings { full_scale_n: 100.0, zero: 2060, span: 2100, max: 4095 };
        let mut output = AnalogOutput::<f32>::new(&settings).unwrap();
        assert_eq!((output.off(), output.signal(&demand(0.0))), (2060, 2060));
        assert_eq!((output.signal(&demand(1e6)), output.signal(&demand(-1e6))), (4095, 0));
        assert_eq!(output.signal(&Demand { force: f32::NAN, command: Position(0) }), 2060);
    }

    #[test]
    fn invalid_stages_are_rejected() {
        let settings = AnalogSettings { full_scale_n: 100.0, zero: 2048, span: 2047, max: 4095 };
        let error = |settings: AnalogSettings| AnalogOutput::<Fixed>::new(&settings).err();
        assert_eq!(error(settings), None);
        assert_eq!(error(AnalogSettings { span: 0, ..settings }), Some(DriveError::Counts));
        assert_eq!(error(AnalogSettings { zero: 4096, ..settings }), Some(DriveError::Counts));
        assert_eq!(error(AnalogSettings { full_scale_n: 0.0, ..settings }), Some(DriveError::FullScale));
    }
}
