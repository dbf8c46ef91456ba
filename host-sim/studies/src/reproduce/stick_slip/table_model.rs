//! The paper's model: two tables, each a mass on the spring and damper of its drive, with friction that first falls and
//! then rises with velocity (equations 1 to 16).
//!
//! M·x″ + C·x′ + K·x = M·g·μ(V0 − x′) − M·V0′ (equations 2 and 3), with x the deflection between drive and table and
//! V0 the drive's velocity on the circle. There is no controller. Both axes are integrated together by the
//! fifth-order Dormand–Prince method with steps of 1e-6 to 1e-4 s.

use std::f64::consts::TAU;

use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};

use crate::reproduce::study::ReproduceError;
use contour::circular_test::{Ballbar, Lap, POINTS};
use model::friction_curve::FallingRising;

/// g.
const GRAVITY_M_PER_S2: f64 = 9.81;

/// Radius of the circle, m.
pub const RADIUS_M: f64 = 0.1;

/// The lower and the higher speed of the paper.
pub const SPEEDS_RAD_PER_S: [f64; 2] = [0.5, 1.5];

/// Minimum and maximum step of the integration.
const STEPS_S: (f64, f64) = (1e-6, 1e-4);

/// One table with its drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Mass M.
    pub mass_kg: f64,
    /// Stiffness K of the lead screw.
    pub stiffness_n_per_m: f64,
    /// Damping C: 1 % of critical, rounded.
    pub damping_n_s_per_m: f64,
}

/// The tables of X and Y.
pub const TABLES: [Table; 2] = [
    Table { mass_kg: 90.0, stiffness_n_per_m: 1e8, damping_n_s_per_m: 1900.0 },
    Table { mass_kg: 120.0, stiffness_n_per_m: 1e8, damping_n_s_per_m: 2200.0 },
];

impl Table {
    /// Friction of the guideway under the table's weight.
    #[must_use]
    pub fn friction(&self) -> FallingRising {
        let load_n = self.mass_kg * GRAVITY_M_PER_S2;
        FallingRising { mu1: 0.15, mu2: 0.08, alpha: 50.0, beta: 5.0, gamma: 1.5, load_n }
    }
}

/// A circle at constant speed, from (R, 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircularPath {
    /// Angular speed Ω; negative clockwise.
    pub speed_rad_per_s: f64,
}

impl CircularPath {
    /// Duration of a lap, s.
    #[must_use]
    pub fn lap_s(self) -> f64 {
        TAU / self.speed_rad_per_s.abs()
    }

    /// Position of the drives, m.
    #[must_use]
    pub fn position_m(self, time_s: f64) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.speed_rad_per_s * time_s);
        [RADIUS_M * cos, RADIUS_M * sin]
    }

    /// Velocity of the drives V0, m/s.
    #[must_use]
    pub fn velocity_m_per_s(self, time_s: f64) -> [f64; 2] {
        let [x, y] = self.position_m(time_s);
        [-self.speed_rad_per_s * y, self.speed_rad_per_s * x]
    }

    /// Acceleration of the drives V0′, m/s².
    #[must_use]
    pub fn acceleration_m_per_s2(self, time_s: f64) -> [f64; 2] {
        self.position_m(time_s).map(|m| -self.speed_rad_per_s.powi(2) * m)
    }
}

/// The equations of motion on a circle; the state is x, x′, y, y′.
struct Equations {
    path: CircularPath,
    friction: [FallingRising; 2],
}

impl ODE<f64, [f64; 4]> for Equations {
    fn diff(&self, time_s: f64, state: &[f64; 4], rate: &mut [f64; 4]) {
        let velocity = self.path.velocity_m_per_s(time_s);
        let acceleration = self.path.acceleration_m_per_s2(time_s);
        for (axis, table) in TABLES.iter().enumerate() {
            let [deflection, speed] = [state[2 * axis], state[2 * axis + 1]];
            let force = self.friction[axis].force_n(velocity[axis] - speed)
                - table.damping_n_s_per_m * speed
                - table.stiffness_n_per_m * deflection;
            rate[2 * axis] = speed;
            rate[2 * axis + 1] = force / table.mass_kg - acceleration[axis];
        }
    }
}

/// Deflection of both drives over one lap.
#[derive(Clone, Debug, PartialEq)]
pub struct Deflections {
    /// The path.
    pub path: CircularPath,
    /// Time since the start of the lap (s), and deflection of X and Y (m).
    pub points: Vec<(f64, [f64; 2])>,
}

impl Deflections {
    /// Integrates two laps from rest and keeps the second. The paper does not give the initial condition; the transient,
    /// 1 % damping at 150 Hz, decays within 0.5 s.
    ///
    /// # Errors
    /// If the integration fails.
    pub fn on(path: CircularPath) -> Result<Self, ReproduceError> {
        let lap_s = path.lap_s();
        let friction = TABLES.each_ref().map(Table::friction);
        let equations = Equations { path, friction };
        // 1 pm, and 1 nm/s: the same times the natural frequency of 1e3 rad/s.
        let tolerance = [1e-12, 1e-9, 1e-12, 1e-9];
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some ten million")]
        let max_steps = (2.0 * lap_s / STEPS_S.0) as usize;
        let times_s: Vec<f64> = (0..=POINTS).map(|i| lap_s * (1.0 + i as f64 / POINTS as f64)).collect();
        let method = ExplicitRungeKutta::dopri5()
            .rtol(1e-9)
            .atol(tolerance)
            .h0(STEPS_S.0)
            .h_min(STEPS_S.0)
            .h_max(STEPS_S.1)
            .max_steps(max_steps);
        let solution = IVP::ode(&equations, 0.0, 2.0 * lap_s, [0.0; 4])
            .method(method)
            .t_eval(&times_s)
            .solve()
            .map_err(|error| ReproduceError::Numerics(format!("stick-slip: {error:?}")))?;
        let points = solution.t.iter().zip(&solution.y).map(|(t, y)| (t - lap_s, [y[0], y[2]])).collect();
        Ok(Self { path, points })
    }

    /// Peak-to-peak deflection of X and Y, µm.
    #[must_use]
    pub fn peak_to_peak_um(&self) -> [f64; 2] {
        [0, 1].map(|axis| 1e6 * numerics::peak_to_peak(self.points.iter().map(|point| point.1[axis])))
    }

    /// The radial deviation. Friction holds a table back: its position is X0 − x, with X0 that of the drive.
    ///
    /// # Errors
    /// If there are no points.
    pub fn lap(&self) -> Result<Lap, ReproduceError> {
        let table = |(time_s, [x, y]): &(f64, [f64; 2])| {
            let [x0, y0] = self.path.position_m(*time_s);
            [x0 - x, y0 - y]
        };
        let path_m: Vec<[f64; 2]> = self.points.iter().map(table).collect();
        super::lap::lap(&path_m, RADIUS_M)
    }
}

/// The circular test at a speed.
///
/// # Errors
/// If the integration fails.
pub fn ballbar(speed_rad_per_s: f64) -> Result<Ballbar, ReproduceError> {
    let lap = |sense: f64| Deflections::on(CircularPath { speed_rad_per_s: sense * speed_rad_per_s })?.lap();
    Ok(Ballbar { positive: lap(1.0)?, negative: lap(-1.0)? })
}

/// Maximum of −dF/dv of the friction between 0 and a speed, N·s/m. With less damping than that, self-excited vibrations
/// would grow.
#[must_use]
pub fn steepest_fall_n_s_per_m(friction: &FallingRising, max_m_per_s: f64) -> f64 {
    const STEPS: usize = 10_000;
    let at = |i: usize| friction.force_n(max_m_per_s * i as f64 / STEPS as f64);
    let falls = (0..STEPS).map(|i| (at(i) - at(i + 1)) * STEPS as f64 / max_m_per_s);
    numerics::max(falls).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The natural frequencies (150 Hz) are a thousand times that of the circle: K·x follows M·g·μ(V0) − M·V0′
    /// quasi-statically, with an error of (C + M·g·μ′)·x′/K. Its maximum is at the reversal of friction, where
    /// μ′ = (μ1·γ − μ2)·α, V0′ = R·Ω² and x′ = M·g·μ′·R·Ω²/K: 2 nm on Y at the higher speed.
    #[test]
    fn the_deflection_is_quasi_static() {
        for speed_rad_per_s in SPEEDS_RAD_PER_S {
            let path = CircularPath { speed_rad_per_s };
            let lap = Deflections::on(path).unwrap();
            assert_eq!(lap.points.len(), POINTS + 1);
            for (axis, table) in TABLES.iter().enumerate() {
                let error_m = |(time_s, deflection): &(f64, [f64; 2])| {
                    let friction_n = table.friction().force_n(path.velocity_m_per_s(*time_s)[axis]);
                    let inertia_n = table.mass_kg * path.acceleration_m_per_s2(*time_s)[axis];
                    (deflection[axis] - (friction_n - inertia_n) / table.stiffness_n_per_m).abs()
                };
                let max_m = numerics::max_abs(lap.points.iter().map(error_m));
                let slope = table.mass_kg * GRAVITY_M_PER_S2 * 0.145 * 50.0;
                let rate = slope * RADIUS_M * speed_rad_per_s.powi(2) / table.stiffness_n_per_m;
                let expected_m = (table.damping_n_s_per_m + slope) * rate / table.stiffness_n_per_m;
                assert!((0.95..1.05).contains(&(max_m / expected_m)), "{axis}: {max_m} {expected_m}");
            }
        }
    }

    /// 2·√(K·M)·1 % = 1897 and 2191 N·s/m.
    #[test]
    fn damping_is_one_percent_of_critical() {
        for table in TABLES {
            let critical = 2.0 * (table.stiffness_n_per_m * table.mass_kg).sqrt();
            assert!((table.damping_n_s_per_m / critical - 0.01).abs() < 1e-4);
        }
    }

    /// Beyond the peak, −μ′ is about (μ1·γ − μ2)·β·sech βv·tanh βv, with a maximum of half of 0.145·5 s/m at
    /// sinh βv = 1, v = 0.176 m/s. At 0.15 m/s, βv = 0.75, it is 0.355 s/m less 2·μ2·v = 0.024 s/m of the square term.
    #[test]
    fn the_slope_of_friction_is_below_the_damping() {
        let fall = steepest_fall_n_s_per_m(&TABLES[0].friction(), 0.15);
        let expected = 90.0 * GRAVITY_M_PER_S2 * (0.145 * 5.0 * 0.75_f64.tanh() / 0.75_f64.cosh() - 0.024);
        assert!((fall / expected - 1.0).abs() < 0.01, "{fall} {expected}");
    }
}
