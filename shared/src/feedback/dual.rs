//! Dual feedback: motor + low-pass(table − motor).
//!
//! Above the crossover 1/T the loop closes on the motor, which is stiff and quiet; below it on the
//! table, where the work is (Soeda, 1977: Qf = s/(s + K')·motor + K'/(s + K')·table, K' = 1/T). The
//! low-pass is stepped exactly for a held input: state += (1 − e^(−tick/T))·(difference − state).

use crate::scalar::Scalar;
use crate::units::Position;

/// Which sensors close the position loop.
#[derive(Clone, Copy, Debug)]
pub enum Feedback<S: Scalar> {
    /// Motor encoder alone (semi-closed loop).
    Motor,
    /// Linear scale alone (full-closed loop).
    Table,
    /// Both.
    Dual {
        /// 1 − e^(−tick/T).
        share: S::Gain,
    },
}

/// Low-passed difference table − motor.
#[derive(Clone, Copy, Debug, Default)]
pub struct State<S: Scalar> {
    correction: S::Sum,
}

impl<S: Scalar> State<S> {
    /// Settled on the difference of two readings.
    #[must_use]
    pub fn settled(motor: Position, table: Option<Position>) -> Self {
        let difference = table.map_or(0, |table| table.beyond(motor));
        Self { correction: S::from_distance(difference).widen() }
    }
}

impl<S: Scalar> Feedback<S> {
    /// Whether the loop uses a linear scale.
    #[must_use]
    pub const fn needs_table(&self) -> bool {
        !matches!(self, Self::Motor)
    }

    /// Where the loop finds the axis when it starts on these readings.
    #[must_use]
    pub fn settled(&self, motor: Position, table: Option<Position>) -> Position {
        match self {
            Self::Motor => motor,
            Self::Table | Self::Dual { .. } => table.unwrap_or(motor),
        }
    }

    /// The position to close the loop on. Without a table reading the last correction holds.
    pub fn position(&self, state: &mut State<S>, motor: Position, table: Option<Position>) -> Position {
        match (self, table) {
            (Self::Table, Some(table)) => table,
            (Self::Motor, _) | (Self::Table, None) => motor,
            (Self::Dual { share }, _) => {
                if let Some(table) = table {
                    let difference = S::from_distance(table.beyond(motor));
                    state.correction += difference.minus(S::round(state.correction)).times(*share);
                }
                motor.moved(S::to_distance(state.correction))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Fixed;

    /// A step of the difference appears as 1 − e^(−t/T).
    fn worst_nm<S: Scalar>() -> f64 {
        let (tick, time_constant) = (1.0 / 20_000.0, 0.08);
        let share = S::gain(1.0 - f64::exp(-tick / time_constant));
        let feedback = Feedback::<S>::Dual { share };
        let mut state = State::default();
        let step = Position::from_m(10e-6);
        let mut worst = 0.0f64;
        for k in 1..=10_000 {
            let nm = 1e9 * feedback.position(&mut state, Position(0), step).to_m();
            let exact = 10_000.0 * (1.0 - f64::exp(-f64::from(k) * tick / time_constant));
            worst = worst.max((nm - exact).abs());
        }
        worst
    }

    #[test]
    fn follows_the_table_with_its_time_constant() {
        assert!(worst_nm::<f64>() < 1e-5);
        // The share rounds to 2⁻²⁵ of 6.2e-4: 5e-5 relative, 0.18 nm where the slope is greatest.
        assert!(worst_nm::<Fixed>() < 0.25, "{}", worst_nm::<Fixed>());
    }
}
