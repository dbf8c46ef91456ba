//! A gantry: two motors with one command, on a beam whose racking stiffness couples them.

mod beam;
mod homing;

use beam::{Beam, COULOMB_N, FORCE_LIMIT_N, LIMIT_M, RATES, STIFFNESS_N_PER_M, settings};
use shared::config::{AxisSettings, ConfigError, GantrySettings};
use shared::feedback::Reading;
use shared::interpolate::{Block, Path, PathError};
use shared::machine::{Machine, MachineError};
use shared::safety::{Fault, FaultKind, Power};
use shared::scalar::{Fixed, Scalar};
use shared::units::{PER_NM, Position};

const SKEW: Fault = Fault::Axis { axis: 1, kind: FaultKind::GantrySkew };

/// A machine that takes the present places of the ends as zero, with the drives on.
fn enabled<S: Scalar>(beam: &Beam, settings: &[AxisSettings; 2]) -> Machine<S, 2> {
    let mut machine = Machine::new(RATES, settings, [Position(0); 2]).unwrap();
    machine.enable();
    machine.tick(&beam.readings());
    assert_eq!(machine.power(), Power::On);
    machine
}

/// A tick of machine and beam. Returns the forces, N.
fn tick<S: Scalar>(machine: &mut Machine<S, 2>, beam: &mut Beam) -> [f64; 2] {
    let forces = machine.tick(&beam.readings()).forces.map(Scalar::value);
    beam.step(forces);
    forces
}

/// A line of 50 mm at 50 mm/s with the second motor told to go elsewhere: the path does not ask it.
fn line<S: Scalar>(machine: &mut Machine<S, 2>) {
    machine.push(&Block::line([0.05, -0.07], 0.05, 0.5)).unwrap();
}

/// Both ends arrive together. The gains are 25/s and 30/s: with feed-forward and an integral the skew on the way is less than that of the
/// gains alone, v·(1/25 − 1/30) = 0.33 mm, and more than a count.
fn arrives_together<S: Scalar>() -> (f64, f64) {
    let mut beam = Beam::at(0.01, 0.0);
    let mut machine = enabled::<S>(&beam, &settings(0.0));
    line(&mut machine);
    let mut most_m = 0.0f64;
    for _ in 0..2 * 20_000 {
        tick(&mut machine, &mut beam);
        most_m = most_m.max(beam.skew_m().abs());
        let [first, second] = machine.command();
        assert_eq!(first, second);
    }
    assert_eq!(machine.power(), Power::On);
    (beam.at_m[0] - 0.01, most_m)
}

#[test]
fn both_ends_of_a_beam_arrive_together() {
    for (way_m, most_m) in [arrives_together::<Fixed>(), arrives_together::<f32>(), arrives_together::<f64>()]
    {
        assert!((way_m - 0.05).abs() < 10e-6, "{way_m} m");
        assert!((0.25e-6..0.33e-3).contains(&most_m), "{most_m} m");
    }
}

/// The second end meets friction beyond the force of both motors, and stands: the first goes on at 50 mm/s. The fault comes when the readings
/// differ by more than the limit, in the next position tick: by at most 5 ticks at 50 mm/s, 12.5 µm, and two counts. Both motors are off in
/// the same tick. Without the supervision the beam would be bent until the first motor is at its force limit, by (200 − 20) N over 0.2 N/µm
/// = 0.9 mm.
fn lag<S: Scalar>(skew_limit_m: f64) -> (Power, f64) {
    let mut beam = Beam::at(0.01, 0.0);
    let mut both = settings(0.0);
    both[1].gantry = both[1].gantry.map(|gantry| GantrySettings { skew_limit_m, ..gantry });
    let mut machine = enabled::<S>(&beam, &both);
    line(&mut machine);
    let mut most_m = 0.0f64;
    for index in 0..20_000 {
        if index == 8000 {
            beam.coulomb_n[1] = 2.0 * FORCE_LIMIT_N;
        }
        let forces = tick(&mut machine, &mut beam);
        most_m = most_m.max(beam.skew_m().abs());
        if !machine.power().is_on() {
            assert!(forces.iter().all(|force_n| force_n.abs() == 0.0), "{forces:?}");
            break;
        }
    }
    (machine.power(), most_m)
}

#[test]
fn an_end_that_lags_switches_both_motors_off() {
    for (power, skew_m) in [lag::<Fixed>(LIMIT_M), lag::<f32>(LIMIT_M), lag::<f64>(LIMIT_M)] {
        assert_eq!(power, Power::Faulted(SKEW));
        assert!((LIMIT_M - 0.5e-6..LIMIT_M + 13e-6).contains(&skew_m), "{skew_m} m");
    }
    // With the greatest limit, the first motor bends the beam by its whole force, and more than the limit above.
    let (power, skew_m) = lag::<Fixed>(GantrySettings::MOST_SKEW_M);
    assert_ne!(power, Power::Faulted(SKEW));
    let bent_m = (FORCE_LIMIT_N - COULOMB_N) / STIFFNESS_N_PER_M;
    assert!((0.9 * bent_m..1.2 * bent_m).contains(&skew_m), "{skew_m} m, {bent_m} m");
}

/// With the drives off, a beam that is not square is not switched on: an enable is refused with the fault, also after it is acknowledged. The
/// limit itself is permitted.
#[test]
fn a_beam_with_skew_is_not_switched_on() {
    let mut machine = Machine::<Fixed, 2>::new(RATES, &settings(0.0), [Position(0); 2]).unwrap();
    let at = |units: i64| [0, units].map(|units| Reading { motor: Position(units), table: None });
    let limit = 400_000 * PER_NM;
    for (skew, expected) in [
        (limit + 1, Power::Faulted(SKEW)),
        (-limit - 1, Power::Faulted(SKEW)),
        (limit, Power::On),
        (-limit, Power::On),
    ] {
        machine.tick(&at(skew));
        machine.enable();
        let output = machine.tick(&at(skew));
        assert_eq!((machine.power(), machine.skew(1)), (expected, Some(skew)));
        assert_eq!(output.enabled, expected == Power::On);
        machine.disable();
        machine.tick(&at(skew));
    }
}

/// Switched on with 0.1 mm of skew, the second motor starts where it is and goes to the command of the first at 1 mm/s: half of the way in
/// 50 ms, all of it in 100 ms.
#[test]
fn a_beam_is_made_square_after_each_enable() {
    let mut beam = Beam::at(0.01, 0.0);
    let mut machine = Machine::<Fixed, 2>::new(RATES, &settings(0.0), [Position(0); 2]).unwrap();
    beam.at_m[1] += 0.1e-3;
    machine.tick(&beam.readings());
    machine.enable();
    let mut ticks = 0;
    for (until, expected_m) in [(1, 0.1e-3), (1000, 0.05e-3), (2000, 0.0), (20_000, 0.0)] {
        while ticks < until {
            tick(&mut machine, &mut beam);
            ticks += 1;
        }
        let [first, second] = machine.command();
        let found_m = (second - first) as f64 / (1e9 * PER_NM as f64);
        // A position tick is 0.25 µm, and a count as well.
        assert!((found_m - expected_m).abs() < 0.6e-6, "{until}: {found_m} m");
    }
    // The integrals have made up for the friction, up to a count at each end and what they still do.
    assert!(machine.is_square(1) && beam.skew_m().abs() < 2e-6, "{} m", beam.skew_m());
}

/// A beam of x and y beside z: every command of x and z on lines, arcs and their corners is that of a machine without the second motor, and
/// y has that of x.
#[test]
fn a_path_is_that_of_the_first_motor_alone() {
    let axis = AxisSettings { travel_m: Some([-0.1, 0.1]), ..AxisSettings::default() };
    let gantry = GantrySettings { first: 0, skew_limit_m: LIMIT_M, reference_offset_m: 0.0 };
    let mut pair = Machine::<Fixed, 3>::new(
        RATES,
        &[axis, AxisSettings { gantry: Some(gantry), ..axis }, axis],
        [Position(0); 3],
    )
    .unwrap();
    let mut alone = Machine::<Fixed, 2>::new(RATES, &[axis; 2], [Position(0); 2]).unwrap();
    pair.enable();
    alone.enable();
    let at = |position| Reading { motor: position, table: None };
    let (mut of_pair, mut of_alone) = (pair.tick(&[at(Position(0)); 3]), alone.tick(&[at(Position(0)); 2]));
    let ways = [[0.02, 0.01], [0.02, 0.03], [-0.01, 0.0]];
    for [x_m, z_m] in ways {
        pair.push(&Block::line([x_m, 0.5, z_m], 0.05, 0.5).within(1e-4)).unwrap();
        alone.push(&Block::line([x_m, z_m], 0.05, 0.5).within(1e-4)).unwrap();
    }
    pair.push(&Block::arc([0, 2], [0.0, 0.0], 0.75, 0.05, 0.5)).unwrap();
    alone.push(&Block::arc([0, 1], [0.0, 0.0], 0.75, 0.05, 0.5)).unwrap();
    let mut moved = 0;
    loop {
        of_pair = pair.tick(&of_pair.commands.map(at));
        of_alone = alone.tick(&of_alone.commands.map(at));
        let [x, y, z] = of_pair.commands;
        assert_eq!(([x, z], y), (of_alone.commands, x));
        moved += usize::from(x != Position(0));
        if of_alone.done {
            break;
        }
    }
    assert!(of_pair.done && moved > 20_000, "{moved}");
}

/// What a motion says of a second motor is refused when it is checked, as is an arc in its plane; and nothing has changed.
#[test]
fn a_block_that_moves_the_second_motor_is_refused() {
    let mut path = Path::<3>::new([Position(0); 3], 4000.0);
    path.set_second_motors([None, Some(0), None]);
    let start = [Position::from_m(0.01).unwrap(); 3];
    let check = |block: &Block<3>| path.check(block, start, &[false; 3]);
    let refused = Err(PathError::SecondMotor { axis: 1 });
    for block in [
        Block::line([0.02, 0.02, 0.01], 0.05, 0.5),
        Block::line([0.01, 0.010_002, 0.01], 0.05, 0.5),
        Block::line([0.02, f64::NAN, 0.01], 0.05, 0.5),
        Block::arc([0, 1], [0.0, 0.0], 0.5, 0.05, 0.5),
        Block::arc([1, 2], [0.0, 0.0], 0.5, 0.05, 0.5),
    ] {
        assert_eq!(check(&block), refused, "{block:?}");
    }
    let end = check(&Block::line([0.02, 0.01, 0.01], 0.05, 0.5)).unwrap();
    assert_eq!(end, [Position::from_m(0.02).unwrap(), start[1], start[2]]);
    assert!(check(&Block::arc([0, 2], [0.0, 0.0], 0.5, 0.05, 0.5)).is_ok());
    // 1 nm is what rounding may make of it.
    let from_zero = |m| path.check(&Block::line([0.01, m, 0.0], 0.05, 0.5), [Position(0); 3], &[false; 3]);
    assert!(from_zero(1e-9).is_ok() && from_zero(-1e-9).is_ok());
    assert_eq!((from_zero(1.1e-9), from_zero(-1.1e-9)), (refused, refused));
    assert!(path.is_done());
}

/// A limit switch at the end of the second motor holds the first, too, and lets it back.
#[test]
fn the_limit_switches_of_both_ends_hold_the_beam() {
    let off = [false; 2];
    for (switch, to_m) in [([true, false], -0.01), ([false, true], 0.01)] {
        for (first, second) in [(switch, off), (off, switch), (switch, switch)] {
            let mut path = Path::<2>::new([Position(0); 2], 4000.0);
            path.set_second_motors([None, Some(0)]);
            path.set_blocked([first, second]);
            let block = |to_m| Block::line([to_m, 0.0], 0.05, 0.5);
            assert_eq!(path.push(&block(to_m)), Err(PathError::LimitSwitch { axis: 0 }));
            assert_eq!(path.push(&block(-to_m)), Ok(()));
        }
    }
}

/// Without references the present difference of the motors can be taken as that without skew. With references it is not: skew is measured from
/// the square beam.
#[test]
fn a_difference_is_taken_as_no_skew_without_references_only() {
    let mut machine = Machine::<Fixed, 2>::new(RATES, &settings(0.0), [Position(0); 2]).unwrap();
    let readings = [0, 1000].map(|units| Reading { motor: Position(units), table: None });
    let mut skew = |change: fn(&mut Machine<Fixed, 2>)| {
        machine.tick(&readings);
        change(&mut machine);
        machine.tick(&readings);
        machine.skew(1)
    };
    assert_eq!(skew(Machine::set_skew_zero), Some(1000));
    assert_eq!(skew(|machine| machine.lose_reference(0)), Some(1000));
    assert_eq!(skew(Machine::set_skew_zero), Some(0));
}

/// Neither the gantry nor its first motor is changed while the machine is configured; a second motor has no soft limits of its own.
#[test]
fn a_gantry_is_made_with_the_machine() {
    let both = settings(0.0);
    let mut machine = Machine::<Fixed, 2>::new(RATES, &both, [Position(0); 2]).unwrap();
    let alone = AxisSettings { gantry: None, ..both[1] };
    let error = MachineError::Config { axis: 1, error: ConfigError::NotWhileRunning("gantry") };
    assert_eq!(machine.change(1, &alone), Err(error));
    assert_eq!(
        (machine.first_motor(1), machine.second_motor(0), machine.other_motor(0)),
        (Some(0), Some(1), Some(1))
    );
    assert_eq!((machine.first_motor(0), machine.second_motor(1), machine.first_motor(5)), (None, None, None));
    assert_eq!(machine.change(1, &AxisSettings { position_gain_per_s: 20.0, ..both[1] }), Ok(()));
}
