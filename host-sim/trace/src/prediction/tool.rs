//! The tool stage: the tool-point probe, predicted from the measured tables.

use super::resonant_response::resonant_response;
use crate::input::signals::{AxisSignals, Signals};
use crate::input::smoothing::Smooth;
use model::effects::Channel;
use numerics::resample::delayed_cubic;
use plant::parameters::AxisParameters;
use plant::tool_point::{self, Tables};

/// Tool point of one axis from the measured tables, m. `None` if the axis has neither table nor motor channel.
///
/// Without a linear scale, `screw` is the table behind the measured motor (m), as the model of the screw moves it.
///
/// The `latency` of the table channel is subtracted from that of the tool, as the tool is predicted from the table channel.
#[must_use]
pub fn tool(
    parameters: &AxisParameters,
    (axis, names): (usize, &[String]),
    signals: &Signals,
    screw: Option<&[f64]>,
) -> Option<Vec<f64>> {
    let tables: Vec<Option<&Smooth>> = signals.axes.iter().map(AxisSignals::table_or_motor).collect();
    let own = tables.get(axis).copied().flatten()?;
    let is_scale = signals.axes[axis].table.is_some();
    let mut tool_m = screw.map_or_else(|| own.value.clone(), <[f64]>::to_vec);
    for mode in parameters.tool.modes() {
        let response = resonant_response(own, mode, signals.sample_s);
        let offsets = response.iter().zip(&own.value).map(|(response, table)| response - table);
        tool_m.iter_mut().zip(offsets).for_each(|(tool, offset)| *tool += mode.participation * offset);
    }
    let mut positions = vec![0.0; names.len()];
    let mut accelerations = vec![0.0; names.len()];
    for (i, position_m) in tool_m.iter_mut().enumerate().take(own.value.len()) {
        for (other, table) in tables.iter().enumerate() {
            positions[other] = table.map_or(0.0, |table| table.value[i]);
            accelerations[other] = table.map_or(0.0, |table| table.quiet_acceleration()[i]);
        }
        let all = Tables { names, position_m: &positions, acceleration: &accelerations };
        let time_s = signals.start_s + i as f64 * signals.sample_s;
        *position_m += tool_point::offset_m(&parameters.tool, axis, &all, time_s);
        if is_scale {
            *position_m -= parameters.scale.error_m(own.value[i], time_s)
                - parameters.scale.displacement_m(own.value[i], time_s);
        }
    }
    let table_late_s =
        signals.axes[axis].table.as_ref().map_or(0.0, |_| parameters.latency_s(Channel::Table));
    Some(delayed_cubic(tool_m, parameters.latency_s(Channel::Tool) - table_late_s, signals.sample_s))
}
