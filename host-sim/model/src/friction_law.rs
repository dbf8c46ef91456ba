//! Decay of friction with speed: functions that effects and friction maps share.
//!
//! The argument is the dimensionless ratio v/vs of velocity and characteristic velocity, of either sign.

/// exp(−(v/vs)²), the usual form of the Stribeck effect (Bo and Pavelescu, *Wear* 82, 1982, with exponent 2).
#[must_use]
#[inline]
pub fn gaussian_decay(ratio: f64) -> f64 {
    (-ratio * ratio).exp()
}

/// exp(−|v|/vs) (Tustin, *J. IEE* 94, 1947).
#[must_use]
#[inline]
pub fn exponential_decay(ratio: f64) -> f64 {
    (-ratio.abs()).exp()
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
