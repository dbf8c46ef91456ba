//! The undeclared effects of a drawn machine.

use std::f64::consts::TAU;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde_json::{Map, Value, json};

use super::draw::{Drawn, one_of};
use super::plant::{LocalDefect, Sinusoid};
use super::simulation::{AXES, Axis};

/// The effects that are drawn, with equal probability.
pub const NAMES: [&str; 17] = [
    "backlash",
    "pitch_progressive",
    "pitch_cyclic",
    "resolver_dividing",
    "windup",
    "stribeck",
    "friction_asymmetry",
    "torque_ripple",
    "constant_load",
    "servo_mismatch",
    "intalk",
    "crosstalk",
    "squareness",
    "straightness",
    "thermal_drift",
    "latency",
    "resonance",
];

/// Effects from outside the catalogue; the tracer should report them as unexplained.
pub const OUTSIDE: [&str; 2] = ["vibration", "local_defect"];

/// Probabilities of no, one, two and three effects.
const PROBABILITIES: [f64; 4] = [0.1, 0.45, 0.35, 0.1];
/// Probability of an effect from outside the catalogue, and probability that such a case has no other effect.
const OUTSIDE_PROBABILITY: f64 = 0.15;
const ALONE_PROBABILITY: f64 = 0.3;

/// A true effect of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Name, as in the results of a trace.
    pub name: &'static str,
    /// Name of its axis.
    pub axis: &'static str,
    /// In the units of a machine file, without phases.
    pub parameters: Vec<(&'static str, f64)>,
    /// `source` or `channel`, where the effect has one.
    pub reference: Option<(&'static str, &'static str)>,
}

impl Truth {
    /// Whether it is from outside the catalogue.
    #[must_use]
    pub fn is_outside(&self) -> bool {
        OUTSIDE.contains(&self.name)
    }

    /// A parameter's value.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<f64> {
        self.parameters.iter().find(|(key, _)| *key == name).map(|&(_, value)| value)
    }

    /// Its entry in `truth.json`.
    #[must_use]
    pub fn json(&self) -> Value {
        let mut entry = Map::new();
        entry.insert("name".to_owned(), json!(self.name));
        entry.insert("axis".to_owned(), json!(self.axis));
        if let Some((key, reference)) = self.reference {
            entry.insert(key.to_owned(), json!(reference));
        }
        entry.extend(self.parameters.iter().map(|&(key, value)| (key.to_owned(), json!(value))));
        Value::Object(entry)
    }
}

/// Draws the effects of a machine and sets them in its true values. No axis gets an effect twice, or one that hides
/// another.
pub fn draw_effects(machine: &mut Drawn, random: &mut ChaCha8Rng) -> Vec<Truth> {
    let mut share: f64 = random.random();
    let count = PROBABILITIES.iter().position(|part| {
        share -= part;
        share < 0.0
    });
    let mut count = count.unwrap_or(1);
    let outside = random.random_bool(OUTSIDE_PROBABILITY);
    if outside && random.random_bool(ALONE_PROBABILITY) {
        count = 0;
    }
    let mut truths: Vec<Truth> = Vec::new();
    while truths.len() < count {
        let name = one_of(&NAMES, random);
        // Squareness is declared on the first axis.
        let axis = if name == "squareness" { 0 } else { random.random_range(0..AXES.len()) };
        let conflicts = |truth: &Truth| truth.axis == AXES[axis] && excludes(truth.name, name);
        if !truths.iter().any(conflicts) {
            truths.push(effect(name, axis, machine, random));
        }
    }
    if outside {
        let name = one_of(&OUTSIDE, random);
        let axis = random.random_range(0..AXES.len());
        truths.push(outside_effect(name, axis, machine, random));
    }
    truths
}

/// Whether one effect on an axis hides the other: a load greater than the friction keeps the screw on one side of its
/// gap.
fn excludes(one: &str, other: &str) -> bool {
    let pair = [one, other];
    one == other || pair.contains(&"backlash") && pair.contains(&"constant_load")
}

/// Gives an axis one of [`NAMES`]. Its size is within about a factor of two of that in the blind cases, if they contain
/// the effect.
#[expect(clippy::too_many_lines, reason = "one arm per effect")]
fn effect(name: &'static str, index: usize, machine: &mut Drawn, random: &mut ChaCha8Rng) -> Truth {
    let declared = &machine.declared[index];
    let (lead_mm, pole_pairs) = (declared.lead_mm, f64::from(declared.pole_pairs));
    let stiffness = declared.stiffness_n_per_um;
    let axis = &mut machine.axes[index];
    let other = AXES[1 - index];
    let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
    let phase = random.random_range(0.0..TAU);
    let channel = one_of(&["table", "tool"], random);
    let order = f64::from(random.random_range(1..=6_u32));
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let mut reference = None;
    let parameters = match name {
        "backlash" => {
            let width = between(5.0, 20.0);
            axis.mechanics.backlash_m = 1e-6 * width;
            vec![("width_um", width)]
        }
        "pitch_progressive" => {
            let slope = sign * between(20.0, 100.0);
            axis.mechanics.pitch_slope = 1e-6 * slope;
            vec![("slope_um_per_m", slope)]
        }
        "pitch_cyclic" => {
            let amplitude = between(2.6, 10.0);
            axis.mechanics.pitch = sinusoid_um(amplitude, lead_mm, phase);
            vec![("amplitude_um", amplitude), ("period_mm", lead_mm)]
        }
        "resolver_dividing" => {
            let (amplitude, period) = (between(1.7, 6.8), lead_mm / pole_pairs);
            axis.resolver = sinusoid_um(amplitude, period, phase);
            vec![("amplitude_um", amplitude), ("period_mm", period)]
        }
        "windup" => {
            let true_stiffness = stiffness * between(0.45, 0.72);
            axis.mechanics.stiffness_n_per_m = 1e6 * true_stiffness;
            vec![("stiffness_n_per_um", true_stiffness)]
        }
        "stribeck" => {
            let (excess, speed) = (between(53.0, 210.0), between(3.0, 12.0));
            axis.mechanics.stribeck_n = excess;
            axis.mechanics.stribeck_m_per_s = 1e-3 * speed;
            vec![("static_excess_n", excess), ("velocity_mm_s", speed)]
        }
        "friction_asymmetry" => {
            // Friction must oppose motion in both directions.
            let most = 0.8 * axis.mechanics.viscous_n_s_per_m;
            let half = sign * between(115.0, 460.0).min(most);
            axis.mechanics.asymmetry_n_s_per_m = half;
            vec![("half_difference_n_s_per_m", half)]
        }
        "torque_ripple" => {
            let (amplitude, period) = (between(26.0, 105.0), lead_mm / order);
            axis.mechanics.ripple = Sinusoid { amplitude, period: 1e-3 * period, phase };
            vec![("amplitude_n", amplitude), ("period_mm", period)]
        }
        "constant_load" => {
            let force = sign * between(95.0, 380.0);
            axis.mechanics.load_n = force;
            vec![("force_n", force)]
        }
        "servo_mismatch" => {
            let percent = sign * between(2.8, 11.0);
            axis.servo.position_gain_per_s *= 1.0 + 0.01 * percent;
            vec![("percent", percent)]
        }
        "intalk" => {
            let per_acceleration = sign * between(1.0, 4.0);
            axis.intalk_s2 = 1e-6 * per_acceleration;
            vec![("um_s2_per_m", per_acceleration)]
        }
        "crosstalk" => {
            let per_acceleration = sign * between(0.7, 2.8);
            axis.crosstalk_s2 = 1e-6 * per_acceleration;
            reference = Some(("source", other));
            vec![("um_s2_per_m", per_acceleration)]
        }
        "squareness" => {
            let slope = sign * between(36.0, 144.0);
            axis.squareness = 1e-6 * slope;
            vec![("um_per_m", slope)]
        }
        "straightness" => {
            let bow = sign * between(124.0, 494.0);
            axis.straightness_per_m = 1e-6 * bow;
            reference = Some(("source", other));
            vec![("um_per_m2", bow)]
        }
        "thermal_drift" => {
            let (amplitude, time_s) = (sign * between(4.6, 18.0), between(15.0, 60.0));
            axis.drift_m = 1e-6 * amplitude;
            axis.drift_s = time_s;
            vec![("amplitude_um", amplitude), ("time_constant_s", time_s)]
        }
        "latency" => {
            let late_ms = between(0.2, 2.0);
            match channel {
                "table" => axis.table_delay_s = 1e-3 * late_ms,
                _ => axis.tool_delay_s = 1e-3 * late_ms,
            }
            reference = Some(("channel", channel));
            vec![("ms", late_ms)]
        }
        _ => resonance(axis, [between(20.0, 80.0), between(0.03, 0.1)], &mut reference),
    };
    Truth { name, axis: AXES[index], parameters, reference }
}

fn resonance(
    axis: &mut Axis,
    [frequency_hz, zeta]: [f64; 2],
    reference: &mut Option<(&'static str, &'static str)>,
) -> Vec<(&'static str, f64)> {
    axis.resonance = Some([TAU * frequency_hz, zeta]);
    *reference = Some(("channel", "tool"));
    vec![("frequency_hz", frequency_hz), ("damping_ratio", zeta)]
}

/// Gives an axis one of [`OUTSIDE`].
fn outside_effect(name: &'static str, index: usize, machine: &mut Drawn, random: &mut ChaCha8Rng) -> Truth {
    let axis = &mut machine.axes[index];
    let channel = one_of(&["table", "tool"], random);
    let phase = random.random_range(0.0..TAU);
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let (channel, parameters) = if name == "vibration" {
        let (amplitude, frequency_hz) = (between(1.0, 3.0), between(40.0, 150.0));
        axis.vibration = Sinusoid { amplitude: 1e-6 * amplitude, period: 1.0 / frequency_hz, phase };
        ("tool", vec![("amplitude_um", amplitude), ("frequency_hz", frequency_hz)])
    } else {
        let (height, width, centre) = (between(2.0, 6.0), between(3.0, 15.0), between(-30.0, 30.0));
        let defect = LocalDefect { height_m: 1e-6 * height, centre_m: 1e-3 * centre, width_m: 1e-3 * width };
        match channel {
            "table" => axis.mechanics.screw_defect = defect,
            _ => axis.tool_defect = defect,
        }
        (channel, vec![("centre_mm", centre), ("width_mm", width), ("height_um", height)])
    };
    Truth { name, axis: AXES[index], parameters, reference: Some(("channel", channel)) }
}

fn sinusoid_um(amplitude_um: f64, period_mm: f64, phase: f64) -> Sinusoid {
    Sinusoid { amplitude: 1e-6 * amplitude_um, period: 1e-3 * period_mm, phase }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::super::draw;
    use super::*;

    /// The effects of 1000 machines.
    fn many() -> Vec<Vec<Truth>> {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut one = |_| draw_effects(&mut draw::machine(&mut random), &mut random);
        (0..1000).map(&mut one).collect()
    }

    #[test]
    fn probabilities_are_as_declared_and_every_effect_is_drawn() {
        let drawn = many();
        let share = |count: usize| {
            let with =
                drawn.iter().filter(|truths| truths.iter().filter(|t| !t.is_outside()).count() == count);
            with.count() as f64 / 1000.0
        };
        // 15 % · 30 % of the cases have no effect of the catalogue. For 1000 draws, four standard deviations are at most
        // 0.063.
        let alone = OUTSIDE_PROBABILITY * ALONE_PROBABILITY;
        for (count, expected) in PROBABILITIES.iter().enumerate() {
            let expected =
                if count == 0 { expected * (1.0 - alone) + alone } else { expected * (1.0 - alone) };
            assert!((share(count) - expected).abs() < 0.063, "{count}: {}", share(count));
        }
        let seen: std::collections::BTreeSet<&str> = drawn.iter().flatten().map(|truth| truth.name).collect();
        assert_eq!(seen, NAMES.into_iter().chain(OUTSIDE).collect());
    }

    #[test]
    fn no_axis_has_effects_that_hide_each_other() {
        for truths in many() {
            for (i, truth) in truths.iter().enumerate() {
                let others = truths[..i].iter().filter(|other| other.axis == truth.axis);
                assert!(!others.clone().any(|other| excludes(other.name, truth.name)), "{truths:?}");
            }
        }
    }

    #[test]
    fn every_effect_that_is_drawn_is_in_the_catalogue() {
        let catalogue = trace::effect_names();
        assert!(NAMES.iter().all(|name| catalogue.contains(name)));
        assert!(!OUTSIDE.iter().any(|name| catalogue.contains(name)));
    }

    #[test]
    fn names_and_parameters_are_those_of_machine_files() {
        let known = |truth: &Truth| {
            let mut entry = truth.json();
            entry.as_object_mut().unwrap().remove("axis");
            // A truth has no phase, but an effect requires one.
            if truth.parameter("period_mm").is_some() {
                entry["phase_rad"] = json!(0.0);
            }
            let machine = json!({"name": "m", "sample_rate_hz": 1e3, "axis": {"x": {"effect": [entry]}}});
            serde_json::from_value::<trace::Machine>(machine)
        };
        for truth in many().iter().flatten().filter(|truth| !truth.is_outside()) {
            assert_eq!(known(truth).unwrap().axis["x"].effect[0].name(), truth.name);
        }
    }
}
