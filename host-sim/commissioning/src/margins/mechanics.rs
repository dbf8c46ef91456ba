//! The linear mechanics of an axis over a time in which the commanded force is constant.
//!
//! With the positions x and X of motor and table, the force F of the drive and its command u,
//!
//! ```text
//! m·x'' = F − k·(x − X) − c·(x' − X'),   M·X'' = k·(x − X) + c·(x' − X') − b·X' − σ0·X − σ1·X',   F' = (u − F)/τ,
//! ```
//!
//! where σ0 and σ1 only act while the guide sticks. A rigid axis has one mass m + M. The solution over a time T for a
//! constant u is the exponential of T times the matrix of the rates, extended by a row of zeros for u.

use nalgebra::{DMatrix, DVector};

use plant::parameters::AxisParameters;

/// What the table does. Each has its own linear model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// The table slides, screw and nut are in contact.
    Sliding,
    /// The table sticks on the elastic bristles of the friction (presliding).
    Sticking,
    /// The nut is within the backlash: the motor moves without the table.
    InBacklash,
    /// The table slides where the drive train is most compliant.
    Softest,
    /// The table slides where the drive train is least compliant.
    Stiffest,
}

impl Condition {
    /// All conditions.
    pub const ALL: [Self; 5] =
        [Self::Sliding, Self::Sticking, Self::InBacklash, Self::Softest, Self::Stiffest];

    /// Name in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sliding => "sliding",
            Self::Sticking => "sticking",
            Self::InBacklash => "in backlash",
            Self::Softest => "softest",
            Self::Stiffest => "stiffest",
        }
    }

    /// Whether an axis can be in this condition.
    #[must_use]
    pub fn is_possible(self, axis: &AxisParameters) -> bool {
        match self {
            Self::Sliding => true,
            Self::Sticking => axis.friction.has_bristles() && axis.friction.coulomb_n > 0.0,
            Self::InBacklash => axis.spring.is_some() && axis.screw.has_gap(),
            Self::Softest | Self::Stiffest => axis.spring.is_some() && !axis.screw.compliance_map.is_empty(),
        }
    }

    /// Compliance of the drive train, as a part of the declared one.
    fn compliance(self, axis: &AxisParameters) -> f64 {
        match self {
            Self::Softest => axis.screw.compliance_range()[1],
            Self::Stiffest => axis.screw.compliance_range()[0],
            _ => 1.0,
        }
    }
}

/// Rates of change of the state: motor position and velocity, table position and velocity if the table is a mass of its own,
/// force of the drive if it lags.
#[derive(Clone, Debug)]
pub struct Mechanics {
    /// Rates by the state, and in the last column by the commanded force.
    rates: DMatrix<f64>,
    /// Index of the table's position; `None`: the table does not move.
    table: Option<usize>,
}

/// Index of the motor's position in the state; its velocity follows.
const MOTOR: usize = 0;

impl Mechanics {
    /// The mechanics of an axis behind a drive with a first-order lag, s; 0: no lag.
    #[must_use]
    pub fn new(axis: &AxisParameters, drive_lag_s: f64, condition: Condition) -> Self {
        let has_table = axis.spring.is_some() && condition != Condition::InBacklash;
        let table = match condition {
            Condition::InBacklash => None,
            _ if has_table => Some(2),
            _ => Some(MOTOR),
        };
        let masses = if has_table { 4 } else { 2 };
        let states = masses + usize::from(drive_lag_s > 0.0);
        let mut rates = DMatrix::zeros(states + 1, states + 1);
        let motor_kg = axis.motor_mass_kg + if axis.spring.is_some() { 0.0 } else { axis.table_mass_kg };
        // The force of the drive is its own state, or the command.
        rates[(MOTOR + 1, masses)] = motor_kg.recip();
        if drive_lag_s > 0.0 {
            rates[(masses, masses)] = -drive_lag_s.recip();
            rates[(masses, states)] = drive_lag_s.recip();
        }
        for position in [MOTOR, 2].into_iter().take(masses / 2) {
            rates[(position, position + 1)] = 1.0;
        }
        if let (Some(spring), true) = (&axis.spring, has_table) {
            let stiffness_n_per_m = spring.stiffness_n_per_m / condition.compliance(axis);
            for (on, kg, sign) in [(MOTOR, motor_kg, -1.0), (2, axis.table_mass_kg, 1.0)] {
                for (by, direction) in [(MOTOR, sign), (2, -sign)] {
                    rates[(on + 1, by)] += direction * stiffness_n_per_m / kg;
                    rates[(on + 1, by + 1)] += direction * spring.damping_n_s_per_m / kg;
                }
            }
        }
        if let Some(table) = table {
            add_guide(&mut rates, axis, condition, table);
        }
        Self { rates, table }
    }

    /// Number of states.
    #[must_use]
    pub fn states(&self) -> usize {
        self.rates.nrows() - 1
    }

    /// State after `time_s`: a matrix, and a vector for the commanded force.
    #[must_use]
    pub fn after(&self, time_s: f64) -> (DMatrix<f64>, DVector<f64>) {
        let exponential = (&self.rates * time_s).exp();
        let n = self.states();
        (
            exponential.view((0, 0), (n, n)).into_owned(),
            exponential.view((0, n), (n, 1)).column(0).into_owned(),
        )
    }

    /// Position (m) and velocity (m/s) of the motor in a state.
    #[must_use]
    pub fn motor(state: &[f64]) -> (f64, f64) {
        (state[MOTOR], state[MOTOR + 1])
    }

    /// Position (m) and velocity (m/s) of the table in a state.
    #[must_use]
    pub fn table(&self, state: &[f64]) -> (f64, f64) {
        self.table.map_or((0.0, 0.0), |table| (state[table], state[table + 1]))
    }
}

/// Adds the forces of the guide on the table.
fn add_guide(rates: &mut DMatrix<f64>, axis: &AxisParameters, condition: Condition, table: usize) {
    let is_rigid = axis.spring.is_none();
    let kg = axis.table_mass_kg + if is_rigid { axis.motor_mass_kg } else { 0.0 };
    let friction = &axis.friction;
    rates[(table + 1, table + 1)] -= friction.viscous_n_s_per_m / kg;
    if condition == Condition::Sticking {
        rates[(table + 1, table)] -= friction.bristle_stiffness_n_per_m / kg;
        rates[(table + 1, table + 1)] -= friction.bristle_damping_n_s_per_m / kg;
    }
}
