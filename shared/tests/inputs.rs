//! Every input of a board raises its fault, with the reaction of the table in `shared::safety`, in the tick in which it appears.
//! Each row fails if the check of its input is taken out of the drive system.

use shared::config::{AxisSettings, Rates};
use shared::drive::{
    Amplifier, Board, DriveSystem, Duty, EnableSwitch, Inputs, StatusLight, Supply, SupplyLimits,
};
use shared::feedback::Reading;
use shared::figures::{Thermistor, ThermistorSettings};
use shared::interpolate::{Block, PathError};
use shared::machine::Machine;
use shared::safety::{Fault, FaultKind, Power};
use shared::scalar::Fixed;
use shared::units::Position;

const LIMITS: SupplyLimits =
    SupplyLimits { min_bus_mv: 36_000, max_bus_mv: 56_000, max_temperature_mc: 80_000 };

/// Two axes that follow their commands exactly.
struct TestBoard {
    at: [Position; 2],
    inputs: Inputs<2>,
    stopped: bool,
    closed: bool,
    duties: [Duty; 2],
    enabled: bool,
}

impl Board<2> for TestBoard {
    fn inputs(&mut self) -> Inputs<2> {
        self.inputs
    }

    fn readings(&mut self) -> [Reading; 2] {
        self.at.map(|motor| Reading { motor, table: None })
    }

    fn enable_switch_closed(&mut self) -> bool {
        self.closed
    }

    fn hardware_stop_active(&mut self) -> bool {
        self.stopped
    }

    fn set_signals(&mut self, duties: [Duty; 2]) {
        self.duties = duties;
    }

    fn set_enabled(&mut self, enabled: bool) {
        self.enabled = enabled;
    }

    fn set_light(&mut self, _: bool) {}

    fn next_tick_due(&mut self) -> bool {
        false
    }
}

const GOOD: Supply = Supply { bus_mv: Some(48_000), temperature_mc: Some(30_000) };

type System = DriveSystem<'static, Fixed, 2>;

/// A system whose drives are off, and its board.
fn off(position_loop_divider: u32) -> (System, TestBoard) {
    let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider };
    let machine = Machine::new(rates, &[AxisSettings::default(); 2], [Position(0); 2]).unwrap();
    let amplifiers = [Amplifier::new(1000.0, 8400).unwrap(); 2];
    let (switch, light) = (EnableSwitch::new(2), StatusLight::new(50));
    let system = DriveSystem::new(Box::leak(Box::new(machine)), amplifiers, switch, light);
    let board = TestBoard {
        at: [Position(0); 2],
        inputs: Inputs { supply: GOOD, ..Inputs::NONE },
        stopped: false,
        closed: false,
        duties: [Duty::default(); 2],
        enabled: false,
    };
    let thermistor = Thermistor::new(&THERMISTOR, LIMITS.max_temperature_mc).unwrap();
    (system.with_supply_limits(LIMITS).with_thermistor(thermistor), board)
}

fn run(system: &mut System, board: &mut TestBoard, ticks: u32) {
    for _ in 0..ticks {
        system.tick(board);
        board.at = system.machine().command();
    }
}

fn enable(system: &mut System, board: &mut TestBoard) {
    board.closed = false;
    run(system, board, 6);
    board.closed = true;
    run(system, board, 6);
}

/// A system that moves both axes in the positive direction at 40 mm/s.
fn moving() -> (System, TestBoard) {
    moving_with(1)
}

/// The same with a number of ticks per position tick.
fn moving_with(position_loop_divider: u32) -> (System, TestBoard) {
    let (mut system, mut board) = off(position_loop_divider);
    system.machine_mut().push(&Block::line([0.4, 0.3], 0.05, 1.0)).unwrap();
    enable(&mut system, &mut board);
    run(&mut system, &mut board, 2000);
    assert!(board.enabled && system.machine().power() == Power::On);
    (system, board)
}

const fn on_y(kind: FaultKind) -> Fault {
    Fault::Axis { axis: 1, kind }
}

/// An input, its fault, and whether the drives stay on for a stop.
type Row = (fn(&mut TestBoard), Fault, bool);

/// Ticks that an input waits for: a limit switch one, of two of three samples; the others none.
const fn wait(fault: Fault) -> u32 {
    matches!(fault, Fault::Axis { kind: FaultKind::LimitSwitch, .. }) as u32
}

/// A thermistor of which 80 °C are 461.8 of 4096 counts: e^(3950·(1/353.15 − 1/298.15)) = 0.1271 of its series resistor.
const THERMISTOR: ThermistorSettings =
    ThermistorSettings { resistance_25_ohm: 1e4, beta_k: 3950.0, series_ohm: 1e4, full_counts: 4096 };

const ROWS: [Row; 11] = [
    (|board| board.inputs.emergency_stop = true, Fault::EmergencyStop, false),
    (|board| board.stopped = true, Fault::HardwareStop, false),
    (|board| board.inputs.supply.bus_mv = Some(56_001), Fault::BusOvervoltage, false),
    (|board| board.inputs.supply.bus_mv = Some(35_999), Fault::BusUndervoltage, false),
    (|board| board.inputs.axes[1].drive_fault = true, on_y(FaultKind::DriveFault), false),
    (|board| board.inputs.axes[1].bad_encoder_signal = true, on_y(FaultKind::EncoderSignal), false),
    (|board| board.inputs.supply.temperature_mc = Some(80_001), Fault::OverTemperature, true),
    (|board| board.inputs.thermistor_counts = Some(461), Fault::OverTemperature, true),
    // A broken wire: the resistor pulls the input up.
    (|board| board.inputs.thermistor_counts = Some(4095), Fault::OverTemperature, true),
    (|board| board.inputs.axes[1].limits = [false, true], on_y(FaultKind::LimitSwitch), true),
    // Both ends at once, as with a broken cable.
    (|board| board.inputs.axes[1].limits = [true, true], on_y(FaultKind::LimitSwitch), true),
];

/// The first tick with another command, counted from a position tick, if the temperature is too high from a tick on.
fn first_other_command(hot_in: usize) -> Option<usize> {
    let [mut hot, mut good] = [(); 2].map(|()| {
        let (mut system, mut board) = moving_with(5);
        while !system.machine().was_position_tick() {
            run(&mut system, &mut board, 1);
        }
        (system, board)
    });
    let mut ticks = 1..100;
    ticks.find(|tick| {
        if *tick == hot_in {
            hot.1.inputs.supply.temperature_mc = Some(80_001);
        }
        let [hot, good] = [&mut hot, &mut good].map(|(system, board)| {
            run(system, board, 1);
            system.machine().command()
        });
        hot != good
    })
}

/// Inputs are read before the path is advanced ahead, two ticks before the position tick: only a stop in the last tick before it is one
/// command late, and one in the position tick acts with the next one, as it does without anything ahead.
#[test]
fn a_stop_by_an_input_is_late_in_the_last_tick_before_a_position_tick_only() {
    let first = [1, 2, 3, 4, 5, 6].map(|tick| first_other_command(tick).unwrap());
    assert_eq!(first, [5, 5, 5, 10, 10, 10]);
}

/// While the machine moves: off in the same tick, or a stop that has ended within 50 ms (40 mm/s at 1 m/s²) and then off. A limit switch acts in
/// the tick behind the one in which it appears, neither before nor later.
#[test]
fn each_input_acts_in_its_tick() {
    for (row, (apply, fault, stops)) in ROWS.into_iter().enumerate() {
        let (mut system, mut board) = moving();
        apply(&mut board);
        for _ in 0..wait(fault) {
            run(&mut system, &mut board, 1);
            assert_eq!((system.machine().power(), board.enabled), (Power::On, true), "row {row}");
        }
        system.tick(&mut board);
        let power = system.machine().power();
        if stops {
            assert_eq!((power, board.enabled), (Power::Stopping(fault), true), "row {row}");
            run(&mut system, &mut board, 1200);
        }
        assert_eq!(system.machine().power(), Power::Faulted(fault), "row {row}");
        assert_eq!((board.enabled, board.duties), (false, [Duty::default(); 2]), "row {row}");
    }
}

/// With the cause present, the power stages are not enabled for a single tick, except by a limit switch: its axis may stand there.
#[test]
fn no_drive_comes_on_while_the_cause_is_present() {
    for (row, (apply, fault, _)) in ROWS.into_iter().enumerate() {
        let (mut system, mut board) = off(1);
        apply(&mut board);
        let mut enabled = false;
        for closed in [false, true, false, true] {
            board.closed = closed;
            for _ in 0..10 {
                run(&mut system, &mut board, 1);
                enabled |= board.enabled;
            }
        }
        let is_limit = matches!(fault, Fault::Axis { kind: FaultKind::LimitSwitch, .. });
        assert_eq!(enabled, is_limit, "row {row}");
        let expected = if is_limit { Power::On } else { Power::Faulted(fault) };
        assert_eq!(system.machine().power(), expected, "row {row}");
    }
}

/// Blocks further onto a switch are refused before they start, on the axis and in the direction of the switch alone.
#[test]
fn a_block_onto_an_active_switch_is_refused_before_it_starts() {
    let (mut system, mut board) = off(1);
    enable(&mut system, &mut board);
    board.inputs.axes[0].limits = [false, true];
    run(&mut system, &mut board, 2);
    let line = |to_m| Block::line(to_m, 0.01, 1.0);
    for to_m in [[1e-6, 0.0], [0.1, -0.1]] {
        let refused = system.machine_mut().push(&line(to_m));
        assert_eq!(refused, Err(PathError::LimitSwitch { axis: 0 }), "{to_m:?}");
    }
    // An arc that starts outwards and comes back.
    let arc = Block::arc([0, 1], [0.0, 0.01], 1.0, 0.01, 1.0);
    assert_eq!(system.machine_mut().push(&arc), Err(PathError::LimitSwitch { axis: 0 }));
    run(&mut system, &mut board, 100);
    assert_eq!((board.at, system.machine().power()), ([Position(0); 2], Power::On));
    for to_m in [[0.0, 0.001], [-0.001, 0.0]] {
        system.machine_mut().push(&line(to_m)).unwrap();
    }
    run(&mut system, &mut board, 20_000);
    assert_eq!((board.at[0].to_m(), system.machine().power()), (-0.001, Power::On));
    // Released, the way is open again.
    board.inputs.axes[0].limits = [false; 2];
    run(&mut system, &mut board, 2);
    system.machine_mut().push(&line([0.001, 0.0])).unwrap();
}

/// A spike of a single sample at each input, with 20 ticks between two of them: no limit switch stops the machine, whichever end; everything else
/// acts.
#[test]
fn a_spike_stops_nothing_at_a_limit_switch_and_acts_elsewhere() {
    for (row, (apply, fault, _)) in ROWS.into_iter().enumerate() {
        let (mut system, mut board) = moving();
        let quiet = board.inputs;
        for _ in 0..5 {
            apply(&mut board);
            run(&mut system, &mut board, 1);
            (board.inputs, board.stopped) = (quiet, false);
            run(&mut system, &mut board, 20);
        }
        let power = system.machine().power();
        assert_eq!(power == Power::On, wait(fault) == 1, "row {row}: {power:?}");
    }
}

/// At the last counts that are allowed nothing happens, and the supply has the temperature: 80 °C to a count of 0.07 K.
#[test]
fn a_thermistor_at_its_limit_is_no_fault_and_tells_the_temperature() {
    let (mut system, mut board) = moving();
    assert_eq!(system.supply(), GOOD);
    board.inputs.thermistor_counts = Some(462);
    run(&mut system, &mut board, 10);
    assert_eq!(system.machine().power(), Power::On);
    let Supply { bus_mv, temperature_mc } = system.supply();
    assert!(
        bus_mv == GOOD.bus_mv && temperature_mc.is_some_and(|mc| (79_920..=80_000).contains(&mc)),
        "{temperature_mc:?}"
    );
}

/// Limits of the supply are those of the board: without limits no voltage is a fault.
#[test]
fn a_board_without_limits_of_the_supply_accepts_any() {
    let (system, mut board) = off(1);
    let mut system = system.with_supply_limits(SupplyLimits::NONE);
    enable(&mut system, &mut board);
    board.inputs.supply = Supply { bus_mv: Some(0), temperature_mc: Some(i32::MAX) };
    run(&mut system, &mut board, 10);
    assert_eq!(system.machine().power(), Power::On);
}
