//! The simulated machine of the emulated servo board: 1 to 4 axes behind the same trait as the pins of a real board.
//!
//! `host-sim/machines/bench.toml` declares this machine with two axes, `host-sim/machines/bench-four.toml` with four. What it does not declare is the backlash of the x screw
//! ([`BACKLASH_M`]): the tracer finds it in the logs of the board. The x motor has no cogging until it is switched on ([`COGGING`]), and y is
//! horizontal until it is stood up.

mod axis;
mod beam;
mod brake;
mod cogging;
mod master;
mod signals;

use shared::capture::ChannelSteps;
use shared::config::{AxisEnvelope, AxisSettings};
use shared::drive::{
    Amplifier, AnyOutput, AxisInputs, Board, DriveSignal, DriveSystem, Duty, EnableSwitch, Inputs,
    StatusLight, Supply, SupplyLimits, TickClock,
};
use shared::feedback::Reading;
use shared::figures::{Thermistor, ThermistorSettings};
use shared::homing::{AtLimit, Direction, HomingSettings, Mark};
use shared::link::message::{BoardSettings, MAX_AXES};
use shared::link::{AdmittedSettings, Envelope, Identity, Times};
use shared::machine::{Machine, MachineConfig};
use shared::scalar::Fixed;
use shared::units::{PER_NM, Position};

use crate::setup::{self, RATES, SWITCH_SETTLING_TICKS, SetupError, TICK_HZ};
pub use axis::COUNT;
use axis::{AxisPlant, Frozen, INDEX_M, LEAD_M, Surroundings};
use beam::{Beam, DRAG_N};
use brake::Brake;
pub use cogging::{COGGING, CoggingWave};
pub use master::MASTER_TURN;
use master::Master;
pub use signals::signals;

/// Width of the dead zone between screw and table, m. Not declared in the machine file.
pub const BACKLASH_M: [f64; MAX_AXES] = [14e-6, 0.0, 0.0, 0.0];

/// Travel of the axes, m; the limit switches are 5 mm beyond it.
pub const TRAVEL_M: [f64; 2] = [-0.1, 0.1];

/// Position of the axes at power-up, m: not known to the controller before they are homed.
const START_M: [f64; MAX_AXES] = [-0.0312, 0.0174, 0.0253, -0.0417];

/// Tables beyond this position are on their home switch, m.
const HOME_SWITCH_M: f64 = -0.09;

/// Position of the table of x from which on its probe touches a workpiece, m.
pub const WORKPIECE_M: f64 = -0.02;

/// Distance of the limit switches beyond the travel, m.
const LIMIT_SWITCH_M: f64 = 5e-3;

/// Supply of the simulated power stages, whose temperature is that of a thermistor.
const SUPPLY: Supply = Supply { bus_mv: Some(48_000), temperature_mc: None };

/// The thermistor of the power stages.
pub const THERMISTOR: ThermistorSettings =
    ThermistorSettings { resistance_25_ohm: 10e3, beta_k: 3950.0, series_ohm: 10e3, full_counts: 4096 };

/// Its counts at 31 °C: 10 kΩ·e^(3950·(1/304.15 − 1/298.15)) is 7.7 kΩ.
pub const THERMISTOR_COUNTS: u16 = 1782;

/// How the axes are homed: towards the switch at their negative end, to the index pulse behind its edge.
const HOMING: HomingSettings = HomingSettings {
    direction: Direction::Negative,
    mark: Mark::MotorIndex { spacing_m: LEAD_M },
    mark_position_m: INDEX_M,
    search_speed_m_per_s: 0.05,
    approach_speed_m_per_s: 0.005,
    acceleration_m_per_s2: 0.5,
    search_distance_m: 0.22,
    back_off_distance_m: 0.012,
    at_limit: AtLimit::TurnRound,
    timeout_s: 60.0,
};

/// Rate of the counter that times the ticks, Hz.
pub const COUNTER_HZ: u32 = 25_000_000;

/// How the ticks are timed.
const TICK_CLOCK: TickClock = setup::tick_clock(COUNTER_HZ);

/// PWM counts of full duty.
const FULL_COUNTS: u16 = 8400;

/// Force of a PWM count, N.
#[expect(clippy::cast_possible_truncation, reason = "rounded to 24 bits")]
const N_PER_COUNT: f32 = setup::FULL_DUTY_N[0] as f32 / FULL_COUNTS as f32;

/// Limits of the supply.
pub const SUPPLY_LIMITS: SupplyLimits =
    SupplyLimits { min_bus_mv: 36_000, max_bus_mv: 56_000, max_temperature_mc: 80_000 };

/// The constants of a board of `N` axes.
#[derive(Debug)]
pub struct Constants<const N: usize>;

impl<const N: usize> Constants<N> {
    /// What no upload and no record in flash may exceed.
    pub const ENVELOPE: Envelope<N> = Envelope {
        axes: [AxisEnvelope {
            travel_m: Some(TRAVEL_M),
            // 18 m/min.
            fastest_m_per_s: 0.3,
            force_limit_n: 300.0,
            saturation_time_s: 1.0,
            following_error_limit_m: 2e-3,
            frozen_encoder_limit_m: 0.5e-3,
            scale_disagreement_limit_m: Some(1e-3),
            stop_deceleration_m_per_s2: 0.5,
            excitation_limit_n: 120.0,
            gantry_skew_limit_m: Some(1e-3),
        }; N],
        supply: SUPPLY_LIMITS,
    };

    /// The settings of the controller at the start, within [`Constants::ENVELOPE`].
    pub const SETTINGS: AdmittedSettings<N> = Self::ENVELOPE.admit_program(BoardSettings {
        rates: RATES,
        axes: [AxisSettings { travel_m: Some(TRAVEL_M), ..setup::SETTINGS[0] }; N],
    });

    /// What the board says about itself.
    pub const IDENTITY: Identity<N> = Identity {
        board: "emulated servo board",
        software: env!("CARGO_PKG_VERSION"),
        tick_hz: TICK_HZ,
        steps: ChannelSteps { command: PER_NM / 16, motor: [COUNT; N], table: [COUNT; N], force_bits: 5 },
        times: Times { hold_ms: 500, off_ms: 10_000, jog_ms: 300 },
        homing: [Some(HOMING); N],
        envelope: &Self::ENVELOPE,
    };
}

/// The machine of `N` axes with its inputs, operated from the bench and not by the host.
#[derive(Debug)]
pub struct Bench<const N: usize> {
    axes: [AxisPlant; N],
    /// Forces that act until the next tick, N.
    forces: [f32; N],
    enabled: bool,
    /// The brake of y, which a horizontal axis does not have.
    y_brake: Brake,
    /// The beam between the tables of x and the last axis.
    beam: Beam,
    /// The encoder at the counter of x, beside its scale: a real board has one of both there.
    master: Master,
    operator_inputs: OperatorInputs,
}

/// What a person operates at the machine.
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub struct OperatorInputs {
    /// The enable switch is closed.
    pub enable_switch: bool,
    /// The emergency stop is pressed.
    pub emergency_stop: bool,
    /// Which sensors of x are frozen.
    pub x_frozen: Frozen,
    /// The signal of the x scale is lost.
    pub x_scale_lost: bool,
    /// The x motor has its cogging ([`COGGING`]).
    pub x_cogging: bool,
    /// y is vertical, upwards in the positive direction, and has a brake.
    pub y_vertical: bool,
    /// The table of y carries 3 kg more.
    pub y_loaded: bool,
    /// A hard stop is before x, at −60 mm of the machine.
    pub x_stop: bool,
    /// A workpiece is before x, whose probe is on its table, from [`WORKPIECE_M`] on.
    pub x_workpiece: bool,
    /// A beam is on the tables of x and of the last axis.
    pub beam: bool,
    /// The table of the last axis has [`DRAG_N`] more friction.
    pub last_dragged: bool,
    /// Counts by which the master of x still has to turn.
    pub master_counts: i32,
    /// The next tick with the power stages on takes one and a half periods.
    pub slow_tick: bool,
    /// The interrupts are held off for two periods.
    pub held_off: bool,
}

impl<const N: usize> Bench<N> {
    /// Axes where they are at power-up, switch open. There are at most [`MAX_AXES`]: more are an error of the compiler.
    #[must_use]
    pub fn new() -> Self {
        const { assert!(N >= 1 && N <= MAX_AXES, "a board has 1 to 4 axes") };
        Self {
            axes: core::array::from_fn(|axis| AxisPlant::new(BACKLASH_M[axis], START_M[axis])),
            forces: [0.0; N],
            enabled: false,
            y_brake: Brake::CLOSED,
            beam: Beam::default(),
            master: Master::default(),
            operator_inputs: OperatorInputs {
                enable_switch: false,
                emergency_stop: false,
                x_frozen: Frozen { encoder: false, scale: false },
                x_scale_lost: false,
                x_cogging: false,
                y_vertical: false,
                y_loaded: false,
                x_stop: false,
                x_workpiece: false,
                beam: false,
                last_dragged: false,
                master_counts: 0,
                slow_tick: false,
                held_off: false,
            },
        }
    }

    /// What the person at the machine operates.
    pub const fn operator_inputs(&mut self) -> &mut OperatorInputs {
        &mut self.operator_inputs
    }

    /// Moves the machine by the time of a tick.
    pub fn step(&mut self) {
        let inputs = self.operator_inputs;
        self.y_brake.step();
        self.master.step(&mut self.operator_inputs.master_counts);
        let forces = if self.enabled { self.forces } else { [0.0; N] };
        let beam_n = self.beam.force_n(inputs.beam, &mut self.axes);
        let braked = inputs.y_vertical && self.y_brake.is_closed();
        for (number, (axis, force)) in self.axes.iter_mut().zip(forces).enumerate() {
            let (mut surroundings, mut frozen) = (Surroundings::default(), Frozen::default());
            if number == 0 {
                let motor_n = if inputs.x_cogging { cogging::force_n(axis.motor()) } else { 0.0 };
                let table_n = -beam_n;
                frozen = inputs.x_frozen;
                surroundings = Surroundings { motor_n, table_n, stopped: inputs.x_stop, ..surroundings };
            } else if number == N - 1 {
                let drag_n = if inputs.last_dragged { DRAG_N } else { 0.0 };
                surroundings = Surroundings { table_n: beam_n, drag_n, ..surroundings };
            }
            if number == 1 {
                let OperatorInputs { y_vertical: vertical, y_loaded: loaded, .. } = inputs;
                surroundings = Surroundings { vertical, loaded, braked, ..surroundings };
            }
            axis.step(force, surroundings, frozen);
        }
    }
}

impl<const N: usize> Default for Bench<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Board<N, DriveSignal> for Bench<N> {
    fn readings(&mut self) -> [Reading; N] {
        let mut readings = self.axes.each_ref().map(AxisPlant::reading);
        if self.operator_inputs.x_scale_lost
            && let Some(x) = readings.first_mut()
        {
            x.table = None;
        }
        readings
    }

    fn inputs(&mut self) -> Inputs<N> {
        let mut axes = self.axes.each_mut().map(|axis| AxisInputs {
            limits: axis.at_limits([TRAVEL_M[0] - LIMIT_SWITCH_M, TRAVEL_M[1] + LIMIT_SWITCH_M]),
            home: axis.is_below(HOME_SWITCH_M),
            motor_index: axis.take_index(),
            ..AxisInputs::NONE
        });
        let mut probe_touched = false;
        if let (Some(inputs), Some(x)) = (axes.first_mut(), self.axes.first()) {
            inputs.signals = Some(signals(x.reading().motor));
            inputs.counter = Some(self.master.count());
            probe_touched = self.operator_inputs.x_workpiece && !x.is_below(WORKPIECE_M);
        }
        let emergency_stop = self.operator_inputs.emergency_stop;
        Inputs {
            axes,
            emergency_stop,
            probe_touched,
            supply: SUPPLY,
            thermistor_counts: Some(THERMISTOR_COUNTS),
        }
    }

    fn enable_switch_closed(&mut self) -> bool {
        self.operator_inputs.enable_switch
    }

    fn hardware_stop_active(&mut self) -> bool {
        // The emergency stop also cuts the power stages without the processor.
        self.operator_inputs.emergency_stop
    }

    fn set_signals(&mut self, signals: [DriveSignal; N]) {
        for (force, signal) in self.forces.iter_mut().zip(signals) {
            // The drives of the bench have PWM and direction.
            let duty = if let DriveSignal::Pwm(duty) = signal { duty } else { Duty::default() };
            let magnitude = f32::from(duty.counts) * N_PER_COUNT;
            *force = if duty.reverse { -magnitude } else { magnitude };
        }
    }

    fn set_enabled(&mut self, enabled: bool) {
        self.enabled = enabled;
    }

    fn set_brakes_open(&mut self, open: bool) {
        self.y_brake.set_open(open);
    }

    /// Nobody looks at the light of a simulated machine.
    fn set_light(&mut self, _lit: bool) {}

    fn next_tick_due(&mut self) -> bool {
        false
    }
}

/// The drive system of the bench, drives off. The machine is configured in place.
///
/// # Errors
/// [`SetupError`] for an invalid value.
pub fn drive_system<const N: usize>(
    machine: &mut Machine<Fixed, N>,
) -> Result<DriveSystem<'_, Fixed, N, AnyOutput<Fixed>>, SetupError> {
    let settings = const { Constants::<N>::SETTINGS };
    machine.configure(MachineConfig::new(settings.rates, &settings.axes)?, &[Position(0); N]);
    let outputs = [AnyOutput::Pwm(Amplifier::new(setup::FULL_DUTY_N[0], FULL_COUNTS)?); N];
    let (switch, light) = (EnableSwitch::new(SWITCH_SETTLING_TICKS), StatusLight::new(setup::BLINK_TICKS));
    for axis in 0..N {
        machine.lose_reference(axis);
    }
    let system = DriveSystem::new(machine, outputs, switch, light);
    let thermistor = Thermistor::new(&THERMISTOR, SUPPLY_LIMITS.max_temperature_mc);
    let system = system.with_thermistor(thermistor.ok_or(SetupError::Converter)?);
    Ok(system.with_supply_limits(SUPPLY_LIMITS).with_tick_clock(TICK_CLOCK))
}
