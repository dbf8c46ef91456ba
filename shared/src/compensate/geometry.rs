//! Squareness and straightness: the tool is displaced by k·y, or by a function of y, where y is the position of another axis.

use super::motion::CommandMotion;
use super::names::points_names;
use super::settings;
use super::table::{Table, ValueRange};
use crate::config::ConfigError;
use crate::config::check::signed_gain;
use crate::scalar::Scalar;
use crate::units::{LENGTH_M, Position, SCALED_POSITION_M};

/// Unit of a position as a signal, m: ±8.5 m in steps of 4 nm.
const POSITION_M: f64 = 64.0 * LENGTH_M;

/// Unit of a position that is squared, m: (4 m)² is then below 2¹⁷.
const SQUARED_M: f64 = 0.016;

/// Greatest magnitude of a position that is squared, m.
const MAX_SQUARED_M: f64 = 4.0;

fn position_signal<S: Scalar>(position: Position) -> S {
    S::from_distance(position.0 >> 6)
}

/// Squareness k.
#[derive(Clone, Copy, Debug)]
pub struct Squareness<S: Scalar> {
    /// −k, error units per unit of [`Scalar::from_position`].
    minus_k: S::Gain,
}

impl<S: Scalar> Squareness<S> {
    /// From m/m.
    ///
    /// # Errors
    /// [`ConfigError`] with `squareness[1]`.
    pub fn new(m_per_m: f64) -> Result<Self, ConfigError> {
        Ok(Self { minus_k: signed_gain::<S>("squareness[1]", -m_per_m, SCALED_POSITION_M / LENGTH_M)? })
    }

    /// −k: the correction of the command is −k·y, error units, for y in units of [`Scalar::from_position`].
    #[must_use]
    pub const fn minus_k(&self) -> S::Gain {
        self.minus_k
    }
}

/// Straightness: k·y², or a table over y.
#[derive(Clone, Copy, Debug)]
pub enum Straightness<S: Scalar> {
    /// k, the conversion from units of [`POSITION_M`] to [`SQUARED_M`], and the greatest magnitude in the latter.
    Quadratic(S::Gain, S::Gain, S),
    /// A table, error units.
    Over(Table<S>),
}

impl<S: Scalar> Straightness<S> {
    /// From settings in m/m² or m.
    ///
    /// # Errors
    /// [`ConfigError`] with a setting of `straightness[1]`.
    pub fn new(settings: &settings::Straightness, bound_m: f64) -> Result<Self, ConfigError> {
        Ok(match settings {
            settings::Straightness::Quadratic(m_per_m2) => Self::Quadratic(
                signed_gain::<S>("straightness[1].Quadratic", *m_per_m2, SQUARED_M * SQUARED_M / LENGTH_M)?,
                S::gain(POSITION_M / SQUARED_M),
                S::signal(MAX_SQUARED_M / SQUARED_M),
            ),
            settings::Straightness::Over(points) => {
                let names = points_names!("straightness[1].Over");
                Self::Over(Table::new(&names, points, ValueRange { unit: LENGTH_M, bound: bound_m })?)
            }
        })
    }

    /// Correction of the command, error units.
    #[must_use]
    pub fn correction(&self, other: &CommandMotion<S>) -> S {
        match self {
            Self::Quadratic(k, scale, max) => {
                let y = S::round(position_signal::<S>(other.position) * *scale).clamp_magnitude(*max);
                // Neither factor is below the gain limit, but both are at most 250: the product, 62,500, fits.
                -S::round(S::round(y * y) * *k)
            }
            Self::Over(table) => -table.at(other.position),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::scalar::Fixed;

    fn off_nm<S: Scalar>(y: f64, k: f64, k2: f64) -> [f64; 2] {
        let other = CommandMotion::<S>::at(Position::from_m(y).unwrap());
        let nm = |correction: S| correction.value() * LENGTH_M * 1e9;
        let square = S::from_position(other.position) * Squareness::<S>::new(k).unwrap().minus_k();
        let straight = Straightness::<S>::new(&settings::Straightness::Quadratic(k2), 1.0).unwrap();
        [nm(S::round(square)) + k * y * 1e9, nm(straight.correction(&other)) + k2 * y * y * 1e9]
    }

    /// A table is of the error, which the correction takes away: halfway from 0 to 4 µm at 0.1 m, to the 2⁻²⁴ of an index.
    #[test]
    fn a_table_is_subtracted() {
        let points =
            settings::Points { start_m: 0.0, spacing_m: 0.2, values: [0.0, 4e-6].into_iter().collect() };
        let straight = Straightness::<f64>::new(&settings::Straightness::Over(points), 1e-3).unwrap();
        let other = CommandMotion::at(Position::from_m(0.1).unwrap());
        assert!((straight.correction(&other).value() * LENGTH_M + 2e-6).abs() < 1e-12);
    }

    /// Beyond 4 m the quadratic keeps its value there, 10⁻⁵/m·16 m² = 160 µm. Gains are rounded by 2⁻²⁵: of 0.0025 for the
    /// coefficient, and of 0.0041, twice, for the square below the end: 2.7e-5 of it.
    #[test]
    fn a_quadratic_keeps_its_value_beyond_four_metres() {
        let straight = Straightness::<Fixed>::new(&settings::Straightness::Quadratic(1e-5), 1.0).unwrap();
        for (m, square) in [(3.9, 15.21), (4.1, 16.0), (10.0, 16.0), (-90.0, 16.0)] {
            let other = CommandMotion::at(Position::from_m(m).unwrap());
            let correction_m = straight.correction(&other).value() * LENGTH_M;
            assert!((correction_m + 1e-5 * square).abs() < 4.5e-9, "{m}: {correction_m}");
        }
    }

    proptest! {
        /// Up to 100 µm/m and 10 µm/m² at ±2 m in fixed point. Squareness, 200 µm: the gain of 0.1 is rounded by 2⁻²⁵, 0.06 nm;
        /// the result is rounded towards −∞ by up to its step of 2⁻¹⁴, 0.0625 nm, that of the position is below 0.01 nm. Straightness, 40 µm: the gain of 0.0025 is rounded by 2⁻²⁵,
        /// 0.5 nm; y in steps of 1 µm enters twice.
        #[test]
        fn the_corrections_match_their_equations(y in -2.0..2.0f64, k in -1e-4..1e-4f64, k2 in -1e-5..1e-5f64) {
            let [square, straight] = off_nm::<Fixed>(y, k, k2);
            prop_assert!(square.abs() < 0.14 && straight.abs() < 2.0, "{square} {straight}");
            let [square, straight] = off_nm::<f32>(y, k, k2);
            prop_assert!(square.abs() < 0.1 && straight.abs() < 0.1, "{square} {straight}");
            let [square, straight] = off_nm::<f64>(y, k, k2);
            prop_assert!(square.abs() < 1e-3 && straight.abs() < 1e-3, "{square} {straight}");
        }
    }
}
