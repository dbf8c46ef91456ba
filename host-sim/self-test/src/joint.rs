//! The kind `joint`: rotary axes, of which one has a gear with hysteresis, or is loaded by gravity.
//!
//! A metre of the simulated machine is 1000°, a newton is a newton metre: only the files have degrees and radians.

use std::f64::consts::{PI, TAU};

use files::log::{Log, Unit};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

use super::draw::{Declared, Drawn, one_of};
use super::effect::sinusoid_um;
use super::machine::AXES;
use super::plant::{Mechanics, SLIPPING, Sinusoid, Slipping};
use super::truth::Truth;

/// Torsion at which each element of a gear slips, in multiples of its travel: the quantiles 1/24, 3/24 to 23/24 of the distribution x·exp(−x). Infinitely
/// many such elements carry 1 − exp(−torsion/travel) of their torque.
pub const SLIPS_AT: [f64; SLIPPING] =
    [0.321, 0.609, 0.847, 1.075, 1.305, 1.549, 1.815, 2.118, 2.479, 2.94, 3.607, 4.964];
/// Radians of a simulated metre.
const RAD_PER_M: f64 = 1e3 * PI / 180.0;
/// Simulated metres of a turn.
const TURN_M: f64 = 0.36;

/// Draws what one joint has, sets it in the true values, and makes the machine file that of rotary axes.
pub fn draw(machine: &mut Drawn, index: usize, random: &mut ChaCha8Rng) -> Vec<Truth> {
    let lead_mm = machine.declared[index].lead_mm;
    let subject = one_of(&["gravity", "gear", "strain_wave_gear"], random);
    let mechanics = &mut machine.axes[index].mechanics;
    let mut extras = Vec::new();
    if subject == "gravity" {
        extras.push(("joint_gravity", gravity(mechanics, random)));
    } else {
        let softer = random.random_range(0.3..0.6);
        mechanics.stiffness_n_per_m *= softer;
        soften(&mut machine.declared[index], softer);
        extras.push(("gear_hysteresis", hysteresis(mechanics, random)));
    }
    if subject == "strain_wave_gear" {
        let (amplitude_um, period_mm) = (random.random_range(1.0..4.0), 0.5 * lead_mm);
        mechanics.screw_waves = vec![sinusoid_um(amplitude_um, period_mm, random.random_range(0.0..TAU))];
        extras.push(("gear_error", vec![("amplitude_um", amplitude_um), ("period_mm", period_mm)]));
    }
    for declared in &mut machine.declared {
        declared.text = rotary_text(&declared.text);
    }
    let truth =
        |(name, parameters)| Truth { name, axis: AXES[index], parameters, reference: None, phase_rad: 0.0 };
    extras.into_iter().map(truth).collect()
}

/// A lever with a weight, at some angle.
fn gravity(mechanics: &mut Mechanics, random: &mut ChaCha8Rng) -> Vec<(&'static str, f64)> {
    let (torque_nm, phase) = (random.random_range(50.0..200.0), random.random_range(0.0..TAU));
    mechanics.load_wave = Sinusoid { amplitude: torque_nm, period: TURN_M, phase };
    vec![("sine_n", torque_nm * libm::cos(phase)), ("cosine_n", torque_nm * libm::sin(phase))]
}

/// 30 to 80 % of the Coulomb friction, within 0.5 to 1.5 times the torsion under it.
fn hysteresis(mechanics: &mut Mechanics, random: &mut ChaCha8Rng) -> Vec<(&'static str, f64)> {
    let torque_nm = random.random_range(0.3..0.8) * mechanics.coulomb_n;
    let travel_m = random.random_range(0.5..1.5) * mechanics.coulomb_n / mechanics.stiffness_n_per_m;
    mechanics.slipping = slipping(torque_nm, travel_m);
    vec![("force_n", torque_nm), ("travel_um", 1e6 * travel_m)]
}

/// The elements of a gear with a torque, N·m, within a travel, m.
#[must_use]
pub fn slipping(torque_nm: f64, travel_m: f64) -> [Slipping; SLIPPING] {
    let limit_n = torque_nm / SLIPPING as f64;
    SLIPS_AT.map(|slips_at| Slipping { stiffness_n_per_m: limit_n / (slips_at * travel_m), limit_n })
}

/// The declared stiffness, with that of a gear for that of a screw.
fn soften(declared: &mut Declared, softer: f64) {
    let line = |stiffness: f64| format!("\nstiffness_n_per_um = {stiffness}\n");
    let before = line(declared.stiffness_n_per_um);
    declared.stiffness_n_per_um *= softer;
    declared.text = declared.text.replacen(&before, &line(declared.stiffness_n_per_um), 1);
}

/// Keys of a linear axis that a rotary one has under another name, and the factor of their values.
const ROTARY_KEYS: [(&str, &str, f64); 12] = [
    ("motor_mass_kg", "motor_inertia_kg_m2", 1.0 / RAD_PER_M),
    ("table_mass_kg", "table_inertia_kg_m2", 1.0 / RAD_PER_M),
    ("stiffness_n_per_um", "stiffness_nm_per_rad", 1e6 / RAD_PER_M),
    ("presliding_stiffness_n_per_um", "presliding_stiffness_nm_per_rad", 1e6 / RAD_PER_M),
    ("damping_n_s_per_m", "damping_nm_s_per_rad", 1.0 / RAD_PER_M),
    ("viscous_n_s_per_m", "viscous_nm_s_per_rad", 1.0 / RAD_PER_M),
    ("presliding_damping_n_s_per_m", "presliding_damping_nm_s_per_rad", 1.0 / RAD_PER_M),
    ("velocity_gain_n_s_per_m", "velocity_gain_nm_s_per_rad", 1.0 / RAD_PER_M),
    ("coulomb_n", "coulomb_nm", 1.0),
    ("motor_coulomb_n", "motor_coulomb_nm", 1.0),
    ("force_limit_n", "torque_limit_nm", 1.0),
    ("lead_mm", "lead_deg", 1.0),
];

/// The table of a rotary axis in a machine file, from that of a linear axis in simulated metres.
fn rotary_text(linear: &str) -> String {
    let line = |line: &str| {
        let (key, value) = line.split_once(" = ")?;
        let (_, rotary, factor) = ROTARY_KEYS.iter().find(|(linear, ..)| *linear == key)?;
        Some(format!("{rotary} = {}\n", factor * value.parse::<f64>().ok()?))
    };
    linear.lines().map(|text| line(text).unwrap_or_else(|| format!("{text}\n"))).collect()
}

/// The log with its positions as degrees. The numbers stay.
pub fn in_degrees(log: &mut Log) {
    for axis in &mut log.axes {
        axis.unit = Unit::Degree;
    }
}

/// Ends of the keys of results, of linear and of rotary axes; none is the end of a later one.
const KEY_ENDS: [[&str; 2]; 13] = [
    ["um_per_m2", "mdeg_per_kdeg2"],
    ["um_per_m", "mdeg_per_kdeg"],
    ["um_s2_per_m", "mdeg_s2_per_kdeg"],
    ["um_per_min", "mdeg_per_min"],
    ["n_per_m2", "nm_per_kdeg2"],
    ["n_per_m", "nm_per_kdeg"],
    ["n_s_per_m", "nm_s_per_kdeg"],
    ["n_per_um", "nm_per_mdeg"],
    ["mm_s", "deg_s"],
    ["um", "mdeg"],
    ["n", "nm"],
    ["mm", "deg"],
    ["n_per_c", "nm_per_c"],
];

/// Results with the keys of linear axes for those of rotary ones. The numbers are the same.
#[must_use]
pub fn with_linear_keys(results: &Value) -> Value {
    renamed(results, &KEY_ENDS.map(|[linear, rotary]| [rotary, linear]))
}

/// A truth with the keys of rotary axes for those of linear ones.
#[must_use]
pub fn with_rotary_keys(truth: &Value) -> Value {
    renamed(truth, &KEY_ENDS)
}

fn renamed(value: &Value, ends: &[[&str; 2]]) -> Value {
    let key = |key: &str| {
        let is_end = |stem: &str| stem.is_empty() || stem.ends_with('_');
        let renamed = |[from, to]: &[&str; 2]| {
            key.strip_suffix(from).filter(|stem| is_end(stem)).map(|stem| format!("{stem}{to}"))
        };
        ends.iter().find_map(renamed).unwrap_or_else(|| key.to_owned())
    };
    match value {
        Value::Object(entries) => {
            entries.iter().map(|(name, entry)| (key(name), renamed(entry, ends))).collect()
        }
        Value::Array(entries) => entries.iter().map(|entry| renamed(entry, ends)).collect(),
        other => other.clone(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::super::case::Case;
    use super::super::kind::Kind;
    use super::*;

    /// 90 kg of a carriage are 90 N·m per 1000°/s², which are 17.45 rad/s²: 5.157 kg·m². A spring of 1 N/µm is one of 1e6 N·m per 17.45 rad.
    #[test]
    fn a_machine_file_of_joints_has_their_units() {
        let text =
            rotary_text("controller = \"p\"\ntable_mass_kg = 90\nstiffness_n_per_um = 1\nlead_mm = 10\n");
        let lines: Vec<&str> = text.lines().collect();
        let value = |line: &str, key: &str| line.strip_prefix(key).unwrap().parse::<f64>().unwrap();
        assert_eq!((lines[0], lines[3]), ("controller = \"p\"", "lead_deg = 10"));
        assert!((value(lines[1], "table_inertia_kg_m2 = ") - 5.156_62).abs() < 1e-5, "{text}");
        assert!((value(lines[2], "stiffness_nm_per_rad = ") - 57_295.78).abs() < 0.01, "{text}");
    }

    #[test]
    fn keys_of_results_are_renamed_and_back() {
        let linear = json!({"a": [{"amplitude_um": 1, "period_mm": 2, "noise_n": 3, "slope_n_per_m": 4}], "um_per_m": 5, "name": 6, "ms": 7});
        let rotary = json!({"a": [{"amplitude_mdeg": 1, "period_deg": 2, "noise_nm": 3, "slope_nm_per_kdeg": 4}], "mdeg_per_kdeg": 5, "name": 6, "ms": 7});
        assert_eq!(with_rotary_keys(&linear), rotary);
        assert_eq!(with_linear_keys(&rotary), linear);
    }

    #[test]
    fn cases_are_rotary_and_have_each_subject() {
        let mut seen = std::collections::BTreeSet::new();
        for number in 1..=10 {
            let case = Case::draw_kind(Kind::Joint, 3, number).unwrap();
            assert!(case.machine_text.contains("table_inertia_kg_m2"), "{}", case.machine_text);
            assert!(case.fit.iter().flat_map(|log| &log.axes).all(|axis| axis.unit == Unit::Degree));
            seen.extend(case.extras.iter().map(|extra| extra.name));
        }
        assert_eq!(seen, ["gear_error", "gear_hysteresis", "joint_gravity"].into());
    }
}
