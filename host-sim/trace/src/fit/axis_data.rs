//! One axis of a trace.

use super::axis_model::AxisModel;
use super::fit_data::{FitData, ResidualSeries};
use model::machine::Axis;

/// One axis of a trace: what is declared of it, and its data.
#[derive(Clone, Copy, Debug)]
pub struct AxisData<'a> {
    /// The axis in the machine file.
    pub declared: &'a Axis,
    /// What is fitted.
    pub fit: FitData<'a>,
    /// What is held out.
    pub validate: FitData<'a>,
}

impl<'a> AxisData<'a> {
    /// These data beside models of all axes.
    #[must_use]
    pub const fn beside(&self, axes: &'a [AxisModel]) -> Self {
        Self {
            declared: self.declared,
            fit: FitData { axes, ..self.fit },
            validate: FitData { axes, ..self.validate },
        }
    }

    /// These data, with the error of the tracer's own simulation in the fit logs and in the validation logs subtracted.
    #[must_use]
    pub const fn without_bias(&self, [fit, validate]: &'a [Vec<ResidualSeries>; 2]) -> Self {
        Self {
            declared: self.declared,
            fit: FitData { bias: fit.as_slice(), ..self.fit },
            validate: FitData { bias: validate.as_slice(), ..self.validate },
        }
    }
}
