//! The data of the machine on the board: all that has to be changed for another machine.
//!
//! Two screws of 5 mm lead with 5000-line encoders on their motors; 15 kg equivalent mass per axis. The values must be
//! accepted by [`MachineConfig::new`] and [`AnyOutput::new`], which is verified by a test on the host.

use core::num::NonZeroU32;

use shared::capture::ChannelSteps;
use shared::config::{AxisEnvelope, AxisSettings, Law, Notches, Rates, Sensors, VelocitySource};
use shared::drive::{
    AnyOutput, DriveError, DriveSettings, DriveSystem, EnableSwitch, StatusLight, SupplyLimits, TickClock,
};
use shared::feedback::resolver::ResolverSettings;
use shared::figures::{Thermistor, ThermistorSettings};
use shared::homing::{AtLimit, Direction, HomingSettings, Mark};
use shared::interpolate::Smoothing;
use shared::link::message::BoardSettings;
use shared::link::report::{Identity, Times};
use shared::link::{AdmittedSettings, Envelope};
use shared::machine::{Machine, MachineConfig, MachineError};
use shared::scalar::Fixed;
use shared::units::{PER_NM, Position};

/// Axes of the board: as many as its pins and timers are assigned to (`firmware/src/board`, `firmware/src/g474`).
pub const AXES: usize = 2;

/// Rates of the loops.
pub const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };

/// The tick rate of [`RATES`] for the tick timer, Hz.
pub const TICK_HZ: u32 = 20_000;

/// Frequency of the crystal, Hz.
pub const CRYSTAL_HZ: u32 = 8_000_000;

/// PWM frequency, Hz: inaudible, and 8400 counts at 168 MHz, 8500 at 170 MHz. A period is one tick.
pub const PWM_HZ: u32 = TICK_HZ;

/// Lead over counts per turn (four per line): 0.25 µm. Negative if the counter decreases in the positive direction.
pub const METRES_PER_COUNT: [f64; AXES] = [5e-3 / 20_000.0; AXES];

/// Force at full duty, N. Negative if a positive duty produces a negative force.
pub const FULL_DUTY_N: [f64; AXES] = [400.0; AXES];

/// The sensor of a motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotorSensor {
    /// Quadrature encoder: m of table travel per count, negative if the counter decreases in the positive direction.
    Encoder {
        /// Travel per count, m.
        metres_per_count: f64,
    },
    /// Resolver or sine encoder on the converters.
    Resolver(ResolverSettings),
}

/// What is connected to an axis of the board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisTable {
    /// Sensor of the motor. With a step drive the steps are counted instead.
    pub motor: MotorSensor,
    /// Linear scale: m per count, signed as for the motor; `None`: there is none.
    pub scale_m_per_count: Option<f64>,
    /// Drive.
    pub drive: DriveSettings,
    /// Whether both limit switches are connected.
    pub limit_switches: bool,
    /// Whether the fault output of the drive is connected.
    pub drive_fault: bool,
    /// Whether the signal output of the scale is connected: low, the scale has no signal.
    pub scale_signal: bool,
}

/// The homing of both axes: towards the negative end, on the index pulse of the motor encoder, one per turn.
const HOMING: HomingSettings = HomingSettings {
    direction: Direction::Negative,
    mark: Mark::MotorIndex { spacing_m: 5e-3 },
    mark_position_m: 0.0,
    search_speed_m_per_s: 0.02,
    approach_speed_m_per_s: 2e-3,
    acceleration_m_per_s2: 0.5,
    search_distance_m: 0.4,
    back_off_distance_m: 0.02,
    at_limit: AtLimit::TurnRound,
    timeout_s: 60.0,
};

/// Late and missed ticks that are no fault while the drives are on: none. The loops are tuned for forces that change once in a tick.
pub const TOLERATED_TICKS: u32 = 0;

/// How ticks are timed with a counter of a clock of `hz`, Hz. For a constant: a slower clock is an error of the compiler.
///
/// # Panics
/// If the clock is slower than the ticks.
#[must_use]
pub const fn tick_clock(hz: u32) -> TickClock {
    let Some(counts_per_tick) = NonZeroU32::new(hz / TICK_HZ) else {
        panic!("a clock slower than the ticks")
    };
    TickClock { counts_per_tick, tolerated: TOLERATED_TICKS }
}

/// What is connected to the board.
pub static TABLE: [AxisTable; AXES] = {
    const fn axis(index: usize) -> AxisTable {
        AxisTable {
            motor: MotorSensor::Encoder { metres_per_count: METRES_PER_COUNT[index] },
            scale_m_per_count: Some(0.5e-6),
            drive: DriveSettings::Pwm { full_duty_n: FULL_DUTY_N[index] },
            limit_switches: true,
            drive_fault: true,
            scale_signal: true,
        }
    }
    [axis(0), axis(1)]
};

/// A count of the finer sensor of each axis, position units: the steps of recordings.
const COUNTS: [i64; AXES] = [250 * PER_NM; AXES];

/// What a board of this machine says about itself, with its own name.
#[must_use]
pub const fn identity(board: &'static str) -> Identity<AXES> {
    Identity {
        board,
        software: env!("CARGO_PKG_VERSION"),
        tick_hz: TICK_HZ,
        steps: ChannelSteps { command: PER_NM / 16, motor: COUNTS, table: COUNTS, force_bits: 5 },
        times: Times { hold_ms: 500, off_ms: 10_000, jog_ms: 300 },
        homing: [Some(HOMING); AXES],
        envelope: &ENVELOPE,
    }
}

/// Vendor and product of the USB port: the pair that V-USB gives to CDC-ACM devices, which the names tell apart. A product that is
/// sold needs its own.
pub const USB_IDS: (u16, u16) = (0x16c0, 0x27dd);

/// Name of the manufacturer.
pub const USB_MANUFACTURER: &str = "Lost Motion";

/// Identifiers of CAN, of 11 bits, on a board with such a port: frames to the board, and from it.
pub const CAN_TO_BOARD: u16 = 0x640;
/// Frames from the board.
pub const CAN_FROM_BOARD: u16 = 0x641;
const _: () = assert!(CAN_TO_BOARD < 0x800 && CAN_FROM_BOARD < 0x800 && CAN_TO_BOARD != CAN_FROM_BOARD);

/// The settings until others are uploaded. They do not compile unless they are within [`ENVELOPE`].
pub const LINK_SETTINGS: AdmittedSettings<AXES> =
    ENVELOPE.admit_program(BoardSettings { rates: RATES, axes: SETTINGS });

/// What no upload and no record in flash may exceed. It is what the machine withstands, not what is convenient: a drive of 400 N, a
/// travel of 0.4 m between the limit switches, with the reference at the negative one, supplies of 48 V.
pub static ENVELOPE: Envelope<AXES> = Envelope {
    axes: [AxisEnvelope {
        travel_m: Some([-0.01, 0.4]),
        // 30 m/min.
        fastest_m_per_s: 0.5,
        force_limit_n: 300.0,
        saturation_time_s: 1.0,
        following_error_limit_m: 5e-3,
        frozen_encoder_limit_m: 0.5e-3,
        scale_disagreement_limit_m: Some(1e-3),
        stop_deceleration_m_per_s2: 0.5,
        excitation_limit_n: 120.0,
        gantry_skew_limit_m: Some(2e-3),
    }; AXES],
    supply: SupplyLimits { min_bus_mv: 36_000, max_bus_mv: 60_000, max_temperature_mc: 80_000 },
};

/// Bus voltage in mV per count of 12 bits: 3.3 V behind a divider of 100 kΩ and 4.7 kΩ.
pub const BUS_MV_PER_COUNT: f64 = 3300.0 / 4096.0 * (100.0 + 4.7) / 4.7;

/// The sensor of the temperature of the power stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TemperatureSensor {
    /// Temperature in m°C per count, and at 0 counts.
    Linear([f64; 2]),
    /// Thermistor between the input and ground, with a resistor to 3.3 V.
    Thermistor(ThermistorSettings),
}

/// The sensor that is fitted.
pub static TEMPERATURE: TemperatureSensor = TemperatureSensor::Linear(TEMPERATURE_MC);

/// Temperature in m°C per count, and at 0 counts: a sensor of 10 mV/K with 500 mV at 0 °C.
pub const TEMPERATURE_MC: [f64; 2] = [3300.0 / 4096.0 * 100.0, -50_000.0];

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
    gain_schedule: None,
    velocity_integral_time_s: Some(0.02),
    velocity_source: VelocitySource::Difference,
    velocity_lag_s: 0.0,
    notches: Notches::NONE,
    low_pass: None,
    force_limit_n: 200.0,
    // At a reversal on a circle, friction of 20 N holds an axis for slightly more than 0.1 mm of the command.
    sensors: Sensors::Motor {
        scale_disagreement_limit_m: Some(0.5e-3),
        frozen_encoder_limit_m: Some(0.3e-3),
    },
    scale_fade_time_s: 0.1,
    following_error_limit_m: 1e-3,
    // 9 m/min.
    fastest_m_per_s: Some(0.15),
    saturation_time_s: 0.2,
    travel_m: Some([0.0, 0.35]),
    stop_deceleration_m_per_s2: 2.0,
    smoothing: Smoothing::None,
    brake: None,
    preload_n: None,
    gantry: None,
}; AXES];

/// Why the values above were rejected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SetupError {
    /// Settings of an axis.
    Machine(MachineError),
    /// Power stage.
    Drive(DriveError),
    /// Metres per count, or a resolver.
    Encoder,
    /// Scale of a converter input.
    Converter,
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

/// The drive system of the board: a step drive gets at most one step in a tick.
pub type BoardDrives<'m> = DriveSystem<'m, Fixed, AXES, AnyOutput<Fixed>>;

/// The drive system without a path, drives off, for power stages with `full_counts` PWM counts, with ticks timed by `clock`. When enabled, it holds the axes
/// at their positions. No axis is homed: positions are those since power-up.
///
/// The machine is configured in place: it is too large for the stack.
///
/// # Errors
/// [`SetupError`] for an invalid value.
pub fn drive_system(
    machine: &mut Machine<Fixed, AXES>,
    full_counts: u16,
    clock: TickClock,
) -> Result<BoardDrives<'_>, SetupError> {
    machine.configure(MachineConfig::new(LINK_SETTINGS.rates, &LINK_SETTINGS.axes)?, &[Position(0); AXES]);
    (0..AXES).for_each(|axis| machine.lose_reference(axis));
    // Read at run time, so that what is built and tested has every alternative of the table.
    let [x, y] = core::hint::black_box(&TABLE);
    let outputs = [AnyOutput::new(&x.drive, full_counts, 1)?, AnyOutput::new(&y.drive, full_counts, 1)?];
    let (switch, light) = (EnableSwitch::new(SWITCH_SETTLING_TICKS), StatusLight::new(BLINK_TICKS));
    let system = DriveSystem::new(machine, outputs, switch, light);
    let system = system.with_supply_limits(ENVELOPE.supply).with_tick_clock(clock);
    match core::hint::black_box(&TEMPERATURE) {
        TemperatureSensor::Linear(_) => Ok(system),
        TemperatureSensor::Thermistor(settings) => {
            let thermistor = Thermistor::new(settings, ENVELOPE.supply.max_temperature_mc);
            Ok(system.with_thermistor(thermistor.ok_or(SetupError::Converter)?))
        }
    }
}
