//! Floating-point signals: gain and sum are of the same type.

use super::state_variable::{self, StateVariable};
use super::{Fixed, Scalar, Section};
use crate::units::Position;

macro_rules! float {
    ($float:ty, $name:literal) => {
        impl Section<$float> for StateVariable<$float> {
            type State = state_variable::State<$float>;

            const AT_REST: Self::State = state_variable::State::AT_REST;

            fn new(g: f64, k: f64, notch_depth: Option<f64>) -> Self {
                Self::new(g, k, notch_depth)
            }

            fn settled(value: $float) -> Self::State {
                state_variable::State::settled(value)
            }

            fn step(&self, state: &mut Self::State, input: $float) -> $float {
                self.step(state, input)
            }
        }

        impl Scalar for $float {
            type Section = StateVariable<$float>;
            type Gain = $float;
            type Sum = $float;

            const ZERO: $float = 0.0;
            const ZERO_GAIN: $float = 0.0;
            const ZERO_SUM: $float = 0.0;
            const NAME: &'static str = $name;
            const GAIN_LIMIT: f64 = 1e18;
            const GAIN_STEP: f64 = 0.0;
            const SIGNAL_LIMIT: f64 = 1e18;
            const SIGNAL_STEP: f64 = 0.0;

            #[expect(
                clippy::cast_possible_truncation,
                clippy::allow_attributes,
                reason = "rounds to the nearest value of the format"
            )]
            #[allow(unfulfilled_lint_expectations, reason = "f64 to f64 truncates nothing")]
            fn gain(value: f64) -> $float {
                value as $float
            }

            fn signal(value: f64) -> $float {
                Self::gain(value)
            }

            #[allow(
                clippy::unnecessary_cast,
                clippy::cast_lossless,
                clippy::allow_attributes,
                reason = "one macro for two types"
            )]
            fn value(self) -> f64 {
                self as f64
            }

            fn bits(self) -> u64 {
                u64::from(self.to_bits())
            }

            fn from_distance(distance: i64) -> $float {
                const UNIT: $float = 1.0 / (1u64 << 30) as $float;
                distance as $float * UNIT
            }

            fn from_increment(distance: i64) -> $float {
                const UNIT: $float = 1.0 / (1u64 << 24) as $float;
                distance as $float * UNIT
            }

            fn increment_rounding(_distance: i64) -> i64 {
                0
            }

            fn from_position(position: Position) -> $float {
                const UNIT: $float = 1.0 / (1u64 << 40) as $float;
                position.0 as $float * UNIT
            }

            #[expect(clippy::cast_possible_truncation, reason = "`as` saturates, as specified")]
            fn to_distance(sum: $float) -> i64 {
                let units = sum * (1u64 << 30) as $float;
                let half = if units < 0.0 { -0.5 } else { 0.5 };
                (units + half) as i64
            }

            #[allow(
                clippy::cast_lossless,
                clippy::cast_precision_loss,
                clippy::allow_attributes,
                reason = "one macro for two types"
            )]
            fn lerp(self, other: $float, fraction_q32: u32) -> $float {
                const UNIT: $float = 1.0 / (1u64 << 32) as $float;
                self + (other - self) * (fraction_q32 as $float * UNIT)
            }

            fn gain_between(from: $float, to: $float, fraction_q32: u32) -> $float {
                from.lerp(to, fraction_q32)
            }

            fn distance(self) -> i64 {
                // Without compensation: a core that computes f64 in software takes 300 instructions for the conversion.
                if self == 0.0 { 0 } else { Self::to_distance(self) }
            }

            #[allow(
                clippy::cast_lossless,
                clippy::cast_precision_loss,
                clippy::allow_attributes,
                reason = "one macro for two types"
            )]
            fn from_fixed(value: Fixed) -> $float {
                const UNIT: $float = 1.0 / (1u64 << 14) as $float;
                value.to_bits() as $float * UNIT
            }

            fn to_gain(self) -> $float {
                self
            }

            fn widen(self) -> $float {
                self
            }

            fn round(sum: $float) -> $float {
                sum
            }

            fn rounding(_sum: $float) -> $float {
                0.0
            }

            fn sum_exceeds(sum: $float, limit: $float) -> bool {
                sum.exceeds(limit)
            }

            fn clamp_magnitude(self, limit: $float) -> $float {
                if self > limit {
                    limit
                } else if self < -limit {
                    -limit
                } else {
                    self
                }
            }
        }
    };
}

float!(f32, "f32");
float!(f64, "f64");
