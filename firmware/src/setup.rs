//! The data of the machine on the board: all that has to be changed for another machine.
//!
//! Two screws of 5 mm lead with 5000-line encoders on their motors; 15 kg equivalent mass per axis. The values must be
//! accepted by [`MachineConfig::new`] and [`Amplifier::new`], which is verified by a test on the host.

use shared::config::{AxisSettings, Law, Rates, Sensors};
use shared::drive::{Amplifier, DriveError, DriveSystem, EnableSwitch, StatusLight};
use shared::interpolate::Smoothing;
use shared::machine::{Machine, MachineConfig, MachineError};
use shared::safety::Fault;
use shared::scalar::Fixed;
use shared::units::Position;

/// Axes of the board.
pub const AXES: usize = 2;

/// Rates of the loops.
pub const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };

/// The tick rate of [`RATES`] for the tick timer, Hz.
pub const TICK_HZ: u32 = 20_000;

/// Frequency of the crystal, Hz.
pub const CRYSTAL_HZ: u32 = 8_000_000;

/// PWM frequency, Hz: inaudible, and 8400 counts at 168 MHz. A period is one tick.
pub const PWM_HZ: u32 = TICK_HZ;

/// Lead over counts per turn (four per line): 0.25 µm. Negative if the counter decreases in the positive direction.
pub const METRES_PER_COUNT: [f64; AXES] = [5e-3 / 20_000.0; AXES];

/// Force at full duty, N. Negative if a positive duty produces a negative force.
pub const FULL_DUTY_N: [f64; AXES] = [400.0; AXES];

/// Debounce time of the enable switch, ticks: 20 ms.
pub const SWITCH_SETTLING_TICKS: u32 = 400;

/// Half period of the status light during a warning, ticks: 2 Hz.
pub const BLINK_TICKS: u32 = 5000;

/// The loops. With 15 kg, Kv gives the velocity loop a bandwidth of 32 Hz; one encoder count, 5 mm/s in one tick, is then
/// 15 N. Kp is a quarter of what that bandwidth allows. Without feed-forward an axis would lag by 1.3 mm at 2 m/min.
pub const SETTINGS: [AxisSettings; AXES] = [AxisSettings {
    law: Law::P,
    position_gain_per_s: 25.0,
    feedforward_percent: 100.0,
    feedforward_ahead_s: 0.0,
    velocity_gain_n_s_per_m: 3_000.0,
    velocity_integral_time_s: Some(0.02),
    velocity_lag_s: 0.0,
    notch: None,
    low_pass: None,
    force_limit_n: 200.0,
    sensors: Sensors::Motor,
    scale_fade_time_s: 0.1,
    following_error_limit_m: 1e-3,
    // 9 m/min.
    fastest_m_per_s: Some(0.15),
    // At a reversal on a circle, friction of 20 N holds an axis for slightly more than 0.1 mm of the command.
    frozen_encoder_limit_m: Some(0.3e-3),
    saturation_time_s: 0.2,
    travel_m: None,
    scale_disagreement_limit_m: None,
    stop_deceleration_m_per_s2: 2.0,
    smoothing: Smoothing::None,
}; AXES];

/// Why the values above were rejected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SetupError {
    /// Settings of an axis.
    Machine(MachineError),
    /// Power stage.
    Drive(DriveError),
    /// Metres per count.
    Encoder,
}

impl From<MachineError> for SetupError {
    fn from(error: MachineError) -> Self {
        Self::Machine(error)
    }
}

impl From<DriveError> for SetupError {
    fn from(error: DriveError) -> Self {
        Self::Drive(error)
    }
}

/// The drive system without a path, drives off, for power stages with `full_counts` PWM counts. When enabled, it holds the axes
/// at their positions. A `previous_fault`, which ended the previous run, has to be acknowledged first.
///
/// The machine is configured in place: it is too large for the stack.
///
/// # Errors
/// [`SetupError`] for an invalid value.
pub fn drive_system(
    machine: &mut Machine<Fixed, AXES>,
    full_counts: u16,
    previous_fault: Option<Fault>,
) -> Result<DriveSystem<'_, Fixed, AXES>, SetupError> {
    machine.configure(MachineConfig::new(RATES, &SETTINGS)?, &[Position(0); AXES]);
    if let Some(fault) = previous_fault {
        machine.inhibit_enable(fault);
    }
    let [x, y] = FULL_DUTY_N;
    let amplifiers = [Amplifier::new(x, full_counts)?, Amplifier::new(y, full_counts)?];
    let (switch, light) = (EnableSwitch::new(SWITCH_SETTLING_TICKS), StatusLight::new(BLINK_TICKS));
    Ok(DriveSystem::new(machine, amplifiers, switch, light))
}
