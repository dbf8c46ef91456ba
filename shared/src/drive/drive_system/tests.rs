//! The drive system on a test board of one axis.

extern crate std;
use std::boxed::Box;

use super::super::amplifier::Duty;
use super::*;
use crate::config::{AxisSettings, Rates};
use crate::interpolate::Block;
use crate::safety::Power;
use crate::scalar::Fixed;

const SETTLING: u32 = 10;
const BLINK: u32 = 50;

/// Counts in a period of the ticks.
const PERIOD: u32 = 8400;

#[expect(clippy::struct_excessive_bools, reason = "inputs and outputs of one bit")]
struct TestBoard {
    at: Position,
    closed: bool,
    stopped: bool,
    late: bool,
    /// Periods of the ticks so far.
    periods: u32,
    duty: Duty,
    enabled: bool,
    lit: bool,
}

impl Board<1> for TestBoard {
    fn readings(&mut self) -> [Reading; 1] {
        [Reading { motor: self.at, table: None }]
    }

    fn enable_switch_closed(&mut self) -> bool {
        self.closed
    }

    fn hardware_stop_active(&mut self) -> bool {
        self.stopped
    }

    fn set_signals(&mut self, [duty]: [Duty; 1]) {
        self.duty = duty;
    }

    fn set_enabled(&mut self, enabled: bool) {
        self.enabled = enabled;
    }

    fn set_light(&mut self, lit: bool) {
        self.lit = lit;
    }

    fn next_tick_due(&mut self) -> bool {
        self.late
    }

    fn started_at(&mut self) -> Option<u32> {
        self.periods += 1;
        Some(self.periods.wrapping_mul(PERIOD))
    }
}

/// A system that has just been enabled with a line to follow, and its board.
fn running() -> (DriveSystem<'static, Fixed, 1>, TestBoard) {
    let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
    let axis = AxisSettings { following_error_limit_m: 1e-3, ..AxisSettings::default() };
    let machine = Box::leak(Box::new(Machine::new(rates, &[axis], [Position(0)]).unwrap()));
    machine.push(&Block::line([0.1], 0.1, 5.0)).unwrap();
    let amplifiers = [Amplifier::new(1000.0, 8400).unwrap()];
    let mut system =
        DriveSystem::new(machine, amplifiers, EnableSwitch::new(SETTLING), StatusLight::new(BLINK));
    let mut board = TestBoard {
        at: Position(0),
        closed: false,
        stopped: false,
        late: false,
        periods: 0,
        duty: Duty::default(),
        enabled: false,
        lit: false,
    };
    close(&mut system, &mut board);
    assert!(board.enabled && !board.lit);
    (system, board)
}

fn run(system: &mut DriveSystem<'_, Fixed, 1>, board: &mut TestBoard, ticks: u32) {
    for _ in 0..ticks {
        system.tick(board);
    }
}

fn close(system: &mut DriveSystem<'_, Fixed, 1>, board: &mut TestBoard) {
    board.closed = false;
    run(system, board, 2 * SETTLING);
    assert!(!board.enabled);
    board.closed = true;
    run(system, board, 2 * SETTLING);
}

/// With a host, the closed switch only permits an enable: not before a new edge, and no longer once it is open or the
/// hardware has stopped the drives.
#[test]
fn a_host_enables_only_while_the_switch_permits_it() {
    let (system, mut board) = running();
    let mut system = system.enabled_by_host();
    // Off by the previous way of enabling: the switch is closed without a new edge.
    system.machine_mut().disable();
    run(&mut system, &mut board, 2 * SETTLING);
    assert!(!board.enabled && system.armed().is_err());
    assert_eq!(system.enable_by_host(), Err(NotArmed::Switch));
    close(&mut system, &mut board);
    assert!(!board.enabled && system.armed().is_ok(), "the switch alone enables");
    assert_eq!(system.enable_by_host(), Ok(()));
    run(&mut system, &mut board, 1);
    assert!(board.enabled);
    board.closed = false;
    run(&mut system, &mut board, 1);
    assert_eq!((board.enabled, system.enable_by_host()), (false, Err(NotArmed::Switch)));
    close(&mut system, &mut board);
    system.enable_by_host().unwrap();
    run(&mut system, &mut board, 1);
    board.stopped = true;
    run(&mut system, &mut board, 1);
    assert_eq!((board.enabled, system.enable_by_host()), (false, Err(NotArmed::Switch)));
    // The stop is released and the fault acknowledged, but the switch has not been operated.
    board.stopped = false;
    system.machine_mut().disable();
    run(&mut system, &mut board, 3 * SETTLING);
    assert_eq!((board.enabled, system.enable_by_host()), (false, Err(NotArmed::Switch)));
}

#[test]
fn the_force_acts_towards_the_command() {
    let (mut system, mut board) = running();
    run(&mut system, &mut board, 40);
    assert!(!board.duty.reverse && board.duty.counts > 0, "{:?}", board.duty);
}

/// Asserts that the stages are disabled, the duty is zero, and the light is on unless the drives are off without a fault.
fn assert_off(system: &DriveSystem<'_, Fixed, 1>, board: &TestBoard, power: Power) {
    assert_eq!((system.machine.power(), board.enabled, board.duty), (power, false, Duty::default()));
    assert_eq!(board.lit, power != Power::Off);
}

#[test]
fn an_overrun_or_a_hardware_stop_disables_the_stages_until_a_new_edge() {
    for fault in [Fault::Overrun, Fault::HardwareStop] {
        let (mut system, mut board) = running();
        run(&mut system, &mut board, 40);
        (board.late, board.stopped) = (fault == Fault::Overrun, fault == Fault::HardwareStop);
        system.tick(&mut board);
        assert_off(&system, &board, Power::Faulted(fault));
        (board.late, board.stopped) = (false, false);
        run(&mut system, &mut board, 1000);
        assert_off(&system, &board, Power::Faulted(fault));
        // The path was discarded: enabled again, the axis holds its new position.
        board.at = Position::from_m(0.02).unwrap();
        close(&mut system, &mut board);
        assert_eq!((board.enabled, board.lit, board.duty), (true, false, Duty::default()));
    }
}

/// Two late or missed ticks are tolerated here, the third one is the fault, in its own tick; with the stages off nothing is counted.
#[test]
fn late_and_missed_ticks_are_a_fault_above_what_is_tolerated() {
    for lost in [0, 1] {
        let (system, mut board) = running();
        let counts_per_tick = core::num::NonZeroU32::new(PERIOD).unwrap();
        let mut system = system.with_tick_clock(TickClock { counts_per_tick, tolerated: 2 });
        run(&mut system, &mut board, 40);
        assert_eq!(system.tick_counts(), TickCounts::default());
        for number in 1..=3 {
            board.late = lost == 0;
            board.periods += lost;
            system.tick(&mut board);
            board.late = false;
            let counts = system.tick_counts();
            let [late, missed] = if lost == 0 { [number, 0] } else { [0, number] };
            assert_eq!((counts.late, counts.missed), (late, missed));
            assert_eq!(counts.longest_delay_permille, 1000 * lost);
            assert_eq!(board.enabled, number < 3, "{number}");
        }
        assert_off(&system, &board, Power::Faulted(Fault::Overrun));
        let counts = system.tick_counts();
        board.late = true;
        for _ in 0..40 {
            board.periods += 3;
            system.tick(&mut board);
        }
        board.late = false;
        assert_eq!(system.tick_counts(), counts);
        // The next enable tolerates as many again.
        close(&mut system, &mut board);
        board.periods += 2;
        system.tick(&mut board);
        assert!(board.enabled);
    }
}

#[test]
fn a_hardware_stop_prevents_an_enable() {
    let (mut system, mut board) = running();
    board.stopped = true;
    board.closed = false;
    run(&mut system, &mut board, 2 * SETTLING);
    board.closed = true;
    for _ in 0..3 * SETTLING {
        system.tick(&mut board);
        assert!(!board.enabled);
    }
    assert_off(&system, &board, Power::Faulted(Fault::HardwareStop));
}

#[test]
fn opening_the_switch_disables_the_stages_in_the_same_tick() {
    let (mut system, mut board) = running();
    run(&mut system, &mut board, 40);
    board.closed = false;
    system.tick(&mut board);
    assert_off(&system, &board, Power::Off);
    board.at = Position::from_m(0.02).unwrap();
    close(&mut system, &mut board);
    assert_eq!((board.enabled, board.duty), (true, Duty::default()));
}

#[test]
fn a_following_error_disables_the_stages_in_the_same_tick() {
    let (mut system, mut board) = running();
    board.at = Position::from_m(2e-3).unwrap();
    system.tick(&mut board);
    let fault = Fault::Axis { axis: 0, kind: FaultKind::FollowingError };
    assert_off(&system, &board, Power::Faulted(fault));
}

/// During a stop along the path the stages stay enabled: they decelerate the axis. From 0.1 m/s with the 5 m/s² of the
/// block, which exceeds the 2 m/s² of a stop, it takes 20 ms: 400 ticks.
#[test]
fn the_stages_stay_enabled_until_a_stop_has_ended() {
    let (mut system, mut board) = running();
    let follow = |system: &mut DriveSystem<'_, Fixed, 1>, board: &mut TestBoard| {
        system.tick(board);
        board.at = system.machine.command()[0];
    };
    for _ in 0..2000 {
        follow(&mut system, &mut board);
    }
    let fault = Fault::Axis { axis: 0, kind: FaultKind::SoftLimit };
    system.machine.fault(fault);
    let mut ticks = 0;
    while system.machine.power() == Power::Stopping(fault) {
        follow(&mut system, &mut board);
        ticks += 1;
        let stopped = system.machine.power() == Power::Faulted(fault);
        assert_eq!((board.enabled, board.lit), (!stopped, true));
        assert!(ticks < 2000);
    }
    assert!((398..=402).contains(&ticks), "{ticks}");
    assert_off(&system, &board, Power::Faulted(fault));
}

/// A warning blinks until the drives are disabled.
#[test]
fn a_warning_blinks() {
    let (mut system, mut board) = running();
    system.machine.fault(Fault::Axis { axis: 0, kind: FaultKind::ScaleLost });
    let lit = (0..4 * BLINK).map(|_| {
        system.tick(&mut board);
        board.lit
    });
    assert_eq!(lit.filter(|lit| *lit).count(), 2 * BLINK as usize);
    assert!(board.enabled);
}

/// A drive that records what is demanded of it.
#[derive(Clone, Copy, Debug)]
struct Recorder;

impl DriveOutput<Fixed> for Recorder {
    type Signal = Position;

    fn signal(&mut self, demand: &Demand<Fixed>) -> Position {
        demand.command
    }

    fn off(&mut self) -> Position {
        Position(0)
    }
}

/// A board with such a drive, whose axis follows it.
struct Follower {
    at: Position,
    closed: bool,
}

impl Board<1, Position> for Follower {
    fn readings(&mut self) -> [Reading; 1] {
        [Reading { motor: self.at, table: None }]
    }

    fn enable_switch_closed(&mut self) -> bool {
        self.closed
    }

    fn hardware_stop_active(&mut self) -> bool {
        false
    }

    fn set_signals(&mut self, [command]: [Position; 1]) {
        self.at = command;
    }

    fn set_enabled(&mut self, _: bool) {}

    fn set_light(&mut self, _: bool) {}

    fn next_tick_due(&mut self) -> bool {
        false
    }
}

/// A step drive counts from power-up. An origin that is set later changes the position of the axis and nothing that is demanded of
/// its drive, at rest and in a motion afterwards.
#[test]
fn a_drive_that_follows_the_command_does_not_see_the_origin() {
    let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
    let mut machine = Machine::new(rates, &[AxisSettings::default()], [Position(0)]).unwrap();
    let mut system =
        DriveSystem::new(&mut machine, [Recorder], EnableSwitch::new(SETTLING), StatusLight::new(BLINK));
    let mut board = Follower { at: Position(0), closed: false };
    for tick in 0..4 * SETTLING {
        board.closed = tick >= 2 * SETTLING;
        system.tick(&mut board);
    }
    assert!(system.machine.power().is_on());
    let shift = OriginShift { motor: 3_000_000_000, table: 0 };
    let before = system.machine.command();
    system.machine.set_origin(0, shift).unwrap();
    system.shift_origin(0, before, shift);
    system.tick(&mut board);
    assert_eq!((board.at, system.machine.command()), (Position(0), [Position(shift.motor)]));
    let [here] = system.machine.command();
    system.machine.push(&Block::line([(here + 1_000_000_000).to_m()], 0.1, 5.0)).unwrap();
    for _ in 0..4000 {
        system.tick(&mut board);
    }
    // The end of the block is rounded to a position unit.
    assert!((board.at.0 - 1_000_000_000).abs() <= 1, "{}", board.at.0);
    assert!(system.machine.power().is_on());
}
