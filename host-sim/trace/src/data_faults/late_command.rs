//! A command that is logged late: the motor moves before the command that it follows.
//!
//! The delay of a closed loop with an unknown gain or feed-forward resembles a shift of the command at low frequencies. A
//! shift is reported only if it removes nearly all of the difference between the motor and the declared loop, and gain and
//! feed-forward together do not.

use rayon::prelude::*;

use super::fault::{DataFault, FaultHandling, FaultKind};
use super::shifted::shifted;
use crate::fit::axis_model::AxisModel;
use crate::fit::declared_machine::DeclaredMachine;
use crate::fit::fit_data::FitData;
use crate::input::signals::{AxisSignals, Signals};
use crate::options::FaultOptions;
use files::log::Channel;
use model::effects::Stage;

/// Number of samples at the start of a log that are simulated.
const SAMPLES: usize = 6000;
/// Largest shift that is looked for, samples.
const MAX_SHIFT: f64 = 200.0;
/// Number of Gauss-Newton steps of the fit of gain and feed-forward.
const STEPS: usize = 6;

/// The simulated motor of one axis in one log.
struct Loop<'a> {
    data: &'a FitData<'a>,
    model: AxisModel,
    log: usize,
    first: usize,
}

impl Loop<'_> {
    fn signals(&self) -> &AxisSignals {
        self.data.signals(self.log)
    }

    /// Motor minus simulated motor after the settling, m, with the command `late` samples earlier, the gain and the
    /// feed-forward changed by these fractions.
    fn residual(&self, late: usize, [gain, feedforward]: [f64; 2]) -> Option<Vec<f64>> {
        let signals = self.signals();
        let (command, motor) = (signals.command.as_ref()?, signals.motor.as_ref()?);
        let end = command.len().min(SAMPLES + late);
        let command = command[..end].get(late..)?.to_vec();
        let mut model = self.model.clone();
        let controller = &mut model.axis.settings.controller;
        controller.position_gain_per_s = controller.position_gain_per_s.map(|value| value * (1.0 + gain));
        let percent = controller.feedforward_percent.unwrap_or(0.0);
        controller.feedforward_percent = Some(percent + 100.0 * feedforward);
        let signals = AxisSignals { command: Some(command), ..signals.clone() };
        let simulated = self.data.closed_loop(&model, &model.parameters(), &signals)?.motor_m;
        let pairs = motor.raw.iter().zip(&simulated).skip(self.first);
        Some(pairs.map(|(measured, simulated)| measured - simulated).collect())
    }

    fn rms(&self, late: usize) -> Option<f64> {
        self.residual(late, [0.0; 2]).map(numerics::rms)
    }

    /// Number of samples by which the motor leads the simulated one, from the regression of the residual on the velocity.
    fn lead(&self, residual: &[f64]) -> Option<f64> {
        let velocity = &self.signals().motor.as_ref()?.velocity;
        let pairs = || residual.iter().zip(velocity.iter().skip(self.first));
        let cross: f64 = pairs().map(|(residual, velocity)| residual * velocity).sum();
        let own: f64 = pairs().map(|(_, velocity)| velocity * velocity).sum();
        (own > 0.0).then(|| cross / own / self.data.logs[self.log].sample_s)
    }

    /// Smallest rms residual with gain and feed-forward fitted.
    fn rms_of_rival(&self) -> Option<f64> {
        const STEP: f64 = 1e-3;
        let mut at = [0.0; 2];
        let mut residual = self.residual(0, at)?;
        let mut least = numerics::rms(residual.iter().copied());
        for _ in 0..STEPS {
            let slope = |change: [f64; 2]| -> Option<Vec<f64>> {
                let moved = self.residual(0, [at[0] + change[0], at[1] + change[1]])?;
                Some(moved.iter().zip(&residual).map(|(moved, here)| (moved - here) / STEP).collect())
            };
            let (a, b) = (slope([STEP, 0.0])?, slope([0.0, STEP])?);
            let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let (aa, ab, bb) = (product(&a, &a), product(&a, &b), product(&b, &b));
            let (ar, br) = (product(&a, &residual), product(&b, &residual));
            let determinant = aa * bb - ab * ab;
            if determinant <= 1e-9 * aa * bb {
                break;
            }
            let step = [(ab * br - bb * ar) / determinant, (ab * ar - aa * br) / determinant];
            at = [(at[0] + step[0]).clamp(-0.8, 4.0), (at[1] + step[1]).clamp(-2.0, 2.0)];
            let Some(next) = self.residual(0, at) else { break };
            residual = next;
            least = least.min(numerics::rms(residual.iter().copied()));
        }
        Some(least)
    }
}

/// Number of samples by which the command of a log is late; `None` if it is not, or if that is not certain.
fn late_samples(data: &FitData<'_>, model: &AxisModel, log: usize, options: &FaultOptions) -> Option<usize> {
    let signals = data.signals(log);
    let noise = signals.motor.as_ref()?.noise;
    let simulated = Loop { data, model: model.clone(), log, first: data.settling(log) };
    let residual = simulated.residual(0, [0.0; 2])?;
    let unshifted = numerics::rms(residual.iter().copied());
    let lead = simulated.lead(&residual)?;
    let smallest = (options.min_jump_noise * noise).max(1e-6 * options.min_jump_um);
    if unshifted < smallest || !(0.5..MAX_SHIFT).contains(&lead) {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "less than MAX_SHIFT")]
    let late = lead.round() as usize;
    let candidates =
        (late.saturating_sub(1).max(1)..=late + 1).filter_map(|late| Some((late, simulated.rms(late)?)));
    let (late, least) = candidates.min_by(|a, b| a.1.total_cmp(&b.1))?;
    if least > options.max_shifted_remainder * unshifted {
        return None;
    }
    let rival = simulated.rms_of_rival()?;
    (rival > options.min_rival_ratio * least).then_some(late)
}

/// Number of samples by which the command of each log is late; `None` for a log in which it is not, or which does not show it
/// with certainty.
#[must_use]
pub fn lateness(data: &FitData<'_>, model: &AxisModel) -> Vec<Option<usize>> {
    let late = |log| late_samples(data, model, log, &data.options.faults);
    (0..data.logs.len()).into_par_iter().map(late).collect()
}

/// The lateness that all logs of a session have, by the lateness of each: a recorder is late in every log, but a motion of
/// one frequency does not show it. `None` unless most logs show it, and all of them the same.
#[must_use]
pub fn of_session(lateness: &[Option<usize>]) -> Option<usize> {
    let shown: Vec<usize> = lateness.iter().copied().flatten().collect();
    let &first = shown.first()?;
    let is_most = shown.len() > 1 && 2 * shown.len() > lateness.len();
    (is_most && shown.iter().all(|&late| late == first)).then_some(first)
}

/// A command that is late in a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Late {
    /// 0: fit logs, 1: validation logs.
    pub set: usize,
    /// Index of the log.
    pub log: usize,
    /// Index of the axis.
    pub axis: usize,
    /// Number of samples by which it is late.
    pub samples: usize,
}

/// Signals whose late commands are shifted back.
pub struct Shifted {
    /// Signals of the fit logs and of the validation logs.
    pub signals: [Vec<Signals>; 2],
    /// The commands that were late, as faults.
    pub faults: Vec<DataFault>,
    /// Where they were late.
    pub late: Vec<Late>,
}

/// Shifts commands back that are logged late, in all logs.
#[must_use]
pub fn shifted_back(declared: &DeclaredMachine, mut signals: [Vec<Signals>; 2]) -> Shifted {
    let DeclaredMachine { machine, names, axes, options } = declared;
    let (mut faults, mut all_late) = (Vec::new(), Vec::new());
    for (axis, model) in axes.iter().enumerate() {
        let found = signals.each_ref().map(|logs| {
            let data = FitData::new(logs, names, axis, machine.rates(), options);
            lateness(&data, model)
        });
        let of_session = of_session(&found.concat());
        for (set, (logs, found)) in signals.iter_mut().zip(found).enumerate() {
            for (log, (signals, lateness)) in logs.iter_mut().zip(found).enumerate() {
                if let Some(samples) = of_session.or(lateness) {
                    faults.push(shift_back(signals, axis, &names[axis], samples));
                    all_late.push(Late { set, log, axis, samples });
                }
            }
        }
    }
    Shifted { signals, faults, late: all_late }
}

/// Shifts the command of an axis of a log back, excludes the samples at its end from the motor stage, as their command was
/// not logged, and returns the fault.
pub fn shift_back(log: &mut Signals, axis: usize, name: &str, late: usize) -> DataFault {
    let count = log.len();
    let signals = &mut log.axes[axis];
    if let Some(command) = &mut signals.command {
        *command = shifted(command, isize::try_from(late).unwrap_or(0));
    }
    signals.mark_faulty(Stage::Motor, count.saturating_sub(late)..count, count);
    DataFault {
        axis: name.to_owned(),
        channel: Some(Channel::Command),
        kind: FaultKind::Shifted,
        log: log.source.clone(),
        at_s: None,
        size: Some(1e3 * late as f64 * log.sample_s),
        frequency_hz: None,
        count: 1,
        treatment: FaultHandling::Corrected,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn most_logs_show_the_lateness_of_a_session() {
        assert_eq!(of_session(&[Some(20), Some(20), None, Some(20), Some(20)]), Some(20));
        // Half of the logs, one log, and logs that differ.
        assert_eq!(of_session(&[Some(1), None, None, Some(1)]), None);
        assert_eq!(of_session(&[Some(1)]), None);
        assert_eq!(of_session(&[Some(1), Some(2), Some(1)]), None);
    }
}
