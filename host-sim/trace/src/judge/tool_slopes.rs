//! Slopes of the tool against the tables, with their intervals, whether or not an effect was found.

use crate::fit::fit_data::FitData;
use crate::fit::fitted_axis::FittedAxis;
use crate::fit::intervals::{covariance, half_widths};
use crate::fit::least_squares;
use crate::fit::scope_fit::ScopeFit;
use crate::judge::found_effect::FoundEffect;
use model::effects::{Effect, SlopeOf, Stage};

/// A slope with the half width of its 95 % confidence interval, µm per m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// Value.
    pub um_per_m: f64,
    /// Half width.
    pub half_width: f64,
}

impl Slope {
    /// The first parameter of an effect that was found.
    #[must_use]
    pub fn of_found(found: &FoundEffect) -> Option<Self> {
        let (um_per_m, half_width) = (*found.effect.values().first()?, *found.half_widths.first()?);
        Some(Self { um_per_m, half_width })
    }

    /// Whether the slope exceeds a tolerance (µm per m) and this many half widths of its interval.
    #[must_use]
    pub fn exceeds(self, least_um_per_m: f64, half_widths: f64) -> bool {
        self.um_per_m.abs() > least_um_per_m.max(half_widths * self.half_width)
    }

    /// The difference of two slopes that were determined independently.
    #[must_use]
    pub fn less(self, other: Self) -> Self {
        Self {
            um_per_m: self.um_per_m - other.um_per_m,
            half_width: libm::hypot(self.half_width, other.half_width),
        }
    }
}

/// The slopes of the tool stage of one axis. Absent: the stage could not be evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolSlopes {
    /// Over the position of the other of two axes: on the first axis squareness + angle of the probe, on the second the angle.
    pub over_other: Option<Slope>,
    /// Over the position of the axis itself: the gain of the probe less that of the scale.
    pub over_own: Option<Slope>,
}

impl ToolSlopes {
    /// The slopes that the fit logs show beside the effects found.
    #[must_use]
    pub fn of(data: &FitData<'_>, axis: &FittedAxis) -> Self {
        let of_other = if data.axis == 0 { SlopeOf::Axes } else { SlopeOf::ProbeAngle };
        let slope = |of: SlopeOf| slope(data, axis, &of.effect(0.0));
        let over_other = if data.names.len() == 2 { slope(of_other) } else { None };
        Self { over_other, over_own: slope(SlopeOf::Probe) }
    }
}

/// The size of an effect of the tool stage, whose fit need not contain it.
fn slope(data: &FitData<'_>, axis: &FittedAxis, effect: &Effect) -> Option<Slope> {
    let index = axis.model.found().iter().position(|found| found.is_same(effect));
    if let Some(index) = index {
        let um_per_m = *axis.model.found()[index].values().first()?;
        return Some(Slope { um_per_m, half_width: *axis.full_half_widths(data, index).first()? });
    }
    let ScopeFit { scope, fitted, exclusions, .. } =
        axis.fits.iter().find(|fit| fit.scope.stages == [Stage::Tool])?;
    let data = FitData { exclusions, ..*data };
    let with = axis.model.with(effect.clone());
    let fitted = least_squares::fit_from(&data, &with, scope, least_squares::STEPS, &fitted.columns);
    let index = fitted.model.found().len() - 1;
    let effect = &fitted.model.found()[index];
    let half_widths = half_widths(effect, &covariance(&data, &fitted), fitted.model.indices_of(scope, index));
    Some(Slope { um_per_m: *effect.values().first()?, half_width: *half_widths.first()? })
}
