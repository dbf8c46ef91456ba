//! Homing of a gantry whose motors have a home switch and index pulses each, at other places of the beam.

use super::SKEW;
use super::beam::{Beam, FORCE_LIMIT_N, LIMIT_M, RATES, SQUARE_M, STIFFNESS_N_PER_M, settings};
use crate::homing::test_board::homing;
use shared::drive::{Amplifier, AxisInputs, Board, DriveSystem, Duty, EnableSwitch, Inputs, StatusLight};
use shared::feedback::Reading;
use shared::homing::{HomingError, HomingSettings, HomingStatus};
use shared::machine::{Machine, Reference};
use shared::safety::Power;
use shared::scalar::Fixed;
use shared::units::Position;

const FULL_COUNTS: u16 = 8400;
const LEAD_M: f64 = 5e-3;

/// An index pulse of each motor, m: that of the second is 1.1 mm further on than that of the first on a square beam.
const INDEX_M: [f64; 2] = [0.0241, 0.0241 + SQUARE_M + OFFSET_M];
const OFFSET_M: f64 = 1.1e-3;

/// Of each motor.
const HOMING: HomingSettings = homing();

type System = DriveSystem<'static, Fixed, 2>;

struct BeamBoard {
    beam: Beam,
    last: Beam,
    closed: bool,
    duties: [Duty; 2],
    /// The last forces of the motors, N.
    forces_n: [f64; 2],
}

impl BeamBoard {
    fn new(first_m: f64, skew_m: f64) -> Self {
        let beam = Beam::at(first_m, skew_m);
        Self { beam, last: beam, closed: false, duties: [Duty::default(); 2], forces_n: [0.0; 2] }
    }

    /// With the drives on, and the references unknown.
    fn enabled(&mut self, offset_m: f64) -> System {
        let machine = Machine::new(RATES, &settings(offset_m), [Position(0); 2]).unwrap();
        let machine = Box::leak(Box::new(machine));
        machine.lose_reference(0);
        let amplifiers = [2.0 * FORCE_LIMIT_N; 2].map(|n| Amplifier::new(n, FULL_COUNTS).unwrap());
        let mut system = DriveSystem::new(machine, amplifiers, EnableSwitch::new(10), StatusLight::new(5000));
        self.run(&mut system, 20);
        self.closed = true;
        self.run(&mut system, 20);
        assert_eq!(system.machine().power(), Power::On);
        system
    }

    fn run(&mut self, system: &mut System, ticks: u32) {
        for _ in 0..ticks {
            system.tick(self);
            self.last = self.beam;
            let force_n = |duty: Duty| 2.0 * FORCE_LIMIT_N * f64::from(duty.counts) / f64::from(FULL_COUNTS);
            self.forces_n = self.duties.map(|duty| if duty.reverse { -force_n(duty) } else { force_n(duty) });
            self.beam.step(self.forces_n);
        }
    }

    /// Homes to the end; gives the status and the greatest skew on the way, m.
    fn home(&mut self, system: &mut System, offset_m: f64) -> (HomingStatus, f64) {
        system.home_gantry(0, [&HOMING; 2], offset_m).unwrap();
        let mut most_m = 0.0f64;
        for _ in 0..60 * 20_000 {
            self.run(system, 1);
            most_m = most_m.max(self.beam.skew_m().abs());
            system.plan_leg();
            let status = system.homing_status().unwrap().1;
            if status != HomingStatus::Running {
                self.run(system, 20_000);
                return (status, most_m);
            }
            assert_eq!(references(system), [Some(Reference::Relative); 2]);
        }
        panic!("the homing does not end")
    }
}

fn references(system: &System) -> [Option<Reference>; 2] {
    [0, 1].map(|axis| system.machine().reference(axis))
}

impl Board<2> for BeamBoard {
    fn inputs(&mut self) -> Inputs<2> {
        let axes = [0, 1].map(|end| {
            let (now_m, last_m) = (self.beam.at_m[end], self.last.at_m[end]);
            let cell = |m: f64| ((m - INDEX_M[end]) / LEAD_M).floor();
            let (from, to) = (now_m.min(last_m), now_m.max(last_m));
            let index_m = INDEX_M[end] + LEAD_M * cell(to);
            AxisInputs {
                limits: [now_m < 0.005, now_m > 0.115],
                home: now_m < 0.026,
                motor_index: (cell(from) < cell(to)).then(|| self.beam.count(end, index_m)),
                ..AxisInputs::NONE
            }
        });
        Inputs { axes, ..Inputs::NONE }
    }

    fn readings(&mut self) -> [Reading; 2] {
        self.beam.readings()
    }

    fn enable_switch_closed(&mut self) -> bool {
        self.closed
    }

    fn hardware_stop_active(&mut self) -> bool {
        false
    }

    fn set_signals(&mut self, duties: [Duty; 2]) {
        self.duties = duties;
    }

    fn set_enabled(&mut self, _: bool) {}

    fn set_light(&mut self, _: bool) {}

    fn next_tick_due(&mut self) -> bool {
        false
    }
}

/// The beam starts with 0.09 mm of skew in either direction, which 18 N of 20 N friction hold. Afterwards it is square within two counts for each reference and what
/// remains of the following errors, both ends read the same, and the motors push with less than their friction.
#[test]
fn a_beam_that_starts_with_skew_is_square_when_it_is_homed() {
    for (start_m, skew_m) in [(0.05, 0.09e-3), (0.05, -0.09e-3), (0.022, 0.09e-3), (0.1, 0.0)] {
        let mut board = BeamBoard::new(start_m, skew_m);
        let mut system = board.enabled(OFFSET_M);
        assert!((board.beam.skew_m() - skew_m).abs() < 1e-6, "held by friction: {} m", board.beam.skew_m());
        let (status, most_m) = board.home(&mut system, OFFSET_M);
        assert_eq!((status, references(&system)), (HomingStatus::Homed, [Some(Reference::Homed); 2]));
        assert!(most_m < LIMIT_M && system.machine().power() == Power::On);
        assert!(board.beam.skew_m().abs() < 3e-6, "{} m", board.beam.skew_m());
        let [first, second] = system.readings().map(|reading| reading.motor.to_m());
        let true_m = board.beam.at_m[0] - INDEX_M[0] + HOMING.mark_position_m;
        assert!((first - true_m).abs() < 0.51e-6 && (second - first).abs() < 3e-6, "{first} m, {second} m");
        let [a, b] = board.forces_n;
        assert!(a.abs() < 20.0 && b.abs() < 20.0, "{a} N, {b} N");
    }
}

/// A declared offset that is wrong by 0.2 mm bends the beam by it: 0.2 N/µm give 40 N in opposite directions, each up to the friction of 20 N
/// less or more.
#[test]
fn an_offset_that_is_wrong_bends_the_beam() {
    for wrong_m in [0.2e-3, -0.2e-3] {
        let mut board = BeamBoard::new(0.05, 0.0);
        let mut system = board.enabled(OFFSET_M);
        assert_eq!(board.home(&mut system, OFFSET_M + wrong_m).0, HomingStatus::Homed);
        // An end that has to overcome its friction beside the beam is not there after a second: 7 µm are 26 N/s of the integral.
        assert!((board.beam.skew_m() + wrong_m).abs() < 10e-6, "{} m", board.beam.skew_m());
        let racking_n = STIFFNESS_N_PER_M * wrong_m;
        let [a, b] = board.forces_n;
        assert!((a - racking_n).abs() < 21.0 && (b + racking_n).abs() < 21.0, "{a} N, {b} N");
        assert!((a - b).abs() > 40.0, "{a} N, {b} N");
    }
}

/// An offset that is wrong by more than the limit: the references do not fit to the beam. The fault comes before the second motor has moved
/// away from the first, nothing is homed, and the next enable is inhibited.
#[test]
fn references_that_do_not_fit_are_a_fault() {
    let mut board = BeamBoard::new(0.05, 0.0);
    let mut system = board.enabled(OFFSET_M);
    let (status, most_m) = board.home(&mut system, OFFSET_M + LIMIT_M + 10e-6);
    assert_eq!(status, HomingStatus::Failed(HomingError::DrivesOff));
    assert_eq!(
        (system.machine().power(), references(&system)),
        (Power::Faulted(SKEW), [Some(Reference::Relative); 2])
    );
    assert!(most_m < 0.1e-3, "{most_m} m");
    system.machine_mut().disable();
    system.machine_mut().enable();
    board.run(&mut system, 5);
    assert_eq!(system.machine().power(), Power::Faulted(SKEW));
}

/// A homing that is stopped, at any of 20 times up to its last tick, leaves both motors without a reference, and the beam where it is.
#[test]
fn a_homing_that_is_stopped_homes_neither() {
    let started = || {
        let mut board = BeamBoard::new(0.03, 0.09e-3);
        let mut system = board.enabled(OFFSET_M);
        system.home_gantry(0, [&HOMING; 2], OFFSET_M).unwrap();
        (board, system)
    };
    let tick = |board: &mut BeamBoard, system: &mut System| {
        board.run(system, 1);
        system.plan_leg();
        system.homing_status().unwrap().1 == HomingStatus::Running
    };
    let (mut board, mut system) = started();
    let mut last = 0;
    while tick(&mut board, &mut system) {
        last += 1;
    }
    for time in 1..=20 {
        let (mut board, mut system) = started();
        // More often towards the end, where the beam is squared.
        let until = last - last * (20 - time) * (20 - time) / 400;
        assert!((0..until).all(|_| tick(&mut board, &mut system)), "{time}");
        system.stop_sequence();
        board.run(&mut system, 4000);
        assert_eq!(system.homing_status(), Some((0, HomingStatus::Failed(HomingError::Stopped))));
        assert_eq!(references(&system), [Some(Reference::Relative); 2]);
        let before = system.machine().command();
        board.run(&mut system, 4000);
        assert_eq!(system.machine().command(), before);
    }
}

/// Neither motor is homed alone, and nothing has changed.
#[test]
fn a_motor_of_a_gantry_is_not_homed_alone() {
    let mut board = BeamBoard::new(0.05, 0.0);
    let mut system = board.enabled(0.0);
    for axis in [0, 1] {
        assert_eq!(system.home(axis, &HOMING), Err(HomingError::Gantry));
    }
    assert_eq!(system.home_gantry(1, [&HOMING; 2], 0.0), Err(HomingError::Gantry));
    assert!(system.homing_status().is_none() && system.machine().is_at_rest());
}
