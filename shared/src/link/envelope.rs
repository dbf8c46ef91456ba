//! The envelope of a board, and settings that are within it.
//!
//! A board takes settings from its program, from a host and from its flash. All of them become [`AdmittedSettings`] first, which only
//! [`Envelope::admit`] makes: nothing that a host uploads or a flash holds is beyond what the program was built with. The settings of the
//! program are admitted when it is compiled: one that would be beyond its own envelope is not built.
//!
//! Temperature and bus voltage are not among the settings: their limits are those of the envelope.

use super::board_settings::BoardSettings;
use crate::config::AxisEnvelope;
use crate::drive::SupplyLimits;
use crate::machine::MachineError;

/// What no settings of a board may exceed: a constant of its program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope<const N: usize> {
    /// Ceilings of the settings of each axis, in m, m/s, N and s.
    pub axes: [AxisEnvelope; N],
    /// Limits of bus voltage, mV, and temperature, m°C, in every tick.
    pub supply: SupplyLimits,
}

/// Settings within the envelope of the board.
#[derive(Clone, Debug, PartialEq)]
pub struct AdmittedSettings<const N: usize>(BoardSettings<N>);

impl<const N: usize> Envelope<N> {
    /// Admits settings.
    ///
    /// # Errors
    /// [`MachineError::Config`] with the axis and the setting that is beyond the envelope.
    pub const fn admit(&self, settings: BoardSettings<N>) -> Result<AdmittedSettings<N>, MachineError> {
        let mut rest = (0, self.axes.as_slice(), settings.axes.as_slice());
        while let (axis, [envelope, envelopes @ ..], [settings, others @ ..]) = rest {
            if let Err(error) = envelope.check(settings) {
                return Err(MachineError::Config { axis, error });
            }
            rest = (axis + 1, envelopes, others);
        }
        Ok(AdmittedSettings(settings))
    }

    /// Admits the settings of the program. For a constant: settings beyond the envelope are an error of the compiler.
    ///
    /// # Panics
    /// If the settings are beyond the envelope.
    #[must_use]
    pub const fn admit_program(&self, settings: BoardSettings<N>) -> AdmittedSettings<N> {
        match self.admit(settings) {
            Ok(admitted) => admitted,
            Err(_) => panic!("the settings of the program are beyond its envelope"),
        }
    }
}

impl<const N: usize> core::ops::Deref for AdmittedSettings<N> {
    type Target = BoardSettings<N>;

    fn deref(&self) -> &BoardSettings<N> {
        &self.0
    }
}
