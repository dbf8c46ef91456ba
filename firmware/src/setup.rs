//! The machine on the board: what a builder of another one changes, and nothing else.
//!
//! Two screws of 5 mm lead with 5000-line encoders on their motors, 15 kg each as the motor feels it.
//! The values have to be accepted by [`MachineConfig::new`] and [`Amplifier::new`]; a test on the host sees to that.

use shared::config::{AxisSettings, Law, Rates, Sensors};
use shared::drive::{Amplifier, DriveError, DriveSystem, EnableSwitch, StatusLight};
use shared::interpolate::Smoothing;
use shared::machine::{Machine, MachineConfig, MachineError};
use shared::safety::Fault;
use shared::scalar::Fixed;
use shared::units::Position;

/// Axes of the board.
pub const AXES: usize = 2;

/// Ticks a second, and every how many of them the position loops run.
pub const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };

/// Frequency of [`RATES`] for the tick timer, Hz.
pub const TICK_HZ: u32 = 20_000;

/// The crystal, Hz.
pub const CRYSTAL_HZ: u32 = 8_000_000;

/// Frequency of the PWM, Hz: inaudible, and 8400 counts at 168 MHz. A period is a tick.
pub const PWM_HZ: u32 = TICK_HZ;

/// Lead over counts of a turn (four a line): 0.25 µm. Negative where the counter falls as the axis goes forward.
pub const METRES_PER_COUNT: [f64; AXES] = [5e-3 / 20_000.0; AXES];

/// Force at full duty, N. Negative where the motor is wired so that a positive duty pushes backwards.
pub const FULL_DUTY_N: [f64; AXES] = [400.0; AXES];

/// Ticks that the enable switch has to stand still before closing counts: 20 ms.
pub const SWITCH_SETTLING_TICKS: u32 = 400;

/// Ticks for which the light is lit and dark while a warning stands: twice a second.
pub const BLINK_TICKS: u32 = 5000;

/// The loops. Kv gives 15 kg a velocity loop of 32 Hz, where one encoder count, 5 mm/s in one tick, is
/// 15 N; Kp is a quarter of what that allows. At 2 m/min an axis would lag 1.3 mm without feed-forward.
pub const SETTINGS: [AxisSettings; AXES] = [AxisSettings {
    law: Law::P,
    position_gain_per_s: 25.0,
    feedforward_percent: 100.0,
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
    // Friction of 20 N holds an axis that turns round on a circle for a good 0.1 mm of the command.
    frozen_encoder_limit_m: Some(0.3e-3),
    saturation_time_s: 0.2,
    travel_m: None,
    scale_disagreement_limit_m: None,
    stop_deceleration_m_per_s2: 2.0,
    smoothing: Smoothing::None,
}; AXES];

/// Why the values above make no machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SetupError {
    /// Loops or program.
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

/// The controller without a path, drives off, for power stages of `full_counts` PWM counts; enabled, it holds the axes
/// where they stand. A fault by which the run before `ended` has to be acknowledged first.
///
/// The machine is filled where it is: by value it would pass over a stack that has no room for it.
///
/// # Errors
/// The [`SetupError`] that says which value is wrong.
pub fn drive_system(
    machine: &mut Machine<Fixed, AXES>,
    full_counts: u16,
    ended: Option<Fault>,
) -> Result<DriveSystem<'_, Fixed, AXES>, SetupError> {
    machine.configure(MachineConfig::new(RATES, &SETTINGS)?, &[Position(0); AXES]);
    if let Some(fault) = ended {
        machine.inhibit_enable(fault);
    }
    let [x, y] = FULL_DUTY_N;
    let amplifiers = [Amplifier::new(x, full_counts)?, Amplifier::new(y, full_counts)?];
    let (switch, light) = (EnableSwitch::new(SWITCH_SETTLING_TICKS), StatusLight::new(BLINK_TICKS));
    Ok(DriveSystem::new(machine, amplifiers, switch, light))
}
