//! What the measuring chain does to the tool stage, and which names of the machine it imitates.
//!
//! - [`turn`]: the angle of the probe against the squareness of the axes, from both axes together
//! - [`slope`]: gain of probe and scale against the lead of the screw
//! - [`wave`]: periodic errors of the scale against those of the screw
//! - [`drift_rate`]: drifts whose time constant the logs do not hold
//! - [`tool_slopes`](crate::judge::tool_slopes): the slopes of the tool stage with their intervals, whether or not an effect was found

pub mod drift_rate;
pub mod slope;
pub mod turn;
pub mod wave;

use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::scope::Scope;
use crate::input::signals::Signals;
use crate::judge::axis_findings::AxisFindings;
use crate::judge::found_effect::FoundEffect;
use crate::options::SearchOptions;
use crate::task::Progress;
use model::effects::Stage;

/// Adds what one axis alone shows to be rivals of the effects found.
pub fn doubt(data: &FitData<'_>, model: &AxisModel, scopes: &[Scope], found: &mut [FoundEffect]) {
    let tool = scopes.iter().find(|scope| scope.stages == [Stage::Tool]);
    wave::doubt(data, model, tool, found);
    drift_rate::doubt(data, found);
}

/// The findings, decided between the machine and the scales and probes that measure it, from all axes together.
#[must_use]
pub fn decide(
    fit_logs: &[Signals],
    axes: Vec<AxisFindings>,
    options: &SearchOptions,
    progress: &Progress<'_>,
) -> Vec<AxisFindings> {
    let separated = turn::separated(axes, options.min_size);
    let decided = |(number, axis): (usize, AxisFindings)| {
        let has_table = fit_logs.iter().all(|log| log.axes[number].table.is_some());
        slope::decided(axis, has_table, options.min_size, progress)
    };
    separated.into_iter().enumerate().map(decided).collect()
}
