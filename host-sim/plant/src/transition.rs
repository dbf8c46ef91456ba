//! One step of the linear part of an axis, exact by the matrix exponential.
//!
//! Two masses with a spring and a damper between them, viscous friction on the table and a first-order lag of the
//! drive: with the stretch s, the masses m and M, the velocities v and V of motor and table, and constant forces p and
//! P on them,
//!
//! ```text
//! s' = v − V,   m·v' = −k·s − c·s' + F + p,   M·V' = k·s + c·s' − b·V + P,   F' = (commanded − F)/τ.
//! ```
//!
//! For forces that are constant over a step, its end is a sum of columns of the exponential, one for each part of the
//! state and each force. This is stable however stiff the spring is. What is not linear (friction, backlash, pitch
//! errors) enters as the forces, see [`super::mechanics`].

use nalgebra::SMatrix;

use super::lane::Lane;
use super::screw::Spring;

/// State at the end of a step: travel of the table over it (m), stretch (m), motor and table velocity (m/s).
pub type End<L> = [L; 4];

/// Rates of change: row, the part that changes; column, the part that causes it.
type Rates = SMatrix<f64, 7, 7>;
const TRAVEL: usize = 0;
const STRETCH: usize = 1;
const MOTOR: usize = 2;
const TABLE: usize = 3;
/// Force of the drive − commanded force.
const LAG: usize = 4;
const MOTOR_FORCE: usize = 5;
const TABLE_FORCE: usize = 6;

/// Masses of an axis and the viscous friction of its table, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Masses {
    /// Inertia of the motor side, reflected to the table.
    pub motor_kg: f64,
    /// Mass of the table side.
    pub table_kg: f64,
    /// Viscous friction of the guide.
    pub viscous_n_s_per_m: f64,
}

/// One step of the linear part: the columns by which state and forces enter the end of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition<L> {
    stretch: End<L>,
    motor: End<L>,
    table: End<L>,
    /// Per newton by which the drive differs from its command at the beginning.
    lag: End<L>,
    /// Per newton on the motor.
    motor_force: End<L>,
    /// Per newton on the table.
    table_force: End<L>,
    /// Mean velocity of the table over the step per newton on it, m/s/N.
    pub mobility: L,
    /// Force on the table that changes its velocity at the end by 1 m/s, N·s/m.
    pub stopping_n_s_per_m: L,
    /// Fraction of the difference between drive and command that is left after the step.
    pub lag_left: L,
}

impl Transition<f64> {
    /// Motor and table as two masses; without a spring nothing connects them. Time constant 0: no lag.
    #[must_use]
    pub fn two_masses(
        masses: Masses,
        spring: Option<&Spring>,
        drive_time_constant_s: f64,
        step_s: f64,
    ) -> Self {
        let Masses { motor_kg, table_kg, viscous_n_s_per_m: b } = masses;
        let (k, c) = spring.map_or((0.0, 0.0), |s| (s.stiffness_n_per_m, s.damping_n_s_per_m));
        let mut rates = Rates::zeros();
        rates[(TRAVEL, TABLE)] = 1.0;
        rates[(STRETCH, MOTOR)] = 1.0;
        rates[(STRETCH, TABLE)] = -1.0;
        for (cause, force) in [(STRETCH, -k), (MOTOR, -c), (TABLE, c), (LAG, 1.0), (MOTOR_FORCE, 1.0)] {
            rates[(MOTOR, cause)] = force / motor_kg;
        }
        for (cause, force) in [(STRETCH, k), (MOTOR, c), (TABLE, -c - b), (TABLE_FORCE, 1.0)] {
            rates[(TABLE, cause)] = force / table_kg;
        }
        Self::over_step(rates, drive_time_constant_s, step_s)
    }

    /// Motor and table as one mass. Time constant 0: no lag.
    #[must_use]
    pub fn one_mass(masses: Masses, drive_time_constant_s: f64, step_s: f64) -> Self {
        let Masses { motor_kg, table_kg, viscous_n_s_per_m: b } = masses;
        let mut rates = Rates::zeros();
        rates[(TRAVEL, TABLE)] = 1.0;
        for (cause, force) in [(TABLE, -b), (LAG, 1.0), (MOTOR_FORCE, 1.0), (TABLE_FORCE, 1.0)] {
            for mass in [MOTOR, TABLE] {
                rates[(mass, cause)] = force / (motor_kg + table_kg);
            }
        }
        Self::over_step(rates, drive_time_constant_s, step_s)
    }

    /// The step of a length (s) with these rates of change, to which the lag of the drive is added.
    fn over_step(mut rates: Rates, drive_time_constant_s: f64, step_s: f64) -> Self {
        let has_lag = drive_time_constant_s > 0.0;
        if has_lag {
            rates[(LAG, LAG)] = -1.0 / drive_time_constant_s;
        }
        let exponential = (rates * step_s).exp();
        let column = |cause: usize| [TRAVEL, STRETCH, MOTOR, TABLE].map(|part| exponential[(part, cause)]);
        Self {
            stretch: column(STRETCH),
            motor: column(MOTOR),
            table: column(TABLE),
            lag: if has_lag { column(LAG) } else { [0.0; 4] },
            motor_force: column(MOTOR_FORCE),
            table_force: column(TABLE_FORCE),
            mobility: exponential[(TRAVEL, TABLE_FORCE)] / step_s,
            stopping_n_s_per_m: exponential[(TABLE, TABLE_FORCE)].recip(),
            lag_left: if has_lag { exponential[(LAG, LAG)] } else { 0.0 },
        }
    }
}

impl<L: Lane> Transition<L> {
    /// The steps of several axes in one register.
    #[must_use]
    pub fn joined(axes: &[&Transition<f64>]) -> Self {
        let column = |of: fn(&Transition<f64>) -> &End<f64>| -> End<L> {
            std::array::from_fn(|part| L::of(|axis| of(axes[axis])[part]))
        };
        Self {
            stretch: column(|axis| &axis.stretch),
            motor: column(|axis| &axis.motor),
            table: column(|axis| &axis.table),
            lag: column(|axis| &axis.lag),
            motor_force: column(|axis| &axis.motor_force),
            table_force: column(|axis| &axis.table_force),
            mobility: L::of(|axis| axes[axis].mobility),
            stopping_n_s_per_m: L::of(|axis| axes[axis].stopping_n_s_per_m),
            lag_left: L::of(|axis| axes[axis].lag_left),
        }
    }

    /// The end of a step with a force on the table (N), from the end without it.
    #[must_use]
    #[inline]
    pub fn with_table_force(&self, end: End<L>, table_force_n: L) -> End<L> {
        std::array::from_fn(|part| end[part] + self.table_force[part] * table_force_n)
    }

    /// The end of a step without a force on the table: stretch (m), velocities of motor and table (m/s), difference
    /// between drive and command (N) at its beginning, and force on the motor (N).
    #[must_use]
    #[inline]
    pub fn end(&self, stretch_m: L, velocities: [L; 2], lag_n: L, motor_force_n: L) -> End<L> {
        let [motor, table] = velocities;
        std::array::from_fn(|part| {
            (self.stretch[part] * stretch_m + self.motor[part] * motor)
                + (self.table[part] * table + self.lag[part] * lag_n)
                + self.motor_force[part] * motor_force_n
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MASSES: Masses = Masses { motor_kg: 90.0, table_kg: 160.0, viscous_n_s_per_m: 0.0 };

    /// Two masses on a spring without damping: the stretch oscillates with ω² = k·(1/m + 1/M).
    #[test]
    fn a_spring_oscillates_at_its_frequency_for_any_step() {
        let spring = Spring { stiffness_n_per_m: 2e8, damping_n_s_per_m: 0.0 };
        let omega = (2e8 * (1.0 / 90.0 + 1.0 / 160.0_f64)).sqrt();
        for step_s in [1e-6, 5e-5, 1e-3] {
            let step = Transition::two_masses(MASSES, Some(&spring), 0.0, step_s);
            let end = step.end(1e-6, [0.0; 2], 0.0, 0.0);
            assert!((end[1] - 1e-6 * (omega * step_s).cos()).abs() < 1e-17, "{step_s}");
            let expected = -1e-6 * omega * (omega * step_s).sin();
            assert!((end[2] - end[3] - expected).abs() < 1e-14 * omega, "{step_s}");
            // No external force: the momentum stays zero.
            assert!((90.0 * end[2] + 160.0 * end[3]).abs() < 1e-13);
        }
    }

    /// A drive that lags by τ adds the momentum F·(t − τ·(1 − e^(−t/τ))).
    #[test]
    fn a_lag_reduces_the_momentum() {
        let (tau, h, force) = (1e-4, 5e-5, 100.0);
        let step = Transition::two_masses(MASSES, None, tau, h);
        let end = step.end(0.0, [0.0; 2], -force, force);
        let expected = force * (h - tau * (1.0 - (-h / tau).exp()));
        assert!((90.0 * end[2] / expected - 1.0).abs() < 1e-12);
        assert!((step.lag_left - (-0.5f64).exp()).abs() < 1e-15);
    }
}
