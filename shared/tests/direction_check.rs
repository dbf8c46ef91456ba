//! The direction check on a simulated plant of two axes, with both signs of force, encoder and scale.

use crate::slide::Slide;
use shared::config::{AxisSettings, Rates};
use shared::drive::analog::AnalogSettings;
use shared::drive::direction_check::{DirectionCheckError, DirectionCheckSettings, DirectionResult};
use shared::drive::output::DriveOutput;
use shared::drive::step::StepOutput;
use shared::drive::{
    Amplifier, AnyOutput, Board, DriveSettings, DriveSystem, Duty, EnableSwitch, Inputs, StatusLight,
};
use shared::feedback::Reading;
use shared::machine::Machine;
use shared::safety::Power;
use shared::scalar::Fixed;
use shared::units::{PER_M, Position};

const TICK_HZ: f64 = 20_000.0;
const MASS_KG: f64 = 15.0;
const FULL_N: f64 = 400.0;

/// 30 N for at most 200 ms. Against 20 N of friction, 0.2 mm take √(2·0.2 mm/(10 N/15 kg)) = 24 ms.
const CHECK: DirectionCheckSettings = DirectionCheckSettings { force_n: 30.0, time_s: 0.2, detect_m: 0.2e-3 };

const START_M: [f64; 2] = [0.01, -0.02];

struct TestPlant {
    at_m: [f64; 2],
    velocity: [f64; 2],
    /// Which axis each drive moves, and the signs of force, motor reading and scale.
    drives: [usize; 2],
    force_sign: f64,
    motor_sign: f64,
    scale_sign: Option<f64>,
    /// Way of the motors from the start before the scales move, m.
    backlash_m: f64,
    late: bool,
    friction_n: f64,
    duties: [Duty; 2],
    enabled: bool,
    enabled_ticks: u32,
    closed: bool,
    inputs: Inputs<2>,
}

impl Board<2> for TestPlant {
    fn inputs(&mut self) -> Inputs<2> {
        self.inputs
    }

    fn readings(&mut self) -> [Reading; 2] {
        self.at_m.map(|m| Reading {
            motor: Position::from_m(self.motor_sign * m).unwrap(),
            table: self.scale_sign.and_then(|sign| Position::from_m(sign * m.max(self.scale_starts_m()))),
        })
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

    fn set_enabled(&mut self, enabled: bool) {
        self.enabled = enabled;
    }

    fn set_light(&mut self, _: bool) {}

    fn next_tick_due(&mut self) -> bool {
        self.late
    }
}

type System = DriveSystem<'static, Fixed, 2>;

fn machine() -> Machine<Fixed, 2> {
    let rates = Rates { velocity_loop_hz: TICK_HZ, position_loop_divider: 5 };
    let settings = AxisSettings { force_limit_n: 200.0, ..AxisSettings::default() };
    Machine::new(rates, &[settings; 2], [Position(0); 2]).unwrap()
}

fn plant() -> (System, TestPlant) {
    let machine = Box::leak(Box::new(machine()));
    let amplifiers = [Amplifier::new(FULL_N, 8400).unwrap(); 2];
    let system = DriveSystem::new(machine, amplifiers, EnableSwitch::new(2), StatusLight::new(50));
    let plant = TestPlant {
        at_m: START_M,
        velocity: [0.0; 2],
        drives: [0, 1],
        force_sign: 1.0,
        motor_sign: 1.0,
        scale_sign: None,
        backlash_m: 0.0,
        late: false,
        friction_n: 20.0,
        duties: [Duty::default(); 2],
        enabled: false,
        enabled_ticks: 0,
        closed: false,
        inputs: Inputs::NONE,
    };
    (system, plant)
}

impl TestPlant {
    fn run(&mut self, system: &mut System, ticks: u32) {
        for _ in 0..ticks {
            system.tick(self);
            self.enabled_ticks += u32::from(self.enabled);
            for (Duty { reverse, counts }, axis) in self.duties.into_iter().zip(self.drives) {
                let magnitude = if self.enabled { FULL_N * f64::from(counts) / 8400.0 } else { 0.0 };
                let force = self.force_sign * if reverse { -magnitude } else { magnitude };
                assert!(magnitude <= CHECK.force_n + 0.05, "a force of {magnitude} N");
                let table = Slide { mass_kg: MASS_KG, viscous_n_s_per_m: 0.0, coulomb_n: self.friction_n };
                table.step(&mut self.at_m[axis], &mut self.velocity[axis], force, 1.0 / TICK_HZ);
            }
        }
    }

    /// Where the scale of an axis that is pushed forwards starts to move, m.
    fn scale_starts_m(&self) -> f64 {
        if self.backlash_m > 0.0 { START_M[0] + self.backlash_m } else { f64::NEG_INFINITY }
    }

    /// Runs a check of X to its end and to rest. Returns the result and the greatest motion of an axis.
    fn check(&mut self, system: &mut System) -> (DirectionResult, f64) {
        self.check_of(system, 0)
    }

    /// Checks any axis.
    fn check_of(&mut self, system: &mut System, checked: usize) -> (DirectionResult, f64) {
        let start_m = self.at_m;
        system.check_direction(checked, &CHECK).unwrap();
        self.closed = false;
        self.run(system, 10);
        assert!(system.is_checking() && !self.enabled, "it waits for the switch");
        self.closed = true;
        self.run(system, 8000);
        assert!(!self.enabled && self.velocity.iter().all(|v| v.abs() < 1e-6));
        let moved = self.at_m.iter().zip(start_m).map(|(m, start)| (m - start).abs());
        let (axis, result) = system.direction_check().unwrap();
        assert_eq!(axis, checked);
        (result.unwrap(), moved.fold(0.0, f64::max))
    }
}

/// Both signs of each of force, encoder and scale. The motion is at least 0.2 mm, and at most what the axis coasts beyond it:
/// ½·v²·m/20 N with v² = 2·0.2 mm·10 N/15 kg, another 0.1 mm.
#[test]
fn the_result_names_the_sign_that_is_wrong() {
    for force_sign in [1.0, -1.0] {
        for motor_sign in [1.0, -1.0] {
            for scale_sign in [None, Some(1.0), Some(-1.0)] {
                let (mut system, mut plant) = plant();
                (plant.force_sign, plant.motor_sign, plant.scale_sign) = (force_sign, motor_sign, scale_sign);
                let (result, moved_m) = plant.check(&mut system);
                let forwards = force_sign * motor_sign > 0.0;
                let expected = match scale_sign {
                    _ if !forwards => DirectionResult::Reversed,
                    None => DirectionResult::OkWithoutScale,
                    Some(sign) if sign * force_sign < 0.0 => DirectionResult::ScaleReversed,
                    _ => DirectionResult::Ok,
                };
                assert_eq!(result, expected, "force {force_sign}, motor {motor_sign}, {scale_sign:?}");
                assert!((0.2e-3..0.31e-3).contains(&moved_m), "{moved_m} m");
            }
        }
    }
}

#[test]
fn a_closed_brake_is_named() {
    let (mut system, mut braked) = plant();
    braked.friction_n = 40.0;
    let (result, moved_m) = braked.check(&mut system);
    assert_eq!(result, DirectionResult::NoMotion);
    assert!(moved_m < 0.2e-3);
    // 200 ms, and the tick in which the time is over.
    assert!((4000..=4002).contains(&braked.enabled_ticks), "{}", braked.enabled_ticks);
}

/// One of motor and scale stands, with either sign of the force: the force ends at 0.2 mm all the same, and the axis coasts half as far.
/// Both stand: the force ends after 200 ms, in which 10 N move 15 kg by 13 mm, and as far again by half to stop.
#[test]
fn any_reading_that_moves_ends_the_force_and_the_result_names_the_one_that_stands() {
    for force_sign in [1.0, -1.0] {
        for (motor_sign, scale_sign, expected) in [
            (1.0, Some(0.0), DirectionResult::ScaleWithoutMotion),
            (-1.0, Some(0.0), DirectionResult::ScaleWithoutMotion),
            (0.0, Some(1.0), DirectionResult::MotorWithoutMotion),
            (0.0, Some(-1.0), DirectionResult::MotorWithoutMotion),
            (0.0, Some(0.0), DirectionResult::NoMotion),
        ] {
            let (mut system, mut dead) = plant();
            (dead.force_sign, dead.motor_sign, dead.scale_sign) = (force_sign, motor_sign, scale_sign);
            let (result, moved_m) = dead.check(&mut system);
            assert_eq!(result, expected, "{force_sign} {motor_sign} {scale_sign:?}");
            let (least_m, most_m) =
                if expected == DirectionResult::NoMotion { (13.3e-3, 20.1e-3) } else { (0.2e-3, 0.31e-3) };
            assert!((least_m..most_m).contains(&moved_m), "{moved_m} m: {result:?}");
        }
    }
}

/// With exchanged plugs the other axis moves, whichever of both is checked and whichever of its sensors works.
#[test]
fn another_axis_that_moves_ends_the_force() {
    for axis in [0, 1] {
        for (motor_sign, scale_sign) in [(1.0, None), (0.0, Some(1.0)), (0.0, Some(-1.0))] {
            let (mut system, mut plant) = plant();
            plant.drives = [1, 0];
            (plant.motor_sign, plant.scale_sign) = (motor_sign, scale_sign);
            let (result, moved_m) = plant.check_of(&mut system, axis);
            assert_eq!(result, DirectionResult::WrongAxis(1 - u8::try_from(axis).unwrap()));
            assert!((0.2e-3..0.31e-3).contains(&moved_m), "{moved_m} m");
        }
    }
}

/// Backlash of half of the distance: the scale has moved by the other half when the force ends.
#[test]
fn a_scale_behind_a_backlash_of_half_the_distance_does_not_stand() {
    for (backlash_m, expected) in
        [(0.1e-3, DirectionResult::Ok), (0.17e-3, DirectionResult::ScaleWithoutMotion)]
    {
        let (mut system, mut plant) = plant();
        (plant.scale_sign, plant.backlash_m) = (Some(1.0), backlash_m);
        assert_eq!(plant.check(&mut system).0, expected, "{backlash_m}");
    }
}

/// Ticks that are late while the check waits do not end it; one that is late while the force acts does.
#[test]
fn a_late_tick_ends_a_check_only_while_the_force_acts() {
    let (mut system, mut plant) = plant();
    system.check_direction(0, &CHECK).unwrap();
    plant.late = true;
    plant.run(&mut system, 100);
    assert_eq!(system.direction_check(), Some((0, None)));
    plant.late = false;
    plant.closed = true;
    plant.run(&mut system, 50);
    assert!(plant.enabled);
    plant.late = true;
    plant.run(&mut system, 1);
    assert_eq!(system.direction_check(), Some((0, Some(DirectionResult::Aborted))));
    assert!(!plant.enabled);
}

/// The loops stay open until the check has ended and the switch has been opened and closed again; then the axes hold where they
/// stand.
#[test]
fn the_next_enable_holds_the_axes_where_they_stand() {
    let (mut system, mut plant) = plant();
    system.check_direction(0, &CHECK).unwrap();
    // An enable by a host has no effect meanwhile.
    system.machine_mut().enable();
    plant.run(&mut system, 10);
    assert_eq!((system.machine().power(), plant.enabled), (Power::Off, false));
    assert_eq!(system.check_direction(1, &CHECK), Err(DirectionCheckError::NotReady));
    plant.closed = true;
    plant.run(&mut system, 8000);
    assert_eq!(system.direction_check(), Some((0, Some(DirectionResult::OkWithoutScale))));
    assert_eq!((system.machine().power(), plant.enabled), (Power::Off, false));
    let at_m = plant.at_m;
    plant.closed = false;
    plant.run(&mut system, 10);
    plant.closed = true;
    plant.run(&mut system, 2000);
    assert_eq!((system.machine().power(), plant.enabled), (Power::On, true));
    for (now, before) in plant.at_m.into_iter().zip(at_m) {
        assert!((now - before).abs() < 1e-9);
    }
    assert_eq!(system.check_direction(0, &CHECK), Err(DirectionCheckError::NotReady));
}

/// Opening the switch, an emergency stop, a drive fault or a limit switch end the force in the same tick.
#[test]
fn a_check_is_aborted_at_once() {
    let abort: [fn(&mut TestPlant); 4] = [
        |plant| plant.closed = false,
        |plant| plant.inputs.emergency_stop = true,
        |plant| plant.inputs.axes[1].drive_fault = true,
        |plant| plant.inputs.axes[0].limits = [false, true],
    ];
    for (row, abort) in abort.into_iter().enumerate() {
        let (mut system, mut plant) = plant();
        system.check_direction(0, &CHECK).unwrap();
        plant.run(&mut system, 10);
        plant.closed = true;
        plant.run(&mut system, 50);
        assert!(plant.enabled);
        abort(&mut plant);
        plant.run(&mut system, 1);
        assert!(!plant.enabled, "row {row}");
        assert_eq!(system.direction_check(), Some((0, Some(DirectionResult::Aborted))), "row {row}");
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let (mut system, _) = plant();
    let mut refused = |axis, settings: DirectionCheckSettings| system.check_direction(axis, &settings).err();
    let named = |name| Some(DirectionCheckError::Setting(name));
    assert_eq!(refused(2, CHECK), Some(DirectionCheckError::NotReady));
    for force_n in [0.0, -1.0, 201.0, f64::NAN] {
        assert_eq!(refused(0, DirectionCheckSettings { force_n, ..CHECK }), named("force_n"));
    }
    for time_s in [0.0, 1.1, f64::NAN] {
        assert_eq!(refused(0, DirectionCheckSettings { time_s, ..CHECK }), named("time_s"));
    }
    // A position unit is 2⁻²⁰ nm: with less, an axis at rest would count as moved.
    for detect_m in [0.0, 0.9 / PER_M, 6e-3, f64::NAN] {
        assert_eq!(refused(0, DirectionCheckSettings { detect_m, ..CHECK }), named("detect_m"));
    }
}

/// A switch that is still closed when the check is prepared, because something else has switched the drives off: it has to be opened
/// before it can start the check, and opening it does not end the check that has not begun.
#[test]
fn a_closed_switch_is_opened_before_the_check_and_does_not_end_it() {
    let (mut system, mut plant) = plant();
    plant.run(&mut system, 10);
    plant.closed = true;
    plant.run(&mut system, 10);
    assert_eq!(system.machine().power(), Power::On);
    system.machine_mut().disable();
    plant.run(&mut system, 10);
    assert_eq!(system.machine().power(), Power::Off);
    assert_eq!(plant.check(&mut system).0, DirectionResult::OkWithoutScale);
}

/// Drives that take a force are checked, by PWM as by ±10 V. One that takes steps has no force, and is refused.
#[test]
fn a_step_drive_has_no_force_to_check() {
    let drives = [
        (DriveSettings::Pwm { full_duty_n: FULL_N }, None),
        (
            DriveSettings::Analog(AnalogSettings { full_scale_n: FULL_N, zero: 2048, span: 2047, max: 4095 }),
            None,
        ),
        (DriveSettings::Steps { step_m: 1e-6 }, Some(DirectionCheckError::StepDrive)),
    ];
    for (drive, expected) in drives {
        let output = AnyOutput::new(&drive, 8400, 1).unwrap();
        assert_eq!(check_with(output).err(), expected, "{drive:?}");
    }
    let steps = StepOutput::new(1e-6, 1).unwrap();
    assert_eq!(check_with(steps), Err(DirectionCheckError::StepDrive));
}

/// Prepares a check of X with this output.
fn check_with<O: DriveOutput<Fixed> + Copy>(output: O) -> Result<(), DirectionCheckError> {
    let mut machine = machine();
    let mut system = DriveSystem::new(&mut machine, [output; 2], EnableSwitch::new(2), StatusLight::new(50));
    system.check_direction(0, &CHECK)
}
