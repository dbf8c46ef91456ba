//! What the channels of a log would show of a motion, in standard deviations of their noise.

use files::log::{AxisLog, Log};
use model::machine::Machine;
use motion::Motion;
use plant::equivalent;
use plant::instruments::Instruments;
use plant::machine_path::MachinePath;
use plant::sensors::Sensor;
use plant::simulate::{self, Run};
use shared::scalar::Format;

/// The channels of all axes in a row, each relative to the one upstream, in standard deviations of the noise; `None` if the machine cannot
/// be simulated on the motion.
#[must_use]
pub fn of(machine: &Machine, motion: &Motion) -> Option<Vec<f64>> {
    let (machine, _) = equivalent::of(machine);
    let path = MachinePath::new(motion, &machine, &motion.name).ok()?;
    let mut controller = simulate::controller(&machine, Format::F64, &path.start_m).ok()?;
    // One seed: the noise of two machines cancels in their difference.
    let instruments = Instruments::of(&machine, 1);
    let run =
        Run { machine: &machine, instruments, start_m: &path.start_m, blocks: &path.blocks, start_s: 0.0 };
    let log = run.log(controller.as_mut(), |_, _, _| {}).ok()?;
    Some(whitened(&log, &instruments))
}

fn whitened(log: &Log, instruments: &Instruments) -> Vec<f64> {
    let [motor, table, tool] =
        [instruments.motor, instruments.table, instruments.tool].map(|sensor| 1e3 * deviation(sensor));
    let force = deviation(instruments.force);
    log.axes
        .iter()
        .flat_map(|axis: &AxisLog| {
            [
                relative(axis.motor.as_deref(), axis.command.as_deref(), motor),
                relative(axis.table.as_deref(), axis.motor.as_deref(), table.hypot(motor)),
                relative(axis.tool.as_deref(), axis.table.as_deref(), tool.hypot(table)),
                axis.force.iter().flatten().map(|newton| newton / force).collect(),
            ]
        })
        .flatten()
        .collect()
}

fn relative(own: Option<&[f64]>, upstream: Option<&[f64]>, deviation_mm: f64) -> Vec<f64> {
    let pairs = own.into_iter().flatten().zip(upstream.into_iter().flatten());
    pairs.map(|(own, upstream)| (own - upstream) / deviation_mm).collect()
}

/// Standard deviation of a reading, with that of its resolution.
fn deviation(sensor: Sensor) -> f64 {
    sensor.noise.hypot(sensor.resolution / 12_f64.sqrt()).max(1e-12)
}
