//! The mechanical model simulated with the measured force alone, without feedback.
//!
//! The model of a rigid axis is integrated from the measured state with the logged force. Its deviation from the measured
//! motor is the double integral of the force error divided by the mass. As it grows without bound, the simulation is
//! restarted at regular intervals.

use std::ops::Range;

use crate::input::signals::AxisSignals;
use crate::prediction::initial_state::steady_motion;
use model::effects::{Channel, Effect, Timing};
use model::machine::Axis;
use numerics::resample::delayed_linear;
use numerics::squares_of_difference;
use plant::mechanics::Stepper;
use plant::parameters::AxisParameters;

/// Durations after which the simulation is restarted, s.
const DURATIONS_S: [f64; 4] = [0.1, 0.5, 2.0, 6.0];

/// Position error of free runs of one length.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeRun {
    /// Axis.
    pub axis: String,
    /// Duration of each run, s.
    pub seconds: f64,
    /// Number of runs.
    pub runs: usize,
    /// Error of the declared model over all runs, µm or mdeg rms; written with the unit in its key.
    pub declared: f64,
    /// Error of the model with the effects found over all runs, in the same unit.
    pub after: f64,
    /// The constant error of the force that alone would make [`Self::after`], N or N·m.
    pub force_error: f64,
}

/// Part of the rms of the force that is added to it to find how far an error of the force moves the axis, and the least such force, N.
const ADDED_PART: f64 = 1e-3;
const LEAST_ADDED_N: f64 = 1e-3;

/// Free runs of the declared and of the better model, both fitted, over held-out logs. Empty if the axis is not rigid (the
/// initial stretch of its spring is not measured), or if motor, force or masses are missing.
///
/// The `latency` of the force that was found is also applied to the declared model, as it is not a property of the mechanics.
#[must_use]
pub fn free_runs(name: &str, declared: &Axis, better: &Axis, logs: &[(&AxisSignals, f64)]) -> Vec<FreeRun> {
    if !better.settings.is_rigid() || !better.settings.has_mass() || logs.is_empty() {
        return Vec::new();
    }
    let is_timing =
        |effect: &&Effect| matches!(effect.timing(), Some(Timing::Reading { channel: Channel::Force, .. }));
    let mut timed = declared.clone();
    timed.effect.retain(|effect| !is_timing(&effect));
    timed.effect.extend(better.effect.iter().filter(is_timing).cloned());
    let models = [&timed, better].map(AxisParameters::of);
    let of_duration = |&seconds: &f64| {
        let of_log =
            |&(signals, sample_s): &(&AxisSignals, f64)| Squares::of(&models, signals, sample_s, seconds);
        let sum = logs.iter().filter_map(of_log).reduce(Squares::plus).filter(|sum| sum.samples > 0)?;
        let rms = |squares: f64| (squares / sum.samples as f64).sqrt();
        let after_m = rms(sum.after);
        Some(FreeRun {
            axis: name.to_owned(),
            seconds,
            runs: sum.runs,
            declared: 1e6 * rms(sum.declared),
            after: 1e6 * after_m,
            force_error: after_m / rms(sum.per_n),
        })
    };
    DURATIONS_S.iter().filter_map(of_duration).collect()
}

/// Sums over the samples of free runs.
#[derive(Clone, Copy)]
struct Squares {
    samples: usize,
    runs: usize,
    /// Errors of the models, m².
    declared: f64,
    after: f64,
    /// Displacement of the better model by a constant force, m²/N².
    per_n: f64,
}

impl Squares {
    fn of(
        [declared, better]: &[AxisParameters; 2],
        signals: &AxisSignals,
        sample_s: f64,
        seconds: f64,
    ) -> Option<Self> {
        let motor = signals.motor.as_ref()?;
        let [declared, better] = [declared, better].map(|model| signals.at_temperature(model));
        let rms_n = numerics::rms(signals.force.as_ref()?.raw.iter().copied());
        let added_n = (ADDED_PART * rms_n).max(LEAST_ADDED_N);
        let runs_of = |parameters: &AxisParameters, added_n| {
            Runs::of(parameters, signals, [sample_s, seconds, added_n])
        };
        let [declared, after] = [runs_of(&declared, 0.0)?, runs_of(&better, 0.0)?];
        let pushed = runs_of(&better, added_n)?;
        let measured = &motor.raw[after.samples()];
        Some(Self {
            samples: after.motor_m.len(),
            runs: after.count,
            declared: squares_of_difference(&declared.motor_m, measured),
            after: squares_of_difference(&after.motor_m, measured),
            per_n: squares_of_difference(&pushed.motor_m, &after.motor_m) / (added_n * added_n),
        })
    }

    fn plus(self, other: Self) -> Self {
        Self {
            samples: self.samples + other.samples,
            runs: self.runs + other.runs,
            declared: self.declared + other.declared,
            after: self.after + other.after,
            per_n: self.per_n + other.per_n,
        }
    }
}

/// Simulated motors of consecutive runs over one log; an incomplete run at its end is left out.
struct Runs {
    motor_m: Vec<f64>,
    count: usize,
}

impl Runs {
    /// Runs start at the second sample, as the first has no central difference.
    const START: usize = 1;

    /// With the sample time and the duration of a run, s, and a constant force that is added to the measured one, N.
    fn of(
        parameters: &AxisParameters,
        signals: &AxisSignals,
        [sample_s, seconds, added_n]: [f64; 3],
    ) -> Option<Self> {
        let (motor, force) = (signals.motor.as_ref()?, signals.force.as_ref()?);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "samples of seconds")]
        let length = ((seconds / sample_s).round() as usize).max(2);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1, a handful")]
        let substeps = (sample_s / parameters.max_step_s()).ceil().max(1.0) as u32;
        let lag_s = parameters.servo.drive_time_constant_s(0.0);
        let stepper = Stepper::new(parameters, lag_s, sample_s / f64::from(substeps));
        let late = parameters.latency_s(Channel::Force) / sample_s;
        let force_n = delayed_linear(&force.raw, -1.0 - late);
        let n = motor.raw.len();
        let mut runs = Self { motor_m: Vec::new(), count: 0 };
        for start in (Self::START..n).step_by(length).take_while(|start| start + length <= n) {
            let time_s = signals.start_s + start as f64 * sample_s;
            let mut motion = steady_motion(parameters, motor.value[start], motor.velocity[start], time_s);
            // The force from a sample to the next is logged with the next sample.
            for force_n in &force_n[start..start + length] {
                runs.motor_m.push(motion.motor_m);
                (0..substeps).for_each(|_| stepper.step(parameters, &mut motion, force_n + added_n));
            }
            runs.count += 1;
        }
        Some(runs)
    }

    /// The samples of the log that were simulated.
    const fn samples(&self) -> Range<usize> {
        Self::START..Self::START + self.motor_m.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::signals::Signals;
    use crate::options::SampleOptions;
    use files::log::{AxisLog, Log, Unit};

    /// A mass of 100 kg, declared 2 % too high, under 50 N without friction: x = F·t²/(2·m), so that the model lags by 2 % of
    /// x.
    #[test]
    fn the_error_of_a_mass_grows_with_the_square_of_time() {
        let axis = |table_mass_kg| {
            let mut axis = Axis::default();
            axis.settings.mechanics.table_mass_kg = Some(table_mass_kg);
            axis
        };
        let at = |t: f64| 0.5 * 0.5 * t * t;
        let mut log = AxisLog::new("x", Unit::Millimetre);
        log.motor = Some((0..2001).map(|i| 1e3 * at(1e-3 * f64::from(i))).collect());
        log.force = Some(vec![50.0; 2001]);
        let log = Log::new("test", 0.0, 1e-3, [log]);
        let signals = Signals::new(&log, &["x".to_owned()], &SampleOptions::default());
        let runs = free_runs("x", &axis(102.0), &axis(100.0), &[(&signals.axes[0], 1e-3)]);
        // Over a run of duration T, the mean of x² is (a·T²/2)²/5.
        for (run, seconds) in runs.iter().zip(DURATIONS_S) {
            let expected_um = 1e6 * (1.0 - 1.0 / 1.02) * 0.25 * seconds * seconds / 5.0f64.sqrt();
            assert!((run.declared / expected_um - 1.0).abs() < 0.02, "{run:?} {expected_um}");
            assert!(run.after < 0.01 * expected_um, "{run:?}");
            // A constant error of the force of 1 N is as much as 1/50 of the motion.
            let um_per_n = 1e6 * 0.005 * seconds * seconds / 5.0f64.sqrt();
            assert!((run.after / run.force_error / um_per_n - 1.0).abs() < 0.02, "{run:?} {um_per_n}");
        }
        assert_eq!(runs.iter().map(|run| run.runs).collect::<Vec<_>>(), [20, 4, 1]);
    }
}
