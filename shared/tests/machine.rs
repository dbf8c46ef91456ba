//! What a machine reports, and calls that name an axis: one that it does not have is refused, and so is any axis of a machine
//! without settings.

use shared::compensate::settings::{ForceModel, Pitch, PitchSource, Points};
use shared::compensate::{AxisCompensation, AxisOf, CompensationKind, CompensationSettings, Dependence};
use shared::config::{AxisSettings, Rates, ScaleLimits, Sensors};
use shared::feedback::OriginShift;
use shared::interpolate::path::QUEUE;
use shared::interpolate::{Block, PathError};
use shared::machine::{Machine, MachineError, Reading};
use shared::safety::{Fault, FaultKind};
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };
const AT_ZERO: [Reading; 2] = [Reading { motor: Position(0), table: None }; 2];

/// A load of 100 N at every position of the travel.
fn compensation() -> CompensationSettings {
    let load = Points { start_m: -1.0, spacing_m: 2.0, values: [100.0; 2].into_iter().collect() };
    let model = ForceModel { load: Some(load), ..ForceModel::default() };
    CompensationSettings { force: Some(model), ..CompensationSettings::default() }
}

/// Each call that names an axis, on one that is not there.
fn refusals(machine: &mut Machine<Fixed, 2>, axis: usize) -> [Result<(), MachineError>; 5] {
    let settings = compensation();
    let converted = AxisCompensation::new(&settings, RATES, AxisOf { axis: 0, axes: 2 }).unwrap();
    [
        machine.change(axis, &AxisSettings { position_gain_per_s: 10.0, ..AxisSettings::default() }),
        machine.compensate(axis, &settings),
        machine.set_compensation(axis, &converted, Dependence::of(0, &settings)),
        machine.switch(axis, CompensationKind::Pitch, false),
        machine.set_origin(axis, OriginShift { motor: 1000, table: 1000 }),
    ]
}

/// Forces of both machines in 100 ticks 1 µm away from the command, bit for bit.
fn assert_same(machine: &mut Machine<Fixed, 2>, untouched: &mut Machine<Fixed, 2>) {
    let moved = AT_ZERO.map(|reading| Reading { motor: Position::from_m(1e-6).unwrap(), ..reading });
    for tick in 0..100 {
        let readings = if tick == 0 { &AT_ZERO } else { &moved };
        let [a, b] = [&mut *machine, &mut *untouched].map(|machine| machine.tick(readings));
        assert_eq!(a, b, "tick {tick}");
        assert!(tick < 10 || a.forces.iter().all(|force| force.value() < -1.0), "{a:?}");
    }
}

#[test]
fn an_axis_that_the_machine_does_not_have_is_refused_and_nothing_is_changed() {
    let new = || Machine::<Fixed, 2>::new(RATES, &[AxisSettings::default(); 2], [Position(0); 2]).unwrap();
    for axis in [2, 3, usize::MAX] {
        let (mut machine, mut untouched) = (new(), new());
        assert_eq!(refusals(&mut machine, axis), [Err(MachineError::NoSuchAxis); 5], "{axis}");
        machine.lose_reference(axis);
        assert_eq!(machine.reference(axis), None);
        assert_eq!(machine.force_limit_n(axis), None);
        assert!(!machine.uses_scale(axis) && !machine.is_held(axis, CompensationKind::Pitch));
        machine.enable();
        untouched.enable();
        assert_same(&mut machine, &mut untouched);
    }
}

#[test]
fn a_machine_without_settings_refuses_every_axis() {
    let mut machine = Machine::<Fixed, 2>::UNCONFIGURED;
    for axis in 0..2 {
        assert_eq!(refusals(&mut machine, axis), [Err(MachineError::NoSuchAxis); 5]);
        assert_eq!((machine.force_limit_n(axis), machine.uses_scale(axis)), (None, false));
    }
    assert_eq!((machine.rates(), machine.position_loop_divider()), (None, 0));
    machine.enable();
    let output = machine.tick(&AT_ZERO);
    assert!(!output.enabled && output.forces == [Fixed::default(); 2] && !machine.was_position_tick());
}

#[test]
fn a_machine_reports_its_settings() {
    let sensors = [
        Sensors::MOTOR,
        Sensors::Table(ScaleLimits::DEFAULT),
        Sensors::Dual { time_constant_s: 0.05, limits: ScaleLimits::DEFAULT },
    ];
    let limits_n = [1500.0, 250.0, 4000.0];
    let settings = [0, 1, 2].map(|axis| AxisSettings {
        sensors: sensors[axis],
        force_limit_n: limits_n[axis],
        ..AxisSettings::default()
    });
    let machine = Machine::<Fixed, 3>::new(RATES, &settings, [Position(0); 3]).unwrap();
    assert_eq!(machine.rates(), Some(RATES));
    assert_eq!(machine.position_loop_divider(), RATES.position_loop_divider);
    assert_eq!([0, 1, 2].map(|axis| machine.uses_scale(axis)), [false, true, true]);
    for (axis, limit_n) in limits_n.into_iter().enumerate() {
        // A multiple of the step of 2⁻¹⁴ N.
        assert_eq!(machine.force_limit_n(axis), Some(limit_n));
    }
}

/// The position loops run in the first tick after an enable and in every fifth from then on, and not while the drives are off.
#[test]
fn position_ticks_are_every_fifth_from_the_enable_on() {
    let mut machine =
        Machine::<Fixed, 2>::new(RATES, &[AxisSettings::default(); 2], [Position(0); 2]).unwrap();
    assert!(!machine.was_position_tick());
    for run in 0..2 {
        machine.tick(&AT_ZERO);
        assert!(!machine.was_position_tick(), "off, run {run}");
        machine.enable();
        for tick in 0..23 {
            machine.tick(&AT_ZERO);
            assert_eq!(machine.was_position_tick(), tick % 5 == 0, "tick {tick} of run {run}");
        }
        machine.disable();
    }
}

/// Position gain · velocity gain of [`proportional`], N/m.
const STIFFNESS_N_PER_M: f64 = 33.0 * 50_000.0;

/// Two axes without an integral part, the drives on. The second has a pitch error of 5 µm and the load of [`compensation`].
fn proportional() -> Machine<Fixed, 2> {
    let settings = AxisSettings {
        position_gain_per_s: 33.0,
        velocity_gain_n_s_per_m: 50_000.0,
        velocity_integral_time_s: None,
        ..AxisSettings::default()
    };
    let mut machine = Machine::<Fixed, 2>::new(RATES, &[settings; 2], [Position(0); 2]).unwrap();
    let forward = Points { start_m: -1.0, spacing_m: 2.0, values: [5e-6; 2].into_iter().collect() };
    let compensation = CompensationSettings {
        pitch: Some(Pitch { of: PitchSource::Screw, forward, backward: None }),
        position_rate_m_per_s: 1e-3,
        ..compensation()
    };
    machine.compensate(1, &compensation).unwrap();
    machine.enable();
    machine
}

/// On a motor that does not move and without an integral part, F = Kv·Kp·(corrected command − motor). A pitch error of 5 µm is
/// corrected by 5 µm, in the direction that the force shows.
#[test]
fn the_corrected_command_is_what_the_position_loop_follows() {
    let mut machine = proportional();
    machine.switch(1, CompensationKind::Force, false).unwrap();
    // 5 µm at 1 mm/s take 100 ticks; after 4000 all filters have settled.
    let forces = (0..4000).map(|_| machine.tick(&AT_ZERO).forces).last().unwrap();
    let [x_m, y_m] = machine.corrected_command().map(Position::to_m);
    assert_eq!((machine.command(), x_m), ([Position(0); 2], 0.0));
    // A step of a table of corrections is below 1 nm.
    assert!((y_m.abs() - 5e-6).abs() < 1e-9, "{y_m} m");
    let expected = STIFFNESS_N_PER_M * y_m;
    // A step of the velocity command, 1 nm/s, is 0.05 mN; one of the force 0.06 mN.
    assert!((forces[1].value() - expected).abs() < 1e-3, "{:?}, not {expected} N", forces[1]);
}

/// The first warning since the enable, also between ticks, until the drives are disabled.
#[test]
fn a_warning_is_reported_until_the_drives_are_disabled() {
    let mut machine =
        Machine::<Fixed, 2>::new(RATES, &[AxisSettings::default(); 2], [Position(0); 2]).unwrap();
    machine.push(&Block::line([0.1, 0.1], 0.1, 1.0)).unwrap();
    let mut readings = AT_ZERO;
    // Twice the 0.1 mm by which an axis may be away from the start of its path.
    readings[1].motor = Position::from_m(0.2e-3).unwrap();
    machine.tick(&readings);
    assert_eq!(machine.warning(), None);
    machine.enable();
    let displaced = Some(Fault::Axis { axis: 1, kind: FaultKind::Displaced });
    for _ in 0..20 {
        assert_eq!(machine.tick(&readings).warning, displaced);
        assert_eq!(machine.warning(), displaced);
    }
    machine.disable();
    assert_eq!(machine.warning(), None);
}

/// There is room exactly as long as a block is accepted. A block that has ended makes room for one.
#[test]
fn there_is_room_as_long_as_blocks_are_accepted() {
    let mut machine =
        Machine::<Fixed, 2>::new(RATES, &[AxisSettings::default(); 2], [Position(0); 2]).unwrap();
    let block = |k: usize| Block::line([1e-3 * k as f64, 0.0], 0.1, 1.0);
    for k in 1..=QUEUE {
        assert!(machine.has_room(), "block {k}");
        machine.push(&block(k)).unwrap();
    }
    assert!(!machine.has_room());
    assert_eq!(machine.push(&block(QUEUE + 1)), Err(PathError::QueueFull));
    machine.enable();
    let mut readings = AT_ZERO;
    // A block of 1 mm at 1 m/s² takes less than 2·√(1 mm / 1 m/s²) = 63 ms, 1265 ticks; with its neighbours joined, less.
    let waiting = (0..2000).take_while(|_| {
        let commands = machine.tick(&readings).commands;
        readings = commands.map(|motor| Reading { motor, table: None });
        !machine.has_room()
    });
    // 1 mm at no more than 0.1 m/s takes 10 ms, 200 ticks.
    let waited = waiting.count();
    assert!((200..1265).contains(&waited), "{waited} ticks");
    machine.push(&block(QUEUE + 1)).unwrap();
    assert!(!machine.has_room());
}

/// A message names the axis and the setting, or what the path refuses; no two causes share a message.
#[test]
fn a_refusal_says_what_is_refused() {
    let refused = AxisSettings { position_gain_per_s: -1.0, ..AxisSettings::default() };
    let settings = [AxisSettings::default(), refused];
    let error = Machine::<Fixed, 2>::new(RATES, &settings, [Position(0); 2]).unwrap_err();
    let message = error.to_string();
    assert!(message.contains("axis 1") && message.contains("position_gain_per_s"), "{message}");
    assert_eq!(MachineError::from(PathError::QueueFull).to_string(), PathError::QueueFull.to_string());
    let messages = [message]
        .into_iter()
        .chain([MachineError::PathRunning, MachineError::NoSuchAxis].map(|error| error.to_string()));
    let messages: std::collections::BTreeSet<_> = messages.collect();
    assert!(messages.len() == 3 && messages.iter().all(|message| message.len() > 10), "{messages:?}");
}

/// Each switch of the user acts on its own compensation of its own axis, also when it is set twice.
#[test]
fn compensations_are_switched_one_by_one() {
    let mut machine = proportional();
    for [pitch, load] in [[true, true], [true, false], [false, false], [false, true], [true, true]] {
        for _ in 0..2 {
            machine.switch(1, CompensationKind::Pitch, pitch).unwrap();
            machine.switch(1, CompensationKind::Force, load).unwrap();
            machine.switch(0, CompensationKind::Pitch, !pitch).unwrap();
            machine.switch(0, CompensationKind::Force, !load).unwrap();
        }
        // 5 µm at 1 mm/s take 5 ms, 100 N at 10⁵ N/s one: both have ended after 0.2 s.
        let forces = (0..4000).map(|_| machine.tick(&AT_ZERO).forces).last().unwrap();
        let y_m = machine.corrected_command()[1].to_m();
        assert!((y_m.abs() - if pitch { 5e-6 } else { 0.0 }).abs() < 1e-9, "{pitch}, {load}: {y_m} m");
        let added = forces[1].value() - STIFFNESS_N_PER_M * y_m;
        // Twice the tolerance above: the load and the output of the position loop are rounded separately.
        assert!((added - if load { 100.0 } else { 0.0 }).abs() < 2e-3, "{pitch}, {load}: {added} N");
        assert_eq!(forces[0], Fixed::ZERO);
    }
}
