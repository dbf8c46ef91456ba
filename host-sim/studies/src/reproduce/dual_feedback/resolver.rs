//! Dividing error of the resolver, ε = D sin θ, with 100 pulses of 0.9° per quarter turn: the number of pulses with an
//! error below 0.683·D, 0.954·D and 0.997·D, the fractions of a normal distribution within 1σ, 2σ and 3σ.
//!
//! The pulses 0 to 99 of one quarter are counted, including the one at zero. Only this count gives all three printed
//! values; no rounding of asin(fraction)/0.9° does. It is applied to the formula, and to the controller's own resolver
//! input ([`Phase::from_samples`], [`Transducer`]) for a motor that moves from pulse to pulse.

use std::f64::consts::TAU;

use shared::feedback::phase::Phase;
use shared::feedback::transducer::Transducer;
use shared::units::Position;

use crate::reproduce::study::{Outcome, Picture, Printed, ReproduceError, Study};
use files::format::fixed;
use model::effects::ResolverDividing;
use pages::plot::{Chart, Ink, Layer};

/// Pulses per quarter turn.
const QUARTER: u32 = 100;

/// Travel per pulse, µm, as in the paper's design example.
const PULSE_UM: f64 = 10.0;

/// Amplitude D of the dividing error, µm; the counts do not depend on it.
const ERROR_UM: f64 = 10.0;

/// Amplitude of the resolver signals in converter counts: 24 bits.
const SIGNAL_COUNTS: f64 = 8_388_607.0;

/// Number of σ, fraction of D, and the printed percentage of pulses.
const PRINTED: [(&str, f64, f64); 3] = [("1σ", 0.683, 48.0), ("2σ", 0.954, 81.0), ("3σ", 0.997, 96.0)];

/// Travel per turn, mm.
fn turn_mm() -> f64 {
    1e-3 * PULSE_UM * f64::from(4 * QUARTER)
}

/// The dividing error as an effect of the model.
fn dividing() -> ResolverDividing {
    ResolverDividing { amplitude_um: ERROR_UM, period_mm: turn_mm(), phase_rad: 0.0, fitted_period_mm: None }
}

/// Sampled phase of the resolver at a motor position, m; `None` if the signal is lost.
#[expect(clippy::cast_possible_truncation, reason = "24 bits")]
fn samples(motor_m: f64) -> Option<Phase> {
    let indicated_m = motor_m + dividing().error().error_m(motor_m);
    let (sine, cosine) = libm::sincos(TAU * 1e3 * indicated_m / turn_mm());
    let counts = |value: f64| (SIGNAL_COUNTS * value).round() as i32;
    Phase::from_samples(counts(sine), counts(cosine), 1 << 22)
}

/// Reading minus motor position at each pulse of a turn, in units of D, through the controller's resolver input; `None`
/// if the signal is lost.
fn simulated_errors() -> Option<Vec<f64>> {
    let mut resolver = Transducer::new(1e-3 * turn_mm(), 1, samples(0.0)?)?;
    let pulse = |k: u32| {
        let motor = Position::from_m(1e-6 * PULSE_UM * f64::from(k))?;
        let error_m = resolver.read(samples(motor.to_m())?).to_m() - motor.to_m();
        Some(1e6 * error_m / ERROR_UM)
    };
    (0..4 * QUARTER).map(pulse).collect()
}

/// The errors by the formula.
fn formula_errors() -> Vec<f64> {
    (0..4 * QUARTER).map(|k| libm::sin(TAU * f64::from(k) / f64::from(4 * QUARTER))).collect()
}

/// Percentage of pulses whose error is within a fraction of D.
fn percent_within(errors: &[f64], fraction: f64) -> f64 {
    let count = errors.iter().filter(|error| error.abs() <= fraction).count();
    100.0 * count as f64 / errors.len() as f64
}

/// Adds the dividing error.
///
/// # Errors
/// If the simulated resolver signal is lost.
pub fn add(study: &mut Study) -> Result<(), ReproduceError> {
    let lost = || ReproduceError::Numerics("the resolver's signal is lost".to_owned());
    let (simulated, formula) = (simulated_errors().ok_or_else(lost)?, formula_errors());
    let quarter = QUARTER as usize;
    for (sigma, fraction, percent) in PRINTED {
        for (source, errors) in [("D sin θ", &formula), ("read through the resolver input", &simulated)] {
            study.outcomes.push(Outcome::new(
                format!("pulses of a quarter turn within {sigma} ({fraction}) of D, {source}"),
                Printed::to_digit(percent, 1.0),
                percent_within(&errors[..quarter], fraction),
                "%",
            ));
        }
    }
    let turn = PRINTED.map(|(_, fraction, _)| fixed(percent_within(&simulated, fraction), 1));
    study.notes.push(format!(
        "The resolver's 48, 81 and 96 % are the pulses of one quarter turn including the pulse at zero: the paper's \
         asin(0.997)/0.9° is 95.1, so that pulses 0 to 95, which are 96 pulses, are below it. Over a whole turn, \
         where zero is not counted four times, the percentages are {}, {} and {} %. They do not correspond to σ of \
         the error itself: σ of a sine is D/√2, and the whole sine is within 2σ.",
        turn[0], turn[1], turn[2]
    ));
    study.pictures.push(picture(&simulated));
    Ok(())
}

/// The simulated errors over a quarter turn, with the three limits.
fn picture(simulated: &[f64]) -> Picture {
    let errors: Vec<(f64, f64)> = (0..QUARTER).map(f64::from).zip(simulated.iter().copied()).collect();
    // From zero along the limit to the last pulse within it, then down to the axis.
    let limit = |(fraction, count): (f64, f64)| {
        let last = count - 1.0;
        Layer {
            ink: Ink::Third,
            points: vec![(0.0, fraction), (last, fraction), (last, 0.0)],
            is_marked: false,
        }
    };
    let counts = PRINTED.map(|(_, fraction, _)| errors.iter().filter(|point| point.1 <= fraction).count());
    let limits = [0, 1, 2].map(|k| limit((PRINTED[k].1, counts[k] as f64)));
    let title = "Dividing error of the resolver over a quarter turn".to_owned();
    let caption = format!(
        "Reading − motor position at each pulse, through the controller's resolver input: D sin θ. The lines end at \
         the last pulse within 1σ, 2σ and 3σ of D; counted from the pulse at zero, these are numbers {}, {} and {}.",
        counts[0], counts[1], counts[2]
    );
    let chart = Chart {
        size: (960, 260),
        title: &title,
        description: &caption,
        x: "pulses of 0.9°",
        y: "error, D",
        noise: Some(0.0),
        layers: limits
            .into_iter()
            .chain([Layer { ink: Ink::After, points: errors.clone(), is_marked: false }])
            .collect(),
    };
    let svg = chart.svg();
    let legend = vec![("after", "error".to_owned()), ("cw", "within 1σ, 2σ, 3σ of D".to_owned())];
    Picture { title, svg, caption, legend }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half a count on both samples is at most √½/2²³ rad, which is 0.054 nm of a 4 mm turn; D is 10 µm.
    #[test]
    fn the_resolver_input_agrees_with_the_formula() {
        let simulated = simulated_errors().unwrap();
        let deviation = numerics::max_abs(simulated.iter().zip(formula_errors()).map(|(a, b)| a - b));
        assert!(deviation < 8e-6 && deviation > 1e-6, "{deviation}");
    }

    /// The count includes pulses 0 to ⌊asin(fraction)/0.9°⌋.
    #[test]
    fn the_count_is_the_arc_sine_plus_one() {
        for fraction in [0.1_f64, 0.5, 0.683, 0.954, 0.997] {
            let last = (fraction.asin() / (TAU / 400.0)).floor();
            let found = percent_within(&formula_errors()[..100], fraction);
            assert!((found - (last + 1.0)).abs() < 1e-9, "{fraction}: {found}");
        }
    }

    /// Half of a sine is within its own σ, D/√2, to two pulses of 400.
    #[test]
    fn half_of_a_sine_is_within_its_sigma() {
        let found = percent_within(&formula_errors(), 0.5f64.sqrt());
        assert!((found - 50.0).abs() <= 0.5, "{found}");
    }
}
