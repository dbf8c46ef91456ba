//! Products of commanded quantities: an error of the tool that depends on several of them at once, such as position times position
//! of another axis (yaw of a guideway times the lever), or speed times position.
//!
//! ```text
//! correction = −amplitude·∏ clamp(quantity/full scale, −1, 1)
//! ```
//!
//! A factor beyond its full scale keeps its value there, as a table does beyond its ends: nothing is known of the error there.

use heapless::Vec;

use super::motion::CommandMotion;
use super::names::{PRODUCTS as NAMES, ProductNames};
use super::settings::{self, FACTORS, PRODUCTS};
use crate::config::ConfigError;
use crate::config::check::{positive, ranged, resolved_gain, signed_gain};
use crate::scalar::Scalar;
use crate::units::{INCREMENT_M, LENGTH_M, SCALED_POSITION_M};

/// A factor at its full scale: 2⁻²¹ of it are a step in fixed point, and the product of two is in its range.
const FULL: f64 = 128.0;

/// Of what a factor is computed, with the gain to [`FULL`] at its full scale.
#[derive(Clone, Copy, Debug)]
enum Quantity<S: Scalar> {
    Position(S::Gain),
    Velocity(S::Gain),
    Speed(S::Gain),
    Acceleration(S::Gain),
    Direction,
}

/// A factor: a quantity of an axis.
#[derive(Clone, Copy, Debug)]
struct Factor<S: Scalar> {
    axis: u8,
    of: Quantity<S>,
}

/// One product.
#[derive(Clone, Copy, Debug)]
struct Product<S: Scalar> {
    /// −amplitude, error units per [`FULL`].
    minus_amplitude: S::Gain,
    count: u8,
    /// Factors from the count on are not used.
    factors: [Factor<S>; FACTORS],
}

/// The products of an axis.
#[derive(Clone, Copy, Debug)]
pub struct Products<S: Scalar> {
    count: u8,
    /// Products from the count on are not used.
    products: [Product<S>; PRODUCTS],
}

impl<S: Scalar> Quantity<S> {
    /// The number of the axis, and the quantity.
    fn new(name: &'static str, factor: &settings::Factor, rate_hz: f64) -> Result<(u8, Self), ConfigError> {
        // The range is named in the unit of the full scale, of which the gain is the reciprocal.
        let gain = |full_scale: f64, unit: f64| {
            let gain = FULL * unit / positive(name, full_scale)?;
            resolved_gain::<S>(name, gain, 1.0).map_err(|error| match error {
                ConfigError::OutOfRange { name, min, max } => {
                    ConfigError::OutOfRange { name, min: FULL * unit / max, max: FULL * unit / min }
                }
                error => error,
            })
        };
        let increment_m_per_s = INCREMENT_M * rate_hz;
        Ok(match *factor {
            settings::Factor::Position { axis, full_scale_m } => {
                (axis, Self::Position(gain(full_scale_m, SCALED_POSITION_M)?))
            }
            settings::Factor::Velocity { axis, full_scale_m_per_s } => {
                (axis, Self::Velocity(gain(full_scale_m_per_s, increment_m_per_s)?))
            }
            settings::Factor::Speed { axis, full_scale_m_per_s } => {
                (axis, Self::Speed(gain(full_scale_m_per_s, increment_m_per_s)?))
            }
            settings::Factor::Acceleration { axis, full_scale_m_per_s2 } => {
                (axis, Self::Acceleration(gain(full_scale_m_per_s2, increment_m_per_s * rate_hz)?))
            }
            settings::Factor::Direction { axis } => (axis, Self::Direction),
        })
    }

    /// The factor for a motion of its axis, [`FULL`] at full scale.
    #[inline]
    fn at(&self, motion: &CommandMotion<S>, full: S) -> S {
        let (signal, gain) = match self {
            Self::Position(gain) => (S::from_position(motion.position), *gain),
            Self::Velocity(gain) => (motion.increment, *gain),
            Self::Speed(gain) => {
                (if motion.increment < S::ZERO { -motion.increment } else { motion.increment }, *gain)
            }
            Self::Acceleration(gain) => (motion.acceleration, *gain),
            Self::Direction => return if motion.forward { full } else { -full },
        };
        S::round(signal * gain).clamp_magnitude(full)
    }
}

impl<S: Scalar> Product<S> {
    const NONE: Self = Self {
        minus_amplitude: S::ZERO_GAIN,
        count: 0,
        factors: [Factor { axis: 0, of: Quantity::Direction }; FACTORS],
    };

    fn new(
        names: &ProductNames,
        settings: &settings::Product,
        (rate_hz, axes): (f64, usize),
    ) -> Result<Self, ConfigError> {
        let minus_amplitude =
            signed_gain::<S>(names.amplitude, -settings.amplitude_m, 1.0 / (LENGTH_M * FULL))?;
        let mut product = Self { minus_amplitude, ..Self::NONE };
        if settings.factors.is_empty() {
            return Err(ConfigError::OutOfRange { name: names.factors, min: 1.0, max: FACTORS as f64 });
        }
        for (slot, factor) in product.factors.iter_mut().zip(&settings.factors) {
            let (axis, of) = Quantity::new(names.factors, factor, rate_hz)?;
            ranged(names.factors, f64::from(axis), 0.0, axes.saturating_sub(1) as f64)?;
            *slot = Factor { axis, of };
            product.count += 1;
        }
        Ok(product)
    }

    /// The correction of the command, error units.
    #[inline]
    fn correction(&self, motions: &[CommandMotion<S>]) -> S::Sum {
        let (full, per_full) = (S::signal(FULL), S::gain(1.0 / FULL));
        let at = |factor: &Factor<S>| {
            motions.get(usize::from(factor.axis)).map_or(S::ZERO, |motion| factor.of.at(motion, full))
        };
        let mut factors = self.factors.iter().take(usize::from(self.count));
        let mut product = factors.next().map_or(S::ZERO, at);
        for factor in factors {
            product = S::round(S::round(product * at(factor)) * per_full);
        }
        product * self.minus_amplitude
    }
}

impl<S: Scalar> Products<S> {
    /// No product.
    pub const NONE: Self = Self { count: 0, products: [Product::NONE; PRODUCTS] };

    /// From SI, for a position loop at `rate_hz` in a machine of so many axes.
    ///
    /// # Errors
    /// [`ConfigError`] with a setting of `products`: no factors, an axis that the machine lacks, or an
    /// amplitude or a full scale beyond the range of the number format.
    pub fn new(
        settings: &Vec<settings::Product, PRODUCTS>,
        rate_hz: f64,
        axes: usize,
    ) -> Result<Self, ConfigError> {
        let mut converted = Self::NONE;
        for ((slot, product), names) in converted.products.iter_mut().zip(settings).zip(&NAMES) {
            *slot = Product::new(names, product, (rate_hz, axes))?;
            converted.count += 1;
        }
        Ok(converted)
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The correction of the command, error units.
    #[inline(never)]
    #[must_use]
    pub fn correction(&self, motions: &[CommandMotion<S>]) -> S {
        let mut sum = S::ZERO_SUM;
        for product in self.products.iter().take(usize::from(self.count)) {
            sum += product.correction(motions);
        }
        S::round(sum)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::scalar::Fixed;
    use crate::units::Position;

    const RATE_HZ: f64 = 4000.0;

    fn products(factors: &[settings::Factor]) -> Vec<settings::Product, PRODUCTS> {
        [settings::Product { amplitude_m: 20e-6, factors: factors.iter().copied().collect() }]
            .into_iter()
            .collect()
    }

    /// Two axes after two ticks: `x` and `y` are positions, m, and changes per tick, m, of which the last is larger by 1/8.
    fn motions<S: Scalar>(x: [f64; 2], y: [f64; 2]) -> [CommandMotion<S>; 2] {
        [x, y].map(|[at, step]| {
            let position = |m: f64| Position::from_m(m).unwrap();
            let mut motion = CommandMotion::at(position(at - 2.125 * step));
            motion.step(position(at - 1.125 * step));
            motion.step(position(at));
            motion
        })
    }

    /// The correction in nm, and that of the equation.
    fn both<S: Scalar>(x: [f64; 2], y: [f64; 2]) -> [f64; 2] {
        let factors = [
            settings::Factor::Position { axis: 1, full_scale_m: 0.2 },
            settings::Factor::Velocity { axis: 0, full_scale_m_per_s: 2.0 },
            settings::Factor::Acceleration { axis: 0, full_scale_m_per_s2: 100.0 },
        ];
        let of = Products::<S>::new(&products(&factors), RATE_HZ, 2).unwrap();
        let velocity = 1.125 * x[1] * RATE_HZ;
        let acceleration = 0.125 * x[1] * RATE_HZ * RATE_HZ;
        let part = |value: f64| value.clamp(-1.0, 1.0);
        let exact = -20e-6 * part(y[0] / 0.2) * part(velocity / 2.0) * part(acceleration / 100.0);
        [of.correction(&motions(x, y)).value() * LENGTH_M * 1e9, exact * 1e9]
    }

    proptest! {
        /// Up to twice the full scales. In fixed point, factors have steps of 2⁻²¹ and gains errors of 2⁻²⁵ of at least 0.008: each of three
        /// factors and three roundings may be off by 4e-6 of 20 µm, 0.08 nm; the sum is rounded to 0.06 nm. The command in steps of 1 pm
        /// (position units of 2⁻²⁰ nm are finer) gives an acceleration to 2⁻¹⁴·0.256 m/s², 2e-7 of its full scale.
        #[test]
        fn the_correction_is_the_product(
            x in -0.3..0.3f64, y in -0.4..0.4f64, step in -1e-4..1e-4f64,
        ) {
            let [fixed, exact] = both::<Fixed>([x, step], [y, 0.0]);
            prop_assert!((fixed - exact).abs() < 0.5, "{fixed} {exact}");
            let [single, exact] = both::<f32>([x, step], [y, 0.0]);
            prop_assert!((single - exact).abs() < 0.05, "{single} {exact}");
            let [double, exact] = both::<f64>([x, step], [y, 0.0]);
            prop_assert!((double - exact).abs() < 1e-3, "{double} {exact}");
        }
    }

    #[test]
    fn speed_has_no_sign_and_direction_nothing_else() {
        let factors = [
            settings::Factor::Speed { axis: 0, full_scale_m_per_s: 1.0 },
            settings::Factor::Direction { axis: 0 },
        ];
        let of = Products::<f64>::new(&products(&factors), RATE_HZ, 2).unwrap();
        for step in [1e-5, -1e-5] {
            let nm = of.correction(&motions([0.0, step], [0.0, 0.0])).value() * LENGTH_M * 1e9;
            // |v| is 45 mm/s; 20 µm·0.045, against the direction.
            assert!((nm + 900.0 * step.signum()).abs() < 1e-3, "{nm}");
        }
    }

    #[test]
    fn rejected_products_are_named() {
        let new = |factors: &[settings::Factor]| {
            Products::<Fixed>::new(&products(factors), RATE_HZ, 2).unwrap_err()
        };
        let name = "products[0].factors";
        assert_eq!(new(&[]), ConfigError::OutOfRange { name, min: 1.0, max: 3.0 });
        let third = settings::Factor::Direction { axis: 2 };
        assert_eq!(new(&[third]), ConfigError::OutOfRange { name, min: 0.0, max: 1.0 });
        let none = settings::Factor::Position { axis: 0, full_scale_m: 0.0 };
        assert_eq!(new(&[none]), ConfigError::NotPositive(name));
        // The least full scale is that of the greatest gain, 128: a position unit of 1.05 mm.
        let short = settings::Factor::Position { axis: 0, full_scale_m: 1e-3 };
        let ConfigError::OutOfRange { min, max, .. } = new(&[short]) else { panic!("{:?}", new(&[short])) };
        assert!((min / SCALED_POSITION_M - 1.0).abs() < 1e-6 && max > 1e3, "{min} {max}");
        let large = settings::Product { amplitude_m: 0.02, factors: [third].into_iter().collect() };
        let error = Products::<Fixed>::new(&[large].into_iter().collect(), RATE_HZ, 3).unwrap_err();
        // 128 times 128 error units.
        let max = 16384.0 * LENGTH_M;
        assert_eq!(error, ConfigError::OutOfRange { name: "products[0].amplitude_m", min: -max, max });
    }
}
