//! A machine of rigid bodies with exact rotations, whose errors are no polynomials, measured with reversals, deviations of the servos and
//! noise.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub const LOW_MM: [f64; 3] = [0.0, 0.0, -300.0];
pub const HIGH_MM: [f64; 3] = [500.0, 400.0, 0.0];

/// A smooth error: slope, sine and cube over the travel.
#[derive(Clone, Copy, Default)]
pub struct Curve {
    pub slope: f64,
    sine: f64,
    phase: f64,
    cube: f64,
}

impl Curve {
    fn at(&self, part: f64) -> f64 {
        let bend = self.sine * (0.7 * TAU * part + self.phase).sin();
        self.slope * part + bend + self.cube * (2.0 * part - 1.0).powi(3)
    }
}

pub struct Machine {
    pub chain: [usize; 3],
    /// µm along and µrad about x, y and z, of x, y and z.
    pub errors: [[Curve; 6]; 3],
    backlash_um: [f64; 3],
}

impl Machine {
    pub fn random(seed: u64, chain: [usize; 3], tilt_urad: f64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut errors = [[Curve::default(); 6]; 3];
        for (axis, curves) in errors.iter_mut().enumerate() {
            for (index, curve) in curves.iter_mut().enumerate() {
                let size = if index < 3 { 6.0 } else { tilt_urad };
                *curve = Curve {
                    slope: if index == axis { 0.0 } else { size * random.random_range(-1.0..1.0) },
                    sine: size * random.random_range(-1.0..1.0),
                    phase: random.random_range(0.0..TAU),
                    cube: size * random.random_range(-0.5..0.5),
                };
            }
            curves[axis].slope = 30.0 * random.random_range(-1.0..1.0);
        }
        Self { chain, errors, backlash_um: [3.0, 5.0, 2.0] }
    }

    /// Actual less commanded position of the tool, µm.
    pub fn error_um(&self, at_mm: [f64; 3]) -> [f64; 3] {
        let mut tool = Isometry3::identity();
        for axis in self.chain {
            let part = (at_mm[axis] - LOW_MM[axis]) / (HIGH_MM[axis] - LOW_MM[axis]);
            let value = |index: usize| self.errors[axis][index].at(part);
            let mut way = Vector3::new(value(0), value(1), value(2)) * 1e-3;
            way[axis] += at_mm[axis];
            let turn = Vector3::new(value(3), value(4), value(5)) * 1e-6;
            tool *= Isometry3::from_parts(Translation3::from(way), UnitQuaternion::from_scaled_axis(turn));
        }
        [0, 1, 2].map(|axis| 1e3 * (tool.translation.vector[axis] - at_mm[axis]))
    }

    /// A positioning test: three runs in both directions at 21 targets.
    pub fn positioning(&self, axis: usize, at_mm: [f64; 3], random: &mut ChaCha8Rng) -> String {
        let mut text = "run,approach,target_mm,deviation_um\n".to_owned();
        for run in 1..=3 {
            for (sign, mark) in [(1.0, "+"), (-1.0, "-")] {
                for index in 0..=20 {
                    let step = if sign > 0.0 { index } else { 20 - index };
                    let mut place_mm = at_mm;
                    place_mm[axis] = LOW_MM[axis] + (HIGH_MM[axis] - LOW_MM[axis]) * f64::from(step) / 20.0;
                    let um = self.error_um(place_mm)[axis] - sign * self.backlash_um[axis] / 2.0
                        + noise_um(random);
                    text += &format!("{run},{mark},{:.4},{um:.4}\n", place_mm[axis]);
                }
            }
        }
        text
    }

    /// The table of a ballbar: a turn in each direction.
    pub fn circle(
        &self,
        plane: [usize; 2],
        centre_mm: [f64; 3],
        radius_mm: f64,
        random: &mut ChaCha8Rng,
    ) -> String {
        let mut text = "angle_deg,radius_um,direction\n".to_owned();
        for (sign, name) in [(1.0, "ccw"), (-1.0, "cw")] {
            for index in 0..720 {
                let degrees = sign * f64::from(index) / 2.0;
                let (sin, cos) = degrees.to_radians().sin_cos();
                let mut place_mm = centre_mm;
                place_mm[plane[0]] += radius_mm * cos;
                place_mm[plane[1]] += radius_mm * sin;
                let mut error_um = self.error_um(place_mm);
                error_um[plane[0]] += 0.5 * self.backlash_um[plane[0]] * sign * sin.signum();
                error_um[plane[1]] -= 0.5 * self.backlash_um[plane[1]] * sign * cos.signum();
                let mismatch_um = sign * 4.0 * 2.0 * sin * cos;
                let um = error_um[plane[0]] * cos + error_um[plane[1]] * sin + mismatch_um - 7.0
                    + noise_um(random);
                text += &format!("{degrees},{um:.4},{name}\n");
            }
        }
        text
    }
}

/// Evenly distributed, 0.35 µm rms.
pub fn noise_um(random: &mut ChaCha8Rng) -> f64 {
    random.random_range(-0.6..0.6)
}
