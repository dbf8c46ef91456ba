//! What the channels of a log would show of a motion, in standard deviations of their noise.

use files::log::AxisLog;
use model::machine::{Axis, Machine};
use motion::{Block, Motion};
use plant::equivalent;
use plant::instruments::Instruments;
use plant::machine_path::MachinePath;
use plant::sensors::Sensor;
use plant::simulate::{self, Run};
use shared::scalar::Format;

/// Rest before the motion, which is not evaluated: the loops settle on errors of the scale.
const SETTLE_S: f64 = 0.5;

/// Least standard deviation of a channel, mm and N: no channel is exact.
const LEAST: f64 = 1e-9;

/// The channels of all axes in a row, each relative to the one upstream, in standard deviations of the noise; `None` if the machine cannot
/// be simulated on the motion.
#[must_use]
pub fn of(machine: &Machine, motion: &Motion) -> Option<Vec<f64>> {
    let (machine, _) = equivalent::of(machine);
    let rest = Block::Dwell { seconds: SETTLE_S };
    let blocks = std::iter::once(rest).chain(motion.blocks.iter().cloned()).collect();
    let settled = Motion { blocks, ..motion.clone() };
    let path = MachinePath::new(&settled, &machine, &motion.name).ok()?;
    let mut controller = simulate::controller(&machine, Format::F64, &path.start_m).ok()?;
    // One seed: the noise of two machines cancels in their difference.
    let instruments = Instruments::of(&machine, 1);
    let run =
        Run { machine: &machine, instruments, start_m: &path.start_m, blocks: &path.blocks, start_s: 0.0 };
    let log = run.log(controller.as_mut(), |_, _, _| {}).ok()?;
    let deviations = machine.axis.values().map(|axis| Deviations::of(axis, &instruments));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred samples")]
    let first = (SETTLE_S / log.sample_time_s).round() as usize;
    let shown = log.axes.iter().zip(machine.axis.values()).zip(deviations);
    let shown = shown.filter(|((log, axis), _)| moves(motion, &log.name) || is_moved_by_others(axis));
    let whitened = shown.flat_map(|((axis, _), deviations)| deviations.whitened(axis, first));
    Some(whitened.collect())
}

/// Whether an axis moves: what an axis at rest shows depends on where it came from.
fn moves(motion: &Motion, name: &str) -> bool {
    let Some(start_mm) = motion.start_mm.get(name) else { return false };
    motion.blocks.iter().any(|block| match block {
        Block::Dwell { .. } => false,
        Block::Line { to_mm, .. } => to_mm.get(name) != Some(start_mm),
        Block::Arc { plane, .. } => plane.iter().any(|axis| axis == name),
    })
}

/// Whether an effect of the axis is caused by another axis.
fn is_moved_by_others(axis: &Axis) -> bool {
    axis.effect.iter().any(|effect| effect.distinction().source().is_some())
}

/// Standard deviations of the channels of an axis, each relative to the one upstream, mm and N.
struct Deviations {
    motor: f64,
    table: f64,
    tool: f64,
    force: f64,
}

impl Deviations {
    /// What the model left of the logs to which it was fitted; else the noise of the sensors.
    fn of(axis: &Axis, instruments: &Instruments) -> Self {
        let [motor, table, tool] =
            [instruments.motor, instruments.table, instruments.tool].map(|sensor| 1e3 * deviation(sensor));
        let left = axis.residual.unwrap_or_default();
        let mm = |left_um: Option<f64>, noise: f64| left_um.map_or(noise, |um| 1e-3 * um).max(LEAST);
        let force = deviation(instruments.force);
        Self {
            motor: mm(left.motor_um, motor),
            table: mm(left.table_um, table.hypot(motor)),
            tool: mm(left.tool_um, tool.hypot(table)),
            force: left.force_n.unwrap_or(force).max(LEAST),
        }
    }

    /// The channels from a sample on.
    fn whitened(&self, axis: &AxisLog, first: usize) -> Vec<f64> {
        let from = |channel: &Option<Vec<f64>>| -> Vec<f64> {
            channel.iter().flatten().skip(first).copied().collect()
        };
        let [command, motor, table, tool] = [&axis.command, &axis.motor, &axis.table, &axis.tool].map(from);
        [
            relative(&motor, &command, self.motor),
            relative(&table, &motor, self.table),
            relative(&tool, &table, self.tool),
            from(&axis.force).iter().map(|newton| newton / self.force).collect(),
        ]
        .concat()
    }
}

/// Less its mean: the zeros of scales and probes are free in every log.
fn relative(own: &[f64], upstream: &[f64], deviation_mm: f64) -> Vec<f64> {
    let all: Vec<f64> =
        own.iter().zip(upstream).map(|(own, upstream)| (own - upstream) / deviation_mm).collect();
    let mean = all.iter().sum::<f64>() / all.len().max(1) as f64;
    all.into_iter().map(|value| value - mean).collect()
}

/// Standard deviation of a reading, with that of its resolution.
fn deviation(sensor: Sensor) -> f64 {
    sensor.noise.hypot(sensor.resolution / 12_f64.sqrt()).max(LEAST)
}
