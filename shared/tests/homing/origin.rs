//! The shift of an origin, on machines whose readings are given.

use shared::compensate::settings::{Pitch, PitchSource, Points};
use shared::compensate::{CompensationKind, CompensationSettings};
use shared::config::{AxisSettings, Rates, ScaleLimits, Sensors};
use shared::feedback::OriginShift;
use shared::interpolate::Block;
use shared::machine::{Machine, MachineError, Reading, Reference};
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };

/// The origins of motor and scale differ by metres.
const LIMITS: ScaleLimits = ScaleLimits { disagreement_m: 10.0, ..ScaleLimits::DEFAULT };

const MOTOR: Sensors =
    Sensors::Motor { scale_disagreement_limit_m: None, frozen_encoder_limit_m: Some(0.01) };

/// A machine of two axes that stands with a following error and has force, integrals and filters in motion.
fn machine<S: Scalar>(sensors: Sensors) -> Machine<S, 2> {
    let settings = AxisSettings { sensors, fastest_m_per_s: Some(1.0), ..AxisSettings::default() };
    let mut machine = Machine::new(RATES, &[settings; 2], [Position(0); 2]).unwrap();
    // Compensations that do not depend on an absolute position.
    let compensation =
        CompensationSettings { backlash_width_m: Some(4e-6), ..CompensationSettings::default() };
    machine.compensate(0, &compensation).unwrap();
    machine.enable();
    machine
}

/// Readings that move irregularly, m.
fn reading(tick: u32) -> Reading {
    let t = f64::from(tick) / RATES.velocity_loop_hz;
    let motor_m = 1e-3 * t + 3e-6 * (200.0 * t).sin();
    let table_m = motor_m - 2e-6 * (60.0 * t).cos();
    Reading { motor: Position::from_m(motor_m).unwrap(), table: Position::from_m(table_m) }
}

/// Two machines get the same readings; the origin of one is set in the middle, by distances of metres that differ for motor and
/// scale. All forces before and after are equal to the bit, in motion that follows too.
fn is_bumpless<S: Scalar>(sensors: Sensors, uses_scale: bool) {
    let [mut plain, mut shifted] = [(); 2].map(|()| machine::<S>(sensors));
    let shift = OriginShift { motor: 3_141_592_653_589_793, table: -271_828_182_845_904 };
    let command_shift = if uses_scale { shift.table } else { shift.motor };
    let mut origin = OriginShift::default();
    let mut forces = 0;
    for tick in 0..6000 {
        if tick == 1003 {
            shifted.set_origin(0, shift).unwrap();
            origin = shift;
        }
        if tick == 3000 {
            let [to, _] = plain.command();
            plain.push(&Block::line([to.to_m() + 1e-3, 0.0], 0.02, 1.0)).unwrap();
            let to = to + command_shift;
            shifted.push(&Block::line([to.to_m() + 1e-3, 0.0], 0.02, 1.0)).unwrap();
        }
        let outputs = [
            plain.tick(&[reading(tick), reading(0)]),
            shifted.tick(&[reading(tick).shifted(origin), reading(0)]),
        ];
        let [a, b] = outputs.map(|output| output.forces.map(Scalar::bits));
        // The end of the block is rounded to a position unit, 1 am of force away; before it, to the bit.
        if tick < 3000 {
            assert_eq!(a, b, "tick {tick}, {}", S::NAME);
        } else {
            let [a, b] = outputs.map(|output| output.forces[0].value());
            assert!((a - b).abs() < 1e-3, "{a} N, {b} N, tick {tick}, {}", S::NAME);
        }
        let [a, b] = outputs.map(|output| output.commands[0]);
        let expected = if tick >= 1003 { command_shift } else { 0 };
        assert!((b - a - expected).abs() <= i64::from(tick >= 3000), "{} units", b - a);
        assert!(outputs.iter().all(|output| output.enabled && output.warning.is_none()));
        forces += u32::from(outputs[0].forces[0].value().abs() > 1.0);
    }
    assert!(forces > 3000, "the loops are at work");
}

#[test]
fn setting_the_origin_is_bumpless_to_the_bit() {
    for (sensors, uses_scale) in [
        (MOTOR, false),
        (Sensors::Table(LIMITS), true),
        (Sensors::Dual { time_constant_s: 0.02, limits: LIMITS }, true),
    ] {
        is_bumpless::<Fixed>(sensors, uses_scale);
        is_bumpless::<f32>(sensors, uses_scale);
        is_bumpless::<f64>(sensors, uses_scale);
    }
}

#[test]
fn an_origin_is_not_set_while_a_path_runs() {
    let mut machine = machine::<Fixed>(MOTOR);
    machine.lose_reference(0);
    machine.push(&Block::line([1e-3, 0.0], 0.02, 1.0)).unwrap();
    machine.tick(&[reading(0); 2]);
    let shift = OriginShift { motor: 1000, table: 1000 };
    assert_eq!(machine.set_origin(0, shift), Err(MachineError::PathRunning));
    assert_eq!(machine.reference(0), Some(Reference::Relative));
    assert_eq!(machine.set_origin(2, shift), Err(MachineError::NoSuchAxis));
}

/// Two axes that are not homed, the drives on, with a pitch map of the screw on the first. Also the rate of the correction, m/s.
fn with_pitch_map() -> (Machine<Fixed, 2>, f64) {
    let settings = AxisSettings { position_gain_per_s: 33.0, ..AxisSettings::default() };
    let mut machine = Machine::<Fixed, 2>::new(RATES, &[settings; 2], [Position(0); 2]).unwrap();
    machine.lose_reference(0);
    machine.lose_reference(1);
    let values = [5e-6, 5e-6].into_iter().collect();
    let forward = Points { start_m: -1.0, spacing_m: 2.0, values };
    let compensation = CompensationSettings {
        pitch: Some(Pitch { of: PitchSource::Screw, forward, backward: None }),
        position_rate_m_per_s: 1e-3,
        ..CompensationSettings::default()
    };
    machine.compensate(0, &compensation).unwrap();
    machine.enable();
    (machine, compensation.position_rate_m_per_s)
}

/// The greatest force on X with readings of zero. The integral part turns a correction of the command into a force that grows, so
/// that any correction shows.
fn greatest_force(machine: &mut Machine<Fixed, 2>, ticks: u32) -> f64 {
    let at_zero = [Reading { motor: Position(0), table: None }; 2];
    (0..ticks).map(|_| machine.tick(&at_zero).forces[0].value().abs()).fold(0.0, f64::max)
}

/// Force of the proportional part after 1 ms: Kv·Kp·1 µm at 1 mm/s.
fn proportional_n(rate_m_per_s: f64) -> f64 {
    50_000.0 * 33.0 * rate_m_per_s * 1e-3
}

/// A pitch map of the screw is held off until its axis is homed: then it comes in at its declared rate. A homing of the other
/// axis does not release it, nor does switching it on.
#[test]
fn a_pitch_map_is_held_off_until_the_axis_is_homed() {
    let (mut machine, rate_m_per_s) = with_pitch_map();
    machine.switch(0, CompensationKind::Pitch, true).unwrap();
    assert!(machine.is_held(0, CompensationKind::Pitch));
    assert!(greatest_force(&mut machine, 2000) < 1e-9);
    machine.set_origin(1, OriginShift::default()).unwrap();
    assert!(machine.is_held(0, CompensationKind::Pitch));
    assert!(greatest_force(&mut machine, 2000) < 1e-9);
    machine.set_origin(0, OriginShift::default()).unwrap();
    assert!(!machine.is_held(0, CompensationKind::Pitch));
    // 5 µm at 1 mm/s take 5 ms. After 1 ms, 1 µm acts: 1.65 N, and the integral part of it, less than a tenth.
    let (early, proportional) = (greatest_force(&mut machine, 20), proportional_n(rate_m_per_s));
    assert!(early > 0.7 * proportional && early < 1.15 * proportional, "{early} N, {proportional} N");
    assert!(greatest_force(&mut machine, 200) > 5.0 * proportional);
}

/// What the user has switched off stays off when the axis is homed.
#[test]
fn homing_does_not_switch_on_what_the_user_has_switched_off() {
    let (mut machine, rate_m_per_s) = with_pitch_map();
    machine.switch(0, CompensationKind::Pitch, false).unwrap();
    machine.set_origin(0, OriginShift::default()).unwrap();
    assert!(greatest_force(&mut machine, 2000) < 1e-9);
    machine.switch(0, CompensationKind::Pitch, true).unwrap();
    assert!(greatest_force(&mut machine, 20) > 0.7 * proportional_n(rate_m_per_s));
}
