//! Residuals of the stages: measured minus predicted, in µm and N.

use std::borrow::Cow;

use super::axis_model::AxisModel;
use super::bump_subtraction::BumpSubtraction;
use super::exclusion::subtract_sine;
use super::fit_data::{FitData, ResidualSeries};
use super::scope::Scope;
use crate::input::added_force::AddedForce;
use crate::input::signals::AxisSignals;
use crate::input::smoothing::Smooth;
use crate::prediction::closed_loop::{ClosedLoopRun, Controlled, closed_loop};
use crate::prediction::driven::{self, Driven, DrivenInput};
use crate::prediction::force_sampling::ForceSampling;
use crate::prediction::force_windup;
use crate::prediction::initial_state::InitialState;
use crate::prediction::law_terms::LogVariables;
use crate::prediction::table_motion::MeasuredMotor;
use crate::prediction::{table_variable, tool, velocity_drive};
use model::axis::Drive;
use model::effects::{Channel, Stage};
use model::residual_law::{ResidualLaw, Term};
use model::residual_table::TableVariable;
use model::servo;
use numerics::resample::delayed_cubic;
use plant::parameters::AxisParameters;

/// What a model of a drive of which little is declared may leave, as a fraction of the difference that it describes.
const MAX_LEFT_OF_UNKNOWN_DRIVE: f64 = 0.3;

impl FitData<'_> {
    /// The residuals of a scope's stages over all logs, ordered by log, then by stage of the scope.
    #[must_use]
    pub fn residuals(&self, model: &AxisModel, scope: &Scope) -> Vec<ResidualSeries> {
        let parameters = model.parameters();
        let mut residuals: Vec<ResidualSeries> = (0..self.logs.len())
            .flat_map(|log| self.residuals_of_log(model, &parameters, scope, log))
            .collect();
        for series in &mut residuals {
            self.subtract_bias(series);
            self.subtract_excluded_sines(series);
        }
        for &stage in &scope.stages {
            for bump in self.exclusions.iter().filter_map(|exclusion| exclusion.bump(stage)) {
                let has_means_subtracted = stage == Stage::Table && !model.axis.settings.has_mass();
                let subtraction = BumpSubtraction { data: self, stage, bump, has_means_subtracted };
                subtraction.subtract_from(&mut residuals);
            }
        }
        residuals
    }

    fn residuals_of_log(
        &self,
        model: &AxisModel,
        parameters: &AxisParameters,
        scope: &Scope,
        log: usize,
    ) -> Vec<ResidualSeries> {
        let driven =
            if scope.is_driven() { self.driven(model, parameters, log) } else { None }.unwrap_or_default();
        let series = |stage: &Stage| {
            let mut values = match stage {
                Stage::Table => self.table(model, parameters, &driven, log),
                Stage::Force => {
                    let measured = self.signals(log).force.as_ref().map_or(&[][..], |force| &force.value);
                    difference(measured, &driven.force_n, 1.0, 0.0)
                }
                Stage::Motor => self.motor(model, parameters, self.signals(log)),
                Stage::Tool => {
                    let screw = scope.shown_in.table_in_tool.then_some(&driven.table_m[..]);
                    let tool = tool::tool(parameters, (self.axis, self.names), &self.logs[log], screw);
                    let measured = self.signals(log).tool.as_ref().map_or(&[][..], |tool| &tool.value);
                    let mut residual =
                        difference(measured, &tool.unwrap_or_default(), 1e6, model.tool_zero_um);
                    if screw.is_some() {
                        force_windup::add_stretch(&mut residual, parameters, self.signals(log));
                    }
                    residual
                }
            };
            for table in model.axis.empirical.iter().filter(|table| table.stage() == *stage) {
                let Some(at) = table_variable::values(&self.logs[log], self.axis, table.variable) else {
                    continue;
                };
                values.iter_mut().zip(at).for_each(|(value, at)| *value -= table.value(at));
            }
            for law in model.axis.residual_law.iter().filter(|law| law.stage() == *stage) {
                self.subtract_law(law, log, &mut values);
            }
            let counts = self.counting(*stage, log);
            for (i, value) in values.iter_mut().enumerate() {
                if !counts(i) {
                    *value = 0.0;
                }
            }
            ResidualSeries { stage: *stage, log, values }
        };
        scope.stages.iter().map(series).collect()
    }

    /// The values of a law over a log, µm or N.
    #[must_use]
    pub fn law_values(&self, law: &ResidualLaw, log: usize) -> Vec<f64> {
        let mut left = vec![0.0; self.logs[log].len()];
        self.subtract_law(law, log, &mut left);
        left.into_iter().map(|value| -value).collect()
    }

    /// Subtracts a law. Terms with a variable that the log does not contain are left out.
    fn subtract_law(&self, law: &ResidualLaw, log: usize, values: &mut [f64]) {
        let variables: Vec<TableVariable> = law.term.iter().flat_map(Term::variables).collect();
        let of_log = LogVariables::new(&self.logs[log], self.axis, law.stage(), &variables);
        for value in &mut *values {
            *value -= law.constant;
        }
        for term in law.term.iter().filter(|term| of_log.has(term)) {
            let coefficients = term.coefficients();
            for (coefficient, part) in coefficients.into_iter().zip(of_log.parts(term)) {
                values.iter_mut().zip(part).for_each(|(value, part)| *value -= coefficient * part);
            }
        }
    }

    /// Table and force driven by the measured motor; `None` without a motor channel.
    fn driven(&self, model: &AxisModel, parameters: &AxisParameters, log: usize) -> Option<Driven> {
        let signals = self.signals(log);
        let commanded = signals.motor_is_command.then(|| parameters.with_motor_as_commanded());
        let parameters = signals.at_temperature(commanded.as_ref().unwrap_or(parameters));
        let input = DrivenInput {
            measured: self.measured_motor(log)?,
            sample_s: self.logs[log].sample_s,
            sampling: ForceSampling::new(&model.axis.settings.controller, &parameters.servo, self.rates),
            added_n: signals.added_force.as_ref().map(AddedForce::filtered_n),
        };
        Some(driven::driven(&parameters, &input))
    }

    fn measured_motor(&self, log: usize) -> Option<MeasuredMotor<'_>> {
        let AxisSignals { motor, motor_path, start_s, .. } = self.signals(log);
        Some(MeasuredMotor { motor: motor.as_ref()?, path: motor_path.as_ref()?, start_s: *start_s })
    }

    fn table(&self, model: &AxisModel, parameters: &AxisParameters, driven: &Driven, log: usize) -> Vec<f64> {
        let signals = self.signals(log);
        let measured = signals.table.as_ref().map_or(&[][..], |table| &table.value);
        let log_of_axis = &self.logs[log];
        let time_s = |sample: usize| log_of_axis.start_s + sample as f64 * log_of_axis.sample_s;
        let table_m = driven.table_m.iter().enumerate();
        let read_m: Vec<f64> = table_m.map(|(i, m)| m + parameters.scale.error_m(*m, time_s(i))).collect();
        let mut residual = difference(measured, &read_m, 1e6, model.table_zero_um);
        force_windup::add_stretch(&mut residual, parameters, signals);
        if self.logs[log].has_own_zero && !model.axis.settings.has_mass() {
            self.subtract_mean(log, &mut residual);
        }
        residual
    }

    /// The error of the tracer's own simulation in a series of the residuals, if it is known.
    #[must_use]
    pub fn bias_of(&self, series: &ResidualSeries) -> Option<&ResidualSeries> {
        self.bias.iter().find(|bias| bias.stage == series.stage && bias.log == series.log)
    }

    fn subtract_bias(&self, series: &mut ResidualSeries) {
        let Some(bias) = self.bias_of(series) else { return };
        for (value, bias) in series.values.iter_mut().zip(&bias.values) {
            // Samples that do not count are zero and remain so.
            *value -= if *value == 0.0 { 0.0 } else { *bias };
        }
    }

    fn subtract_excluded_sines(&self, series: &mut ResidualSeries) {
        for frequency_hz in
            self.exclusions.iter().filter_map(|exclusion| exclusion.frequency_hz(series.stage))
        {
            let step_rad = std::f64::consts::TAU * frequency_hz * self.logs[series.log].sample_s;
            let counts: Vec<bool> =
                (0..series.values.len()).map(self.counting(series.stage, series.log)).collect();
            subtract_sine(&mut series.values, &counts, step_rad);
        }
    }

    /// Subtracts the mean of a table residual, as the zeros of the encoders may differ between recordings.
    fn subtract_mean(&self, log: usize, residual: &mut [f64]) {
        let counts = self.counting(Stage::Table, log);
        let counted = |i: &usize| counts(*i);
        let mean = numerics::mean((0..residual.len()).filter(counted).map(|i| residual[i]));
        for value in residual {
            *value -= mean;
        }
    }

    fn motor(&self, model: &AxisModel, parameters: &AxisParameters, signals: &AxisSignals) -> Vec<f64> {
        let (Some(motor), Some(command)) = (&signals.motor, &signals.command) else { return Vec::new() };
        let sample_s = self.sample_s();
        let simulated = match model.axis.settings.controller.drive {
            Drive::Torque => self.closed_loop(model, parameters, signals).map(|simulated| simulated.motor_m),
            Drive::Velocity => {
                velocity_drive::motor(&model.axis.settings, &parameters.servo, command, sample_s)
            }
            Drive::Stepper => {
                let dead_time_s = parameters.servo.velocity_drive.dead_time_s;
                let command = delayed_cubic(command.clone(), dead_time_s, sample_s);
                Some(parameters.stepper.rotor_m(&command, sample_s))
            }
        };
        // Without a valid closed loop the residual is the following error itself.
        difference(&motor.raw, simulated.as_ref().unwrap_or(command), 1e6, 0.0)
    }

    /// Period of the position loop, s: that of the logs.
    fn sample_s(&self) -> f64 {
        f64::from(self.rates.position_loop_divider) / self.rates.velocity_loop_hz
    }

    /// The command that the controller received, m: the logged one at the instants at which it was in force.
    fn commanded<'s>(&self, parameters: &AxisParameters, signals: &'s AxisSignals) -> Option<Cow<'s, [f64]>> {
        let command = signals.command.as_ref()?;
        let late_s = parameters.latency_s(Channel::Command);
        if late_s == 0.0 {
            return Some(Cow::Borrowed(command));
        }
        let sample_s = self.sample_s();
        Some(Cow::Owned(delayed_cubic(command.clone(), -late_s, sample_s)))
    }

    /// The model simulated in closed loop with a log's command; `None` if a channel or a setting is missing or the loop
    /// cannot be simulated.
    #[must_use]
    pub fn closed_loop(
        &self,
        model: &AxisModel,
        parameters: &AxisParameters,
        signals: &AxisSignals,
    ) -> Option<ClosedLoopRun> {
        if !model.axis.settings.has_mass() {
            return None;
        }
        let command = self.commanded(parameters, signals)?;
        let settings = servo::settings(&model.axis.settings, &parameters.servo).ok()?;
        let mut start =
            InitialState::of(&command, signals, 1e-6 * model.table_zero_um, &self.options.samples)?;
        start.table_m =
            start.table_m.map(|reading_m| parameters.scale.table_of_reading_m(reading_m, start.time_s));
        let sample_s = self.sample_s();
        let added =
            signals.added_force.as_ref().map(|added| added.from_sample_n(&model.axis.effect, sample_s));
        let controlled = Controlled { settings: &settings, rates: self.rates };
        let parameters = signals.at_temperature(parameters);
        closed_loop(&parameters, controlled, &command, &added.unwrap_or_default(), start)
    }

    /// Standard deviation of the white noise in a stage's residual, µm or N: the smallest residual that a model can reach.
    ///
    /// The value is that of the log with the least noise: the sensors are the same in all logs, and vibration in a log
    /// increases the estimate.
    #[must_use]
    pub fn noise(&self, model: &AxisModel, stage: Stage) -> f64 {
        let noise = self.logs_with(stage).map(|log| self.noise_of_log(model, stage, log));
        noise.reduce(f64::min).unwrap_or(0.0)
    }

    /// Largest residual of a stage that a model which describes the logs leaves, µm or N. Of a drive of which little is declared, the
    /// model is an approximation: it may leave a part of what the channel differs from the one that drives its prediction.
    #[must_use]
    pub fn max_described(&self, model: &AxisModel, stage: Stage) -> f64 {
        let by_noise = self.options.verdict.max_described(self.noise(model, stage));
        if model.axis.settings.controller.drive == Drive::Torque {
            return by_noise;
        }
        by_noise.max(MAX_LEFT_OF_UNKNOWN_DRIVE * self.difference_to_upstream_um(stage))
    }

    /// Rms of the difference between a channel and the one that drives its prediction, without its mean, µm; 0 for the force.
    fn difference_to_upstream_um(&self, stage: Stage) -> f64 {
        let mut differences = Vec::new();
        for log in self.logs_with(stage) {
            let signals = self.signals(log);
            let motor = signals.motor.as_ref();
            let (channel, upstream) = match stage {
                Stage::Motor => (motor, signals.command.as_deref()),
                Stage::Table => (signals.table.as_ref(), motor.map(|motor| &motor.value[..])),
                Stage::Tool => {
                    (signals.tool.as_ref(), signals.table_or_motor().map(|smooth| &smooth.value[..]))
                }
                Stage::Force => (None, None),
            };
            let (Some(channel), Some(upstream)) = (channel, upstream) else { continue };
            let of_log: Vec<f64> = channel.value.iter().zip(upstream).map(|(a, b)| 1e6 * (a - b)).collect();
            let mean = numerics::mean(of_log.iter().copied());
            differences.extend(of_log.into_iter().map(|difference| difference - mean));
        }
        if differences.is_empty() { 0.0 } else { numerics::rms(differences) }
    }

    /// Standard deviation of the white noise in a stage's residual over one log.
    #[must_use]
    pub fn noise_of_log(&self, model: &AxisModel, stage: Stage, log: usize) -> f64 {
        let signals = self.signals(log);
        let of = |smooth: &Option<Smooth>, value: fn(&Smooth) -> f64| smooth.as_ref().map_or(0.0, value);
        let position = |smooth: &Option<Smooth>| 1e6 * of(smooth, |smooth| smooth.value_noise);
        match stage {
            Stage::Motor => 1e6 * of(&signals.motor, |motor| motor.noise),
            Stage::Table => libm::hypot(position(&signals.table), position(&signals.motor)),
            Stage::Tool => {
                libm::hypot(position(&signals.tool), 1e6 * self.noise_of_predicted_tool_m(model, log))
            }
            Stage::Force => {
                let axis = &model.axis.settings;
                let mass = if axis.is_rigid() { axis.mechanics.table_mass_kg.unwrap_or(0.0) } else { 0.0 }
                    + axis.mechanics.motor_mass_kg.unwrap_or(0.0);
                libm::hypot(
                    of(&signals.force, |force| force.value_noise),
                    mass * of(&signals.motor, |motor| motor.acceleration_noise),
                )
            }
        }
    }

    /// Standard deviation of the white noise that the tables pass on to a predicted tool, m: by their positions, and by their accelerations
    /// where the tool depends on these. A mode of the tool is not considered.
    fn noise_of_predicted_tool_m(&self, model: &AxisModel, log: usize) -> f64 {
        let sample_s = self.logs[log].sample_s;
        let tool = model.parameters().tool;
        let own = self.signals(log).table_or_motor();
        let per_own_s2 = tool.per_own_acceleration_s2();
        let own_m = own.map_or(0.0, |table| table.noise_with_acceleration(per_own_s2, sample_s));
        let of_other = |(name, per_s2): (&str, f64)| {
            let index = self.names.iter().position(|other| other == name)?;
            let table = self.logs[log].axes[index].table_or_motor()?;
            Some(per_s2 * table.quiet_acceleration_noise(sample_s))
        };
        tool.per_other_acceleration_s2().filter_map(of_other).fold(own_m, libm::hypot)
    }
}

/// (measured − predicted)·scale − zero.
fn difference(measured: &[f64], predicted: &[f64], scale: f64, zero: f64) -> Vec<f64> {
    measured
        .iter()
        .zip(predicted)
        .map(|(measured, predicted)| scale * (measured - predicted) - zero)
        .collect()
}
