//! The error of the tracer's own prediction of the tool stage.
//!
//! The tool is predicted from the tables at the samples. Between the samples the force of the drive changes in steps of the
//! velocity loop, and the acceleration with it, always at the same instants of a sample: the second difference of the
//! samples, which is a mean over two of them, differs systematically from the acceleration at a sample, by some tenths of a
//! percent. To compute this error, the closed loops of the axes are simulated, with the tool in the steps of the plant. The
//! tool stage of these simulated logs leaves the error as its residual.

use super::axis_model::AxisModel;
use super::fit_data::FitData;
use crate::input::signals::Signals;
use crate::input::smoothing::Smooth;
use crate::prediction::closed_loop::{ClosedLoopRun, TableMotion};
use model::effects::Channel;
use numerics::resample::delayed_cubic;
use plant::parameters::AxisParameters;
use plant::tool_point::{self, Tables};

/// Whether an effect of the tool depends on an acceleration; the error is zero otherwise.
#[must_use]
pub fn is_needed(model: &AxisModel) -> bool {
    let tool = model.parameters().tool;
    tool.intalk.um_s2_per_m != 0.0 || !tool.crosstalk.is_empty() || !tool.resonances.is_empty()
}

/// A log in which the tables of this axis and of the axes that excite its tool, and its tool, are those of the models in
/// their closed loops; `None` if a loop cannot be simulated. The models of the other axes are those of the data.
#[must_use]
pub fn simulated(data: &FitData<'_>, model: &AxisModel, log: usize) -> Option<Signals> {
    let measured = &data.logs[log];
    let parameters = model.parameters();
    let mut result = measured.clone();
    let mut runs: Vec<Option<ClosedLoopRun>> = vec![None; measured.axes.len()];
    for (axis, name) in data.names.iter().enumerate() {
        let is_source = parameters.tool.crosstalk.iter().any(|crosstalk| crosstalk.source == *name);
        if axis != data.axis && !is_source {
            continue;
        }
        let model = if axis == data.axis { model } else { data.axes.get(axis)? };
        let (of_axis, parameters) = (FitData { axis, ..*data }, model.parameters());
        let mut run = of_axis.closed_loop(model, &parameters, &measured.axes[axis])?;
        run.table.iter_mut().for_each(|table| table.position_m += 1e-6 * model.table_zero_um);
        let late_s = parameters.latency_s(Channel::Table);
        let read_m = read_m(&run, &parameters, measured);
        let table_m = delayed_cubic(read_m, late_s, measured.sample_s);
        replace(&mut result.axes[axis].table, table_m, measured.sample_s)?;
        runs[axis] = Some(run);
    }
    let tool_m = tool_m(data, model, measured, &runs)?;
    let late_s = parameters.latency_s(Channel::Tool);
    replace(
        &mut result.axes[data.axis].tool,
        delayed_cubic(tool_m, late_s, measured.sample_s),
        measured.sample_s,
    )?;
    Some(result)
}

/// What the scale reads of a simulated table, m.
fn read_m(run: &ClosedLoopRun, parameters: &AxisParameters, measured: &Signals) -> Vec<f64> {
    let time_s = |sample: usize| measured.start_s + sample as f64 * measured.sample_s;
    let table_m = run.table.iter().map(|table| table.position_m).enumerate();
    table_m.map(|(i, m)| m + parameters.scale.error_m(m, time_s(i))).collect()
}

/// The tool of the axis in simulated loops, m. The tables of axes that were not simulated are the measured ones.
fn tool_m(
    data: &FitData<'_>,
    model: &AxisModel,
    measured: &Signals,
    runs: &[Option<ClosedLoopRun>],
) -> Option<Vec<f64>> {
    let parameters = model.parameters();
    let own = runs[data.axis].as_ref()?;
    let position_m = |axis: usize, i: usize| match &runs[axis] {
        Some(run) => run.table[i].position_m,
        None => measured.axes[axis].table_or_motor().map_or(0.0, |table| table.value[i]),
    };
    let axes = 0..data.names.len();
    let tool_m = |i: usize| {
        let positions: Vec<f64> = axes.clone().map(|axis| position_m(axis, i)).collect();
        let accelerations: Vec<f64> =
            runs.iter().map(|run| run.as_ref().map_or(0.0, |run| run.table[i].m_per_s2)).collect();
        let tables = Tables { names: data.names, position_m: &positions, acceleration: &accelerations };
        let time_s = measured.start_s + i as f64 * measured.sample_s;
        let offset_m = tool_point::offset_m(&parameters.tool, data.axis, &tables, time_s);
        let TableMotion { position_m, oscillation_m, .. } = own.table[i];
        let grown_m = parameters.scale.displacement_m(position_m, time_s);
        position_m + grown_m + oscillation_m + offset_m + 1e-6 * model.tool_zero_um
    };
    Some((0..own.table.len()).map(tool_m).collect())
}

/// Replaces a channel by simulated values, filtered alike; `None` if the log lacks the channel.
fn replace(channel: &mut Option<Smooth>, values: Vec<f64>, sample_s: f64) -> Option<()> {
    *channel = Some(channel.as_ref()?.of_other(values, sample_s));
    Some(())
}
