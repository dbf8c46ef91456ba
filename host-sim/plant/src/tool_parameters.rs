//! The parameters of what is between table and tool.

use model::effects::{
    Crosstalk, EffectModel, Intalk, Mode, Resonance, Squareness, Straightness, ThermalDrift, ThermalRate, Yaw,
};
use model::position_curve::PositionCurve;

use super::probe::Probe;

/// Effects between table and tool.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolParameters {
    /// Offset per acceleration of the axis itself.
    pub intalk: Intalk,
    /// Offset per acceleration of another axis.
    pub crosstalk: Vec<Crosstalk>,
    /// Offset per position of the other axis.
    pub squareness: Squareness,
    /// Offset per squared position of another axis.
    pub straightness: Vec<Straightness>,
    /// Offset over the position of another axis, by its name: m over m.
    pub straightness_maps: Vec<(String, PositionCurve)>,
    /// Offset per product of the position of the axis itself and that of another one.
    pub yaws: Vec<Yaw>,
    /// Offsets over the time of the session that approach an end.
    pub drifts: Vec<ThermalDrift>,
    /// Offset in proportion to the time of the session.
    pub rate: ThermalRate,
    /// Modes in which the tool oscillates against the table.
    pub resonances: Vec<Resonance>,
    /// Alignment of the probe that reads the tool.
    pub probe: Probe,
}

impl ToolParameters {
    /// The modes in which the tool oscillates against the table.
    pub fn modes(&self) -> impl Iterator<Item = Mode> + '_ {
        self.resonances.iter().filter_map(EffectModel::mode)
    }

    /// Offset of the tool per acceleration of its own axis, without modes, m per m/s².
    #[must_use]
    pub fn per_own_acceleration_s2(&self) -> f64 {
        self.intalk.offset_m(1.0)
    }

    /// Offsets of the tool per acceleration of other axes, by their names, m per m/s².
    pub fn per_other_acceleration_s2(&self) -> impl Iterator<Item = (&str, f64)> {
        self.crosstalk.iter().map(|crosstalk| (crosstalk.source.as_str(), crosstalk.offset_m(1.0)))
    }

    /// Offsets of the tool per product of the positions of its own axis and of another one, by the name of the latter, m per m².
    pub fn per_position_product_m(&self) -> impl Iterator<Item = (&str, f64)> {
        self.yaws.iter().map(|yaw| (yaw.source.as_str(), yaw.offset_m(1.0, 1.0)))
    }

    /// Largest displacement of the tool per acceleration of its own axis, far below the frequencies of its modes, m per m/s².
    #[must_use]
    pub fn max_displacement_s2(&self) -> f64 {
        let of_modes: f64 = self.resonances.iter().map(|mode| mode.static_s2().abs()).sum();
        self.intalk.offset_m(1.0).abs() + of_modes
    }
}
