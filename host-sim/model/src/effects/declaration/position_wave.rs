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

#[cfg(test)]
mod tests {
    use super::*;

    /// On a lead of 20 mm, 4 mm are a fifth of a turn and 20 mm a turn; 17.27 and 7 mm are no whole fraction of it.
    #[test]
    fn a_whole_fraction_of_the_lead_is_no_own_period() {
        let has_own =
            |period_mm, lead_mm| PositionWave { amplitude_um: 1.0, period_mm }.has_own_period(lead_mm);
        assert!(has_own(17.27, Some(20.0)) && has_own(7.0, Some(20.0)) && has_own(20.0, None));
        assert!(!has_own(4.0, Some(20.0)) && !has_own(20.0, Some(20.0)));
    }
}
