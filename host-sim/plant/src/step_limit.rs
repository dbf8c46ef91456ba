//! The longest step with which an axis can be simulated.

use super::friction;
use super::friction_direction::DRIVE_SLIP_M;
use super::parameters::AxisParameters;

impl AxisParameters {
    /// Longest step (s) that resolves what is not linear; see [`AxisParameters::step_limit`].
    #[must_use]
    pub fn max_step_s(&self) -> f64 {
        self.step_limit().1
    }

    /// The machine file's key that limits the step, and the longest step (s) that it allows.
    ///
    /// The linear part is exact at any step. The fastest of these nonlinear parts limits it: the bristles of the guide
    /// under the table, 0.06 rad of √(σ0/m) per step; the friction of the motor about standstill, 0.2 of Fc/(w·m), or while it turns over, as the bristles; the
    /// contact at the edges of the backlash, a stiffness that varies, or the loop of a gear, 0.1 rad of √(k·(1/m + 1/M)). It is at most 1 ms.
    #[must_use]
    pub fn step_limit(&self) -> (&'static str, f64) {
        let (motor_kg, table_kg) = match self.spring {
            Some(_) => (self.motor_mass_kg, self.table_mass_kg),
            None => (self.motor_mass_kg + self.table_mass_kg, self.motor_mass_kg + self.table_mass_kg),
        };
        let bristles = (self.friction.bristle_stiffness_n_per_m / table_kg).sqrt();
        let motor = self.motor_level_n(0.0) / friction::SIGN_WIDTH_M_PER_S / motor_kg;
        let contact = match &self.spring {
            Some(spring) if !self.screw.is_coupling_constant() => {
                let stiffness_n_per_m =
                    spring.stiffness_n_per_m + self.screw.hysteresis.sticking_n_per_m(0.0);
                (stiffness_n_per_m * (motor_kg.recip() + table_kg.recip())).sqrt()
            }
            _ => 0.0,
        };
        // The friction of the motor that turns over is a spring.
        let turning = (self.motor_turning_n / DRIVE_SLIP_M / motor_kg).sqrt();
        // Steps per second.
        let rates = [
            ("presliding_stiffness_n_per_um", bristles / 0.06),
            ("motor_coulomb_n", motor / 0.2),
            ("motor_mass_kg", turning / 0.06),
            ("stiffness_n_per_um", contact / 0.1),
        ];
        let min_rate = ("velocity_loop_rate_hz", 1e3);
        let faster = |fastest: (&'static str, f64), rate: (&'static str, f64)| {
            if rate.1 > fastest.1 { rate } else { fastest }
        };
        let (key, rate) = rates.into_iter().fold(min_rate, faster);
        (key, rate.recip())
    }
}
