//! A wave over the position of the screw.

/// A periodic error of the table against the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionWave {
    /// Half of the peak-to-peak value.
    pub amplitude_um: f64,
    /// Period.
    pub period_mm: f64,
}

impl PositionWave {
    /// Whether the period is no whole fraction of the lead (mm).
    #[must_use]
    pub fn has_own_period(&self, lead_mm: Option<f64>) -> bool {
        lead_mm.is_none_or(|lead_mm| {
            let order = lead_mm / self.period_mm;
            (order - order.round()).abs() > 1e-6 * order
        })
    }
}
