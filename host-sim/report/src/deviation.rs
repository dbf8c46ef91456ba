//! How far a machine ran off a circle, and how much of that a model leaves unexplained.

use std::f64::consts::TAU;

use super::circle::{Arc, Circle};
use super::stages::{AxisView, part};
use model::effects::Stage;
use trace::residual::Part;
use trace::signals::{AxisSignals, Signals, Smooth};

/// Points a turn; each is the mean of the samples around it.
const POINTS: f64 = 1440.0;

/// The deviation along the radius over one arc.
#[derive(Clone, Debug, PartialEq)]
pub struct Lap {
    /// As [`Arc::is_clockwise`].
    pub is_clockwise: bool,
    /// Angle of the command, and deviation outwards, µm.
    pub points: Vec<(f64, f64)>,
}

/// A circle that was run.
pub struct Run<'a> {
    /// The circle.
    pub circle: &'a Circle,
    /// Its log.
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
            let off = |i: usize, _| 1e6 * ((x.raw[i] - cx).hypot(y.raw[i] - cy) - self.circle.radius);
            Some((name, self.laps(off)))
        })
    }

    /// The position stages that both axes have.
    pub fn stages(&self) -> Vec<Stage> {
        let is_there = |stage: &Stage| {
            self.axes.iter().all(|axis| part(&axis.before, *stage, self.circle.log).is_some())
        };
        [Stage::Motor, Stage::Table, Stage::Tool].into_iter().filter(is_there).collect()
    }

    /// What the models leave of the deviation, given the residuals of both axes.
    ///
    /// Each stage is driven by what was measured upstream of it, so their residuals add up along the
    /// chain command, motor, table, tool.
    pub fn unexplained(&self, residuals: [&[Part]; 2]) -> Vec<Lap> {
        let stages = self.stages();
        let sums = residuals.map(|parts| {
            let mut sum = vec![0.0; self.signals.len()];
            for part in stages.iter().filter_map(|&stage| part(parts, stage, self.circle.log)) {
                sum.iter_mut().zip(&part.values).for_each(|(sum, value)| *sum += value);
            }
            sum
        });
        self.laps(|i, angle: f64| sums[0][i] * angle.cos() + sums[1][i] * angle.sin())
    }

    /// Fastest mean speed of an arc, m/s.
    pub fn speed(&self) -> f64 {
        let of_arc = |arc: &Arc| arc.swept / (self.signals.sample_s * arc.samples.len() as f64);
        self.circle.radius * numerics::max_abs(self.circle.arcs.iter().map(of_arc))
    }

    /// A deviation, given by sample and angle of the command, averaged over pieces of each arc.
    fn laps(&self, deviation: impl Fn(usize, f64) -> f64) -> Vec<Lap> {
        let settling = self.axes[0].evidence.settling(self.circle.log);
        let lap = |arc: &Arc| {
            let counted: Vec<usize> = arc.samples.clone().filter(|&i| i >= settling).collect();
            let a_turn = arc.samples.len() as f64 * TAU / arc.swept;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
            let length = (a_turn / POINTS).round().max(1.0) as usize;
            let point = |piece: &[usize]| {
                let mean = numerics::mean(piece.iter().map(|&i| deviation(i, self.angle(i))));
                (self.angle(piece[piece.len() / 2]), mean)
            };
            Lap { is_clockwise: arc.is_clockwise, points: counted.chunks(length).map(point).collect() }
        };
        self.circle.arcs.iter().map(lap).collect()
    }

    /// Angle of the command.
    fn angle(&self, sample: usize) -> f64 {
        let from_centre = |axis: usize| {
            let command = self.signals.axes[axis].command.as_ref();
            command.map_or(0.0, |command| command[sample] - self.circle.centre[axis])
        };
        from_centre(1).atan2(from_centre(0))
    }
}
