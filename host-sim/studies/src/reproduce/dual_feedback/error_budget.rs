//! Superposition of independent errors, and the error budget of the paper's positioning example.
//!
//! (A ± ΔA) + (B ± ΔB) = (A + B) ± √(ΔA² + ΔB²). A torque error becomes a position error through the motor's stiffness,
//! its torque per pulse of position error: 50 kg·cm at 2.4°, which is 0.01 mm at the table.

use std::ops::{Add, Mul};

use crate::reproduce::study::{Outcome, Printed, Study};
use files::format::fixed;

/// A value ± its scatter.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Uncertain {
    /// Mean.
    value: f64,
    /// Half the width of the scatter.
    half_width: f64,
}

/// `value` ± `half_width`.
const fn uncertain(value: f64, half_width: f64) -> Uncertain {
    Uncertain { value, half_width }
}

/// The scatter of independent errors adds in quadrature.
impl Add for Uncertain {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        uncertain(self.value + other.value, libm::hypot(self.half_width, other.half_width))
    }
}

impl Mul<f64> for Uncertain {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        uncertain(self.value * factor, self.half_width * factor.abs())
    }
}

/// Static friction of the axis, at the motor, kg·cm.
const STATIC_KG_CM: Uncertain = uncertain(30.0, 3.0);

/// Scatter of the minimum kinetic friction, at the motor, kg·cm.
const KINETIC_FLUCTUATION_KG_CM: f64 = 1.5;

/// Motor torque per pulse of position error, kg·cm.
const MOTOR_KG_CM_PER_PULSE: f64 = 50.0;

/// Right-hand side of equation (5), kg·cm: the sum of all friction, each with its scatter added.
const ALL_FRICTION_KG_CM: f64 = 50.7;

/// Contribution of friction to the lost motion in equation (6), pulses.
const FRICTION_PULSES: f64 = 0.92;

/// Backlash in equation (6), pulses.
const BACKLASH_PULSES: f64 = 0.25;

/// Accuracy of the transducer in equation (6), and variation of the command in equation (7), pulses.
const SENSING_PULSES: f64 = 0.05;

/// Travel of the table per pulse, µm.
const PULSE_UM: f64 = 10.0;

/// Sum of all friction at the motor without the scatter, kg·cm.
fn mean_friction_kg_cm() -> f64 {
    ALL_FRICTION_KG_CM - STATIC_KG_CM.half_width - KINETIC_FLUCTUATION_KG_CM
}

/// Lost motion, equation (6), pulses.
fn lost_motion() -> Uncertain {
    let friction = uncertain(mean_friction_kg_cm(), 0.0)
        + uncertain(0.0, STATIC_KG_CM.half_width)
        + uncertain(0.0, KINETIC_FLUCTUATION_KG_CM);
    friction * MOTOR_KG_CM_PER_PULSE.recip()
        + uncertain(BACKLASH_PULSES, 0.0)
        + uncertain(0.0, SENSING_PULSES)
}

/// Positioning error, equation (7), pulses: half of the lost motion, which is measured from side to side.
fn positioning() -> Uncertain {
    (lost_motion() + uncertain(0.0, SENSING_PULSES)) * 0.5
}

/// Repeat error, equation (8), pulses: the kinetic friction of two approaches.
fn repeatability() -> Uncertain {
    let once = uncertain(0.0, KINETIC_FLUCTUATION_KG_CM) * MOTOR_KG_CM_PER_PULSE.recip();
    once + once
}

/// Torque that one pulse must produce against the maximum friction, equation (5), kg·cm.
fn torque_kg_cm() -> f64 {
    FRICTION_PULSES * MOTOR_KG_CM_PER_PULSE + STATIC_KG_CM.half_width + KINETIC_FLUCTUATION_KG_CM
}

/// Adds the design example.
pub fn add(study: &mut Study) {
    let (lost, position) = (lost_motion(), positioning());
    // 0.92 pulses stand for 0.915 to 0.925.
    let torque = Printed::Figure { value: ALL_FRICTION_KG_CM, tolerance: 0.005 * MOTOR_KG_CM_PER_PULSE };
    let (static_kg_cm, motor) = (STATIC_KG_CM.value + STATIC_KG_CM.half_width, MOTOR_KG_CM_PER_PULSE);
    study.findings.push(format!(
        "One pulse produces {motor} kg·cm, which moves the axis against its greatest static friction of \
         {static_kg_cm} kg·cm, but not against the sum of all friction, {} kg·cm. That requires two pulses, for \
         which the paper states its repeat error.",
        fixed(torque_kg_cm(), 1),
    ));
    study.outcomes.extend([
        Outcome::new(
            "torque to move at least one pulse, (5), from the friction in (6)",
            torque,
            torque_kg_cm(),
            "kg·cm",
        ),
        Outcome::new(
            "lost motion, (6), from the torque in (5)",
            Printed::to_digit(11.7, 0.1),
            PULSE_UM * lost.value,
            "µm",
        ),
        Outcome::new("lost motion: scatter ±", Printed::to_digit(0.8, 0.1), PULSE_UM * lost.half_width, "µm"),
        Outcome::new("positioning error, (7)", Printed::to_digit(6.0, 1.0), PULSE_UM * position.value, "µm"),
        Outcome::new(
            "positioning error: scatter ±",
            Printed::to_digit(3.15, 0.01),
            PULSE_UM * position.half_width,
            "µm",
        ),
        Outcome::new(
            "repeat error of two pulses and more ±, (8)",
            Printed::to_digit(0.42, 0.01),
            PULSE_UM * repeatability().half_width,
            "µm",
        ),
    ]);
    study.notes.extend([
        "The motor friction and the minimum kinetic friction of the design example are illegible, but their sum \
         appears twice: in the torque of (5), 50.7 kg·cm with the scatter of all terms, and in the friction in (6), \
         0.92 pulses of 50 kg·cm without it. Each is computed from the other here. They agree to 0.2 kg·cm, which \
         would be the scatter of the motor's own friction. The terms of the scatter in (6) are read as 3 and 1.5 of \
         50 kg·cm and 0.05 pulse of the transducer, the backlash as 0.25 pulse."
            .to_owned(),
        "(6) is scanned as 0.92 − 0.08 − 0.25; as 1.17 is 0.92 + 0.25, the signs are read as ± and +.".to_owned(),
        "The scatter of the positioning error, ±3.15 µm in (7), does not follow from its own legible terms: 0.05, \
         0.08 and 0.05 pulse, combined and halved, give ±0.5 µm. The adjacent terms are missing from the scan. \
         (0.05 + 0.08 + 0.5)/2 is 0.315, with ±0.5 pulse added linearly and not as a square; this is a guess, and \
         the verdict differs."
            .to_owned(),
    ]);
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// The rule against 10⁵ draws of a sum of two independent errors. The standard deviation of n draws has a standard
    /// error of σ/√(2n), 0.22 % (less for uniform draws); five of it are allowed.
    #[test]
    fn scatter_adds_in_quadrature() {
        let mut random = ChaCha8Rng::seed_from_u64(8);
        let n = 100_000;
        // Uniform in ±√3·Δ has a standard deviation of Δ.
        let mut draw =
            |of: Uncertain| of.value + of.half_width * 3f64.sqrt() * (2.0 * random.random::<f64>() - 1.0);
        let (a, b) = (uncertain(30.0, 3.0), uncertain(16.2, 1.5));
        let sums: Vec<f64> = (0..n).map(|_| draw(a) + draw(b)).collect();
        let (mean, deviation) = numerics::mean_and_deviation(&sums);
        let rule = a + b;
        assert!((mean - rule.value).abs() < 5.0 * rule.half_width / f64::from(n).sqrt());
        assert!((deviation / rule.half_width - 1.0).abs() < 5.0 * 0.0022);
    }

    /// By hand: 46.2/50 + 0.25 and √(0.06² + 0.03² + 0.05²) = √0.0070 pulses; √2·0.03; 46 + 3 + 1.5.
    #[test]
    fn the_design_example_by_hand() {
        let lost = lost_motion();
        assert!((lost.value - 1.174).abs() < 1e-12 && (lost.half_width - 0.0070f64.sqrt()).abs() < 1e-12);
        assert!((positioning().half_width - 0.5 * 0.0095f64.sqrt()).abs() < 1e-12);
        assert!((repeatability().half_width - 0.042_426_4).abs() < 1e-6);
        assert!((torque_kg_cm() - 50.5).abs() < 1e-12);
    }
}
