//! The expected error of an effect of x on a circle of 20 mm, from equations.

use std::f64::consts::TAU;

use super::runs::SPEED_MM_S;

const RADIUS_M: f64 = 0.02;
const STEPS: usize = 4096;
const HARMONICS: usize = 600;

/// A point of a circle at constant speed.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub theta: f64,
    /// 1: the angle grows, −1: it falls.
    pub direction: f64,
    pub m_per_s: f64,
}

impl Point {
    /// Position of x, m.
    pub fn x_m(self) -> f64 {
        RADIUS_M * self.theta.cos()
    }

    /// Position of y, m.
    pub fn y_m(self) -> f64 {
        RADIUS_M * self.theta.sin()
    }

    /// Velocity of x, m/s.
    pub fn v_m_per_s(self) -> f64 {
        -self.m_per_s * self.direction * self.theta.sin()
    }

    /// Acceleration of x, m/s².
    pub fn ax_m_per_s2(self) -> f64 {
        -self.m_per_s.powi(2) / RADIUS_M * self.theta.cos()
    }

    /// Acceleration of y, m/s².
    pub fn ay_m_per_s2(self) -> f64 {
        -self.m_per_s.powi(2) / RADIUS_M * self.theta.sin()
    }
}

fn points(m_per_s: f64, direction: f64) -> Vec<Point> {
    let theta = |i: usize| TAU * (i as f64 + 0.5) / STEPS as f64;
    (0..STEPS).map(|i| Point { theta: theta(i), direction, m_per_s }).collect()
}

/// Rms along the radius, µm, of an error of x, µm: the part along the radius is its product with cos θ.
pub fn radial_rms_um(error_um: impl Fn(Point) -> f64) -> f64 {
    radial_rms_at_um(1e-3 * SPEED_MM_S, error_um)
}

/// [`radial_rms_um`] at another speed.
pub fn radial_rms_at_um(m_per_s: f64, error_um: impl Fn(Point) -> f64) -> f64 {
    rms([1.0, -1.0]
        .into_iter()
        .flat_map(|direction| points(m_per_s, direction))
        .map(|p| error_um(p) * p.theta.cos()))
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (n, sum) = values.fold((0.0, 0.0), |(n, sum), value| (n + 1.0, sum + value * value));
    (sum / n).sqrt()
}

/// A P position loop with a PI velocity loop about one mass.
#[derive(Clone, Copy, Debug)]
pub struct Loop {
    pub mass_kg: f64,
    pub position_gain_per_s: f64,
    pub velocity_gain_n_s_per_m: f64,
    pub integral_time_s: f64,
    /// Between motor and table, N/m.
    pub stiffness_n_per_m: f64,
}

/// The loop of the x axis of the machine.
pub const LOOP: Loop = Loop {
    mass_kg: 250.0,
    position_gain_per_s: 50.0,
    velocity_gain_n_s_per_m: 60_000.0,
    integral_time_s: 0.016,
    stiffness_n_per_m: 200e6,
};

/// Where a force acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Motor,
    Table,
}

impl Loop {
    /// Rms along the radius, µm, of the displacement by a force against x, N, on the circle.
    ///
    /// `m·s²·x = −F − Kv·(1 + 1/(Ti·s))·(s + Kp)·x`; a force on the table also stretches the drive by F/k.
    pub fn displaced_um(&self, side: Side, force_n: impl Fn(Point) -> f64) -> f64 {
        let m_per_s = 1e-3 * SPEED_MM_S;
        rms([1.0, -1.0].into_iter().flat_map(|direction| {
            let points = points(m_per_s, direction);
            let force: Vec<f64> = points.iter().map(|p| force_n(*p)).collect();
            let x_m = self.response_m(&points, &force, side);
            points.into_iter().zip(x_m).map(|(p, x_m)| 1e6 * x_m * p.theta.cos()).collect::<Vec<_>>()
        }))
    }

    /// Rms along the radius, µm, of the difference of the displacements of two loops.
    pub fn difference_um(&self, other: &Self, side: Side, force_n: impl Fn(Point) -> f64) -> f64 {
        rms([1.0, -1.0].into_iter().flat_map(|direction| {
            let points = points(1e-3 * SPEED_MM_S, direction);
            let force: Vec<f64> = points.iter().map(|p| force_n(*p)).collect();
            let [one, two] = [self, other].map(|of| of.response_m(&points, &force, side));
            let difference = points.into_iter().zip(one.into_iter().zip(two));
            difference.map(|(p, (a, b))| 1e6 * (a - b) * p.theta.cos()).collect::<Vec<_>>()
        }))
    }

    /// The periodic displacement, m, by a periodic force, N: by its harmonics.
    fn response_m(&self, points: &[Point], force_n: &[f64], side: Side) -> Vec<f64> {
        let mut x_m = vec![0.0; points.len()];
        for n in 0..HARMONICS {
            let phase = |p: &Point| n as f64 * p.theta * p.direction;
            let scale = if n == 0 { 1.0 } else { 2.0 } / points.len() as f64;
            let sum = |of: fn(f64) -> f64| {
                scale * points.iter().zip(force_n).map(|(p, f)| f * of(phase(p))).sum::<f64>()
            };
            let (cos_n, sin_n) = (sum(f64::cos), sum(f64::sin));
            let [re, im] = self.compliance_m_per_n(n as f64 * points[0].m_per_s / RADIUS_M, side);
            for (x, p) in x_m.iter_mut().zip(points) {
                let (sin, cos) = phase(p).sin_cos();
                *x -= cos_n * (re * cos - im * sin) + sin_n * (re * sin + im * cos);
            }
        }
        x_m
    }

    /// Displacement of the table per force against it at an angular frequency, real and imaginary part.
    fn compliance_m_per_n(&self, rad_per_s: f64, side: Side) -> [f64; 2] {
        let stretch = if side == Side::Table { self.stiffness_n_per_m.recip() } else { 0.0 };
        if rad_per_s == 0.0 {
            return [stretch, 0.0];
        }
        let Self {
            mass_kg, position_gain_per_s: kp, velocity_gain_n_s_per_m: kv, integral_time_s: ti, ..
        } = *self;
        // (1 + 1/(Ti·iω))·(iω + Kp) = Kp + 1/Ti + i·(ω − Kp/(Ti·ω))
        let re = kv * (kp + 1.0 / ti) - mass_kg * rad_per_s.powi(2);
        let im = kv * (rad_per_s - kp / (ti * rad_per_s));
        let square = re * re + im * im;
        [re / square + stretch, -im / square]
    }
}
