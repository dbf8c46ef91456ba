//! Axes on rigid bodies in closed loop, against the statics of the structure and against an axis without bodies.

use super::*;
use crate::instruments::Instruments;
use crate::simulate::{self, Run};
use files::log::Log;
use model::machine::Machine;
use motion::{PathBlock, PathShape};
use shared::scalar::Format;

const MACHINE: &str = model::examples::BODIES_MACHINE;

/// Two turns of a circle of 40 mm radius in x and z at 0.2 m/s: 1 m/s² at 0.8 Hz, far below every mode. Then two turns
/// back: the friction of one axis tilts the tool in phase with the acceleration of the other, with a sign that depends
/// on the direction of rotation.
fn circle() -> (Machine, Log) {
    run(MACHINE, 0.2, 2.0)
}

fn run(machine: &str, feed_m_per_s: f64, turns: f64) -> (Machine, Log) {
    let machine = Machine::parse(machine, "bodies.toml").unwrap();
    let start_m = [0.04, 0.0, 0.0];
    let round = |turns| PathShape::Arc { plane: [0, 2], centre_m: [0.0, 0.0], turns };
    let blocks = [turns, -turns].map(|turns| PathBlock::new(round(turns), feed_m_per_s, 2.0));
    let mut controller = simulate::controller(&machine, Format::F64, &start_m).unwrap();
    let instruments = Instruments { drive_time_constant_s: 1e-4, ..Instruments::default() };
    let run = Run { machine: &machine, instruments, start_m: &start_m, blocks: &blocks, start_s: 0.0 };
    let log = run.log(controller.as_mut(), |_, _, _| ()).unwrap();
    (machine, log)
}

/// Samples of a slow half circle, out and back: on the machine as it is, and with keys and effects of x; while x
/// moves forwards, and backwards. A sample is table − motor (µm), force (N) and motor (mm).
fn samples(keys: &str, effect: &str) -> [[Vec<[f64; 3]>; 2]; 2] {
    let with = MACHINE.replacen("[axis.x]", &format!("[axis.x]\n{keys}"), 1) + effect;
    [MACHINE, &with].map(|machine| {
        let (_, log) = run(machine, 0.02, 0.5);
        let x = &log.axes[0];
        let [motor, table, force] = [&x.motor, &x.table, &x.force].map(|channel| channel.as_ref().unwrap());
        [1.0, -1.0].map(|sign| {
            // Above 10 of 20 mm/s.
            let moves = |i: &usize| sign * (motor[i + 1] - motor[i - 1]) / 2e-3 > 10.0;
            let row = |i: usize| [1e3 * (table[i] - motor[i]), force[i], motor[i]];
            (1..motor.len() - 1).filter(moves).map(row).collect()
        })
    })
}

fn mean(rows: &[[f64; 3]], column: usize) -> f64 {
    numerics::mean(rows.iter().map(|row| row[column]))
}

/// One body on a guide that is driven through its centre of gravity moves as the axis of [`crate::mechanics`]. Both use
/// the means of friction and lag over a step.
#[test]
fn a_body_on_a_guide_moves_as_an_axis_without_bodies() {
    let axis = "name = \"a\"\nsample_rate_hz = 1000.0\nvelocity_loop_rate_hz = 4000.0\n\
        [axis.x]\ncontroller = \"p\"\nposition_gain_per_s = 40.0\nvelocity_gain_n_s_per_m = 80000.0\n\
        velocity_integral_time_s = 0.02\nforce_limit_n = 15000.0\nfeedback = \"motor\"\nmotor_mass_kg = 120.0\n\
        table_mass_kg = 250.0\nstiffness_n_per_um = 200.0\ndamping_n_s_per_m = 12000.0\nmotor_coulomb_n = 40.0\n\
        viscous_n_s_per_m = 1500.0\n";
    let body = "[structure.body.table]\nmass_kg = 250.0\ninertia_kg_m2 = [5.0, 5.0, 5.0, 0.0, 0.0, 0.0]\n\
        centre_mm = [0.0, 0.0, 0.0]\n[[structure.joint]]\nkind = \"guideway\"\nfrom = \"ground\"\nto = \"table\"\n\
        at_mm = [[-200.0, -200.0, 0.0], [200.0, -200.0, 0.0], [-200.0, 200.0, 0.0], [200.0, 200.0, 0.0]]\n\
        stiffness_n_per_um = [0.0, 500.0, 500.0]\n[structure.axis.x]\nfrom = \"ground\"\nto = \"table\"\n\
        direction = [1.0, 0.0, 0.0]\nat_mm = [0.0, 0.0, 0.0]\nscale_at_mm = [0.0, 0.0, 0.0]\nmotor_mass_kg = 120.0\n\
        stiffness_n_per_um = 200.0\ndamping_n_s_per_mm = 12.0\n[structure.tool]\nbody = \"table\"\n\
        at_mm = [0.0, 0.0, 0.0]\n[structure.workpiece]\nbody = \"ground\"\nat_mm = [0.0, 0.0, 0.0]\n";
    let sliding =
        "coulomb_n = 250.0\npresliding_stiffness_n_per_um = 40.0\npresliding_damping_n_s_per_m = 2000.0\n";
    let gap = "coulomb_n = 250.0\npresliding_stiffness_n_per_um = 40.0\npresliding_damping_n_s_per_m = 2000.0\n\
        [[axis.x.effect]]\nname = \"backlash\"\nwidth_um = 8.0\n";
    let effects = "coulomb_n = 250.0\n[[axis.x.effect]]\nname = \"pitch_cyclic\"\namplitude_um = 2.0\nperiod_mm = 5.0\n\
        phase_rad = 0.4\n[[axis.x.effect]]\nname = \"torque_ripple\"\namplitude_n = 30.0\nperiod_mm = 4.0\n\
        phase_rad = 0.0\n[[axis.x.effect]]\nname = \"constant_load\"\nforce_n = 90.0\n\
        [[axis.x.effect]]\nname = \"friction_asymmetry\"\nhalf_difference_n_s_per_m = 200.0\n";
    // The gap opens and closes up to a step of 80 µs apart, at some mm/s.
    for (extra, bound_nm) in [("coulomb_n = 250.0\n", 1.0), (sliding, 1.0), (gap, 40.0), (effects, 1.0)] {
        let run = |machine: &str| {
            let machine = Machine::parse(machine, "one.toml").unwrap();
            let line = |to_m: f64| PathBlock::new(PathShape::Line { to_m: vec![to_m] }, 0.04, 1.0);
            let blocks = [line(0.02), PathBlock::dwell(0.2), line(-0.01)];
            let mut controller = simulate::controller(&machine, Format::F64, &[0.0]).unwrap();
            let instruments = Instruments { drive_time_constant_s: 5e-4, ..Instruments::default() };
            let run = Run { machine: &machine, instruments, start_m: &[0.0], blocks: &blocks, start_s: 0.0 };
            run.log(controller.as_mut(), |_, _, _| ()).unwrap().axes.remove(0)
        };
        let (alone, with_body) = (format!("{axis}{extra}"), format!("{axis}{extra}{body}"));
        let [alone, with_body] = [alone, with_body].map(|machine| run(&machine).table.unwrap());
        let distance_nm = numerics::max_abs(alone.iter().zip(&with_body).map(|(a, b)| 1e6 * (a - b)));
        assert!(distance_nm < bound_nm, "{distance_nm} nm apart with {extra}");
        assert!(alone.iter().any(|mm| *mm > 19.0));
    }
}

fn is_near(found: f64, expected: f64, tolerance: f64) -> bool {
    (found - expected).abs() <= tolerance * expected.abs()
}

/// At a reversal sliding friction F changes the force by 2F and the stretch of the screw by 2F/k. Backlash changes
/// table − motor by its width.
#[test]
fn friction_and_backlash_reverse_with_the_direction() {
    let change = |rows: &[Vec<[f64; 3]>; 2], column| mean(&rows[0], column) - mean(&rows[1], column);
    // The speed is steady within some per mille.
    let [without, with] = samples("coulomb_n = 300.0", "");
    let (stretch_um, force_n) =
        (change(&with, 0) - change(&without, 0), change(&with, 1) - change(&without, 1));
    assert!(is_near(force_n, 600.0, 0.01), "{force_n} N");
    assert!(is_near(stretch_um, -600.0 / 150.0, 0.01), "{stretch_um} µm");
    let soft = "[[axis.x.effect]]\nname = \"windup\"\nstiffness_n_per_um = 75.0\n";
    let [_, soft] = samples("coulomb_n = 300.0", soft);
    let stretch_um = change(&soft, 0) - change(&with, 0);
    // The viscous friction stretches the softer screw more, too.
    let viscous_n = change(&without, 0) * -150.0;
    assert!(is_near(stretch_um, -(600.0 + viscous_n) * (1.0 / 75.0 - 1.0 / 150.0), 0.01), "{stretch_um} µm");
    let gap = "[[axis.x.effect]]\nname = \"backlash\"\nwidth_um = 12.0\n";
    let [without, with] = samples("", gap);
    let lost_um = change(&with, 0) - change(&without, 0);
    assert!(is_near(lost_um, -12.0, 0.01), "{lost_um} µm");
    let force_n = change(&with, 1) - change(&without, 1);
    assert!(force_n.abs() < 5.0, "{force_n} N");
}

#[test]
fn a_pitch_error_shows_as_a_slope_of_table_over_motor() {
    let lead = "[[axis.x.effect]]\nname = \"pitch_progressive\"\nslope_um_per_m = 200.0\n";
    let [without, with] = samples("", lead);
    for (without, with) in without.iter().zip(&with) {
        let slope = |rows: &[[f64; 3]]| {
            let (mean_um, mean_mm) = (mean(rows, 0), mean(rows, 2));
            let products = rows.iter().map(|row| (row[0] - mean_um) * (row[2] - mean_mm)).sum::<f64>();
            1e3 * products / rows.iter().map(|row| (row[2] - mean_mm).powi(2)).sum::<f64>()
        };
        let slope = slope(with) - slope(without);
        assert!(is_near(slope, 200.0, 0.01), "{slope} µm/m");
    }
}

/// The offset of the tool per acceleration is that of the statics of the structure. 0.8 Hz below the lowest mode of
/// some 30 Hz amplify it by (0.8/30)² < 0.1 %; the stretch of the screws by friction is measured by the scales.
#[test]
fn an_acceleration_tilts_the_tool_as_the_statics_say() {
    let (machine, log) = circle();
    let statics = Assembly::of(machine.structure.as_ref().unwrap()).unwrap().talk_at_rest().unwrap();
    let tilt_um = |axis: usize| -> Vec<f64> {
        let axis = &log.axes[axis];
        let pairs = axis.tool.as_ref().unwrap().iter().zip(axis.table.as_ref().unwrap());
        pairs.map(|(tool, table)| 1e3 * (tool - table)).collect()
    };
    let acceleration = |axis: usize| -> Vec<f64> {
        let table = log.axes[axis].table.as_ref().unwrap();
        // Over 40 ms, 0.2 rad of the circle: 0.3 % less.
        (20..table.len() - 20).map(|i| (table[i + 20] - 2.0 * table[i] + table[i - 20]) / 0.4).collect()
    };
    let (x, z) = (acceleration(0), acceleration(2));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for axis in [0, 2] {
        let tilt = tilt_um(axis);
        let tilt = &tilt[20..tilt.len() - 20];
        let (xx, xz, zz) = (dot(&x, &x), dot(&x, &z), dot(&z, &z));
        let (xl, zl) = (dot(&x, tilt), dot(&z, tilt));
        let of_x = (xl * zz - zl * xz) / (xx * zz - xz * xz);
        let of_z = (zl * xx - xl * xz) / (xx * zz - xz * xz);
        for (found, cause) in [(of_x, 0), (of_z, 2)] {
            let expected = statics.tool_um_s2_per_m[(axis, cause)];
            let error = (found - expected).abs();
            assert!(error < 0.02 + 0.03 * expected.abs(), "{axis} by {cause}: {found} of {expected} µm·s²/m");
        }
    }
    assert!(statics.tool_um_s2_per_m[(0, 2)].abs() > 0.3, "the coupling is large enough to be measured");
}
