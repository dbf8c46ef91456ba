//! Axes that move without their drives: the force with which a drive comes on, and the order of drive and brake.

mod faults;
mod order;
mod preload;
mod sag;

use shared::config::{AxisSettings, Brake, Rates, Sensors};
use shared::drive::{Amplifier, Board, DriveSystem, Duty, EnableSwitch, StatusLight};
use shared::feedback::Reading;
use shared::machine::Machine;
use shared::safety::Power;
use shared::scalar::Fixed;
use shared::units::Position;

const TICK_S: f64 = 50e-6;
const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
const WEIGHT_N: f64 = 147.15;

/// The loops of the servo board with 15 kg.
fn loops() -> AxisSettings {
    AxisSettings {
        position_gain_per_s: 25.0,
        velocity_gain_n_s_per_m: 3000.0,
        velocity_integral_time_s: Some(0.02),
        force_limit_n: 300.0,
        following_error_limit_m: 2e-3,
        sensors: Sensors::MOTOR,
        ..AxisSettings::default()
    }
}

/// Times of the brake, ticks.
const RELEASE: usize = 7;
const ENGAGE: usize = 5;

/// A vertical axis with a brake of a few ticks.
fn braked() -> AxisSettings {
    let brake = Brake { release_s: 7.0 * TICK_S, engage_s: 5.0 * TICK_S };
    AxisSettings { brake: Some(brake), preload_n: Some(WEIGHT_N), ..loops() }
}

/// What a tick has set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Outputs {
    stage: bool,
    brakes_open: bool,
}

const OFF: Outputs = Outputs { stage: false, brakes_open: false };
const HELD: Outputs = Outputs { stage: true, brakes_open: false };
const FREE: Outputs = Outputs { stage: true, brakes_open: true };

/// A board whose axes follow their commands exactly.
struct TestBoard<const N: usize> {
    at: [Position; N],
    switch_closed: bool,
    stopped: bool,
    late: bool,
    duties: [Duty; N],
    outputs: Outputs,
}

impl<const N: usize> TestBoard<N> {
    const NEW: Self = Self {
        at: [Position(0); N],
        switch_closed: false,
        stopped: false,
        late: false,
        duties: [Duty { reverse: false, counts: 0 }; N],
        outputs: OFF,
    };
}

impl<const N: usize> Board<N> for TestBoard<N> {
    fn readings(&mut self) -> [Reading; N] {
        self.at.map(|motor| Reading { motor, table: None })
    }

    fn enable_switch_closed(&mut self) -> bool {
        self.switch_closed
    }

    fn hardware_stop_active(&mut self) -> bool {
        self.stopped
    }

    fn set_signals(&mut self, duties: [Duty; N]) {
        self.duties = duties;
    }

    fn set_enabled(&mut self, enabled: bool) {
        self.outputs.stage = enabled;
    }

    fn set_brakes_open(&mut self, open: bool) {
        self.outputs.brakes_open = open;
    }

    fn set_light(&mut self, _: bool) {}

    fn next_tick_due(&mut self) -> bool {
        self.late
    }
}

/// A system and its board.
struct Rig<const N: usize> {
    system: DriveSystem<'static, Fixed, N>,
    board: TestBoard<N>,
}

impl<const N: usize> Rig<N> {
    /// Drives off. The switch, which has just been closed, settles in the third tick.
    fn new(settings: [AxisSettings; N]) -> Self {
        let machine = Machine::new(RATES, &settings, [Position(0); N]).unwrap();
        let outputs = [Amplifier::new(400.0, 8400).unwrap(); N];
        let (switch, light) = (EnableSwitch::new(2), StatusLight::new(1000));
        let system = DriveSystem::new(Box::leak(Box::new(machine)), outputs, switch, light);
        let mut rig = Self { system, board: TestBoard::NEW };
        rig.ticks(10);
        rig.board.switch_closed = true;
        rig
    }

    /// With the brakes open.
    fn on(settings: [AxisSettings; N]) -> Self {
        let mut rig = Self::new(settings);
        while rig.power() != Power::On {
            rig.tick();
        }
        rig
    }

    fn power(&self) -> Power {
        self.system.machine().power()
    }

    fn machine(&mut self) -> &mut Machine<Fixed, N> {
        self.system.machine_mut()
    }

    /// A tick; the axes are then at its command.
    fn tick(&mut self) -> Outputs {
        self.board.at = self.system.tick(&mut self.board).output.commands;
        self.board.outputs
    }

    fn ticks(&mut self, count: usize) -> Vec<Outputs> {
        (0..count).map(|_| self.tick()).collect()
    }
}
