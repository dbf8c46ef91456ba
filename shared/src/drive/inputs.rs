//! What a board reads besides positions: switches, faults of the drives, and the supply.
//!
//! # Example
//!
//! ```
//! use shared::drive::{Supply, SupplyLimits};
//! use shared::safety::Fault;
//!
//! let limits = SupplyLimits { min_bus_mv: 36_000, max_bus_mv: 56_000, max_temperature_mc: 80_000 };
//! let supply = Supply { bus_mv: Some(57_100), temperature_mc: Some(41_000) };
//! assert_eq!(limits.fault(&supply), Some(Fault::BusOvervoltage));
//! ```

use crate::figures::EncoderSignals;
use crate::safety::Fault;
use crate::units::Position;

/// The inputs of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inputs<const N: usize> {
    /// Inputs of each axis.
    pub axes: [AxisInputs; N],
    /// Whether the emergency stop is pressed.
    pub emergency_stop: bool,
    /// Whether the probe is touched.
    pub probe_touched: bool,
    /// Supply of the power stages.
    pub supply: Supply,
    /// Counts of the thermistor of the hottest power stage; `None`: there is none ([`super::DriveSystem::with_thermistor`]).
    pub thermistor_counts: Option<u16>,
}

impl<const N: usize> Inputs<N> {
    /// No switch, no fault, no measurement.
    pub const NONE: Self = Self {
        axes: [AxisInputs::NONE; N],
        emergency_stop: false,
        probe_touched: false,
        supply: Supply::NOT_MEASURED,
        thermistor_counts: None,
    };
}

/// The inputs of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AxisInputs {
    /// Limit switch at the negative and at the positive end.
    pub limits: [bool; 2],
    /// Home switch.
    pub home: bool,
    /// Motor reading that was latched at an index pulse since the last tick, from the origin at power-up.
    pub motor_index: Option<Position>,
    /// Scale reading that was latched at an index pulse since the last tick, from the origin at power-up.
    pub scale_index: Option<Position>,
    /// Whether the drive reports a fault.
    pub drive_fault: bool,
    /// Whether the signals of the motor encoder or resolver are outside their amplitudes.
    pub bad_encoder_signal: bool,
    /// Sine and cosine of that encoder or resolver; `None`: the sensor has none.
    pub signals: Option<EncoderSignals>,
    /// External counter at the input of the scale, over all 32 bits; `None`: a scale is there, or nothing.
    pub counter: Option<u32>,
}

impl AxisInputs {
    /// No switch, no fault.
    pub const NONE: Self = Self {
        limits: [false; 2],
        home: false,
        motor_index: None,
        scale_index: None,
        drive_fault: false,
        bad_encoder_signal: false,
        signals: None,
        counter: None,
    };
}

/// The supply of the power stages. `None`: not measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Supply {
    /// Bus voltage, mV.
    pub bus_mv: Option<u32>,
    /// Temperature of the hottest power stage, m°C.
    pub temperature_mc: Option<i32>,
}

impl Supply {
    /// No measurement.
    pub const NOT_MEASURED: Self = Self { bus_mv: None, temperature_mc: None };
}

/// Limits of the supply.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct SupplyLimits {
    /// Least bus voltage, mV.
    pub min_bus_mv: u32,
    /// Greatest bus voltage, mV.
    pub max_bus_mv: u32,
    /// Greatest temperature, m°C.
    pub max_temperature_mc: i32,
}

impl SupplyLimits {
    /// Everything is allowed.
    pub const NONE: Self = Self { min_bus_mv: 0, max_bus_mv: u32::MAX, max_temperature_mc: i32::MAX };

    /// The most severe fault of a supply.
    #[must_use]
    pub const fn fault(&self, supply: &Supply) -> Option<Fault> {
        match *supply {
            Supply { bus_mv: Some(bus), .. } if bus > self.max_bus_mv => Some(Fault::BusOvervoltage),
            Supply { bus_mv: Some(bus), .. } if bus < self.min_bus_mv => Some(Fault::BusUndervoltage),
            Supply { temperature_mc: Some(temperature), .. } if temperature > self.max_temperature_mc => {
                Some(Fault::OverTemperature)
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each limit itself is allowed, and one unit beyond it is not; what is not measured is no fault.
    #[test]
    fn the_limits_are_the_last_allowed_values() {
        let limits = SupplyLimits { min_bus_mv: 36_000, max_bus_mv: 56_000, max_temperature_mc: 80_000 };
        let fault = |bus_mv, temperature_mc| {
            limits.fault(&Supply { bus_mv: Some(bus_mv), temperature_mc: Some(temperature_mc) })
        };
        assert_eq!(fault(36_000, 80_000), None);
        assert_eq!(fault(56_000, -40_000), None);
        assert_eq!(fault(35_999, 20_000), Some(Fault::BusUndervoltage));
        assert_eq!(fault(56_001, 20_000), Some(Fault::BusOvervoltage));
        assert_eq!(fault(48_000, 80_001), Some(Fault::OverTemperature));
        assert_eq!(fault(56_001, 80_001), Some(Fault::BusOvervoltage));
        assert_eq!(limits.fault(&Supply::NOT_MEASURED), None);
        let extreme = |bus_mv, temperature_mc| Supply { bus_mv, temperature_mc };
        assert_eq!(SupplyLimits::NONE.fault(&extreme(Some(0), Some(i32::MAX))), None);
        assert_eq!(SupplyLimits::NONE.fault(&extreme(Some(u32::MAX), Some(i32::MIN))), None);
    }
}
