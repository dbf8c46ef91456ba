//! The frequency response of the simulated machine, measured on the emulated board.

use std::f64::consts::{PI, TAU};
use std::fs;
use std::thread::sleep;
use std::time::Duration;

use nalgebra::Complex;
use serde_json::Value;

use super::emulated_board::EmulatedBoard;

/// Masses, stiffness, damping and friction of an axis of the bench (`firmware/src/bench/axis.rs`): kg, N/m, N·s/m, N.
const MOTOR_KG: f64 = 6.0;
const TABLE_KG: f64 = 9.0;
const STIFFNESS: f64 = 50e6;
const DAMPING: f64 = 5000.0;
const VISCOUS: f64 = 100.0;
const COULOMB_N: f64 = 20.0;

/// Time of a step of the bench, s. It computes velocities first and moves by the new ones (semi-implicit Euler): under a constant force F a
/// mass m moves by F·h²/m in the first step and not by F·h²/2m, so that its positions are half a step ahead of those of the equations.
const STEP_S: f64 = 12.5e-6;

/// Sum of the amplitudes at once, N, in groups of four tones.
const FORCE_N: f64 = 100.0;
const AT_ONCE: usize = 4;

/// Velocity of the motor per force of two masses on a spring, as the bench computes it, and velocity of the table per velocity of the motor,
/// with a viscous friction of the table.
fn plant(frequency_hz: f64, viscous: f64) -> [Complex<f64>; 2] {
    let s = Complex::new(0.0, TAU * frequency_hz);
    let spring = DAMPING * s + STIFFNESS;
    let table = TABLE_KG * s * s + viscous * s + spring;
    let ahead = Complex::from_polar(1.0, 0.5 * s.im * STEP_S);
    [ahead * s * table / ((MOTOR_KG * s * s + spring) * table - spring * spring), spring / table]
}

/// A measured tone.
struct Tone {
    frequency_hz: f64,
    plant: Complex<f64>,
    open_loop: Complex<f64>,
}

impl Tone {
    fn of(tone: &Value) -> Self {
        let complex = |key: &str| {
            let number = |part: &str| tone[key][part].as_f64().unwrap();
            Complex::from_polar(number("magnitude"), number("phase_deg").to_radians())
        };
        assert!(tone["coherence"].as_f64().unwrap() > 0.9, "{tone}");
        Self {
            frequency_hz: tone["frequency_hz"].as_f64().unwrap(),
            plant: complex("plant_m_per_s_per_n"),
            open_loop: complex("open_loop"),
        }
    }

    /// The deviation from two masses on a spring.
    fn off(&self, viscous: f64) -> f64 {
        (self.plant / plant(self.frequency_hz, viscous)[0] - 1.0).norm()
    }
}

/// The viscous friction that takes the same force from a table with many tones as its Coulomb friction F does: F·√(2/π)/σ with the effective
/// velocity σ (statistical linearisation; A. Gelb and W. E. Vander Velde, *Multiple-Input Describing Functions*, 1968, chapter 2).
fn equivalent_viscous(tones: &[&Tone]) -> f64 {
    let mut viscous = VISCOUS;
    for _ in 0..30 {
        let power: f64 = tones
            .iter()
            .map(|tone| {
                let force_n = FORCE_N / tones.len() as f64 / (1.0 + tone.open_loop);
                0.5 * (tone.plant * force_n * plant(tone.frequency_hz, viscous)[1]).norm_sqr()
            })
            .sum();
        viscous = VISCOUS + COULOMB_N * (2.0 / PI).sqrt() / power.sqrt();
    }
    viscous
}

/// Above the resonance the plant is that of masses and spring alone; a rigid axis of the same mass is far from it. At the lowest tone of each
/// group, which moves the table most, it is that with the friction of the table besides; without friction it is far from it.
#[test]
fn the_response_is_that_of_the_masses_the_spring_and_the_friction() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let text = board.succeeds(&format!(
        "board response --port bench --axis y --from-hz 10 --to-hz 2000 --force-n {FORCE_N} --tones 28 --at-once {AT_ONCE} --periods 2 \
         --out frf.json --yes"
    ));
    println!("{text}");
    let file: Value =
        serde_json::from_str(&fs::read_to_string(board.path().join("frf.json")).unwrap()).unwrap();
    assert_eq!((file["version"].as_u64(), file["conditions"]["axis"].as_str()), (Some(1), Some("y")));
    let tones: Vec<Tone> = file["tones"].as_array().unwrap().iter().map(Tone::of).collect();
    let fast: Vec<&Tone> = tones.iter().filter(|tone| tone.frequency_hz > 700.0).collect();
    assert!(fast.len() >= 4);
    for tone in fast {
        let rigid = 1.0 / Complex::new(0.0, TAU * tone.frequency_hz * (MOTOR_KG + TABLE_KG));
        let (off, off_rigid) = (tone.off(VISCOUS), (tone.plant / rigid - 1.0).norm());
        assert!(off < 0.09 && off_rigid > 1.3, "{} Hz: {off} {off_rigid}", tone.frequency_hz);
    }
    let groups = tones.len().div_ceil(AT_ONCE);
    for group in 0..groups {
        let group: Vec<&Tone> = tones.iter().skip(group).step_by(groups).collect();
        let viscous = equivalent_viscous(&group);
        let (off, off_without) = (group[0].off(viscous), group[0].off(VISCOUS));
        println!("{:6.1} Hz: {viscous:.0} N·s/m, {off:.3}, {off_without:.3}", group[0].frequency_hz);
        assert!(off < 0.15 && off_without > 0.7, "{} Hz: {off} {off_without}", group[0].frequency_hz);
    }
    let natural = (STIFFNESS * (1.0 / MOTOR_KG + 1.0 / TABLE_KG)).sqrt() / TAU;
    let resonances = file["resonances"].as_array().unwrap();
    let is_it = |entry: &Value| (entry["frequency_hz"].as_f64().unwrap() / natural - 1.0).abs() < 0.15;
    assert!(resonances.iter().any(is_it), "{natural} Hz: {resonances:?}");
}

/// Beyond the envelope the board refuses it, with the name of the limit; what cannot be measured is an error of the option. A second program
/// sees the measurement and stops it.
#[test]
fn a_response_beyond_the_envelope_is_refused_and_another_program_stops_one() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let response = "board response --port bench --axis y";
    let refused = board.fails(1, &format!("{response} --force-n 121 --yes"));
    assert!(
        refused.contains("y: excitation_limit_n: 121 is above 120, the ceiling of this board"),
        "{refused}"
    );
    // Before the drives were switched on.
    board.status_with(&["drives: off; the enable switch permits an enable"]);
    for (options, option) in [
        ("--force-n 0", "--force-n"),
        ("--force-n 50 --from-hz 1", "--from-hz"),
        ("--force-n 50 --to-hz 9000", "--to-hz"),
        ("--force-n 50 --tones 1", "--tones"),
        ("--force-n 50 --periods 0", "--periods"),
        ("--force-n 50", "--yes"),
    ] {
        let refused = board.fails(2, &format!("{response} {options}"));
        assert!(refused.contains(option) && refused.trim().lines().count() == 1, "{refused}");
    }
    let first = board.start(&format!("{response} --force-n 50 --yes"));
    sleep(Duration::from_secs(3));
    let status = board.succeeds("board status --port bench");
    assert!(status.contains("path: frequency response"), "{status}");
    board.succeeds("board stop --port bench");
    let output = first.wait_with_output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && message.contains("another program has stopped"), "{message}");
    board.status_with(&["path: at rest"]);
}
