//! Squareness and straightness: the tool point is off by k·y, or by a function of y, y another axis's position.

use super::motion::Motion;
use super::pitch::over;
use super::settings;
use super::table::Table;
use crate::config::ConfigError;
use crate::config::check::gain;
use crate::scalar::Scalar;
use crate::units::{LENGTH_M, Position};

/// Metres in one unit of a whole position as a signal: ±8.5 m in steps of 4 nm.
const PLACE_M: f64 = 64.0 * LENGTH_M;

/// Metres in one unit of a position that is squared: 16 mm, so that 4 m squared is below 2¹⁷.
const SQUARED_M: f64 = 0.016;

/// Squares are of at most so much.
const MOST_SQUARED_M: f64 = 4.0;

fn whole<S: Scalar>(place: Position) -> S {
    S::from_distance(place.0 >> 6)
}

/// k of squareness.
#[derive(Clone, Copy, Debug)]
pub struct Squareness<S: Scalar> {
    per_place: S::Gain,
}

impl<S: Scalar> Squareness<S> {
    /// From m/m.
    ///
    /// # Errors
    /// Names `squareness`.
    pub fn new(m_per_m: f64) -> Result<Self, ConfigError> {
        Ok(Self { per_place: gain::<S>("squareness", m_per_m, PLACE_M / LENGTH_M)? })
    }

    /// What to add to the command, error units: −k·y.
    #[must_use]
    pub fn correction(&self, other: &Motion<S>) -> S::Sum {
        S::Sum::default() - whole::<S>(other.place) * self.per_place
    }
}

/// k·y², or a table over y.
#[derive(Clone, Copy, Debug)]
pub enum Straightness<S: Scalar> {
    /// k, and what makes a place squared of a place.
    Quadratic(S::Gain, S::Gain),
    /// Error units.
    Over(Table<S>),
}

impl<S: Scalar> Straightness<S> {
    /// From settings in m/m² or m.
    ///
    /// # Errors
    /// Names `straightness`.
    pub fn new(settings: &settings::Straightness, bound_m: f64) -> Result<Self, ConfigError> {
        Ok(match settings {
            settings::Straightness::Quadratic(m_per_m2) => Self::Quadratic(
                gain::<S>("straightness", *m_per_m2, SQUARED_M * SQUARED_M / LENGTH_M)?,
                S::gain(PLACE_M / SQUARED_M),
            ),
            settings::Straightness::Over(points) => {
                Self::Over(over(points, "straightness", LENGTH_M, bound_m)?)
            }
        })
    }

    /// What to add to the command, error units.
    #[must_use]
    pub fn correction(&self, other: &Motion<S>) -> S {
        match self {
            Self::Quadratic(k, scale) => {
                let most = S::signal(MOST_SQUARED_M / SQUARED_M);
                let y = S::round(whole::<S>(other.place) * *scale).clamp_magnitude(most);
                // Two factors of at most 250: one below the gain limit is not needed, the product is 62,500.
                -S::round(S::round(y * y) * *k)
            }
            Self::Over(table) => -table.at(other.place),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::scalar::Fixed;

    fn off_nm<S: Scalar>(y: f64, k: f64, k2: f64) -> [f64; 2] {
        let other = Motion::<S>::at(Position::from_m(y).unwrap());
        let nm = |correction: S| correction.value() * LENGTH_M * 1e9;
        let square = Squareness::<S>::new(k).unwrap().correction(&other);
        let straight = Straightness::<S>::new(&settings::Straightness::Quadratic(k2), 1.0).unwrap();
        [nm(S::round(square)) + k * y * 1e9, nm(straight.correction(&other)) + k2 * y * y * 1e9]
    }

    proptest! {
        /// 100 µm/m and 10 µm/m² on ±2 m. Squareness: half a step of the result, 31 pm, of the place, 2 nm·1e-4, and
        /// of the gain, 2⁻²⁵ of 0.0064. Straightness: 1 µm of 16 mm twice on 40 µm, and the gain, 2⁻²⁵ of 0.0025.
        #[test]
        fn corrects_what_the_geometry_makes(y in -2.0..2.0f64, k in -1e-4..1e-4f64, k2 in -1e-5..1e-5f64) {
            let [square, straight] = off_nm::<Fixed>(y, k, k2);
            prop_assert!(square.abs() < 1.0 && straight.abs() < 2.0, "{square} {straight}");
            let [square, straight] = off_nm::<f32>(y, k, k2);
            prop_assert!(square.abs() < 0.1 && straight.abs() < 0.1, "{square} {straight}");
            let [square, straight] = off_nm::<f64>(y, k, k2);
            prop_assert!(square.abs() < 1e-3 && straight.abs() < 1e-3, "{square} {straight}");
        }
    }
}
