//! Common part of effects in the controller: the relative deviation of a true setting from the declared one, in percent.

/// Declares the items of [`EffectModel`](super::EffectModel) that are the same for a type with the field `percent`: step of
/// the finite difference and limits of the search, percent.
macro_rules! relative_deviation {
    (step $step:literal, limits [$least:expr, $most:expr]) => {
        const PARAMETERS: &'static [super::declaration::Parameter] = &[super::declaration::Parameter::new(
            "percent",
            super::declaration::Unit::Percent,
            super::declaration::Range::Above(-100.0),
        )];
        const OCCURRENCE: super::declaration::Occurrence = super::declaration::Occurrence::Once;
        const SHOWN_IN: &'static [super::declaration::Stage] = &[super::declaration::Stage::Motor];

        fn stages(&self) -> &'static [super::declaration::Stage] {
            &[super::declaration::Stage::Motor]
        }

        fn coordinates(&self) -> Vec<super::declaration::Coordinate> {
            vec![super::declaration::Coordinate::between(self.percent, $step, $least, $most)]
        }

        fn at(&self, x: &[f64]) -> Self {
            Self { percent: x[0] }
        }

        fn values(&self) -> Vec<f64> {
            vec![self.percent]
        }
    };
}

pub(in crate::effects) use relative_deviation;
