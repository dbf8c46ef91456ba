//! Common part of effects that are a time in the loop of the drive, in ms, from zero to a limit.

/// Declares the items of [`EffectModel`](super::EffectModel) that are the same for a type with the field `ms`: the longest time
/// and the initial guesses, ms. The step of the finite difference is 0.02 ms.
macro_rules! delay {
    (longest $longest:literal, guesses $guesses:expr) => {
        const PARAMETERS: &'static [super::declaration::Parameter] = &[super::declaration::Parameter::new(
            "ms",
            super::declaration::Unit::Millisecond,
            super::declaration::Range::UpTo($longest),
        )];
        const OCCURRENCE: super::declaration::Occurrence = super::declaration::Occurrence::Once;
        const SHOWN_IN: &'static [super::declaration::Stage] = &[super::declaration::Stage::Motor];
        const DRIVES: &'static [crate::axis::Drive] = &[crate::axis::Drive::Torque];

        fn stages(&self) -> &'static [super::declaration::Stage] {
            &[super::declaration::Stage::Motor]
        }

        fn initial_guesses(context: &super::declaration::EffectContext<'_>) -> Vec<Self> {
            let times_ms: &[f64] =
                if context.has(super::declaration::Stage::Motor) { &$guesses } else { &[] };
            times_ms.iter().map(|&ms| Self { ms }).collect()
        }

        fn coordinates(&self) -> Vec<super::declaration::Coordinate> {
            vec![super::declaration::Coordinate::between(self.ms, 0.02, 0.0, $longest)]
        }

        fn at(&self, x: &[f64]) -> Self {
            Self { ms: x[0] }
        }

        fn values(&self) -> Vec<f64> {
            vec![self.ms]
        }
    };
}

pub(in crate::effects) use delay;
