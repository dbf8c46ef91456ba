//! The settings of the force feed-forward in SI.

use serde::{Deserialize, Serialize};

use super::settings::Points;

/// Force feed-forward from the commanded motion: the force that the model of the machine requires.
///
/// With the commanded motion x, v, a after the lag, and the friction of motor and table:
///
/// ```text
/// table:  F_t = table_mass·a + friction(v, ∫|v|dt, x) + viscous·v + half_difference·|v| + load(x)
/// motor:  F   = share·(motor_mass·a + motor friction(v) + F_t)
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ForceModel {
    /// Mass on the motor's side, kg.
    pub motor_mass_kg: f64,
    /// Mass of the table, kg.
    pub table_mass_kg: f64,
    /// Coulomb friction of the motor, N; it acts with tanh(v / 0.2 mm/s).
    pub motor_coulomb_n: f64,
    /// Rise of the motor's friction towards standstill.
    pub motor_stribeck: Option<Stribeck>,
    /// Friction of the table.
    pub friction: TableFriction,
    /// Load over the position, N: the force that the drive has to exert in the positive direction to hold the table
    /// (spring, cable chain, gravity). Kept outside the travel of the points.
    pub load: Option<Points>,
    /// Lag of the axis behind its command, s: the commanded motion passes a first-order low-pass filter with this time
    /// constant before it enters the model. 0: none.
    pub lag_s: f64,
    /// Fraction of the force that is applied, 0 to 1. The deflection of the drive is computed from the whole force.
    pub share: f64,
}

impl Default for ForceModel {
    fn default() -> Self {
        Self {
            motor_mass_kg: 0.0,
            table_mass_kg: 0.0,
            motor_coulomb_n: 0.0,
            motor_stribeck: None,
            friction: TableFriction::default(),
            load: None,
            lag_s: 0.0,
            share: 1.0,
        }
    }
}

/// Friction of the table.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TableFriction {
    /// Coulomb friction, N. Above 0 where presliding or a rise towards standstill is set.
    pub coulomb_n: f64,
    /// Viscous friction b, N·s/m.
    pub viscous_n_s_per_m: f64,
    /// Asymmetry h of the viscous friction, N·s/m: b + h in the positive direction, b − h in the negative one.
    pub half_difference_n_s_per_m: f64,
    /// Presliding stiffness σ₀, N/m: after a reversal the friction follows the distance travelled,
    /// dF = σ₀·dx − σ₀·|dx|·F/g(v). Absent: friction acts with tanh(v / 0.2 mm/s).
    pub presliding_stiffness_n_per_m: Option<f64>,
    /// Rise towards standstill: g(v) = coulomb + excess·exp(−(v/vₛ)²).
    pub stribeck: Option<Stribeck>,
    /// Additional friction over the position, N.
    pub map: Option<Points>,
    /// Additional friction that decays over the time since this setting.
    pub warm_up: Option<FrictionWarmUp>,
}

/// Rise of friction towards standstill: excess·exp(−(v/velocity)²).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stribeck {
    /// Friction at standstill above Coulomb friction, N; negative where it is below.
    pub excess_n: f64,
    /// Velocity vₛ at which the excess has fallen to 1/e, m/s.
    pub velocity_m_per_s: f64,
}

/// Additional friction `force·exp(−t/time_constant)`, with the time t since this setting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionWarmUp {
    /// Additional friction when the compensation is set, N.
    pub force_n: f64,
    /// Time constant of its decay, s.
    pub time_constant_s: f64,
}
