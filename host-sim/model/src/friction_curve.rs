//! Friction as a function of velocity only, for guideways and motors with published curves.
//!
//! There are two forms:
//! - a coefficient that falls from its static value and rises again (Chattopadhyay 2008, eq. 1, after Feeny and Moon):
//!   μ(v) = [μ2·v² + (μ1·γ − μ2)·sech βv]·tanh αv, times the load on the guideway;
//! - linear interpolation between points (Soeda 1977, Fig. 1): from static friction at standstill down to a minimum of
//!   kinetic friction, and up again with speed.

use serde::{Deserialize, Serialize};

/// A friction curve. In a file, it is a table with one key, the name of the form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Curve {
    /// See [`FallingRising`].
    FallingRising(FallingRising),
    /// See [`Piecewise`].
    Piecewise(Piecewise),
}

impl Curve {
    /// Friction against the motion, N, with the sign of the velocity; zero at standstill.
    #[must_use]
    pub fn force_n(&self, velocity_m_per_s: f64) -> f64 {
        match self {
            Self::FallingRising(curve) => curve.force_n(velocity_m_per_s),
            Self::Piecewise(curve) => curve.force_n(velocity_m_per_s),
        }
    }

    /// Absolute value of friction, N; at standstill the limit for v → 0.
    #[must_use]
    pub fn level_n(&self, velocity_m_per_s: f64) -> f64 {
        match self {
            Self::FallingRising(curve) => curve.force_n(velocity_m_per_s).abs(),
            Self::Piecewise(curve) => level_n(curve.side(velocity_m_per_s), 1e3 * velocity_m_per_s.abs()),
        }
    }

    /// Checks the parameters.
    ///
    /// # Errors
    /// What was expected, in words.
    pub fn check(&self) -> Result<(), &'static str> {
        match self {
            Self::FallingRising(curve) => curve.check(),
            Self::Piecewise(curve) => curve.check(),
        }
    }
}

/// A friction coefficient that falls and rises with speed, times the load on a guideway.
///
/// The paper gives units for α and β but none for the velocity, which is taken in m/s. The printed unit of α is s²/m². As
/// this would make the argument of tanh even in v, the unit s/m is used, as for β.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FallingRising {
    /// μ1, static coefficient.
    pub mu1: f64,
    /// μ2, dynamic coefficient; also the factor of the square of the velocity (m/s).
    pub mu2: f64,
    /// α, steepness of the change of sign at zero velocity, s/m.
    pub alpha: f64,
    /// β, rate of the decrease with speed, s/m.
    pub beta: f64,
    /// γ, factor that compensates the reduction of the peak by tanh and sech.
    pub gamma: f64,
    /// Load on the guideway.
    pub load_n: f64,
}

impl FallingRising {
    /// μ at a velocity, with the sign of the velocity.
    #[must_use]
    pub fn coefficient(&self, velocity_m_per_s: f64) -> f64 {
        let v = velocity_m_per_s;
        let falling = (self.mu1 * self.gamma - self.mu2) / libm::cosh(self.beta * v);
        (self.mu2 * v * v + falling) * libm::tanh(self.alpha * v)
    }

    /// Friction against the motion, N.
    #[must_use]
    pub fn force_n(&self, velocity_m_per_s: f64) -> f64 {
        self.load_n * self.coefficient(velocity_m_per_s)
    }

    fn check(&self) -> Result<(), &'static str> {
        let all = [self.mu1, self.mu2, self.alpha, self.beta, self.gamma, self.load_n];
        if all.iter().any(|value| !value.is_finite() || *value < 0.0) {
            return Err("finite numbers not below 0");
        }
        // Otherwise friction would act in the direction of motion at low speed.
        if self.mu1 * self.gamma < self.mu2 { Err("mu1 times gamma not below mu2") } else { Ok(()) }
    }
}

/// Linear interpolation of friction between points. The last segment is extrapolated to higher speeds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Piecewise {
    /// Points for motion in + direction, by ascending speed. Below the first speed, the force is that of the first point.
    pub forward: Vec<Point>,
    /// Points for motion in − direction, with positive speeds and forces; absent: as forward.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub backward: Option<Vec<Point>>,
}

/// A point of a [`Piecewise`] curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// Speed, not negative.
    pub speed_mm_s: f64,
    /// Friction against the motion, not negative.
    pub force_n: f64,
}

impl Piecewise {
    /// Friction against the motion, N.
    #[must_use]
    pub fn force_n(&self, velocity_m_per_s: f64) -> f64 {
        if velocity_m_per_s == 0.0 {
            return 0.0;
        }
        level_n(self.side(velocity_m_per_s), 1e3 * velocity_m_per_s.abs()).copysign(velocity_m_per_s)
    }

    /// Points of the direction of motion.
    fn side(&self, velocity_m_per_s: f64) -> &[Point] {
        match &self.backward {
            Some(backward) if velocity_m_per_s < 0.0 => backward,
            _ => &self.forward,
        }
    }

    fn check(&self) -> Result<(), &'static str> {
        let sides = || std::iter::once(&self.forward).chain(&self.backward);
        if sides().any(Vec::is_empty) {
            return Err("at least one point");
        }
        let is_possible = |p: &Point| p.speed_mm_s.is_finite() && p.force_n.is_finite() && p.force_n >= 0.0;
        if !sides().flatten().all(is_possible) {
            return Err("finite speeds, and forces not below 0");
        }
        let ascends = |side: &Vec<Point>| side.windows(2).all(|pair| pair[0].speed_mm_s < pair[1].speed_mm_s);
        if sides().all(|side| side[0].speed_mm_s >= 0.0 && ascends(side)) {
            Ok(())
        } else {
            Err("speeds not below 0, each greater than the one before")
        }
    }
}

/// Friction at a speed. It is limited to zero from below, as friction never acts in the direction of motion.
fn level_n(points: &[Point], speed_mm_s: f64) -> f64 {
    let Some(first) = points.first() else { return 0.0 };
    if speed_mm_s <= first.speed_mm_s || points.len() == 1 {
        return first.force_n;
    }
    let above = points.partition_point(|point| point.speed_mm_s < speed_mm_s).min(points.len() - 1);
    let (from, to) = (points[above - 1], points[above]);
    let fraction = (speed_mm_s - from.speed_mm_s) / (to.speed_mm_s - from.speed_mm_s);
    (from.force_n + fraction * (to.force_n - from.force_n)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper() -> FallingRising {
        FallingRising { mu1: 0.15, mu2: 0.08, alpha: 50.0, beta: 5.0, gamma: 1.5, load_n: 1000.0 }
    }

    /// By hand: at 20 mm/s tanh 1 = 0.761594, sech 0.1 = 0.995021, so (0.000032 + 0.145·0.995021)·0.761594 = 0.109906;
    /// at 0.2 m/s tanh 10 = 1, sech 1 = 0.648054, so 0.0032 + 0.093968 = 0.097168; at 2 m/s sech 10 = 0.0000908, so
    /// 0.32 + 0.0000132.
    #[test]
    fn friction_falls_and_rises_with_speed() {
        for (v, expected_n) in [(0.02, 109.906), (0.2, 97.168), (2.0, 320.013)] {
            assert!((paper().force_n(v) - expected_n).abs() < 1e-3, "{v}: {}", paper().force_n(v));
            assert!((paper().force_n(-v) + expected_n).abs() < 1e-3, "odd");
        }
        assert!(paper().force_n(0.0).abs() < f64::EPSILON);
        // Near standstill the slope is (μ1·γ − μ2)·α = 7.25 s/m.
        assert!((paper().coefficient(1e-6) / 7.25e-6 - 1.0).abs() < 1e-6);
    }

    /// The design example of the dual-feedback paper, 1 kg·cm as 1 N: 30 at standstill, a minimum of 13, and 32.5 at
    /// 4800 mm/min = 80 mm/s. The speed of the minimum is not printed; 2 mm/s are assumed.
    fn soeda() -> Piecewise {
        let point = |(speed_mm_s, force_n)| Point { speed_mm_s, force_n };
        Piecewise { forward: [(0.0, 30.0), (2.0, 13.0), (80.0, 32.5)].map(point).to_vec(), backward: None }
    }

    #[test]
    fn friction_is_linear_between_points() {
        // 30 − 17/2·1; 13 + 19.5/78·39; beyond the last point 32.5 + 0.25 per mm/s.
        for (mm_s, expected_n) in
            [(1e-9, 30.0), (1.0, 21.5), (2.0, 13.0), (41.0, 22.75), (80.0, 32.5), (100.0, 37.5)]
        {
            let force_n = soeda().force_n(1e-3 * mm_s);
            assert!((force_n - expected_n).abs() < 1e-6, "{mm_s}: {force_n}");
            assert!((soeda().force_n(-1e-3 * mm_s) + expected_n).abs() < 1e-6, "odd");
        }
        assert!(soeda().force_n(0.0).abs() < f64::EPSILON);
    }

    #[test]
    fn directions_may_differ_and_extrapolation_ends_at_zero() {
        let backward =
            vec![Point { speed_mm_s: 1.0, force_n: 20.0 }, Point { speed_mm_s: 3.0, force_n: 10.0 }];
        let curve = Piecewise { backward: Some(backward), ..soeda() };
        for (mm_s, expected_n) in [(1.0, 21.5), (-0.5, -20.0), (-2.0, -15.0), (-4.0, -5.0), (-6.0, 0.0)] {
            let force_n = curve.force_n(1e-3 * mm_s);
            assert!((force_n - expected_n).abs() < 1e-9, "{mm_s}: {force_n}");
        }
    }

    #[test]
    fn a_written_file_entry_is_read_as_the_same_curve() {
        for curve in [Curve::FallingRising(paper()), Curve::Piecewise(soeda())] {
            let text = toml::to_string(&curve).unwrap();
            assert_eq!(toml::from_str::<Curve>(&text).unwrap(), curve, "{text}");
            assert_eq!(curve.check(), Ok(()));
            assert!(curve.force_n(0.01) > 10.0 && curve.force_n(0.01) < 110.0);
        }
        let text = "[piecewise]\nforward = [{ speed_mm_s = 0.0, force_n = 3.0, torque = 1.0 }]";
        assert!(toml::from_str::<Curve>(text).is_err());
    }

    #[test]
    fn invalid_curves_are_refused() {
        let pushing = FallingRising { gamma: 0.5, ..paper() };
        assert!(Curve::FallingRising(pushing).check().is_err());
        assert!(Curve::FallingRising(FallingRising { load_n: f64::NAN, ..paper() }).check().is_err());
        let mut not_ascending = soeda();
        not_ascending.forward.swap(1, 2);
        for piecewise in [Piecewise { forward: Vec::new(), backward: None }, not_ascending] {
            assert!(Curve::Piecewise(piecewise).check().is_err());
        }
    }
}
