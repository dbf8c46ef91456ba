//! What a machine file says of the axis whose cogging is learned.

use model::axis::Settings;

/// The declared values that a measurement depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Declared {
    /// Mass of motor and table, kg, above 0.
    pub mass_kg: f64,
    /// Gain of the velocity loop, N·s/m, above 0.
    pub velocity_gain_n_s_per_m: f64,
    /// Integral time of the velocity loop, s; 0: no integral part.
    pub velocity_integral_time_s: f64,
    /// Gain of the position loop, 1/s, above 0.
    pub position_gain_per_s: f64,
    /// Travel per turn of the screw, mm; `None`: not declared.
    pub lead_mm: Option<f64>,
    /// Soft limits, mm; `None`: not declared.
    pub travel_mm: Option<[f64; 2]>,
    /// Force limit, N; `None`: not declared.
    pub force_limit_n: Option<f64>,
}

impl Declared {
    /// The values of an axis.
    ///
    /// # Errors
    /// The key of a value that is required and not declared: a mass or a gain.
    pub fn of(settings: &Settings) -> Result<Self, &'static str> {
        let Settings { controller, limits, mechanics, .. } = settings;
        let motor_mass_kg = mechanics.motor_mass_kg.ok_or("motor_mass_kg")?;
        let table_mass_kg = mechanics.table_mass_kg.ok_or("table_mass_kg")?;
        let mass_kg = motor_mass_kg + table_mass_kg;
        Ok(Self {
            mass_kg: Some(mass_kg).filter(|kg| *kg > 0.0).ok_or("motor_mass_kg")?,
            velocity_gain_n_s_per_m: controller.velocity_gain_n_s_per_m.ok_or("velocity_gain_n_s_per_m")?,
            velocity_integral_time_s: controller.velocity_integral_time_s.unwrap_or(0.0),
            position_gain_per_s: controller.position_gain_per_s.ok_or("position_gain_per_s")?,
            lead_mm: mechanics.lead_mm,
            travel_mm: limits.travel_mm,
            force_limit_n: controller.force_limit_n,
        })
    }

    /// Crossover of the velocity loop on a rigid axis, rad/s: gain over mass.
    #[must_use]
    pub fn velocity_crossover_rad_per_s(&self) -> f64 {
        self.velocity_gain_n_s_per_m / self.mass_kg
    }

    /// Time in which the loops settle after the acceleration, s: to e⁻⁶ of the position loop and e⁻³ of the integral part.
    #[must_use]
    pub fn settling_s(&self) -> f64 {
        6.0 / self.position_gain_per_s + 3.0 * self.velocity_integral_time_s
    }
}
