//! In-talk and cross-talk: the tool point is off by a coefficient times an acceleration, of its own axis or of
//! another (Nguyen, Weikert, Wegener), because drives act off the centre of gravity of what they move.

use super::pitch::over;
use super::settings;
use super::table::Table;
use crate::config::ConfigError;
use crate::scalar::Scalar;
use crate::units::{INCREMENT_M, LENGTH_M, Position};

/// The coefficient, error units per increment unit a tick².
#[derive(Clone, Copy, Debug)]
pub enum Talk<S: Scalar> {
    /// The same everywhere.
    Constant(S),
    /// Over the own position.
    Over(Table<S>),
}

impl<S: Scalar> Talk<S> {
    /// From settings in m·s²/m, for a command every 1/`rate_hz`.
    ///
    /// # Errors
    /// By `name`, with the range that the number format holds.
    pub fn new(name: &'static str, settings: &settings::Talk, rate_hz: f64) -> Result<Self, ConfigError> {
        let unit = LENGTH_M / (INCREMENT_M * rate_hz * rate_hz);
        let most = unit * S::GAIN_LIMIT.min(1e9);
        Ok(match settings {
            settings::Talk::Constant(value) => {
                Self::Constant(S::signal(crate::config::check::ranged(name, *value, -most, most)? / unit))
            }
            settings::Talk::Over(points) => Self::Over(over(points, name, unit, most)?),
        })
    }

    /// What to add to the command per acceleration of it (increment units a tick²), error units: −c.
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
    use crate::compensate::motion::Motion;
    use crate::scalar::Fixed;

    /// 1.5 µm·s²/m on a circle of 2 mm at 8 Hz, 5.05 m/s²: −c times the acceleration of the command.
    fn worst_nm<S: Scalar>() -> f64 {
        let (rate, radius, omega, c) = (4000.0, 2e-3, core::f64::consts::TAU * 8.0, 1.5e-6);
        let talk = Talk::<S>::new("intalk", &settings::Talk::Constant(c), rate).unwrap();
        let at = |k: i32| radius * (omega * f64::from(k) / rate).sin();
        let place = |k| Position::from_m(at(k)).unwrap();
        let mut motion = Motion::<S>::at(place(0));
        let mut worst = 0.0f64;
        for k in 1..2000 {
            motion.step(place(k));
            if k > 2 {
                let a = (at(k) - 2.0 * at(k - 1) + at(k - 2)) * rate * rate;
                let made = S::round(talk.correction(motion.place) * motion.acceleration).value() * LENGTH_M;
                worst = worst.max((made + c * a).abs() * 1e9);
            }
        }
        worst
    }

    #[test]
    fn corrects_what_the_acceleration_makes() {
        // The acceleration in steps of 1 pm a tick², 16 µm/s² at 4 kHz, is 24 pm; the coefficient in steps of 2⁻¹⁴
        // of 0.375 is 1.6e-4 of 7.6 µm.
        assert!(worst_nm::<Fixed>() < 1.5, "{}", worst_nm::<Fixed>());
        assert!(worst_nm::<f32>() < 0.1, "{}", worst_nm::<f32>());
        assert!(worst_nm::<f64>() < 0.03, "{}", worst_nm::<f64>());
    }
}
