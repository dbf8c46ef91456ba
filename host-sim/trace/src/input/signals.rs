//! A log prepared for tracing: channels in SI units, filtered and differentiated, with the noise of each.

use std::borrow::Cow;
use std::ops::Range;

use super::added_force::AddedForce;
use super::motor_path::MotorPath;
use super::smoothing::Smooth;
use super::temperature;
use crate::options::SampleOptions;
use files::log::{AxisLog, Log, Unit};
use model::effects::{LoggedChannels, Stage};
use plant::guide_temperature::GuideTemperature;
use plant::parameters::AxisParameters;

/// One axis of one log, in SI units. For rotary axes, degrees are treated as mm and N·m as N.
#[derive(Clone, Debug)]
pub struct AxisSignals {
    /// Time of the first sample on the session's clock, s.
    pub start_s: f64,
    /// Unit of the axis in its log; `None` if the log does not contain the axis.
    pub unit: Option<Unit>,
    /// Position command.
    pub command: Option<Vec<f64>>,
    /// Motor encoder; of a stepper motor without one, the command.
    pub motor: Option<Smooth>,
    /// Whether [`Self::motor`] is the command.
    pub motor_is_command: bool,
    /// Motor position between the samples.
    pub motor_path: Option<MotorPath>,
    /// Linear scale.
    pub table: Option<Smooth>,
    /// Tool-point probe.
    pub tool: Option<Smooth>,
    /// Whether each sample is within a standstill. Friction at standstill depends on how the axis came to rest and on the
    /// creep caused by sensor noise, which no model of the motion predicts.
    pub standstill: Vec<bool>,
    /// First sample from which the state of the friction is that of sliding; 0 if the log starts in a standstill.
    pub sliding_from: usize,
    /// Whether the force of each sample is at its limit; empty if none is.
    pub saturated: Vec<bool>,
    /// Whether a fault of the data spoils each sample, by stage in the order of [`Stage`]; empty if none does.
    pub faulty: [Vec<bool>; 4],
    /// Drive force over the velocity tick that ends at the sample, N; its filtered value is [`Smooth::value`].
    pub force: Option<Smooth>,
    /// Known force that was added to that of the controller and is contained in `force`; `None`: none was added.
    pub added_force: Option<AddedForce>,
    /// Temperature of the guide; `None`: not measured.
    pub temperature: Option<GuideTemperature>,
}

/// One log.
#[derive(Clone, Debug)]
pub struct Signals {
    /// File or name of the log.
    pub source: String,
    /// First time on the session's clock, s.
    pub start_s: f64,
    /// Sample time, s.
    pub sample_s: f64,
    /// Whether the zeros of the encoders may differ from those of the first fitted log, as this is another recording.
    pub has_own_zero: bool,
    /// Number of samples at the start that are simulated but not evaluated, if these signals are a piece of a longer log: the
    /// state of the machine at the start of a piece is not known. 0: the settling time.
    pub lead_in: usize,
    /// Number of samples at the end that are not evaluated, as the filters reach beyond the end of a piece.
    pub lead_out: usize,
    /// Signals of the axes, in the order of the machine.
    pub axes: Vec<AxisSignals>,
}

impl Signals {
    /// Prepares a log for a machine with these axes. An axis that the log does not contain has no channels.
    #[must_use]
    pub fn new(log: &Log, axes: &[String], options: &SampleOptions) -> Self {
        Self::of_machine(log, axes, &[], options)
    }

    /// As [`Signals::new`]; of the axes with these names, the motor is taken as the command where the log has no reading of it.
    #[must_use]
    pub fn of_machine(log: &Log, axes: &[String], steppers: &[String], options: &SampleOptions) -> Self {
        let sample_s = log.sample_time_s;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
        let half_window = ((options.smoothing_s / sample_s).round() as usize).clamp(2, 50);
        let prepared = |name: &String| {
            let found = log.axes.iter().find(|axis| axis.name == *name);
            let signals = found.map_or_else(AxisSignals::absent, |axis| {
                let is_commanded = axis.motor.is_none() && steppers.contains(name);
                AxisSignals::new(axis, is_commanded, (sample_s, half_window), options)
            });
            let times_s = [log.start_s, sample_s];
            let temperature =
                found.and_then(|axis| temperature::of_log(axis, times_s, options.temperature_smoothing_s));
            AxisSignals { start_s: log.start_s, temperature, ..signals }
        };
        Self {
            source: log.source.clone(),
            start_s: log.start_s,
            sample_s,
            has_own_zero: false,
            lead_in: 0,
            lead_out: 0,
            axes: axes.iter().map(prepared).collect(),
        }
    }

    /// Estimates the noise of the channels again, without the samples that a fault of the data spoils.
    pub fn estimate_noise_without_faults(&mut self, options: &SampleOptions) {
        for axis in &mut self.axes {
            axis.estimate_noise_without_faults(self.sample_s, options);
        }
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.axes.iter().find_map(AxisSignals::len).unwrap_or(0)
    }

    /// Whether there is no sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl AxisSignals {
    const fn absent() -> Self {
        Self {
            start_s: 0.0,
            unit: None,
            command: None,
            motor: None,
            motor_is_command: false,
            motor_path: None,
            table: None,
            tool: None,
            standstill: Vec::new(),
            sliding_from: 0,
            saturated: Vec::new(),
            faulty: [const { Vec::new() }; 4],
            force: None,
            added_force: None,
            temperature: None,
        }
    }

    fn new(
        axis: &AxisLog,
        is_commanded: bool,
        (sample_s, half_window): (f64, usize),
        options: &SampleOptions,
    ) -> Self {
        let metres = |channel: &Option<Vec<f64>>| -> Option<Vec<f64>> {
            channel.as_ref().map(|mm| mm.iter().map(|mm| 1e-3 * mm).collect())
        };
        let smooth = |channel| {
            metres(channel)
                .map(|raw| Smooth::new(raw, sample_s, half_window).with_quiet_acceleration(sample_s))
        };
        let motor = smooth(if is_commanded { &axis.command } else { &axis.motor });
        let standstill = motor.as_ref().map_or_else(Vec::new, |motor| standstill(motor, sample_s, options));
        Self {
            start_s: 0.0,
            unit: Some(axis.unit),
            command: metres(&axis.command),
            motor_path: motor.as_ref().map(|motor| MotorPath::new(motor, options.play_noise, sample_s)),
            sliding_from: motor
                .as_ref()
                .map_or(0, |motor| sliding_from(motor, &standstill, sample_s, options)),
            motor_is_command: is_commanded && motor.is_some(),
            motor,
            standstill,
            saturated: Vec::new(),
            faulty: Default::default(),
            table: smooth(&axis.table),
            tool: smooth(&axis.tool),
            force: axis.force.clone().map(|raw| Smooth::new(raw, sample_s, half_window)),
            added_force: axis.added_force.clone().map(|raw| AddedForce::new(raw, sample_s, half_window)),
            temperature: None,
        }
    }

    /// Parameters with the temperature of the guide in this log, where their friction depends on it.
    #[must_use]
    pub fn at_temperature<'p>(&self, parameters: &'p AxisParameters) -> Cow<'p, AxisParameters> {
        if self.temperature.is_none() || !parameters.friction.temperature.changes() {
            return Cow::Borrowed(parameters);
        }
        let mut parameters = parameters.clone();
        parameters.friction.guide_temperature.clone_from(&self.temperature);
        Cow::Owned(parameters)
    }

    /// Whether the motor has a reading of its own.
    #[must_use]
    pub const fn has_motor_reading(&self) -> bool {
        self.motor.is_some() && !self.motor_is_command
    }

    /// Samples of a stage that a fault of the data spoils; empty if there is none.
    #[must_use]
    pub fn faulty(&self, stage: Stage) -> &[bool] {
        &self.faulty[stage as usize]
    }

    /// Marks samples of a stage, of `count` in the log, as spoiled by a fault of the data.
    pub fn mark_faulty(&mut self, stage: Stage, samples: Range<usize>, count: usize) {
        let flags = &mut self.faulty[stage as usize];
        flags.resize(count, false);
        flags[samples].fill(true);
    }

    fn estimate_noise_without_faults(&mut self, sample_s: f64, options: &SampleOptions) {
        let [motor, table, tool, force] =
            [Stage::Motor, Stage::Table, Stage::Tool, Stage::Force].map(|stage| &self.faulty[stage as usize]);
        let channels =
            [(&mut self.table, table), (&mut self.tool, tool), (&mut self.force, force)].into_iter();
        for (channel, faulty) in channels.filter(|(_, faulty)| !faulty.is_empty()) {
            if let Some(channel) = channel {
                channel.estimate_noise_without(faulty);
            }
        }
        if let (Some(channel), false) = (&mut self.motor, motor.is_empty()) {
            channel.estimate_noise_without(motor);
            self.motor_path = Some(MotorPath::new(channel, options.play_noise, sample_s));
        }
    }

    /// This axis with [`Self::motor_path`] recomputed for this standard deviation of the encoder noise, m.
    #[must_use]
    pub fn with_motor_noise(mut self, noise_m: f64, sample_s: f64, options: &SampleOptions) -> Self {
        if let Some(motor) = &mut self.motor {
            motor.noise = noise_m;
            self.motor_path = Some(MotorPath::new(motor, options.play_noise, sample_s));
        }
        self
    }

    /// The table, or the motor if no scale was logged: the input of the tool stage.
    #[must_use]
    pub fn table_or_motor(&self) -> Option<&Smooth> {
        self.table.as_ref().or(self.motor.as_ref())
    }

    /// Whether the travel of the axis is at least this, mm or degrees. True without any position channel.
    #[must_use]
    pub fn moves(&self, min_travel_mm: f64) -> bool {
        let channels = [&self.motor, &self.table].into_iter().flatten().map(|smooth| &smooth.raw);
        let channels: Vec<&Vec<f64>> = channels.chain(&self.command).collect();
        if channels.is_empty() {
            return true;
        }
        let travels = channels.into_iter().map(|values| numerics::peak_to_peak(values.iter().copied()));
        numerics::max(travels) >= 1e-3 * min_travel_mm
    }

    fn len(&self) -> Option<usize> {
        let smooth = [&self.motor, &self.table, &self.tool, &self.force];
        let smooth = smooth.into_iter().flatten().map(|smooth| smooth.raw.len());
        self.command.as_ref().map(Vec::len).into_iter().chain(smooth).next()
    }
}

/// The channels of an axis in the logs, of which some may lack all but the force.
#[must_use]
pub fn logged_channels(logs: &[Signals], axis: usize, options: &SampleOptions) -> LoggedChannels {
    let one_has = |has: fn(&AxisSignals) -> bool| logs.iter().any(|log| has(&log.axes[axis]));
    LoggedChannels {
        motor: one_has(AxisSignals::has_motor_reading),
        scale: one_has(|axis| axis.table.is_some()),
        force: logs.iter().all(|log| log.axes[axis].force.is_some()),
        temperature_c: temperature::mean_c(
            logs.iter().map(|log| log.axes[axis].temperature.as_ref()),
            options.min_temperature_range_c,
        ),
    }
}

/// The first sample by which an axis that moves at the start of its log has travelled far enough for its friction to be that
/// of sliding: how far the bristles are deflected at the start is not known. At most the settling time, which only a log of
/// less than four times that time does not leave out anyway.
fn sliding_from(motor: &Smooth, standstill: &[bool], sample_s: f64, options: &SampleOptions) -> usize {
    if standstill.first().is_none_or(|&at_rest| at_rest) {
        return 0;
    }
    let travel_m = numerics::peak_to_peak(motor.value.iter().copied());
    let far_m = (1e-6 * options.min_sliding_um).min(0.1 * travel_m);
    let [mut least, mut most] = [motor.value[0]; 2];
    let has_slid = |&position: &f64| {
        (least, most) = (least.min(position), most.max(position));
        most - least >= far_m
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0.3 s of samples")]
    let latest = (options.settling_s / sample_s) as usize;
    motor.value.iter().take(latest).position(has_slid).unwrap_or(latest.min(motor.value.len()))
}

/// Whether each sample is within a standstill.
fn standstill(motor: &Smooth, sample_s: f64, options: &SampleOptions) -> Vec<bool> {
    let noise = motor.value_noise / (motor.half_window() as f64 * sample_s);
    let slow = options.max_standstill_m_per_s.max(options.max_standstill_noise * noise);
    let mut standstill = vec![false; motor.velocity.len()];
    let mut start = 0;
    for end in 0..=motor.velocity.len() {
        if motor.velocity.get(end).is_some_and(|velocity| velocity.abs() < slow) {
            continue;
        }
        if (end - start) as f64 * sample_s >= options.min_standstill_s {
            standstill[start..end].fill(true);
        }
        start = end + 1;
    }
    standstill
}
