//! A force model that is set or switched in motion, at rest, and with another origin.

use super::force::{SLOW, settings};
use super::*;

/// A model that is set during motion, again or for the first time, with and without a lag: the filtered motion, the bristles and the tables
/// start where they are, so that the force goes on as if nothing had been set.
#[test]
fn a_model_that_is_set_in_motion_goes_on() {
    for (lag_s, is_first) in [(0.0, false), (0.02, false), (0.0, true), (0.02, true)] {
        let model = ForceModel {
            table_mass_kg: 100.0,
            friction: TableFriction {
                coulomb_n: 100.0,
                presliding_stiffness_n_per_m: Some(50e6),
                ..TableFriction::default()
            },
            load: Some(points(-0.3, 0.01, |x| 1000.0 * x)),
            lag_s,
            ..ForceModel::default()
        };
        let settings = settings(model);
        let none = CompensationSettings::default();
        let mut untouched = TwoAxes::<Fixed>::new([&settings, &none]);
        let mut plant = TwoAxes::new([if is_first { &none } else { &settings }, &none]);
        let mut worst = 0.0f64;
        for k in 1..4000 {
            let t = f64::from(k) / RATE_HZ;
            // 0.05 m/s: a steady motion after 0.2 s of acceleration.
            let x = if t < 0.2 { 0.125 * t * t } else { 0.005 + 0.05 * (t - 0.2) };
            if k == 3000 {
                plant.all.replace(0, &AxisCompensation::new(&settings, RATES, FIRST_AXIS).unwrap());
            }
            for plant in [&mut plant, &mut untouched] {
                plant.tick([x, 0.0], [x, 0.0]);
            }
            if k >= 3000 || !is_first {
                worst = worst.max((plant.added[2][0] - untouched.added[2][0]).abs());
            }
        }
        // The load is evaluated at the setting, not in its turn.
        assert!(worst < 0.05, "lag {lag_s}, first: {is_first}: {worst} N");
        assert!(plant.added[2][0] > 120.0);
    }
}

type Jump = fn(&mut Compensation<Fixed, 2>);

/// A jump of the command has no force where the machine rests there, or where it is one of the origin: 100 kg would need 64 kN for 0.04 mm in
/// a tick. Without the call it has one.
#[test]
fn a_jump_of_the_command_at_rest_or_of_the_origin_has_no_force() {
    let model = ForceModel { table_mass_kg: 100.0, ..ForceModel::default() };
    let settings = settings(model);
    let cases: [(Jump, f64); 3] = [
        (|all| all.rest_at(&[position(0.010_04), position(0.0)]), 0.0),
        (|all| all.shift(0, position(4e-5) - position(0.0)), 0.0),
        (|_| (), 1000.0),
    ];
    for (jump, expected_n) in cases {
        let mut plant = TwoAxes::<Fixed>::new([&settings, &CompensationSettings::default()]);
        plant.settle([0.0; 2], [0.01, 0.0]);
        assert!(plant.added[2][0].abs() < 1e-9);
        jump(&mut plant.all);
        let mut greatest = 0.0f64;
        for _ in 0..10 {
            plant.tick([0.010_04, 0.0], [0.010_04, 0.0]);
            greatest = greatest.max(plant.added[2][0]);
        }
        // In a tick the force changes by 1000 N at most.
        assert!((greatest - expected_n).abs() < 1.0, "{greatest} N instead of {expected_n} N");
    }
}

/// A model that was switched off, with nothing else that is computed, goes on where the motion is when it is switched on.
#[test]
fn a_model_that_was_switched_off_follows_the_motion() {
    let friction = TableFriction { viscous_n_s_per_m: 800.0, ..TableFriction::default() };
    let settings =
        settings(ForceModel { table_mass_kg: 100.0, friction, lag_s: 0.02, ..ForceModel::default() });
    let none = CompensationSettings::default();
    let [mut plant, mut untouched] = [(), ()].map(|()| TwoAxes::<Fixed>::new([&settings, &none]));
    for k in 1..3000 {
        let [x, ..] = SLOW.at(f64::from(k) / RATE_HZ);
        if k == 100 || k == 2000 {
            plant.all.switch(0, CompensationKind::Force, k == 2000);
        }
        for plant in [&mut plant, &mut untouched] {
            plant.tick([x, 0.0], [x, 0.0]);
        }
        // The same bits, once the force has come back at its rate, 1000 N a tick.
        assert!(
            k < 2001 || plant.added[2].map(f64::to_bits) == untouched.added[2].map(f64::to_bits),
            "{k}: {:?} {:?}",
            plant.added,
            untouched.added
        );
    }
    assert!(untouched.added[2][0].abs() > 10.0);
}

/// A machine that starts at 0.1 m has no motion from zero to there.
#[test]
fn a_machine_starts_at_its_position() {
    let settings = settings(ForceModel { table_mass_kg: 100.0, ..ForceModel::default() });
    let start = [position(0.1), position(0.0)];
    let mut all = Compensation::<Fixed, 2>::none(start);
    all.replace(0, &AxisCompensation::new(&settings, RATES, FIRST_AXIS).unwrap());
    for _ in 0..5 {
        all.commands(&start);
        let forces = all.forces(&start.map(|motor| Reading { motor, table: None }));
        assert_eq!(forces, [Fixed::ZERO; 2]);
    }
}
