//! Each fault on a machine in motion: it switches the drives off in the same tick, or stops along the path, or warns and the
//! motion continues.

mod coming_on;
mod frozen;
mod scale;
mod travel;

use crate::slide::Slide;
use shared::config::{AxisSettings, ConfigError, Rates, ScaleLimits, Sensors};
use shared::interpolate::{Block, PathError, Smoothing};
use shared::machine::{Machine, MachineError, Output, Reading};
use shared::safety::{Fault, FaultKind, Power};
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

const RATE_HZ: f64 = 4000.0;
const RATES: Rates = Rates { velocity_loop_hz: RATE_HZ, position_loop_divider: 1 };

/// A scale whose jump of 0.6 mm is a disagreement.
const LIMITS: ScaleLimits = ScaleLimits { disagreement_m: 0.5e-3, frozen_m: 0.4e-3 };

/// For a scale that differs from the motor by some millimetres.
const WIDE: ScaleLimits = ScaleLimits { disagreement_m: 0.02, ..LIMITS };

fn position(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

/// Each axis.
const TABLE: Slide = Slide { mass_kg: 50.0, viscous_n_s_per_m: 0.0, coulomb_n: 0.0 };

/// Two axes.
struct TestPlant<S: Scalar> {
    machine: Machine<S, 2>,
    motor_m: [f64; 2],
    velocity: [f64; 2],
    /// Error of the motor reading of the second axis.
    motor_jump_m: f64,
    /// Whether the scales have a reading.
    scale: bool,
    /// Error of the scale readings.
    scale_off_m: f64,
    /// Where the scale of the first axis stands, if it does.
    scale_frozen_m: Option<f64>,
}

impl<S: Scalar> TestPlant<S> {
    fn new(axis: &AxisSettings) -> Self {
        let mut machine = Machine::new(RATES, &[*axis; 2], [Position(0); 2]).unwrap();
        machine.push(&Block::line([0.2, 0.1], 0.1, 2.0)).unwrap();
        machine.enable();
        Self {
            machine,
            motor_m: [0.0; 2],
            velocity: [0.0; 2],
            motor_jump_m: 0.0,
            scale: true,
            scale_off_m: 0.0,
            scale_frozen_m: None,
        }
    }

    fn tick(&mut self) -> Output<S, 2> {
        let position = |m: f64| Position::from_m(m).unwrap();
        let readings = [0, 1].map(|axis| Reading {
            motor: position(self.motor_m[axis] + if axis == 1 { self.motor_jump_m } else { 0.0 }),
            table: self.scale.then(|| {
                let scale_m = self.scale_frozen_m.filter(|_| axis == 0).unwrap_or(self.motor_m[axis]);
                position(scale_m + self.scale_off_m)
            }),
        });
        let output = self.machine.tick(&readings);
        for axis in 0..2 {
            let force_n = output.forces[axis].value();
            TABLE.step(&mut self.motor_m[axis], &mut self.velocity[axis], force_n, 1.0 / RATE_HZ);
        }
        output
    }

    /// Runs until the drives are off, at most 5 s.
    fn until_off(&mut self, mut each_tick: impl FnMut(&Self, Output<S, 2>)) {
        for _ in 0..20_000 {
            let output = self.tick();
            each_tick(self, output);
            if !self.machine.power().is_on() {
                return;
            }
        }
        panic!("still {:?}", self.machine.power());
    }

    fn run(&mut self, ticks: u32) -> Output<S, 2> {
        (0..ticks).map(|_| self.tick()).last().unwrap()
    }
}

fn axis() -> AxisSettings {
    AxisSettings {
        position_gain_per_s: 50.0,
        velocity_gain_n_s_per_m: 20_000.0,
        following_error_limit_m: 0.01,
        fastest_m_per_s: Some(0.5),
        saturation_time_s: 0.01,
        stop_deceleration_m_per_s2: 4.0,
        sensors: Sensors::Dual { time_constant_s: 0.05, limits: LIMITS },
        ..AxisSettings::default()
    }
}

const fn on(axis: u8, kind: FaultKind) -> Fault {
    Fault::Axis { axis, kind }
}

/// The drives are switched off in the tick in which the fault occurs.
fn switches_off_at_once<S: Scalar>(change: impl Fn(&mut TestPlant<S>), fault: Fault) {
    let mut plant = TestPlant::<S>::new(&axis());
    assert!(plant.run(2000).enabled);
    change(&mut plant);
    let output = plant.tick();
    assert_eq!(plant.machine.power(), Power::Faulted(fault), "{}", S::NAME);
    assert!(!output.enabled && output.forces.iter().all(|force| force.value() == 0.0));
    // An enable has no effect before an acknowledgement.
    plant.machine.enable();
    assert!(!plant.tick().enabled);
    plant.machine.disable();
    plant.machine.enable();
}

fn severe_faults<S: Scalar>() {
    // 0.3 mm in a tick of 0.25 ms is 1.2 m/s, above the limit of 0.5 m/s; the disagreement is below its limit of 0.5 mm.
    switches_off_at_once::<S>(|plant| plant.motor_jump_m = 0.3e-3, on(1, FaultKind::EncoderStep));
    switches_off_at_once::<S>(|plant| plant.scale_off_m = 0.6e-3, on(0, FaultKind::Disagreement));
    switches_off_at_once::<S>(|plant| plant.machine.fault(Fault::Overrun), Fault::Overrun);
    switches_off_at_once::<S>(|plant| plant.machine.fault(Fault::HardwareStop), Fault::HardwareStop);
}

#[test]
fn severe_faults_switch_the_drives_off_in_every_format() {
    severe_faults::<Fixed>();
    severe_faults::<f32>();
    severe_faults::<f64>();
}

#[test]
fn a_following_error_switches_the_drives_off() {
    let mut plant = TestPlant::<Fixed>::new(&AxisSettings { following_error_limit_m: 1.5e-3, ..axis() });
    // At constant speed the error of the first axis is 0.1 m/s·2/√5/Kp = 1.8 mm: it passes 1.5 mm during acceleration.
    plant.run(2000);
    assert_eq!(plant.machine.power(), Power::Faulted(on(0, FaultKind::FollowingError)));
}

#[test]
fn a_saturated_force_stops_the_path_after_its_budget() {
    let mut plant = TestPlant::<Fixed>::new(&AxisSettings { force_limit_n: 20.0, ..axis() });
    // The acceleration needs 50 kg·2 m/s²·2/√5 = 89 N.
    let mut ticks = 0;
    while !matches!(plant.machine.power(), Power::Stopping(_)) {
        plant.tick();
        ticks += 1;
        assert!(ticks < 400, "{:?}", plant.machine.power());
    }
    // The budget of 10 ms is 40 ticks. The force is saturated some ticks after the start, at a velocity error of
    // 20 N/Kv = 1 mm/s.
    assert!((41..=80).contains(&ticks), "{ticks}");
    assert_eq!(plant.machine.power(), Power::Stopping(on(0, FaultKind::ForceSaturated)));
}

/// The velocity loop is closed on the difference of motor readings. With Kv·Δt/m > 2 the velocity changes its sign and grows
/// in each tick, until the force alternates between its limits with an unsaturated tick now and then.
#[test]
fn an_unstable_loop_is_stopped_although_its_force_changes_sign() {
    let velocity_gain_n_s_per_m = 2.5 * 50.0 * RATE_HZ;
    let mut plant =
        TestPlant::<f64>::new(&AxisSettings { velocity_gain_n_s_per_m, force_limit_n: 200.0, ..axis() });
    let (mut ticks, mut below, mut sign_changes, mut last) = (0, 0, 0, 0.0);
    while plant.machine.power() == Power::Off || plant.machine.power().is_on() {
        let force = plant.tick().forces[0].value();
        below += u32::from(force.abs() < 199.0);
        sign_changes += u32::from(force * last < 0.0);
        last = force;
        ticks += 1;
        assert!(ticks < 2000, "still running");
    }
    assert!(sign_changes > 10 && below > 0, "{sign_changes} changes of sign, {below} ticks below the limit");
}

#[test]
fn a_lost_scale_warns_and_the_motion_continues() {
    let mut plant = TestPlant::<Fixed>::new(&axis());
    plant.run(1000);
    plant.scale = false;
    let output = plant.tick();
    assert_eq!(output.warning, Some(on(0, FaultKind::ScaleLost)));
    assert_eq!(plant.run(1000).warning, output.warning);
    assert_eq!(plant.machine.power(), Power::On);
    plant.scale = true;
    assert_eq!(plant.run(100).warning, output.warning);
    plant.machine.disable();
    assert_eq!(plant.tick().warning, None);
}

/// A silent host stops a moving machine along its path, with the drives on: from 0.1 m/s with 4 m/s² in 25 ms, 100 ticks, and one for the
/// standstill. Without force the axis would coast on.
#[test]
fn a_silent_host_stops_the_path_before_the_drives_go_off() {
    let mut plant = TestPlant::<Fixed>::new(&axis());
    plant.run(2000);
    plant.machine.fault(Fault::HostSilent);
    assert_eq!(plant.machine.power(), Power::Stopping(Fault::HostSilent));
    let mut ticks = 0;
    while plant.machine.power().is_on() {
        plant.tick();
        ticks += 1;
        assert!(ticks < 200, "{:?}", plant.machine.power());
    }
    assert_eq!(plant.machine.power(), Power::Faulted(Fault::HostSilent));
    assert!((99..=102).contains(&ticks), "{ticks}");
    // The command stands; the axis follows it with Kp = 50/s: 0.1 m/s·e^(−50/s·25 ms) and what the stop has not taken yet.
    assert!(plant.velocity[0].abs() < 0.06, "{}", plant.velocity[0]);
}
