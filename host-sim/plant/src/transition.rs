//! What one step makes of an axis: the linear part exactly, by the matrix exponential.
//!
//! Two masses with a spring and a damper between them, viscous friction on the table and the lag of the drive
//! are linear: with stretch s, masses m and M, velocities v and V, and pushes p and P on motor and table,
//! s′ = v − V, m·v′ = −k·s − c·s′ + F + p, M·V′ = k·s + c·s′ − b·V + P, F′ = (commanded − F)/τ. For pushes that stay over a step the state at its end is a sum of columns, one for
//! each part of the state and each push. However stiff the spring, there is nothing for it to be unstable with; what
//! is not linear (friction, the gap, errors of the screw) comes in as pushes, see [`super::mechanics`].

use nalgebra::SMatrix;

use super::lane::Lane;
use super::screw::Spring;

/// At the end of a step: table's way over it, stretch, motor velocity, table velocity.
pub type End<L> = [L; 4];

/// What makes what, and what is made of it.
type Rates = SMatrix<f64, 7, 7>;
const WAY: usize = 0;
const STRETCH: usize = 1;
const MOTOR: usize = 2;
const TABLE: usize = 3;
/// What the drive gives beyond what is commanded.
const LAG: usize = 4;
const MOTOR_PUSH: usize = 5;
const TABLE_PUSH: usize = 6;

/// Masses of an axis and the viscous friction of its table, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Masses {
    /// Motor side.
    pub motor_kg: f64,
    /// Table side.
    pub table_kg: f64,
    /// On the table.
    pub viscous_n_s_per_m: f64,
}

/// One step of the linear part: columns by which state and pushes enter the end of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition<L> {
    stretch: End<L>,
    motor: End<L>,
    table: End<L>,
    /// Per newton of what the drive still lacks or has too much.
    lag: End<L>,
    /// Per newton that stays on the motor.
    motor_push: End<L>,
    table_push: End<L>,
    /// Mean velocity of the table (m/s) per newton that stays on it.
    pub mobility: L,
    /// Newtons that have to stay on the table to change its velocity by 1 m/s within the step.
    pub stops_n_s_per_m: L,
    /// Share of the drive's lag that is left.
    pub lag_left: L,
}

impl Transition<f64> {
    /// Two masses; without a spring they do not touch.
    #[must_use]
    pub fn of_two(masses: Masses, spring: Option<&Spring>, drive_time_constant_s: f64, step_s: f64) -> Self {
        let Masses { motor_kg, table_kg, viscous_n_s_per_m: b } = masses;
        let (k, c) = spring.map_or((0.0, 0.0), |s| (s.stiffness_n_per_m, s.damping_n_s_per_m));
        let mut rates = Rates::zeros();
        rates[(WAY, TABLE)] = 1.0;
        rates[(STRETCH, MOTOR)] = 1.0;
        rates[(STRETCH, TABLE)] = -1.0;
        for (cause, force) in [(STRETCH, -k), (MOTOR, -c), (TABLE, c), (LAG, 1.0), (MOTOR_PUSH, 1.0)] {
            rates[(MOTOR, cause)] = force / motor_kg;
        }
        for (cause, force) in [(STRETCH, k), (MOTOR, c), (TABLE, -c - b), (TABLE_PUSH, 1.0)] {
            rates[(TABLE, cause)] = force / table_kg;
        }
        Self::over(rates, drive_time_constant_s, step_s)
    }

    /// Motor and table as one mass.
    #[must_use]
    pub fn of_one(masses: Masses, drive_time_constant_s: f64, step_s: f64) -> Self {
        let Masses { motor_kg, table_kg, viscous_n_s_per_m: b } = masses;
        let mut rates = Rates::zeros();
        rates[(WAY, TABLE)] = 1.0;
        for (cause, force) in [(TABLE, -b), (LAG, 1.0), (MOTOR_PUSH, 1.0), (TABLE_PUSH, 1.0)] {
            for mass in [MOTOR, TABLE] {
                rates[(mass, cause)] = force / (motor_kg + table_kg);
            }
        }
        Self::over(rates, drive_time_constant_s, step_s)
    }

    /// `rates` is what everything makes of the rate of every part of the state.
    fn over(mut rates: Rates, drive_time_constant_s: f64, step_s: f64) -> Self {
        let lags = drive_time_constant_s > 0.0;
        if lags {
            rates[(LAG, LAG)] = -1.0 / drive_time_constant_s;
        }
        let whole = (rates * step_s).exp();
        let column = |cause: usize| [WAY, STRETCH, MOTOR, TABLE].map(|part| whole[(part, cause)]);
        Self {
            stretch: column(STRETCH),
            motor: column(MOTOR),
            table: column(TABLE),
            lag: if lags { column(LAG) } else { [0.0; 4] },
            motor_push: column(MOTOR_PUSH),
            table_push: column(TABLE_PUSH),
            mobility: whole[(WAY, TABLE_PUSH)] / step_s,
            stops_n_s_per_m: whole[(TABLE, TABLE_PUSH)].recip(),
            lag_left: if lags { whole[(LAG, LAG)] } else { 0.0 },
        }
    }
}

impl<L: Lane> Transition<L> {
    /// Of axes beside each other.
    #[must_use]
    pub fn beside(axes: &[&Transition<f64>]) -> Self {
        let column = |of: fn(&Transition<f64>) -> &End<f64>| -> End<L> {
            std::array::from_fn(|part| L::of(|axis| of(axes[axis])[part]))
        };
        Self {
            stretch: column(|axis| &axis.stretch),
            motor: column(|axis| &axis.motor),
            table: column(|axis| &axis.table),
            lag: column(|axis| &axis.lag),
            motor_push: column(|axis| &axis.motor_push),
            table_push: column(|axis| &axis.table_push),
            mobility: L::of(|axis| axes[axis].mobility),
            stops_n_s_per_m: L::of(|axis| axes[axis].stops_n_s_per_m),
            lag_left: L::of(|axis| axes[axis].lag_left),
        }
    }

    /// The end of a step with a push on the table, from the end without.
    #[must_use]
    #[inline]
    pub fn pushed(&self, end: End<L>, table_push_n: L) -> End<L> {
        std::array::from_fn(|part| end[part] + self.table_push[part] * table_push_n)
    }

    /// The end of a step, without what pushes the table.
    #[must_use]
    #[inline]
    pub fn end(&self, stretch_m: L, velocities: [L; 2], lag_n: L, motor_push_n: L) -> End<L> {
        let [motor, table] = velocities;
        std::array::from_fn(|part| {
            (self.stretch[part] * stretch_m + self.motor[part] * motor)
                + (self.table[part] * table + self.lag[part] * lag_n)
                + self.motor_push[part] * motor_push_n
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MASSES: Masses = Masses { motor_kg: 90.0, table_kg: 160.0, viscous_n_s_per_m: 0.0 };

    /// Two masses on a spring without damping: the stretch swings with ω² = k·(1/m + 1/M).
    #[test]
    fn a_spring_swings_with_its_frequency_at_any_step() {
        let spring = Spring { stiffness_n_per_m: 2e8, damping_n_s_per_m: 0.0 };
        let omega = (2e8 * (1.0 / 90.0 + 1.0 / 160.0_f64)).sqrt();
        for step_s in [1e-6, 5e-5, 1e-3] {
            let step = Transition::of_two(MASSES, Some(&spring), 0.0, step_s);
            let end = step.end(1e-6, [0.0; 2], 0.0, 0.0);
            assert!((end[1] - 1e-6 * (omega * step_s).cos()).abs() < 1e-17, "{step_s}");
            let expected = -1e-6 * omega * (omega * step_s).sin();
            assert!((end[2] - end[3] - expected).abs() < 1e-14 * omega, "{step_s}");
            // Nothing from outside: the common centre stays.
            assert!((90.0 * end[2] + 160.0 * end[3]).abs() < 1e-13);
        }
    }

    /// A drive that lags by τ gives F·(t − τ·(1 − e^(−t/τ))) of momentum.
    #[test]
    fn a_lag_takes_its_share_of_the_momentum() {
        let (tau, h, force) = (1e-4, 5e-5, 100.0);
        let step = Transition::of_two(MASSES, None, tau, h);
        let end = step.end(0.0, [0.0; 2], -force, force);
        let expected = force * (h - tau * (1.0 - (-h / tau).exp()));
        assert!((90.0 * end[2] / expected - 1.0).abs() < 1e-12);
        assert!((step.lag_left - (-0.5f64).exp()).abs() < 1e-15);
    }
}
