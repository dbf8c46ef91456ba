//! A velocity as a position.

/// The integral of samples by the rule of trapezoids, from zero.
#[must_use]
pub fn of(rates: &[f64], period_s: f64) -> Vec<f64> {
    let mut integral = 0.0;
    let steps = rates.windows(2).map(|two| {
        integral += 0.5 * (two[0] + two[1]) * period_s;
        integral
    });
    // The first sample is the origin.
    std::iter::once(0.0).chain(steps).take(rates.len()).collect()
}

#[cfg(test)]
mod tests {
    use crate::of_bytes;
    use crate::request::Request;

    #[test]
    fn of_nothing_is_nothing() {
        assert_eq!(super::of(&[], 1.0), [0.0; 0]);
        assert_eq!(super::of(&[5.0], 1.0), [0.0]);
        assert_eq!(super::of(&[2.0, 4.0], 0.5), [0.0, 1.5]);
    }

    /// A velocity of 40·cos(10π·t) mm/s is the position 40/(10π)·sin(10π·t). The error of the rule of trapezoids is at most h²/12·t times
    /// the greatest second derivative of the velocity: 1.3 µm of 1.3 mm.
    #[test]
    fn a_velocity_is_integrated() {
        let omega = 10.0 * std::f64::consts::PI;
        let rows = (0..400).map(|i| {
            let t_s = 1e-3 * f64::from(i);
            format!("{t_s:.3},{:.9}\n", 40.0 * (omega * t_s).cos())
        });
        let text = format!("t,v\n{}", rows.collect::<String>());
        let request = Request {
            mappings: vec!["x_motor_mm=v".parse().unwrap()],
            units: vec!["x_motor_mm=mm/s".parse().unwrap()],
            ..Request::default()
        };
        let imported = of_bytes(text.as_bytes(), "a.csv", &request).unwrap();
        let bound_mm = 1e-6 / 12.0 * 0.4 * 40.0 * omega * omega;
        for (i, x) in imported.log.axes[0].motor.as_ref().unwrap().iter().enumerate() {
            let expected = 40.0 / omega * (1e-3 * omega * i as f64).sin();
            assert!((x - expected).abs() < bound_mm, "{i}: {x} {expected}");
        }
    }
}
