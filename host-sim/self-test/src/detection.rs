//! Machines with a single effect of a given size in units of the noise: whether a trace finds it.
//!
//! The size of an effect is the rms of its contribution to its main residual channel over the logs to fit, divided by the
//! standard deviation of that channel's sensor. It is computed by this crate's own simulator, as the difference between
//! two machines without noise, one with the effect and one without.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::case::{Case, Purpose, block, run_session, stream};
use super::draw::{self, Drawn, Motion};
use super::kind::Kind;
use super::machine::AXES;
use super::score::Outcome;
use super::sensors::Sensors;
use super::truth::{NAMES, Truth, axis_index};
use super::{effect, machine::Axis};
use files::error::InputError;
use files::log::{AxisLog, Log};

/// Sizes that are aimed at, in units of the noise: 0.1 to 30, by equal factors.
pub const SIZES: [f64; 11] = [0.1, 0.18, 0.31, 0.55, 0.98, 1.73, 3.06, 5.42, 9.58, 17.0, 30.0];

/// Largest relative error of the size before its strength is corrected again, for effects that are not proportional to it.
const MAX_SIZE_ERROR: f64 = 0.1;
const MAX_CORRECTIONS: usize = 4;
/// Highest frequency of a resonance, Hz: well below half the sample rate.
const HIGHEST_RESONANCE_HZ: f64 = 300.0;

/// A residual channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Motor,
    Table,
    Tool,
    Force,
}

/// The residual channel in which an effect is largest.
fn main_stage(truth: &Truth) -> Stage {
    match (truth.name, truth.reference) {
        ("servo_mismatch", _) => Stage::Motor,
        ("stribeck" | "friction_asymmetry" | "torque_ripple" | "constant_load", _) => Stage::Force,
        ("backlash" | "pitch_progressive" | "pitch_cyclic" | "resolver_dividing" | "windup", _)
        | ("latency", Some((_, "table"))) => Stage::Table,
        _ => Stage::Tool,
    }
}

impl Stage {
    /// The measured signal of the stage relative to the measured signal upstream, mm or N.
    fn signal(self, axis: &AxisLog) -> Vec<f64> {
        let minus = |signal: &Option<Vec<f64>>, upstream: &Option<Vec<f64>>| {
            let pairs = signal.iter().flatten().zip(upstream.iter().flatten());
            pairs.map(|(signal, upstream)| signal - upstream).collect()
        };
        match self {
            Self::Motor => axis.motor.clone().unwrap_or_default(),
            Self::Table => minus(&axis.table, &axis.motor),
            Self::Tool => minus(&axis.tool, &axis.table),
            Self::Force => axis.force.clone().unwrap_or_default(),
        }
    }

    /// Noise of its sensor, mm or N.
    fn noise(self, sensors: &Sensors) -> f64 {
        let sensor = match self {
            Self::Motor => sensors.motor,
            Self::Table => sensors.table,
            Self::Tool => sensors.tool,
            Self::Force => sensors.force,
        };
        sensor.deviation()
    }
}

/// Simulates the logs to fit without noise.
pub(super) fn noise_free(drawn: &Drawn, session: &[Motion]) -> Vec<Log> {
    let axes = drawn.axes.clone().map(|axis| Axis { sensors: Sensors::ideal(), ..axis });
    let fit: Vec<Motion> = session.iter().filter(|motion| motion.name.starts_with("fit")).cloned().collect();
    run_session(&Drawn { axes, ..drawn.clone() }, &fit, |_| ChaCha8Rng::seed_from_u64(0))
}

/// Size of an effect in units of the noise, from its machine with and without it.
fn size(truth: &Truth, bare: &Drawn, session: &[Motion]) -> f64 {
    let index = axis_index(truth.axis);
    let mut with = bare.clone();
    effect::apply(truth, &mut with.axes[index]);
    let stage = main_stage(truth);
    let [with, without] = [&with, bare].map(|drawn| {
        noise_free(drawn, session).iter().flat_map(|log| stage.signal(&log.axes[index])).collect::<Vec<_>>()
    });
    let contribution = numerics::rms(with.iter().zip(&without).map(|(with, without)| with - without));
    contribution / stage.noise(&bare.axes[index].sensors)
}

/// A machine with one effect.
pub struct SizedCase {
    /// Size of the effect in units of the noise.
    pub size: f64,
    /// The machine with its logs; its only truth is the effect.
    pub case: Case,
}

impl SizedCase {
    /// Draws a case. Its effect and the size that is aimed at follow from its number: 187 numbers contain every pair. No
    /// effect becomes larger than in a textbook case, so that its size may be less.
    ///
    /// # Errors
    /// As [`Case::draw`].
    pub fn draw(seed: u64, number: u64) -> Result<Self, InputError> {
        let stream = |purpose| stream(block::DETECTION, seed, number, purpose);
        let mut random = stream(Purpose::Machine);
        let mut drawn = draw::machine(&draw::WITHIN_TOLERANCE, &mut random);
        let session = draw::session(&mut random);
        let name = nth(&NAMES, number);
        let index = if name == "squareness" { 0 } else { random.random_range(0..AXES.len()) };
        let textbook = effect::draw(name, index, &drawn, &mut random);
        let (truth, size) = sized(&textbook, nth(&SIZES, number), &drawn, &session);
        effect::apply(&truth, &mut drawn.axes[index]);
        let logs = run_session(&drawn, &session, |log| stream(Purpose::Log(log)));
        Ok(Self { size, case: Case::new((Kind::Textbook, number), &drawn, vec![truth], logs)? })
    }
}

/// The element for a number from 1 on, cyclically.
fn nth<T: Copy>(of: &[T], number: u64) -> T {
    #[expect(clippy::cast_possible_truncation, reason = "below the length of an array")]
    let index = ((number + of.len() as u64 - 1) % of.len() as u64) as usize;
    of[index]
}

/// The effect with a size near `target`, at most that drawn, and its size.
fn sized(textbook: &Truth, target: f64, bare: &Drawn, session: &[Motion]) -> (Truth, f64) {
    let index = axis_index(textbook.axis);
    // The true stiffness, from which a wind-up deviates.
    let stiffness = 1e-6 * bare.axes[index].mechanics.stiffness_n_per_m;
    let mut strength = 1.0;
    let mut found = (textbook.clone(), size(textbook, bare, session));
    for _ in 0..MAX_CORRECTIONS {
        let ratio: f64 = target / found.1;
        if (ratio - 1.0).abs() <= MAX_SIZE_ERROR || strength * ratio >= 1.0 {
            break;
        }
        strength *= ratio;
        let mut truth = effect::scaled(textbook, strength, stiffness);
        if truth.name == "resonance"
            && let Some((_, frequency_hz)) = truth.parameters.first_mut()
        {
            *frequency_hz = frequency_hz.min(HIGHEST_RESONANCE_HZ);
        }
        found = (truth.clone(), size(&truth, bare, session));
    }
    found
}

/// Whether the effect of a case was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Detection {
    /// Number of the case.
    pub number: u64,
    /// The effect.
    pub truth: Truth,
    /// Its size in units of the noise.
    pub size: f64,
    /// Whether it was found by name and axis.
    pub is_found: bool,
    /// Names and axes of effects that were found and are not there, without those that the trace calls ambiguous.
    pub false_names: Vec<(String, String)>,
    /// Names and axes of false effects that the trace calls ambiguous.
    pub ambiguous_names: Vec<(String, String)>,
}

/// Traces a case and compares.
///
/// # Errors
/// When the tracer refuses a log.
pub fn detect(sized: &SizedCase, progress: &(dyn Fn(&str) + Sync)) -> Result<Detection, InputError> {
    let outcome: Outcome = super::trace_and_score(&sized.case, progress)?;
    let certain = outcome.certain_false_finds();
    let (false_names, ambiguous_names) =
        outcome.false_finds().into_iter().cloned().partition(|found| certain.contains(&found));
    Ok(Detection {
        number: outcome.number,
        truth: outcome.truths[0].clone(),
        size: sized.size,
        is_found: outcome.missed().is_empty(),
        false_names,
        ambiguous_names,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn machine(seed: u64) -> (Drawn, [Motion; 5]) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        (draw::machine(&draw::WITHIN_TOLERANCE, &mut random), draw::session(&mut random))
    }

    fn truth(name: &'static str, parameters: &[(&'static str, f64)]) -> Truth {
        Truth { name, axis: "x", parameters: parameters.to_vec(), reference: None, phase_rad: 0.0 }
    }

    #[test]
    fn the_size_of_a_slope_is_the_slope_times_the_rms_of_the_position() {
        let (bare, session) = machine(3);
        let slope = truth("pitch_progressive", &[("slope_um_per_m", 40.0)]);
        let logs = noise_free(&bare, &session);
        let positions_mm = logs.iter().flat_map(|log| log.axes[0].motor.clone().unwrap());
        // Noise of the scale: 20 nm, and steps of 10 nm.
        let noise_mm = (20e-6_f64.powi(2) + 10e-6_f64.powi(2) / 12.0).sqrt();
        let expected = 40e-6 * numerics::rms(positions_mm) / noise_mm;
        let found = size(&slope, &bare, &session);
        // The force changes with the slope, and with it the stretch of the spring, only at the start, where the table is
        // not where the screw sets it; half a percent covers that.
        assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
    }

    #[test]
    fn the_size_of_a_constant_load_is_its_force_over_the_noise() {
        let (bare, session) = machine(4);
        let found = size(&truth("constant_load", &[("force_n", 30.0)]), &bare, &session);
        // 2 N and steps of 0.1 N. The presliding friction holds a part of the load at standstill, which is less than a
        // tenth of the time, and the loop takes some 20 ms to respond at each start.
        let expected = 30.0 / 2.0;
        assert!(found < 1.02 * expected && found > 0.8 * expected, "{found}");
    }

    #[test]
    fn an_effect_gets_the_size_that_is_aimed_at_or_stays_as_drawn() {
        let (bare, session) = machine(5);
        let mut random = ChaCha8Rng::seed_from_u64(6);
        for name in ["backlash", "windup", "latency", "stribeck", "servo_mismatch"] {
            let textbook = effect::draw(name, 0, &bare, &mut random);
            let (truth, size) = sized(&textbook, 3.0, &bare, &session);
            assert!((size / 3.0 - 1.0).abs() <= MAX_SIZE_ERROR, "{name}: {size}");
            assert_ne!(truth, textbook);
            let (largest, _) = sized(&textbook, 1e9, &bare, &session);
            assert_eq!(largest, textbook);
        }
    }

    #[test]
    fn effects_and_sizes_are_paired_completely() {
        let pairs: std::collections::BTreeSet<(&str, u64)> =
            (1..=187).map(|number| (nth(&NAMES, number), nth(&SIZES, number).to_bits())).collect();
        assert_eq!(pairs.len(), 187);
        assert_eq!((nth(&NAMES, 1), nth(&NAMES, 18)), ("backlash", "backlash"));
    }
}
