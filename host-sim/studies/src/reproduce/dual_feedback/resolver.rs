//! Dividing error of the resolver, ε = D sin θ at 100 pulses of 0.9° a quarter turn: how many pulses lie within the
//! share of D that a normal distribution holds in 1σ, 2σ and 3σ (68.3, 95.4 and 99.7 %).
//!
//! The pulses are those of one quarter, 0 to 99, the one at zero included: that count, and no rounding of
//! asin(share)/0.9°, gives all three printed figures. It is taken of the formula, and of what the controller's own
//! resolver input ([`Phase::from_samples`], [`Transducer`]) shows of a motor that goes from pulse to pulse.

use std::f64::consts::TAU;

use shared::feedback::phase::Phase;
use shared::feedback::transducer::Transducer;
use shared::units::Position;

use super::printed;
use crate::reproduce::{Outcome, Picture, ReproduceError, Study};
use model::effects::ResolverDividing;
use report::number::fixed;
use report::plot::{Chart, Ink, Layer};

/// Pulses of a quarter turn.
const QUARTER: u32 = 100;
/// Travel of a pulse, µm, as in the paper's design example.
const PULSE_UM: f64 = 10.0;
/// D of the resolver that is simulated, µm; the shares do not depend on it.
const GREATEST_UM: f64 = 10.0;
/// Amplitude of the resolver's windings in converter counts: 24 bits.
const AMPLITUDE: f64 = 8_388_607.0;
/// Shares of D, and pulses in a hundred as printed.
const PRINTED: [(&str, f64, f64); 3] = [("1σ", 0.683, 48.0), ("2σ", 0.954, 81.0), ("3σ", 0.997, 96.0)];

/// Travel of a turn, mm.
fn turn_mm() -> f64 {
    1e-3 * PULSE_UM * f64::from(4 * QUARTER)
}

fn dividing() -> ResolverDividing {
    ResolverDividing { amplitude_um: GREATEST_UM, period_mm: turn_mm(), phase_rad: 0.0 }
}

/// What the converters sample of a resolver whose motor stands at a place, m.
#[expect(clippy::cast_possible_truncation, reason = "24 bits")]
fn samples(motor_m: f64) -> Option<Phase> {
    let shown_m = motor_m + dividing().error_m(motor_m);
    let (sine, cosine) = (TAU * 1e3 * shown_m / turn_mm()).sin_cos();
    let counts = |value: f64| (AMPLITUDE * value).round() as i32;
    Phase::from_samples(counts(sine), counts(cosine), 1 << 22)
}

/// Reading − motor at each pulse of a turn, in D, through the controller's resolver input; `None` if the
/// signal is lost.
fn read() -> Option<Vec<f64>> {
    let mut resolver = Transducer::new(1e-3 * turn_mm(), 1, samples(0.0)?)?;
    let pulse = |k: u32| {
        let motor = Position::from_m(1e-6 * PULSE_UM * f64::from(k))?;
        let error_m = resolver.read(samples(motor.to_m())?).to_m() - motor.to_m();
        Some(1e6 * error_m / GREATEST_UM)
    };
    (0..4 * QUARTER).map(pulse).collect()
}

/// The same by the formula.
fn formula() -> Vec<f64> {
    (0..4 * QUARTER).map(|k| (TAU * f64::from(k) / f64::from(4 * QUARTER)).sin()).collect()
}

/// Of a hundred pulses, those within a share of D.
fn within(errors: &[f64], share: f64) -> f64 {
    let count = errors.iter().filter(|error| error.abs() <= share).count();
    100.0 * count as f64 / errors.len() as f64
}

/// Adds the resolver.
///
/// # Errors
/// When the resolver's signal is lost, which it is not.
pub fn add(study: &mut Study) -> Result<(), ReproduceError> {
    let lost = || ReproduceError::Numerics("the resolver's signal is lost".to_owned());
    let (read, formula) = (read().ok_or_else(lost)?, formula());
    let quarter = QUARTER as usize;
    for (sigma, share, percent) in PRINTED {
        for (how, errors) in [("D sin θ", &formula), ("read through the resolver input", &read)] {
            study.outcomes.push(Outcome::new(
                format!("pulses of a quarter turn within {sigma} ({share}) of D, {how}"),
                printed(percent, 1.0),
                within(&errors[..quarter], share),
                "%",
            ));
        }
    }
    let turn = PRINTED.map(|(_, share, _)| fixed(within(&read, share), 1));
    study.notes.push(format!(
        "The resolver's 48, 81 and 96 % are pulses of one quarter turn with the one at zero: the paper's \
         asin(0.997)/0.9° is 95.1, and pulses 0 to 95, 96 of them, lie below it. Over a whole turn, where zero is not \
         counted four times, the shares are {}, {} and {} %. They are no σ of the error itself: a sine's σ is D/√2, \
         and 2σ of that hold all of it.",
        turn[0], turn[1], turn[2]
    ));
    study.pictures.push(picture(&read));
    Ok(())
}

fn picture(read: &[f64]) -> Picture {
    let errors: Vec<(f64, f64)> = (0..QUARTER).map(f64::from).zip(read.iter().copied()).collect();
    // From zero along the share to its last pulse, and down to the axis.
    let limit = |(share, count): (f64, f64)| {
        let last = count - 1.0;
        Layer { ink: Ink::Third, points: vec![(0.0, share), (last, share), (last, 0.0)], is_marked: false }
    };
    let counts = PRINTED.map(|(_, share, _)| errors.iter().filter(|point| point.1 <= share).count());
    let limits = [0, 1, 2].map(|k| limit((PRINTED[k].1, counts[k] as f64)));
    let title = "Dividing error of the resolver over a quarter turn".to_owned();
    let caption = format!(
        "Reading − motor at each pulse, read through the controller's resolver input: D sin θ. The lines end at the \
         last pulse within 1σ, 2σ and 3σ of D: counted from the one at zero, number {}, {} and {}.",
        counts[0], counts[1], counts[2]
    );
    let chart = Chart {
        size: (960, 260),
        title: &title,
        description: &caption,
        x: "pulses of 0.9°",
        y: "error, D",
        noise: 0.0,
        layers: limits
            .into_iter()
            .chain([Layer { ink: Ink::After, points: errors.clone(), is_marked: false }])
            .collect(),
    };
    let svg = chart.svg();
    let keys = vec![("after", "error".to_owned()), ("cw", "within 1σ, 2σ, 3σ of D".to_owned())];
    Picture { title, svg, caption, keys }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half a count on both samples is √½/amplitude rad at most, of a turn of 4 mm 0.054 nm; D is 10 µm.
    #[test]
    fn the_input_shows_the_formula() {
        let off = numerics::max_abs(read().unwrap().iter().zip(formula()).map(|(a, b)| a - b));
        assert!(off < 8e-6 && off > 1e-6, "{off}");
    }

    /// Counted against the arc sine: pulses 0 to ⌊asin(share)/0.9°⌋.
    #[test]
    fn a_count_is_the_arc_sine_and_one() {
        for share in [0.1_f64, 0.5, 0.683, 0.954, 0.997] {
            let last = (share.asin() / (TAU / 400.0)).floor();
            let found = within(&formula()[..100], share);
            assert!((found - (last + 1.0)).abs() < 1e-9, "{share}: {found}");
        }
    }

    /// Half of a sine lies within its own σ, D/√2, to two pulses of 400.
    #[test]
    fn half_of_a_sine_lies_within_its_sigma() {
        let found = within(&formula(), 0.5f64.sqrt());
        assert!((found - 50.0).abs() <= 0.5, "{found}");
    }
}
