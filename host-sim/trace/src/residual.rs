//! Measured minus modelled, stage by stage, in µm and N.

use shared::config::Rates;

use super::added::AddedForce;
use super::axis_model::AxisModel;
use super::in_loop::{Loop, Start, closed_loop};
use super::last_tick::LastTick;
use super::predict;
use super::scope::Scope;
use super::set_aside::{self, Aside};
use super::signals::{AxisSignals, Signals, Smooth};
use super::wound;
use model::effects::Stage;
use model::servo;
use plant::parameters::AxisParameters;

/// What an axis is explained from.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    /// The logs.
    pub logs: &'a [Signals],
    /// Names of the machine's axes.
    pub names: &'a [String],
    /// Which of them is explained.
    pub axis: usize,
    /// Its loops.
    pub rates: Rates,
    /// What is known to be in the residuals, and is left out of them.
    pub aside: &'a [Aside],
    /// What tracing itself leaves of the machine, which is none of its residual: see [`super::own_error`].
    pub own: &'a [Part],
}

/// The residual of one stage over one log, sample by sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Stage.
    pub stage: Stage,
    /// Number of the log.
    pub log: usize,
    /// µm, or N for the force stage. Samples that do not count are zero.
    pub values: Vec<f64>,
}

/// Settling at the start of a log that is left out, s: what came before it is not known.
const SETTLING_S: f64 = 0.3;

impl Evidence<'_> {
    fn signals(&self, log: usize) -> &AxisSignals {
        &self.logs[log].axes[self.axis]
    }

    /// Where the motor or the table of the axis was, least and greatest, mm.
    #[must_use]
    pub fn travel_mm(&self) -> [f64; 2] {
        let places = (0..self.logs.len()).filter_map(|log| self.signals(log).table_or_motor());
        let places = places.flat_map(|smooth| smooth.position.iter().map(|m| 1e3 * m));
        numerics::min_max(places)
    }

    /// Samples at the start of each log that no residual counts.
    #[must_use]
    pub fn settling(&self, log: usize) -> usize {
        let log = &self.logs[log];
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0.3 s of samples")]
        let samples = (SETTLING_S / log.sample_s) as usize;
        samples.min(log.len() / 4)
    }

    /// Which samples of a stage of a log count: after the settling and, in the stages that hang on friction, in motion.
    pub fn counting(&self, stage: Stage, log: usize) -> impl Fn(usize) -> bool {
        let settling = self.settling(log);
        let AxisSignals { standing, saturated, .. } = self.signals(log);
        let hangs_on_friction = matches!(stage, Stage::Table | Stage::Force);
        let standing = if hangs_on_friction { &standing[..] } else { &[] };
        let saturated = if stage == Stage::Force { &saturated[..] } else { &[] };
        let is = |flags: &[bool], sample: usize| flags.get(sample).copied().unwrap_or(false);
        let is_aside =
            move |sample: usize| self.aside.iter().any(|aside| aside.covers(self, stage, log, sample));
        move |sample| {
            sample >= settling && !is(standing, sample) && !is(saturated, sample) && !is_aside(sample)
        }
    }

    /// The residuals of a scope's stages over all logs: log by log, the scope's stages in order.
    #[must_use]
    pub fn residuals(&self, model: &AxisModel, scope: &Scope) -> Vec<Part> {
        let parameters = model.parameters();
        let mut parts: Vec<Part> =
            (0..self.logs.len()).flat_map(|log| self.of_log(model, &parameters, scope, log)).collect();
        for part in &mut parts {
            self.take_own_out(part);
            set_aside::take_out(self, part);
        }
        parts
    }

    fn of_log(&self, model: &AxisModel, parameters: &AxisParameters, scope: &Scope, log: usize) -> Vec<Part> {
        let signals = self.signals(log);
        let sample_s = self.logs[log].sample_s;
        let drives = scope.stages.iter().any(|stage| matches!(stage, Stage::Table | Stage::Force));
        let last_tick = LastTick::new(&model.axis, self.rates);
        let driven = match (&signals.motor, &signals.motor_path) {
            (Some(motor), Some(path)) if drives => {
                let added = signals.added.as_ref().map(AddedForce::filtered_n);
                predict::driven(parameters, motor, path, sample_s, last_tick, added)
            }
            _ => predict::Driven::default(),
        };
        let part = |stage: &Stage| {
            let mut values = match stage {
                Stage::Table => {
                    let measured = signals.table.as_ref().map_or(&[][..], |table| &table.position);
                    let mut left = difference(measured, &driven.table_m, 1e6, model.table_zero_um);
                    wound::add_stretch(&mut left, parameters.forced_windup.as_ref(), signals);
                    if self.logs[log].has_own_zero && !model.axis.has_mass() {
                        self.take_zero_out(log, &mut left);
                    }
                    left
                }
                Stage::Force => {
                    let measured = signals.force.as_ref().map_or(&[][..], |force| &force.position);
                    difference(measured, &driven.force_n, 1.0, 0.0)
                }
                Stage::Motor => self.motor(model, parameters, signals),
                Stage::Tool => {
                    let tool = predict::tool(parameters, self.axis, self.names, &self.logs[log]);
                    let measured = signals.tool.as_ref().map_or(&[][..], |tool| &tool.position);
                    difference(measured, &tool.unwrap_or_default(), 1e6, model.tool_zero_um)
                }
            };
            let counts = self.counting(*stage, log);
            for (i, value) in values.iter_mut().enumerate() {
                if !counts(i) {
                    *value = 0.0;
                }
            }
            Part { stage: *stage, log, values }
        };
        scope.stages.iter().map(part).collect()
    }

    fn take_own_out(&self, part: &mut Part) {
        let of_part = |own: &&Part| own.stage == part.stage && own.log == part.log;
        let Some(own) = self.own.iter().find(of_part) else { return };
        for (value, own) in part.values.iter_mut().zip(&own.values) {
            // What does not count is zero and stays so.
            *value -= if *value == 0.0 { 0.0 } else { *own };
        }
    }

    /// Takes the mean of a table residual out: encoders that are zeroed when they are switched on.
    fn take_zero_out(&self, log: usize, left: &mut [f64]) {
        let counts = self.counting(Stage::Table, log);
        let counted = |i: &usize| counts(*i);
        let mean = numerics::mean((0..left.len()).filter(counted).map(|i| left[i]));
        for value in left {
            *value -= mean;
        }
    }

    fn motor(&self, model: &AxisModel, parameters: &AxisParameters, signals: &AxisSignals) -> Vec<f64> {
        let (Some(motor), Some(command)) = (&signals.motor, &signals.command) else { return Vec::new() };
        let simulated = self.in_loop(model, parameters, signals).map(|simulated| simulated.motor_m);
        // A loop that cannot run explains nothing: the residual is the following error itself.
        difference(&motor.raw, simulated.as_ref().unwrap_or(command), 1e6, 0.0)
    }

    /// The model in its loop behind a log's command; `None` where something lacks or the loop cannot run.
    #[must_use]
    pub fn in_loop(
        &self,
        model: &AxisModel,
        parameters: &AxisParameters,
        signals: &AxisSignals,
    ) -> Option<Loop> {
        let command = signals.command.as_ref()?;
        let settings = servo::settings(&model.axis, &parameters.servo).ok()?;
        let start = Start::of(command, signals, 1e-6 * model.table_zero_um)?;
        let sample_s = f64::from(self.rates.position_loop_divider) / self.rates.velocity_loop_hz;
        let added = signals.added.as_ref().map(|added| added.from_sample_n(&model.axis.effect, sample_s));
        closed_loop(parameters, &settings, self.rates, command, &added.unwrap_or_default(), start)
    }

    /// Standard deviation of the white noise in a stage's residual, µm or N: what no model can remove.
    #[must_use]
    pub fn noise(&self, model: &AxisModel, stage: Stage) -> f64 {
        // The sensors are the same in all logs: the quietest shows their noise, the others chatter, too.
        let noise = (0..self.logs.len()).map(|log| self.noise_of_log(model, stage, log));
        noise.reduce(f64::min).unwrap_or(0.0)
    }

    /// The same for one log.
    #[must_use]
    pub fn noise_of_log(&self, model: &AxisModel, stage: Stage, log: usize) -> f64 {
        let signals = self.signals(log);
        let of = |smooth: &Option<Smooth>, value: fn(&Smooth) -> f64| smooth.as_ref().map_or(0.0, value);
        let position = |smooth: &Option<Smooth>| 1e6 * of(smooth, |smooth| smooth.position_noise);
        match stage {
            Stage::Motor => 1e6 * of(&signals.motor, |motor| motor.noise),
            Stage::Table => position(&signals.table).hypot(position(&signals.motor)),
            Stage::Tool => {
                let table = if signals.table.is_some() { &signals.table } else { &signals.motor };
                position(&signals.tool).hypot(position(table))
            }
            Stage::Force => {
                let axis = &model.axis;
                let mass = if axis.is_rigid() { axis.table_mass_kg.unwrap_or(0.0) } else { 0.0 }
                    + axis.motor_mass_kg.unwrap_or(0.0);
                of(&signals.force, |force| force.position_noise)
                    .hypot(mass * of(&signals.motor, |motor| motor.acceleration_noise))
            }
        }
    }
}

/// (measured − modelled)·scale − zero.
fn difference(measured: &[f64], modelled: &[f64], scale: f64, zero: f64) -> Vec<f64> {
    measured.iter().zip(modelled).map(|(measured, modelled)| scale * (measured - modelled) - zero).collect()
}

/// Root mean square of a stage over all samples that count; not a number where none does.
#[must_use]
pub fn rms(parts: &[Part], stage: Stage, evidence: &Evidence<'_>) -> f64 {
    let (mut squares, mut count) = (0.0, 0usize);
    for part in parts.iter().filter(|part| part.stage == stage) {
        squares += part.values.iter().map(|r| r * r).sum::<f64>();
        let counts = evidence.counting(stage, part.log);
        count += (0..part.values.len()).filter(|&i| counts(i)).count();
    }
    if count == 0 { f64::NAN } else { (squares / count as f64).sqrt() }
}
