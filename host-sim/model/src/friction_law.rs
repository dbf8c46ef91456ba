//! Decay of friction with speed: functions that effects and friction maps share.
//!
//! The argument is the dimensionless ratio v/vs of velocity and characteristic velocity, of either sign.

/// exp(−(v/vs)²), the usual form of the Stribeck effect (Bo and Pavelescu, *Wear* 82, 1982, with exponent 2).
#[must_use]
#[inline]
pub fn gaussian_decay(ratio: f64) -> f64 {
    libm::exp(-ratio * ratio)
}

/// Rise of friction towards standstill, excess·exp(−(v/vs)²), N; v in m/s, vs in mm/s.
#[must_use]
#[inline]
pub fn stribeck_rise_n(static_excess_n: f64, velocity_mm_s: f64, velocity_m_per_s: f64) -> f64 {
    if static_excess_n == 0.0 {
        return 0.0;
    }
    static_excess_n * gaussian_decay(1e3 * velocity_m_per_s / velocity_mm_s)
}

/// exp(−|v|/vs) (Tustin, *J. IEE* 94, 1947).
#[must_use]
#[inline]
pub fn exponential_decay(ratio: f64) -> f64 {
    libm::exp(-ratio.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_are_even_and_one_at_standstill() {
        for decay in [gaussian_decay, exponential_decay] {
            assert_eq!(decay(0.0).to_bits(), 1.0_f64.to_bits());
            assert_eq!(decay(-0.7).to_bits(), decay(0.7).to_bits());
        }
        assert!((gaussian_decay(2.0) - (-4.0_f64).exp()).abs() < 1e-15);
        assert!((exponential_decay(2.0) - (-2.0_f64).exp()).abs() < 1e-15);
    }
}
