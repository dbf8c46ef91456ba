//! In-talk and cross-talk: the tool is displaced by a coefficient times the acceleration of its own axis or of another one,
//! because drives do not act at the centre of gravity of the bodies that they move (Nguyen, Weikert, Wegener).

use super::names::PointsNames;
use super::settings;
use super::table::{Table, ValueRange};
use crate::config::ConfigError;
use crate::scalar::Scalar;
use crate::units::{INCREMENT_M, LENGTH_M, Position};

/// The coefficient, error units per increment unit per tick².
#[derive(Clone, Copy, Debug)]
pub enum Talk<S: Scalar> {
    /// Constant.
    Constant(S),
    /// As a function of the position of the compensated axis.
    Over(Table<S>),
}

impl<S: Scalar> Talk<S> {
    /// From settings in m·s²/m, for a command every 1/`rate_hz`. With the names of the constant and of the table.
    ///
    /// # Errors
    /// [`ConfigError`] with one of the names and the range of the number format.
    pub fn new(
        (constant, table): (&'static str, &PointsNames),
        settings: &settings::Talk,
        rate_hz: f64,
    ) -> Result<Self, ConfigError> {
        let unit = LENGTH_M / (INCREMENT_M * rate_hz * rate_hz);
        let max = unit * S::GAIN_LIMIT.min(1e9);
        Ok(match settings {
            settings::Talk::Constant(value) => {
                Self::Constant(S::signal(crate::config::check::ranged(constant, *value, -max, max)? / unit))
            }
            settings::Talk::Over(points) => {
                Self::Over(Table::new(table, points, ValueRange { unit, bound: max })?)
            }
        })
    }

    /// Correction of the command per acceleration: −c, error units per increment unit per tick².
    #[must_use]
    pub fn correction(&self, own: Position) -> S {
        match self {
            Self::Constant(value) => -*value,
            Self::Over(table) => -table.at(own),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensate::motion::CommandMotion;
    use crate::compensate::names::points_names;
    use crate::scalar::Fixed;

    const NAMES: (&str, &PointsNames) = ("intalk.Constant", &points_names!("intalk.Over"));

    /// Greatest error of −c·a for c = 1.5 µm·s²/m on a sine of 2 mm at 8 Hz: a is at most 5.05 m/s², the correction 7.6 µm.
    fn worst_nm<S: Scalar>() -> f64 {
        let (rate, radius, omega, c) = (4000.0, 2e-3, core::f64::consts::TAU * 8.0, 1.5e-6);
        let talk = Talk::<S>::new(NAMES, &settings::Talk::Constant(c), rate).unwrap();
        let at = |k: i32| radius * (omega * f64::from(k) / rate).sin();
        let position = |k| Position::from_m(at(k)).unwrap();
        let mut motion = CommandMotion::<S>::at(position(0));
        let mut worst = 0.0f64;
        for k in 1..2000 {
            motion.step(position(k));
            if k > 2 {
                let a = (at(k) - 2.0 * at(k - 1) + at(k - 2)) * rate * rate;
                let sum = talk.correction(motion.position) * motion.acceleration;
                worst = worst.max((S::round(sum).value() * LENGTH_M + c * a).abs() * 1e9);
            }
        }
        worst
    }

    /// An error by a constant and by a table, halfway between 1 and 3 µm per m/s².
    #[test]
    fn a_table_has_the_sign_of_a_constant() {
        let values = [1e-6, 3e-6].into_iter().collect();
        let over = settings::Talk::Over(settings::Points { start_m: 0.0, spacing_m: 0.2, values });
        let [over, constant] = [over, settings::Talk::Constant(2e-6)].map(|talk| {
            Talk::<f64>::new(NAMES, &talk, 4000.0).unwrap().correction(Position(0) + 104_857_600_000_000)
        });
        // A unit is 4 µm per m/s²; the index of a table has an error of 2⁻²⁴.
        assert!((constant + 0.5).abs() < 1e-12 && (over - constant).abs() < 1e-6, "{over}");
    }

    /// A unit at 4 kHz is 1.024 µm/(16 nm·rate²), 4 µm per m/s²; a gain of fixed point is below 128 of them.
    #[test]
    fn a_coefficient_that_is_no_gain_is_refused() {
        let new = |value| Talk::<Fixed>::new(NAMES, &settings::Talk::Constant(value), 4000.0).err();
        assert_eq!((new(5.11e-4), new(-5.11e-4)), (None, None));
        for value in [5.13e-4, -5.13e-4] {
            let Some(ConfigError::OutOfRange { name: "intalk.Constant", min, max }) = new(value) else {
                panic!("{:?}", new(value))
            };
            assert!((max - 5.12e-4).abs() < 1e-15 && (min + max).abs() < 1e-18, "{min} to {max}");
        }
    }

    #[test]
    fn the_correction_is_proportional_to_the_acceleration() {
        // Fixed point: a step of the acceleration is 1 pm per tick², 16 µm/s² at 4 kHz, which is 24 pm of the correction. A
        // step of the coefficient, 2⁻¹⁴ of 0.375, is 1.6e-4 of 7.6 µm.
        assert!(worst_nm::<Fixed>() < 1.5, "{}", worst_nm::<Fixed>());
        assert!(worst_nm::<f32>() < 0.1, "{}", worst_nm::<f32>());
        assert!(worst_nm::<f64>() < 0.03, "{}", worst_nm::<f64>());
    }
}
