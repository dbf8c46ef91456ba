//! A model of an axis with the fits that led to it.

use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::intervals::{Covariance, covariance, half_widths};
use crate::fit::least_squares::{self, Fitted};
use crate::fit::scope::Scope;
use crate::fit::scope_fit::ScopeFit;
use crate::fit::total_mass;
use crate::fit::upstream::covariance_after;
use model::effects::Effect;

/// A model of an axis with the fits that led to it.
#[derive(Clone, Debug)]
pub struct FittedAxis {
    /// The declared model, fitted.
    pub baseline: AxisModel,
    /// The model with effects.
    pub model: AxisModel,
    /// Fits of the model, scope by scope.
    pub fits: Vec<ScopeFit>,
}

impl FittedAxis {
    /// The axis without a found effect, by its index in [`AxisModel::found`]. The scopes that the effect changes, and all
    /// later ones, are fitted again.
    #[must_use]
    pub fn without(&self, data: &FitData<'_>, index: usize) -> Self {
        self.changed(data, index, None)
    }

    /// As [`Self::without`], with another form of the effect, if one is given, as the last effect.
    #[must_use]
    pub fn changed(&self, data: &FitData<'_>, index: usize, form: Option<Effect>) -> Self {
        let effect = &self.model.found()[index];
        let is_without = form.is_none();
        let without = self.model.without(index);
        let mut model = form.map_or_else(|| without.clone(), |form| without.with(form));
        // Without any effect the model is the declared one, which is already fitted.
        let steps = if model.found().is_empty() { 0 } else { least_squares::STEPS };
        let mut fits = self.fits.clone();
        // Scopes that were fitted jointly share one fit. Later scopes depend on earlier ones: the timing of the table, for
        // example, affects the tool.
        let mut first_refitted: Option<usize> = None;
        for i in 0..fits.len() {
            let ScopeFit { scope, fitted_scope, fitted, exclusions } = &self.fits[i];
            if let Some(other) =
                first_refitted.filter(|other| self.fits[*other].fitted_scope == *fitted_scope)
            {
                fits[i].fitted = fits[other].fitted.clone();
                continue;
            }
            if first_refitted.is_none() && !fitted_scope.holds(effect) {
                continue;
            }
            // A wrong effect may have biased the fit. If no effect is left, the fit starts from the values of the declared
            // model.
            if !model.found().iter().any(|other| fitted_scope.holds(other)) {
                let parameters = self.baseline.free_parameters(fitted_scope);
                let values: Vec<f64> =
                    parameters.iter().map(|parameter| parameter.coordinate.value).collect();
                model = model.at(fitted_scope, &values);
            }
            let known = if is_without {
                fitted.columns_without(&self.model, fitted_scope, index)
            } else {
                Vec::new()
            };
            let data = FitData { exclusions, ..*data };
            let fitted = least_squares::fit_from(&data, &model, fitted_scope, steps, &known);
            model = total_mass::pinned(&data, &fitted, [scope, fitted_scope]);
            fits[i].fitted = fitted;
            first_refitted = Some(i);
        }
        Self { baseline: self.baseline.clone(), model, fits }
    }

    /// Half widths of the confidence intervals of a found effect's parameters. `data` are the fit logs with the error that was
    /// subtracted.
    #[must_use]
    pub fn half_widths(&self, data: &FitData<'_>, index: usize) -> Vec<f64> {
        self.half_widths_by(index, |_, fitted| covariance(data, fitted))
    }

    /// These values with the uncertainty of what an earlier fit determined: see [`crate::fit::upstream`].
    #[must_use]
    pub fn full_half_widths(&self, data: &FitData<'_>, index: usize) -> Vec<f64> {
        self.half_widths_by(index, |scope, fitted| {
            covariance_after(data, &self.fits, &self.model, (scope, fitted))
        })
    }

    fn half_widths_by(&self, index: usize, covariance: impl Fn(&Scope, &Fitted) -> Covariance) -> Vec<f64> {
        let effect = &self.model.found()[index];
        let fit = self.fits.iter().find(|fit| fit.scope.holds(effect));
        fit.map_or_else(Vec::new, |ScopeFit { fitted_scope, fitted, .. }| {
            let indices = fitted.model.indices_of(fitted_scope, index);
            half_widths(effect, &covariance(fitted_scope, fitted), indices)
        })
    }
}
