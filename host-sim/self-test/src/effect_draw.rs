//! The undeclared effects of a drawn machine: how many, which, and which of them exclude each other.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::draw::{Drawn, one_of};
use super::effect;
use super::kind::Kind;
use super::machine::AXES;
use super::truth::{NAMES, Truth, axis_index};

/// Probabilities of no, one, two and three effects.
const PROBABILITIES: [f64; 4] = [0.1, 0.45, 0.35, 0.1];
/// Probability of an effect from outside the catalogue, and probability that such a case has no other effect.
const OUTSIDE_PROBABILITY: f64 = 0.15;
const ALONE_PROBABILITY: f64 = 0.3;
/// Probability that a machine with something beyond the catalogue has no effect of the catalogue.
const EXTRA_ALONE_PROBABILITY: f64 = 0.3;
/// Smallest size of an effect of the kind `small` as a fraction of the textbook size; fractions are log-uniform.
const SMALLEST_STRENGTH: f64 = 1.0 / 30.0;

/// Draws the effects of a machine of the textbook kind and sets them in its true values.
pub fn draw_textbook(machine: &mut Drawn, random: &mut ChaCha8Rng) -> Vec<Truth> {
    let mut count = draw_count(random);
    let outside = random.random_bool(OUTSIDE_PROBABILITY);
    if outside && random.random_bool(ALONE_PROBABILITY) {
        count = 0;
    }
    let mut truths = Vec::new();
    add_effects(&mut truths, count, machine, random);
    if outside {
        truths.push(effect::draw_outside(machine, random));
    }
    truths
}

/// Draws the effects of the catalogue of another kind and sets them in the true values. `extras` is what else the
/// machine has: no axis gets an effect that cannot be told from it.
pub fn draw_beside(extras: &[Truth], kind: Kind, machine: &mut Drawn, random: &mut ChaCha8Rng) -> Vec<Truth> {
    let count = match kind {
        Kind::Many => random.random_range(4..=5),
        Kind::Small => random.random_range(1..=3),
        Kind::Sensors | Kind::Sparse => random.random_range(0..=2),
        _ if kind.may_stand_alone() && random.random_bool(EXTRA_ALONE_PROBABILITY) => 0,
        _ => draw_count(random),
    };
    let bare = machine.axes.clone();
    let mut truths = extras.to_vec();
    let wanted = extras.len() + count;
    while truths.len() < wanted {
        add_effects(&mut truths, wanted, machine, random);
        // Beyond the tolerance, a lower stiffness is a wrong declared value, which is no effect.
        truths.retain(|truth| kind != Kind::Offspec || truth.name != "windup");
    }
    truths.drain(..extras.len());
    if kind == Kind::Small {
        for truth in &mut truths {
            let strength = libm::pow(SMALLEST_STRENGTH, random.random_range(0.0..1.0));
            *truth = effect::small(truth, strength, machine);
        }
    }
    // Again from the machine without them, because the list may have become shorter or the effects smaller.
    machine.axes = bare;
    for truth in &truths {
        effect::apply(truth, &mut machine.axes[axis_index(truth.axis)]);
    }
    truths
}

fn draw_count(random: &mut ChaCha8Rng) -> usize {
    let mut share: f64 = random.random();
    let count = PROBABILITIES.iter().position(|part| {
        share -= part;
        share < 0.0
    });
    count.unwrap_or(1)
}

/// Draws effects until there are `count`. No axis gets an effect twice, or one that hides another.
fn add_effects(truths: &mut Vec<Truth>, count: usize, machine: &mut Drawn, random: &mut ChaCha8Rng) {
    while truths.len() < count {
        let name = one_of(&NAMES, random);
        // Squareness is declared on the first axis.
        let axis = if name == "squareness" { 0 } else { random.random_range(0..AXES.len()) };
        let conflicts = |truth: &Truth| truth.axis == AXES[axis] && excludes(truth.name, name);
        if !truths.iter().any(conflicts) {
            let truth = effect::draw(name, axis, machine, random);
            effect::apply(&truth, &mut machine.axes[axis]);
            truths.push(truth);
        }
    }
}

/// Pairs that are not drawn on one axis. A load greater than the friction keeps the screw on one side of its gap; a strain wave gear has none. The
/// others have the same consequence: a pitch shape has a slope, a second harmonic of the screw the period of a resolver
/// with two pole pairs, and the loop multiplies Kp by Kv and by feed-forward.
const EXCLUSIONS: [[&str; 2]; 32] = [
    ["backlash", "constant_load"],
    ["backlash", "cable_drag"],
    ["backlash", "backlash_varies"],
    ["constant_load", "backlash_varies"],
    ["pitch_progressive", "pitch_shape"],
    ["squareness", "guide_shape"],
    ["straightness", "guide_shape"],
    ["resolver_dividing", "screw_second_harmonic"],
    ["resolver_dividing", "gear_error"],
    ["backlash", "joint_gravity"],
    ["backlash", "gear_hysteresis"],
    ["servo_mismatch", "feedforward_mismatch"],
    ["servo_mismatch", "velocity_gain_mismatch"],
    ["servo_mismatch", "integral_time_mismatch"],
    ["servo_mismatch", "drive_lag"],
    ["servo_mismatch", "feedback_late"],
    ["servo_mismatch", "feedback_notch"],
    ["servo_mismatch", "feedback_low_pass"],
    ["servo_mismatch", "dead_time"],
    ["servo_mismatch", "loop_delay"],
    ["servo_mismatch", "velocity_fresh"],
    ["servo_mismatch", "command_shifted"],
    ["constant_load", "drive_asymmetry"],
    ["friction_asymmetry", "drive_asymmetry"],
    ["thermal_drift", "two_drifts"],
    ["thermal_drift", "linear_drift"],
    ["resonance", "two_modes"],
    ["latency", "two_modes"],
    ["resonance", "mode_on_table"],
    ["latency", "mode_on_table"],
    ["windup", "stiffness_varies"],
    ["windup", "no_stiffness"],
];

/// Whether one effect on an axis hides the other.
fn excludes(one: &str, other: &str) -> bool {
    one == other || EXCLUSIONS.contains(&[one, other]) || EXCLUSIONS.contains(&[other, one])
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use serde_json::json;

    use super::super::draw;
    use super::super::truth::{CONTROLLER, OUTSIDE};
    use super::*;

    /// Drawn effects that the tracer knows.
    const CATALOGUED: &[&[&str]] = &[&NAMES, &CONTROLLER];

    /// The effects of 1000 machines.
    fn many() -> Vec<Vec<Truth>> {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut one =
            |_| draw_textbook(&mut draw::machine(&draw::WITHIN_TOLERANCE, &mut random), &mut random);
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
        assert!(CATALOGUED.iter().copied().flatten().all(|name| catalogue.contains(name)));
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
