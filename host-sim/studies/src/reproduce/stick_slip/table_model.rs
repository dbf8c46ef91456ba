//! The paper's model: two tables, each a mass on the spring and damper of its drive, under friction that falls and
//! rises with velocity (eqs. 1 to 16).
//!
//! x is how far a table stands off its drive, V0 the drive's velocity on the circle, and no controller is in it:
//! M·x″ + C·x′ + K·x = M·g·μ(V0 − x′) − M·V0′ (eqs. 2 and 3). Both axes are integrated together by the method of
//! Dormand and Prince, of fifth order, with a step between 1e-6 and 1e-4 s.

use std::f64::consts::TAU;

use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};

use crate::reproduce::ReproduceError;
use crate::reproduce::ballbar::{Ballbar, Lap, POINTS};
use model::friction_curve::FallingRising;

const GRAVITY_M_PER_S2: f64 = 9.81;

/// Radius of the circle.
pub const RADIUS_M: f64 = 0.1;

/// The lower and the higher speed on the circle.
pub const SPEEDS_RAD_PER_S: [f64; 2] = [0.5, 1.5];

/// Shortest and longest step.
const STEPS_S: (f64, f64) = (1e-6, 1e-4);

/// One table with its drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// M.
    pub mass_kg: f64,
    /// K, of the lead screw.
    pub stiffness_n_per_m: f64,
    /// C: 1 % of the critical damping, rounded.
    pub damping_n_s_per_m: f64,
}

/// The tables of X and Y.
pub const TABLES: [Table; 2] = [
    Table { mass_kg: 90.0, stiffness_n_per_m: 1e8, damping_n_s_per_m: 1900.0 },
    Table { mass_kg: 120.0, stiffness_n_per_m: 1e8, damping_n_s_per_m: 2200.0 },
];

impl Table {
    /// Friction of the guideway under the table's own weight.
    #[must_use]
    pub fn friction(&self) -> FallingRising {
        let load_n = self.mass_kg * GRAVITY_M_PER_S2;
        FallingRising { mu1: 0.15, mu2: 0.08, alpha: 50.0, beta: 5.0, gamma: 1.5, load_n }
    }
}

/// The circle run at a constant speed, from (R, 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Ω; negative: clockwise.
    pub speed_rad_per_s: f64,
}

impl Circle {
    /// Duration of a lap, s.
    #[must_use]
    pub fn lap_s(&self) -> f64 {
        TAU / self.speed_rad_per_s.abs()
    }

    /// Where the drives are, m.
    #[must_use]
    pub fn position_m(&self, time_s: f64) -> [f64; 2] {
        let (sin, cos) = (self.speed_rad_per_s * time_s).sin_cos();
        [RADIUS_M * cos, RADIUS_M * sin]
    }

    /// V0, m/s.
    #[must_use]
    pub fn velocity_m_per_s(&self, time_s: f64) -> [f64; 2] {
        let [x, y] = self.position_m(time_s);
        [-self.speed_rad_per_s * y, self.speed_rad_per_s * x]
    }

    /// V0′, m/s².
    #[must_use]
    pub fn acceleration_m_per_s2(&self, time_s: f64) -> [f64; 2] {
        self.position_m(time_s).map(|m| -self.speed_rad_per_s.powi(2) * m)
    }
}

/// The tables on a circle; the state is x, x′, y, y′.
struct Motion {
    circle: Circle,
    friction: [FallingRising; 2],
}

impl ODE<f64, [f64; 4]> for Motion {
    fn diff(&self, time_s: f64, state: &[f64; 4], rate: &mut [f64; 4]) {
        let velocity = self.circle.velocity_m_per_s(time_s);
        let acceleration = self.circle.acceleration_m_per_s2(time_s);
        for (axis, table) in TABLES.iter().enumerate() {
            let [place, speed] = [state[2 * axis], state[2 * axis + 1]];
            let force = self.friction[axis].force_n(velocity[axis] - speed)
                - table.damping_n_s_per_m * speed
                - table.stiffness_n_per_m * place;
            rate[2 * axis] = speed;
            rate[2 * axis + 1] = force / table.mass_kg - acceleration[axis];
        }
    }
}

/// A lap of both tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviations {
    /// On which circle.
    pub circle: Circle,
    /// Time since the lap began (s), and how far the tables of X and Y stand off their drives, m.
    pub points: Vec<(f64, [f64; 2])>,
}

impl Deviations {
    /// Integrates two laps from rest and keeps the second: the paper says nothing of the start, and the swing that it
    /// leaves, of 1 % damping at 150 Hz, is over within half a second.
    ///
    /// # Errors
    /// When the integration fails.
    pub fn on(circle: Circle) -> Result<Self, ReproduceError> {
        let lap_s = circle.lap_s();
        let friction = TABLES.each_ref().map(Table::friction);
        let motion = Motion { circle, friction };
        // Below a nanometre, and what that is in velocity at the natural frequency.
        let tolerance = [1e-12, 1e-9, 1e-12, 1e-9];
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few ten millions")]
        let most_steps = (2.0 * lap_s / STEPS_S.0) as usize;
        let times_s: Vec<f64> = (0..=POINTS).map(|i| lap_s * (1.0 + i as f64 / POINTS as f64)).collect();
        let method = ExplicitRungeKutta::dopri5()
            .rtol(1e-9)
            .atol(tolerance)
            .h0(STEPS_S.0)
            .h_min(STEPS_S.0)
            .h_max(STEPS_S.1)
            .max_steps(most_steps);
        let solution = IVP::ode(&motion, 0.0, 2.0 * lap_s, [0.0; 4])
            .method(method)
            .t_eval(&times_s)
            .solve()
            .map_err(|error| ReproduceError::Numerics(format!("stick-slip: {error:?}")))?;
        let points = solution.t.iter().zip(&solution.y).map(|(t, y)| (t - lap_s, [y[0], y[2]])).collect();
        Ok(Self { circle, points })
    }

    /// From the least to the greatest deviation of X and of Y, µm.
    #[must_use]
    pub fn swing_um(&self) -> [f64; 2] {
        [0, 1].map(|axis| 1e6 * numerics::peak_to_peak(self.points.iter().map(|point| point.1[axis])))
    }

    /// The lap as a ballbar sees it. Friction holds a table back: it stands at X0 − x.
    ///
    /// # Errors
    /// When there are no points.
    pub fn lap(&self) -> Result<Lap, ReproduceError> {
        let place = |(time_s, [x, y]): &(f64, [f64; 2])| {
            let [x0, y0] = self.circle.position_m(*time_s);
            [x0 - x, y0 - y]
        };
        let path_m: Vec<[f64; 2]> = self.points.iter().map(place).collect();
        Lap::of(&path_m, RADIUS_M).ok_or_else(|| ReproduceError::Numerics("stick-slip: no lap".to_owned()))
    }
}

/// The circle at a speed in both directions.
///
/// # Errors
/// When the integration fails.
pub fn ballbar(speed_rad_per_s: f64) -> Result<Ballbar, ReproduceError> {
    let lap = |sense: f64| Deviations::on(Circle { speed_rad_per_s: sense * speed_rad_per_s })?.lap();
    Ok(Ballbar { positive: lap(1.0)?, negative: lap(-1.0)? })
}

/// Steepest fall of friction with velocity up to a speed, N·s/m: with less damping a table would swing up by itself.
#[must_use]
pub fn steepest_fall_n_s_per_m(friction: &FallingRising, most_m_per_s: f64) -> f64 {
    const STEPS: usize = 10_000;
    let at = |i: usize| friction.force_n(most_m_per_s * i as f64 / STEPS as f64);
    let falls = (0..STEPS).map(|i| (at(i) - at(i + 1)) * STEPS as f64 / most_m_per_s);
    numerics::max(falls).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The natural frequencies (150 Hz) are a thousand times the circle's: K·x follows M·g·μ(V0) − M·V0′. What it falls
    /// behind is (C + M·g·μ′)·x′/K, greatest where friction turns over: μ′ = (μ1·γ − μ2)·α there, V0′ = R·Ω², and so
    /// x′ = M·g·μ′·R·Ω²/K. On Y at the higher speed that is 2 nm.
    #[test]
    fn follows_the_curve_in_quasi_static_balance() {
        for speed_rad_per_s in SPEEDS_RAD_PER_S {
            let circle = Circle { speed_rad_per_s };
            let lap = Deviations::on(circle).unwrap();
            assert_eq!(lap.points.len(), POINTS + 1);
            for (axis, table) in TABLES.iter().enumerate() {
                let off_m = |(time_s, place): &(f64, [f64; 2])| {
                    let friction_n = table.friction().force_n(circle.velocity_m_per_s(*time_s)[axis]);
                    let inertia_n = table.mass_kg * circle.acceleration_m_per_s2(*time_s)[axis];
                    place[axis] - (friction_n - inertia_n) / table.stiffness_n_per_m
                };
                let most_m = numerics::max_abs(lap.points.iter().map(off_m));
                let slope = table.mass_kg * GRAVITY_M_PER_S2 * 0.145 * 50.0;
                let rate = slope * RADIUS_M * speed_rad_per_s.powi(2) / table.stiffness_n_per_m;
                let expected_m = (table.damping_n_s_per_m + slope) * rate / table.stiffness_n_per_m;
                assert!((0.95..1.05).contains(&(most_m / expected_m)), "{axis}: {most_m} {expected_m}");
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

    /// Past its peak −μ′ is about (μ1·γ − μ2)·β·sech βv·tanh βv, no more than half of 0.145·5 s/m, reached at
    /// sinh βv = 1, v = 0.176 m/s; at 0.15 m/s, βv = 0.75, it is 0.355 less the square's 2·μ2·v = 0.024 s/m.
    #[test]
    fn friction_falls_slower_than_the_damping_takes_up() {
        let fall = steepest_fall_n_s_per_m(&TABLES[0].friction(), 0.15);
        let expected = 90.0 * GRAVITY_M_PER_S2 * (0.145 * 5.0 * 0.75_f64.tanh() / 0.75_f64.cosh() - 0.024);
        assert!((fall / expected - 1.0).abs() < 0.01, "{fall} {expected}");
    }
}
