//! Radial deviation of a machine from a circle, and the part of it that a model does not explain.

use std::f64::consts::TAU;

use super::axis_view::{AxisView, series};
use contour::circle_fit::{self, Arc, Circle};
use model::effects::Stage;
use trace::fit::fit_data::ResidualSeries;
use trace::input::signals::{AxisSignals, Signals};
use trace::input::smoothing::Smooth;

/// Points per turn; each is the mean of the samples around it.
const POINTS_PER_TURN: f64 = 1440.0;

/// The radial deviation over one arc.
#[derive(Clone, Debug, PartialEq)]
pub struct Lap {
    /// See [`Arc::is_clockwise`].
    pub is_clockwise: bool,
    /// Angle of the command (rad) and deviation (µm), positive outwards.
    pub points: Vec<(f64, f64)>,
}

/// The largest circle of the first two axes in the logs, with the index of its log.
pub fn largest_circle(logs: &[Signals]) -> Option<(usize, Circle)> {
    let circles = logs.iter().enumerate().filter_map(|(log, signals)| {
        let [x, y] = signals.axes.get(..2)? else { return None };
        Some((log, circle_fit::find(x.command.as_ref()?, y.command.as_ref()?)?))
    });
    // The first of several equal ones.
    circles.fold(None, |best: Option<(usize, Circle)>, circle| match best {
        Some(best) if best.1.radius >= circle.1.radius => Some(best),
        _ => Some(circle),
    })
}

/// A circle in a log, with its axes.
pub struct Run<'a> {
    /// The circle.
    pub circle: &'a Circle,
    /// Index of the log.
    pub log: usize,
    /// The log that contains it.
    pub signals: &'a Signals,
    /// The two axes.
    pub axes: [&'a AxisView<'a>; 2],
}

impl Run<'_> {
    /// Deviation of the measured point nearest to the tool, and the name of its channel.
    pub fn measured(&self) -> Option<(&'static str, Vec<Lap>)> {
        type Channel = fn(&AxisSignals) -> Option<&Smooth>;
        let channels: [(&str, Channel); 3] = [
            ("tool", |axis| axis.tool.as_ref()),
            ("table", |axis| axis.table.as_ref()),
            ("motor", |axis| axis.motor.as_ref()),
        ];
        channels.into_iter().find_map(|(name, channel)| {
            let (x, y) = (channel(&self.signals.axes[0])?, channel(&self.signals.axes[1])?);
            let [cx, cy] = self.circle.centre;
            let deviation_um =
                |i: usize, _| 1e6 * (libm::hypot(x.raw[i] - cx, y.raw[i] - cy) - self.circle.radius);
            Some((name, self.laps(deviation_um)))
        })
    }

    /// The position stages that both axes have.
    pub fn stages(&self) -> Vec<Stage> {
        let is_there =
            |stage: &Stage| self.axes.iter().all(|axis| series(&axis.before, *stage, self.log).is_some());
        [Stage::Motor, Stage::Table, Stage::Tool].into_iter().filter(is_there).collect()
    }

    /// The part of the deviation that the models do not explain, given the residuals of both axes.
    ///
    /// Each stage is simulated from the measured signal upstream, so that the residuals of the stages add up along the
    /// chain command, motor, table, tool.
    pub fn residual(&self, residuals: [&[ResidualSeries]; 2]) -> Vec<Lap> {
        let stages = self.stages();
        let sums = residuals.map(|all| {
            let mut sum = vec![0.0; self.signals.len()];
            for series in stages.iter().filter_map(|&stage| series(all, stage, self.log)) {
                sum.iter_mut().zip(&series.values).for_each(|(sum, value)| *sum += value);
            }
            sum
        });
        self.laps(|i, angle: f64| sums[0][i] * libm::cos(angle) + sums[1][i] * libm::sin(angle))
    }

    /// Largest mean speed of the arcs, m/s.
    pub fn speed(&self) -> f64 {
        let of_arc = |arc: &Arc| arc.swept_rad / (self.signals.sample_s * arc.samples.len() as f64);
        self.circle.radius * numerics::max_abs(self.circle.arcs.iter().map(of_arc))
    }

    /// A deviation (µm), given by sample and angle of the command, averaged over pieces of each arc.
    fn laps(&self, deviation: impl Fn(usize, f64) -> f64) -> Vec<Lap> {
        let settling = self.axes[0].data.settling(self.log);
        let lap = |arc: &Arc| {
            let settled: Vec<usize> = arc.samples.clone().filter(|&i| i >= settling).collect();
            let samples_per_turn = arc.samples.len() as f64 * TAU / arc.swept_rad;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
            let length = (samples_per_turn / POINTS_PER_TURN).round().max(1.0) as usize;
            let point = |piece: &[usize]| {
                let mean = numerics::mean(piece.iter().map(|&i| deviation(i, self.angle(i))));
                (self.angle(piece[piece.len() / 2]), mean)
            };
            Lap { is_clockwise: arc.is_clockwise, points: settled.chunks(length).map(point).collect() }
        };
        self.circle.arcs.iter().map(lap).collect()
    }

    /// Angle of the command, rad.
    fn angle(&self, sample: usize) -> f64 {
        let from_centre = |axis: usize| {
            let command = self.signals.axes[axis].command.as_ref();
            command.map_or(0.0, |command| command[sample] - self.circle.centre[axis])
        };
        libm::atan2(from_centre(1), from_centre(0))
    }
}
