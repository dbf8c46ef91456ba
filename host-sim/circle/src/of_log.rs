//! The circle of logs: command and measured position of two axes.
//!
//! A delay of both axes turns the measured points back along the circle. It is estimated from the tangential deviation, the mean of both
//! directions, and the command is delayed by it, so that what remains is small beside the radius.

use std::f64::consts::TAU;
use std::ops::Range;

use contour::circle_fit::{self, Arc, Circle};
use contour::logged::POSITIONS;
use files::error::InputError;
use files::log::{AxisLog, Channel, Log, Unit};
use numerics::resample::delayed_cubic;
use numerics::wrapped;

use super::measured::{Measured, faults};
use super::samples::{Instant, Observed, Samples};

/// Largest deviation of the speed from its median on the part of an arc that is evaluated, as a fraction.
const STEADY_FRACTION: f64 = 0.02;

/// Time after the speed is reached that is left out: at least, s, and in delays.
const SETTLING_S: f64 = 0.15;
const SETTLING_DELAYS: f64 = 8.0;

/// Samples on either side over which the speed is taken.
const SPEED_SPAN: usize = 5;

/// Largest difference of the radii of two logs of one circle, and of their sampling times, as fractions.
const SAME_RADIUS: f64 = 1e-3;
const SAME_RATE: f64 = 1e-6;

impl Measured {
    /// The largest circle of two linear axes of logs: of one, or of several that were moved one after the other on the same machine, for
    /// example one for each direction.
    ///
    /// # Errors
    /// No log, a log without command, measured position or circle, or with another circle than the first.
    pub fn of_logs(logs: &[Log]) -> Result<Self, InputError> {
        let planes = logs.iter().map(plane).collect::<Result<Vec<_>, _>>()?;
        let signals: Vec<Signals<'_>> = logs
            .iter()
            .zip(&planes)
            .map(|(log, (plane, channel, circle))| Signals::new(log, *plane, *channel, circle))
            .collect();
        let Some((log, (plane, channel, _))) = logs.iter().zip(&planes).next() else {
            return Err(InputError::expected("circle", "a log", "none"));
        };
        let axes = plane.map(|axis| log.axes[axis].name.clone());
        for ((other, (plane, own, _)), own_signals) in logs.iter().zip(&planes).zip(&signals).skip(1) {
            let names = plane.map(|axis| other.axes[axis].name.clone());
            if names != axes || own != channel {
                let circle = |axes: &[String; 2], channel: &Channel| {
                    format!("a circle of {} and {} measured at the {}", axes[0], axes[1], channel.word())
                };
                let expected = format!("{}, as in {}", circle(&axes, channel), log.source);
                return Err(InputError::expected(&other.source, expected, circle(&names, own)));
            }
            own_signals.check_same(&signals[0], [&other.source, &log.source])?;
        }
        let delay_s = delay_s(&signals);
        let (samples, starts_rad, left_out) = samples(&signals, delay_s);
        if samples.instants.is_empty() {
            return Err(InputError::expected(&log.source, "a circle at a steady speed", "none"));
        }
        let mut notes = Vec::new();
        if *channel != Channel::Tool {
            notes.push(format!(
                "Measured at the {}: errors between it and the tool are not in these figures.",
                channel.word()
            ));
        }
        if left_out > 0 {
            notes.push(format!("{left_out} readings far from their neighbours are left out."));
        }
        let source = log.source.clone();
        let (channel, delay_s) = (channel.word(), Some(delay_s));
        Ok(Self { source, axes, channel, has_nominal_radius: true, delay_s, samples, starts_rad, notes })
    }
}

/// The two axes with the largest circle in their commands, and the measured channel nearest to the tool.
fn plane(log: &Log) -> Result<([usize; 2], Channel, Circle), InputError> {
    let is_linear = |axis: &AxisLog| axis.unit == Unit::Millimetre;
    let commanded: Vec<usize> =
        (0..log.axes.len()).filter(|&i| is_linear(&log.axes[i]) && log.axes[i].command.is_some()).collect();
    if commanded.len() < 2 {
        let expected = "the command of two linear axes (NAME_command_mm)";
        return Err(InputError::expected(&log.source, expected, format!("{}", commanded.len())));
    }
    let has = |axis: usize, channel: Channel| log.axes[axis].channel(channel).is_some();
    let pairs =
        commanded.iter().flat_map(|&i| commanded.iter().filter(move |&&j| j > i).map(move |&j| [i, j]));
    let pairs: Vec<[usize; 2]> = pairs.collect();
    let channel_of = |pair: &[usize; 2]| {
        POSITIONS.into_iter().find(|&channel| pair.iter().all(|&axis| has(axis, channel)))
    };
    if pairs.iter().all(|pair| channel_of(pair).is_none()) {
        let expected =
            "a measured position of two axes with a command (NAME_tool_mm, NAME_table_mm or NAME_motor_mm)";
        return Err(InputError::expected(&log.source, expected, "none"));
    }
    let circle_of = |pair: &[usize; 2]| {
        let channel = channel_of(pair)?;
        let [x, y] = pair.map(|axis| metres(&log.axes[axis], Channel::Command));
        Some((*pair, channel, circle_fit::find(&x, &y)?))
    };
    let circles = pairs.iter().filter_map(circle_of);
    circles.max_by(|a, b| a.2.radius.total_cmp(&b.2.radius)).ok_or_else(|| {
        let expected = "a command with a circle of three quarters of a turn or more";
        InputError::expected(&log.source, expected, "none")
    })
}

fn metres(axis: &AxisLog, channel: Channel) -> Vec<f64> {
    axis.channel(channel).unwrap_or_default().iter().map(|mm| 1e-3 * mm).collect()
}

/// The signals of the two axes about the centre of the circle.
struct Signals<'a> {
    circle: &'a Circle,
    start_s: f64,
    sample_s: f64,
    /// mm from the centre.
    command: [Vec<f64>; 2],
    measured: [Vec<f64>; 2],
    log: &'a Log,
}

/// The part of an arc that is evaluated.
struct SteadyArc {
    samples: Range<usize>,
    direction: f64,
    speed_mm_s: f64,
    /// Angle of the command at the start of the whole arc.
    start_angle: f64,
}

impl<'a> Signals<'a> {
    fn new(log: &'a Log, plane: [usize; 2], channel: Channel, circle: &'a Circle) -> Self {
        let about_centre = |channel: Channel| {
            [0, 1].map(|i| {
                let values = log.axes[plane[i]].channel(channel).unwrap_or_default();
                values.iter().map(|mm| mm - 1e3 * circle.centre[i]).collect()
            })
        };
        Self {
            circle,
            start_s: log.start_s,
            sample_s: log.sample_time_s,
            command: about_centre(Channel::Command),
            measured: about_centre(channel),
            log,
        }
    }

    /// Angle of the command delayed by a time, rad.
    fn angles(&self, delay_s: f64) -> Vec<f64> {
        let [x, y] = [0, 1].map(|i| delayed_cubic(self.command[i].clone(), delay_s, self.sample_s));
        x.iter().zip(&y).map(|(x, y)| libm::atan2(*y, *x)).collect()
    }

    /// Checks that this is the circle of another log, with the same time from sample to sample.
    fn check_same(&self, first: &Self, [source, first_source]: [&str; 2]) -> Result<(), InputError> {
        let is_near = |a: f64, b: f64, fraction: f64| (a / b - 1.0).abs() < fraction;
        let [radius_mm, first_mm] = [self, first].map(|signals| 1e3 * signals.circle.radius);
        if !is_near(radius_mm, first_mm, SAME_RADIUS) {
            let expected = format!("a circle of radius {first_mm:.3} mm, as in {first_source}");
            return Err(InputError::expected(source, expected, format!("{radius_mm:.3} mm")));
        }
        if !is_near(self.sample_s, first.sample_s, SAME_RATE) {
            let expected = format!("samples {} s apart, as in {first_source}", first.sample_s);
            return Err(InputError::expected(source, expected, format!("{} s", self.sample_s)));
        }
        Ok(())
    }

    /// Sum and number of the times by which the measured point is behind the command, for each direction, beyond a delay.
    fn add_lateness(&self, delay_s: f64, sums: &mut [(f64, f64); 2]) {
        let angles = self.angles(delay_s);
        for arc in self.steady(delay_s) {
            let (sum, count) = &mut sums[usize::from(arc.direction < 0.0)];
            for i in arc.samples {
                let (sin, cos) = libm::sincos(angles[i]);
                let along = arc.direction * (self.measured[1][i] * cos - self.measured[0][i] * sin);
                *sum -= along / arc.speed_mm_s;
                *count += 1.0;
            }
        }
    }

    /// The parts of the arcs at a steady speed, after settling, for a delay.
    fn steady(&self, delay_s: f64) -> Vec<SteadyArc> {
        let angles = self.angles(0.0);
        self.circle.arcs.iter().filter_map(|arc| self.steady_arc(arc, &angles, delay_s)).collect()
    }

    fn steady_arc(&self, arc: &Arc, angles: &[f64], delay_s: f64) -> Option<SteadyArc> {
        let Range { start, end } = arc.samples;
        let last = end.saturating_sub(1);
        let radius_mm = 1e3 * self.circle.radius;
        let speed = |i: usize| {
            let (from, to) = (i.saturating_sub(SPEED_SPAN).max(start), (i + SPEED_SPAN).min(last));
            let swept = wrapped(angles[to] - angles[from], TAU).abs();
            radius_mm * swept / (self.sample_s * (to - from).max(1) as f64)
        };
        let speeds: Vec<f64> = (start..end).map(speed).collect();
        let median = numerics::median(&speeds)?;
        let is_steady = |speed: &f64| (speed - median).abs() < STEADY_FRACTION * median;
        let first = start + speeds.iter().position(is_steady)?;
        let steady_end = start + speeds.iter().rposition(is_steady)? + 1;
        #[expect(clippy::cast_possible_truncation, reason = "a number of samples")]
        let samples = |time_s: f64| (time_s / self.sample_s).round() as isize;
        // Before an arc, the motion is another one: what follows its start is a transient.
        let settling = samples(SETTLING_S.max(SETTLING_DELAYS * delay_s));
        let delay = samples(delay_s);
        let from = (first.cast_signed() + settling + delay.max(0)).clamp(0, last.cast_signed());
        let to = (steady_end.cast_signed() + delay.min(0)).clamp(from, end.cast_signed());
        let kept = from.cast_unsigned()..to.cast_unsigned();
        (!kept.is_empty()).then(|| SteadyArc {
            samples: kept,
            direction: if arc.is_clockwise { -1.0 } else { 1.0 },
            speed_mm_s: median,
            start_angle: angles[start],
        })
    }
}

/// Time by which both axes follow the command, s: the mean of the directions.
fn delay_s(signals: &[Signals<'_>]) -> f64 {
    const ROUNDS: usize = 6;
    let mut delay_s = 0.0;
    for _ in 0..ROUNDS {
        let mut sums = [(0.0, 0.0); 2];
        for log in signals {
            log.add_lateness(delay_s, &mut sums);
        }
        let means: Vec<f64> =
            sums.iter().filter(|(_, count)| *count > 0.0).map(|(sum, count)| sum / count).collect();
        if means.is_empty() {
            break;
        }
        delay_s += numerics::mean(means.iter().copied());
    }
    delay_s
}

/// The samples, the angle from the start of each arc to its first sample, and how many readings were left out.
fn samples(signals: &[Signals<'_>], delay_s: f64) -> (Samples, Vec<f64>, usize) {
    let steady: Vec<(&Signals<'_>, Vec<SteadyArc>)> =
        signals.iter().map(|log| (log, log.steady(delay_s))).collect();
    let speeds = steady.iter().flat_map(|(_, arcs)| arcs.iter().map(|arc| arc.speed_mm_s));
    let top_speed = numerics::max_abs(speeds);
    let radius_mm = signals.first().map_or(0.0, |log| 1e3 * log.circle.radius);
    let (mut instants, mut arcs, mut starts_rad) = (Vec::new(), Vec::new(), Vec::new());
    let mut is_interpolated = Vec::new();
    let mut deviations = [Vec::new(), Vec::new()];
    for (log, of_log) in steady {
        let angles = log.angles(delay_s);
        for arc in of_log {
            let start = instants.len();
            for i in arc.samples.clone() {
                let at = Instant {
                    speed: arc.speed_mm_s / top_speed,
                    time_s: log.start_s + i as f64 * log.sample_s,
                    arc: arcs.len(),
                    ..Instant::new(angles[i], arc.direction)
                };
                for (axis, deviation) in deviations.iter_mut().enumerate() {
                    deviation.push(1e3 * (log.measured[axis][i] - radius_mm * at.position[axis]));
                }
                instants.push(at);
                is_interpolated.push(!log.log.is_measured(i));
            }
            starts_rad.push(wrapped(angles[arc.samples.start] - arc.start_angle, TAU).abs());
            arcs.push(start..instants.len());
        }
    }
    let mut is_left_out = vec![false; instants.len()];
    for i in deviations.iter().flat_map(|deviation| faults(deviation)) {
        is_left_out[i] = true;
    }
    let left_out = is_left_out.iter().filter(|fault| **fault).count();
    for (is_left_out, is_interpolated) in is_left_out.iter_mut().zip(is_interpolated) {
        *is_left_out |= is_interpolated;
    }
    let sample_s = signals.first().map(|log| log.sample_s);
    let (speed_mm_s, observed) = (Some(top_speed), Observed::Both(deviations));
    let samples = Samples { radius_mm, speed_mm_s, sample_s, instants, arcs, observed };
    (samples.filtered(|i| !is_left_out[i]), starts_rad, left_out)
}
