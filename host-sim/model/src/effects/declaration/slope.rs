//! Common part of effects that are a slope of a position over a position, in µm per m.

/// What a slope of a position over a position belongs to. Of these slopes the logs show sums and differences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlopeOf {
    /// The lead of the screw.
    Screw,
    /// The gain of the linear scale.
    Scale,
    /// The gain of the probe.
    Probe,
    /// The angle between the axes.
    Axes,
    /// The angle of the probe.
    ProbeAngle,
}

/// A temperature difference of 0.05 K changes the length of steel by 0.5 µm/m.
pub const LEAST_SLOPE_UM_PER_M: f64 = 0.5;

/// Declares the items of [`EffectModel`](super::EffectModel) that are the same for a type with one value, the slope in this field.
macro_rules! slope {
    ($field:ident) => {
        const PARAMETERS: &'static [super::declaration::Parameter] = &[super::declaration::Parameter::new(
            stringify!($field),
            super::declaration::Unit::MicrometrePerMetre,
            super::declaration::Range::Signed,
        )];
        const OCCURRENCE: super::declaration::Occurrence = super::declaration::Occurrence::Repeated;

        fn coordinates(&self) -> Vec<super::declaration::Coordinate> {
            vec![super::declaration::Coordinate::signed(self.$field, 5.0, 1e5)]
        }

        fn exceeds_tolerance(
            &self,
            _declared: &crate::axis::Settings,
            _rates: shared::config::Rates,
        ) -> bool {
            self.$field.abs() > super::declaration::LEAST_SLOPE_UM_PER_M
        }

        fn at(&self, x: &[f64]) -> Self {
            Self { $field: x[0] }
        }

        fn values(&self) -> Vec<f64> {
            vec![self.$field]
        }

        fn abscissa(&self) -> super::declaration::Abscissa {
            super::declaration::Abscissa::Position
        }
    };
}

pub(in crate::effects) use slope;
