//! The simulated machine of the emulated servo board: two axes behind the same trait as the pins of a real board.
//!
//! `host-sim/machines/bench.toml` declares this machine. What it does not declare is the backlash of the x screw
//! ([`BACKLASH_M`]): the tracer finds it in the logs of the board.

mod axis;

use shared::capture::ChannelSteps;
use shared::config::AxisSettings;
use shared::drive::{Amplifier, Board, DriveSystem, Duty, EnableSwitch, StatusLight};
use shared::feedback::Reading;
use shared::link::message::BoardSettings;
use shared::link::{Identity, Times};
use shared::machine::{Machine, MachineConfig};
use shared::scalar::Fixed;
use shared::units::{PER_NM, Position};

use crate::setup::{self, AXES, RATES, SWITCH_SETTLING_TICKS, SetupError, TICK_HZ};
use axis::AxisPlant;

/// Width of the dead zone between screw and table, m. Not declared in the machine file.
pub const BACKLASH_M: [f64; AXES] = [14e-6, 0.0];

/// A count of the motor encoders and of the linear scales, position units: 50 nm.
pub const COUNT: i64 = 50 * PER_NM;

/// Travel of the axes, m; the limit switches are 5 mm beyond it.
pub const TRAVEL_M: [f64; 2] = [-0.1, 0.1];

/// PWM counts of full duty.
const FULL_COUNTS: u16 = 8400;

/// The settings of the controller at the start.
pub const SETTINGS: BoardSettings = BoardSettings {
    rates: RATES,
    axes: [AxisSettings {
        travel_m: Some(TRAVEL_M),
        scale_disagreement_limit_m: Some(0.5e-3),
        ..setup::SETTINGS[0]
    }; AXES],
};

/// What the board says about itself.
pub const IDENTITY: Identity = Identity {
    board: "emulated servo board",
    software: env!("CARGO_PKG_VERSION"),
    tick_hz: TICK_HZ,
    steps: ChannelSteps {
        command: PER_NM / 16,
        motor: [COUNT; AXES],
        table: [COUNT; AXES],
        force_bits: 5,
    },
    times: Times { hold_ms: 500, off_ms: 10_000, jog_ms: 300 },
};

/// The machine with its inputs, operated from the bench and not by the host.
#[derive(Debug)]
pub struct Bench {
    axes: [AxisPlant; AXES],
    /// Forces that act until the next tick, N.
    forces: [f32; AXES],
    enabled: bool,
    inputs: Inputs,
}

/// The inputs of the board.
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "switches and wires")]
pub struct Inputs {
    /// The enable switch is closed.
    pub enable_switch: bool,
    /// The emergency stop is pressed.
    pub emergency_stop: bool,
    /// The encoder of the x motor is frozen.
    pub x_encoder_frozen: bool,
    /// The signal of the x scale is lost.
    pub x_scale_lost: bool,
    /// The status light is lit.
    pub light: bool,
}

impl Bench {
    /// Axes at zero, switch open.
    #[must_use]
    pub fn new() -> Self {
        Self {
            axes: BACKLASH_M.map(AxisPlant::new),
            forces: [0.0; AXES],
            enabled: false,
            inputs: Inputs {
                enable_switch: false,
                emergency_stop: false,
                x_encoder_frozen: false,
                x_scale_lost: false,
                light: false,
            },
        }
    }

    /// The inputs, for the person at the bench.
    pub const fn inputs(&mut self) -> &mut Inputs {
        &mut self.inputs
    }

    /// Moves the machine by the time of a tick.
    pub fn step(&mut self) {
        let frozen = self.inputs.x_encoder_frozen;
        for (number, (axis, force)) in self.axes.iter_mut().zip(self.forces).enumerate() {
            axis.step(if self.enabled { force } else { 0.0 }, !(frozen && number == 0));
        }
    }
}

impl Default for Bench {
    fn default() -> Self {
        Self::new()
    }
}

impl Board<AXES> for Bench {
    fn readings(&mut self) -> [Reading; AXES] {
        let [mut x, y] = self.axes.each_ref().map(AxisPlant::reading);
        if self.inputs.x_scale_lost {
            x.table = None;
        }
        [x, y]
    }

    fn enable_switch_closed(&mut self) -> bool {
        self.inputs.enable_switch
    }

    fn hardware_stop_active(&mut self) -> bool {
        self.inputs.emergency_stop
    }

    fn set_duties(&mut self, duties: [Duty; AXES]) {
        for ((force, duty), full_n) in self.forces.iter_mut().zip(duties).zip(setup::FULL_DUTY_N) {
            let magnitude = f32::from(duty.counts) * (full_n as f32 / f32::from(FULL_COUNTS));
            *force = if duty.reverse { -magnitude } else { magnitude };
        }
    }

    fn set_enabled(&mut self, enabled: bool) {
        self.enabled = enabled;
    }

    fn set_light(&mut self, lit: bool) {
        self.inputs.light = lit;
    }

    fn next_tick_due(&mut self) -> bool {
        false
    }
}

/// The drive system of the bench, drives off. The machine is configured in place.
///
/// # Errors
/// [`SetupError`] for an invalid value.
pub fn drive_system(
    machine: &mut Machine<Fixed, AXES>,
) -> Result<DriveSystem<'_, Fixed, AXES>, SetupError> {
    machine.configure(MachineConfig::new(SETTINGS.rates, &SETTINGS.axes)?, &[Position(0); AXES]);
    let [x, y] = setup::FULL_DUTY_N;
    let amplifiers = [Amplifier::new(x, FULL_COUNTS)?, Amplifier::new(y, FULL_COUNTS)?];
    let (switch, light) =
        (EnableSwitch::new(SWITCH_SETTLING_TICKS), StatusLight::new(setup::BLINK_TICKS));
    Ok(DriveSystem::new(machine, amplifiers, switch, light))
}
