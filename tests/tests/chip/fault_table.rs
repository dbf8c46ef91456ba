//! Each fault, in each state of the drives, leads to the state that the table says, in the next tick: on the host and on the
//! emulated core, by the same orders.
//!
//! The table is written out here, apart from the code and as in `docs/controller.md`. `--nocapture` prints the number of cases.

use lockstep::emulator::{DEFAULT_TIMEOUT, Emulator};
use lockstep::remote::Connection;
use shared::axis::Reading;
use shared::config::{AxisSettings, Rates};
use shared::interpolate::Block;
use shared::lockstep::protocol::{AXES, Answer, FRAME, Order, Setup, TickResult, decode, encode};
use shared::lockstep::session::{NoMeter, Session};
use shared::safety::{Fault, FaultKind, Power};
use shared::scalar::Format;
use shared::units::Position;

/// What a fault does to drives that are on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Does {
    Off,
    Stop,
    Warn,
}

/// Faults of an axis.
const OF_AN_AXIS: [(FaultKind, Does); 14] = [
    (FaultKind::FollowingError, Does::Off),
    (FaultKind::Disagreement, Does::Off),
    (FaultKind::EncoderStep, Does::Off),
    (FaultKind::EncoderFrozen, Does::Off),
    (FaultKind::ScaleFrozen, Does::Off),
    (FaultKind::DriveFault, Does::Off),
    (FaultKind::EncoderSignal, Does::Off),
    (FaultKind::GantrySkew, Does::Off),
    (FaultKind::ForceSaturated, Does::Stop),
    (FaultKind::SoftLimit, Does::Stop),
    (FaultKind::LimitSwitch, Does::Stop),
    (FaultKind::GearLag, Does::Stop),
    (FaultKind::ScaleLost, Does::Warn),
    (FaultKind::Displaced, Does::Warn),
];

/// Faults of the machine.
const OF_THE_MACHINE: [(Fault, Does); 9] = [
    (Fault::Overrun, Does::Off),
    (Fault::HardwareStop, Does::Off),
    (Fault::Watchdog, Does::Off),
    (Fault::StoredSettings, Does::Off),
    (Fault::EmergencyStop, Does::Off),
    (Fault::BusOvervoltage, Does::Off),
    (Fault::BusUndervoltage, Does::Off),
    (Fault::OverTemperature, Does::Stop),
    (Fault::HostSilent, Does::Stop),
];

/// The state in which a fault occurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Off,
    /// On, holding.
    Holding,
    /// On, on a path.
    Moving,
    Stopping,
    Faulted,
}

const STATES: [State; 5] = [State::Off, State::Holding, State::Moving, State::Stopping, State::Faulted];

/// The faults that lead to `Stopping` and `Faulted`.
const STOPPED_BY: Fault = Fault::Axis { axis: 1, kind: FaultKind::SoftLimit };
const FAULTED_BY: Fault = Fault::Overrun;

/// The state after the tick. At rest a stop has ended in the same tick.
fn expected(state: State, fault: Fault, does: Does) -> Power {
    match (state, does) {
        (State::Off, _) => Power::Off,
        (State::Faulted, _) => Power::Faulted(FAULTED_BY),
        (State::Holding | State::Moving, Does::Warn) => Power::On,
        (State::Holding | State::Moving | State::Stopping, Does::Off) | (State::Holding, Does::Stop) => {
            Power::Faulted(fault)
        }
        (State::Moving, Does::Stop) => Power::Stopping(fault),
        (State::Stopping, Does::Stop | Does::Warn) => Power::Stopping(STOPPED_BY),
    }
}

/// The controller on the host or on the emulated core.
enum Side {
    Host(Box<Session>),
    Core(Emulator),
}

impl Side {
    fn order(&mut self, order: &Order) -> Answer {
        let mut frame = [0; FRAME];
        encode(order, &mut frame).unwrap();
        match self {
            Self::Host(session) => session.answer(&frame, &mut NoMeter).unwrap(),
            Self::Core(emulator) => {
                emulator.exchange(&mut frame).unwrap();
                decode(&frame).unwrap()
            }
        }
    }

    fn does(&mut self, order: &Order) {
        assert_eq!(self.order(order), Answer::Ready, "{order:?}");
    }

    /// A tick in which the axes are at the given positions.
    fn tick(&mut self, at: [Position; AXES]) -> TickResult {
        let readings = at.map(|motor| Reading { motor, table: None });
        match self.order(&Order::Tick(readings)) {
            Answer::Tick(result) => result,
            other => panic!("{other:?}"),
        }
    }

    /// Runs ticks in which the axes follow their commands. Returns the commands of the last one.
    fn run(&mut self, ticks: u32, mut at: [Position; AXES]) -> [Position; AXES] {
        for _ in 0..ticks {
            at = self.tick(at).commands;
        }
        at
    }

    /// Brings a new machine into a state. Returns its commands.
    fn enter(&mut self, state: State) -> [Position; AXES] {
        self.does(&Order::Setup(Setup {
            format: Format::Fixed,
            rates: Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 },
            axes: [AxisSettings::default(); AXES],
            start: [Position(0); AXES],
        }));
        if state == State::Off {
            return self.run(3, [Position(0); AXES]);
        }
        if state == State::Moving || state == State::Stopping {
            self.does(&Order::Block(Block::line([0.1, 0.05], 0.1, 2.0)));
        }
        self.does(&Order::Enable);
        let at = self.run(60, [Position(0); AXES]);
        match state {
            State::Stopping => self.does(&Order::Fault(STOPPED_BY)),
            State::Faulted => self.does(&Order::Fault(FAULTED_BY)),
            State::Off | State::Holding | State::Moving => {}
        }
        let at = self.run(2, at);
        let power = self.tick(at).power;
        let reached = match state {
            State::Off => power == Power::Off,
            State::Holding | State::Moving => power == Power::On,
            State::Stopping => power == Power::Stopping(STOPPED_BY),
            State::Faulted => power == Power::Faulted(FAULTED_BY),
        };
        assert!(reached, "{state:?}: {power:?}");
        at
    }

    /// Asserts the state after each fault in each state, and where a stop ends.
    fn follows_the_table(&mut self) {
        let mut cases = 0;
        for (fault, does) in faults() {
            for state in STATES {
                let at = self.enter(state);
                self.does(&Order::Fault(fault));
                let result = self.tick(at);
                let power = expected(state, fault, does);
                assert_eq!(result.power, power, "{fault:?} in {state:?}");
                if !power.is_on() {
                    assert_eq!(result.force_bits, [0; AXES], "{fault:?} in {state:?}: a force");
                }
                let warns =
                    does == Does::Warn && matches!(state, State::Holding | State::Moving | State::Stopping);
                assert_eq!(result.warning, warns.then_some(fault), "{fault:?} in {state:?}");
                // From at most 6.3 mm/s with 2 m/s²: 3.2 ms, 63 ticks.
                if let Power::Stopping(by) = power {
                    let at = self.run(80, result.commands);
                    assert_eq!(self.tick(at).power, Power::Faulted(by), "{fault:?} in {state:?}");
                }
                // Only an acknowledgement and then an enable switch the drives on again.
                if let Power::Faulted(by) = self.tick(result.commands).power {
                    self.does(&Order::Enable);
                    assert_eq!(self.tick(at).power, Power::Faulted(by));
                    self.does(&Order::Disable);
                    assert_eq!(self.tick(at).power, Power::Off);
                    self.does(&Order::Enable);
                    assert_eq!(self.tick(at).power, Power::On);
                }
                cases += 1;
            }
        }
        println!("{cases} cases");
        assert_eq!(cases, 5 * (2 * 14 + 9));
    }
}

/// Every fault, on both axes.
fn faults() -> Vec<(Fault, Does)> {
    let on_axes = (0..2).flat_map(|axis| OF_AN_AXIS.map(|(kind, does)| (Fault::Axis { axis, kind }, does)));
    on_axes.chain(OF_THE_MACHINE).collect()
}

#[test]
fn the_table_has_every_fault() {
    let (kinds, machine) = (OF_AN_AXIS.map(|(kind, _)| kind), OF_THE_MACHINE.map(|(fault, _)| fault));
    assert!(FaultKind::ALL.iter().all(|kind| kinds.contains(kind)) && kinds.len() == FaultKind::ALL.len());
    assert!(Fault::OF_THE_MACHINE.iter().all(|fault| machine.contains(fault)));
    assert_eq!(machine.len(), Fault::OF_THE_MACHINE.len());
}

#[test]
fn each_fault_in_each_state_follows_the_table_on_the_host() {
    Side::Host(Box::new(Session::NEW)).follows_the_table();
}

#[test]
fn each_fault_in_each_state_follows_the_table_on_the_core() {
    let program = tests::firmware::built("emulated");
    Side::Core(Emulator::start(&program, DEFAULT_TIMEOUT).unwrap()).follows_the_table();
}
