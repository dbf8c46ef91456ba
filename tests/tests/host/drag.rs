//! A drag that grows with the square of the velocity, in logs of motor and force alone. The logs are the equation of motion at a
//! known position, not a simulation.

use std::f64::consts::TAU;

use files::log::{AxisLog, Log, Unit};
use model::machine::Machine;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use trace::{Identification, trace};

const SAMPLE_S: f64 = 1e-3;
const MASS_KG: f64 = 95.0;
const COULOMB_N: f64 = 20.0;
const VISCOUS_N_S_PER_M: f64 = 200.0;

/// A log of 20 s at up to 0.43 m/s: two sines, with the force m·a + Fc·sign(v) + b·v + c·v·|v|, and noise of 0.5 N and 0.1 µm.
fn log(seed: u64, force_at_1_m_per_s: f64) -> Log {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut noise = || numerics::noise::sum_of_uniforms(&mut random);
    let phases = [noise(), noise()];
    let sines = [(0.08, 0.7), (0.03, 0.31)];
    // Position, velocity and acceleration.
    let motion = |t: f64| {
        sines.iter().zip(phases).fold([0.0; 3], |[x, v, a], ((size, hertz), phase)| {
            let (omega, angle) = (TAU * hertz, TAU * hertz * t + phase);
            [x + size * angle.sin(), v + size * omega * angle.cos(), a - size * omega * omega * angle.sin()]
        })
    };
    let (mut motor_mm, mut force_n) = (Vec::new(), Vec::new());
    for i in 0..20_000 {
        let t = SAMPLE_S * f64::from(i);
        motor_mm.push(1e3 * motion(t)[0] + 1e-4 * noise());
        // The force of a row is the mean of the interval that ends at the sample.
        let [_, v, a] = motion(t - 0.5 * SAMPLE_S);
        let friction_n = COULOMB_N * (v / 0.2e-3).tanh() + VISCOUS_N_S_PER_M * v;
        force_n.push(MASS_KG * a + friction_n + force_at_1_m_per_s * v * v.abs() + 0.5 * noise());
    }
    let mut axis = AxisLog::new("x", Unit::Millimetre);
    (axis.motor, axis.force) = (Some(motor_mm), Some(force_n));
    Log::new("x.csv", 0.0, SAMPLE_S, [axis])
}

fn traced(seed: u64, force_at_1_m_per_s: f64) -> Identification {
    let text = format!(
        "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\nmotor_mass_kg = 0.0\ntable_mass_kg = {MASS_KG:?}\ncoulomb_n = {COULOMB_N:?}\n\
         viscous_n_s_per_m = {VISCOUS_N_S_PER_M:?}\nplant_tolerance_percent = 10.0\n"
    );
    let machine = Machine::parse(&text, "m.toml").unwrap();
    let logs = [log(seed, force_at_1_m_per_s), log(seed + 100, force_at_1_m_per_s)];
    trace(&machine, &logs[..1], &logs[1..], &|_| {}).unwrap()
}

/// 150 N at 1 m/s are up to 28 N here, beside 20 N of dry and 86 N of viscous friction. What a tenth of the viscous friction, its
/// tolerance, may take of it is at most 8.6 N at one speed, but not at all of them: the value is known to a few percent.
#[test]
fn a_drag_is_found_with_its_size() {
    for seed in 0..3 {
        let trace = traced(seed, 150.0);
        let names: Vec<&str> = trace.axes()[0].found.iter().map(|found| found.effect.name()).collect();
        assert_eq!(names, ["quadratic_drag"], "{seed}");
        let found = &trace.axes()[0].found[0];
        let (value_n, half_n) = (found.effect.values()[0], found.half_widths[0]);
        assert!((value_n - 150.0).abs() < half_n && half_n < 7.5, "{seed}: {value_n} ± {half_n} N");
    }
}

#[test]
fn no_drag_is_found_where_there_is_none() {
    for seed in 0..10 {
        assert!(traced(seed, 0.0).axes()[0].found.is_empty(), "{seed}");
    }
}
