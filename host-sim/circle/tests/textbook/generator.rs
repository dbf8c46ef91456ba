//! Circles with known parts: displacements of the axes as the textbooks on ballbar tests give them, and noise.
//!
//! x = R·cos θ, y = R·sin θ, θ = ±ω·t. Squareness s: x grows by s·y, an oval of range R·s. A scale error ±e/2: range R·e. Servo mismatch: the
//! axes are late by τx and τy, an oval of range R·ω·(τx − τy) that turns with the direction. Backlash b: each axis is b/2 behind its
//! velocity, a step of b. Play p: the other axis is displaced by p/2 against the velocity of the first, in both directions together a
//! range of p. Spike: h·exp(−s/w) outwards, s the angle since the reversal. Cyclic: a·sin(2π·x/pitch + φ). Vibration: a·sin(2π·f·t + φ), a
//! range of 2a where the axis points along the radius.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// One part, by its parameters: µm, rad, mm, Hz.
#[derive(Clone, Copy, Debug)]
pub enum Part {
    Centre([f64; 2]),
    Radius(f64),
    Squareness(f64),
    Scale(f64),
    Servo(f64),
    Backlash(usize, f64),
    Spike(usize, f64, f64),
    Play(usize, f64),
    Cyclic(usize, f64, f64, f64),
    Vibration(usize, f64, f64, f64),
}

/// Name, axis and range of a true part.
#[derive(Clone, Debug)]
pub struct Truth {
    pub name: &'static str,
    pub axis: String,
    pub um: f64,
}

/// A circle: one lap each way, or two.
#[derive(Clone, Debug)]
pub struct Circle {
    pub radius_mm: f64,
    pub rad_per_s: f64,
    pub rate_hz: f64,
    pub parts: Vec<Part>,
    pub noise_um: f64,
    /// Time constant of the noise, s; 0: white.
    pub correlation_s: f64,
    pub seed: u64,
}

/// Time and direction of a sample on the circle.
#[derive(Clone, Copy)]
pub struct At {
    pub theta: f64,
    pub direction: f64,
    pub time_s: f64,
}

impl Circle {
    /// A circle of 1 to 5 parts between 2 and 20 µm.
    pub fn random(seed: u64, correlation_s: f64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let radius_mm = between(&mut random, 40.0, 150.0);
        let speed_mm_s = between(&mut random, 20.0, 60.0);
        let mut circle = Self {
            radius_mm,
            rad_per_s: speed_mm_s / radius_mm,
            rate_hz: 500.0,
            parts: Vec::new(),
            noise_um: between(&mut random, 0.1, 0.4),
            correlation_s,
            seed,
        };
        let count = 1 + seed % 5;
        while (circle.parts.len() as u64) < count {
            let part = circle.draw(&mut random);
            let is_there =
                circle.parts.iter().any(|other| circle.truth(other).name == circle.truth(&part).name);
            if !is_there {
                circle.parts.push(part);
            }
        }
        circle
    }

    fn draw(&self, random: &mut ChaCha8Rng) -> Part {
        let sign = if random.random::<f64>() < 0.5 { -1.0 } else { 1.0 };
        let um = between(random, 2.0, 20.0);
        let axis = usize::from(random.random::<f64>() < 0.5);
        let phase = between(random, 0.0, TAU);
        match (random.random::<f64>() * 10.0).floor() {
            0.0 => Part::Centre([0.5 * um * phase.cos(), 0.5 * um * phase.sin()]),
            1.0 => Part::Radius(sign * um),
            2.0 => Part::Squareness(sign * um),
            3.0 => Part::Scale(sign * um),
            4.0 => Part::Servo(sign * um),
            5.0 => Part::Backlash(axis, sign * um),
            6.0 => Part::Spike(axis, sign * um, between(random, 1.0, 5.0).to_radians()),
            7.0 => Part::Play(axis, sign * um),
            8.0 => Part::Cyclic(axis, 0.5 * um, between(random, 3.0, 0.3 * self.radius_mm), phase),
            _ => Part::Vibration(axis, 0.5 * um, between(random, 30.0, 200.0), phase),
        }
    }

    /// Displacement of both axes by all parts, µm.
    pub fn displacement(&self, at: At) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for part in &self.parts {
            let value = self.of_part(part, at);
            sum = [sum[0] + value[0], sum[1] + value[1]];
        }
        sum
    }

    fn of_part(&self, part: &Part, at: At) -> [f64; 2] {
        let (sin, cos) = at.theta.sin_cos();
        let d = at.direction;
        let unit = [cos, sin];
        let velocity = [-d * sin, d * cos];
        let along = |axis: usize, value: f64| if axis == 0 { [value, 0.0] } else { [0.0, value] };
        match *part {
            Part::Centre(shift) => shift,
            Part::Radius(um) => [um * cos, um * sin],
            Part::Squareness(um) => [um * sin, 0.0],
            Part::Scale(um) => [0.5 * um * cos, -0.5 * um * sin],
            // x is late by half of the difference, y early: −τ·v with R·ω·τ = um/2.
            Part::Servo(um) => [-0.5 * um * velocity[0], 0.5 * um * velocity[1]],
            Part::Backlash(axis, um) => along(axis, -0.5 * um * velocity[axis].signum()),
            Part::Play(axis, um) => along(1 - axis, -0.5 * um * velocity[axis].signum()),
            Part::Spike(axis, um, width) => {
                let offset = if axis == 0 { 0.0 } else { FRAC_PI_2 };
                let since = (d * (at.theta - offset)).rem_euclid(PI);
                along(axis, -um * velocity[axis].signum() * (-since / width).exp())
            }
            Part::Cyclic(axis, um, pitch_mm, phase) => {
                along(axis, um * (TAU * self.radius_mm * unit[axis] / pitch_mm + phase).sin())
            }
            Part::Vibration(axis, um, hz, phase) => along(axis, um * (TAU * hz * at.time_s + phase).sin()),
        }
    }

    /// Name, axis and range of a part, by the formulas above. The range of a wave is the greatest of its product with the cosine.
    pub fn truth(&self, part: &Part) -> Truth {
        let axis = |axis: usize| ["x", "y"][axis].to_owned();
        let both = || "xy".to_owned();
        let (name, axis, um) = match *part {
            Part::Centre([a, b]) => ("centre", both(), 2.0 * a.hypot(b)),
            Part::Radius(um) => ("radius", both(), um.abs()),
            Part::Squareness(um) => ("squareness", both(), um.abs()),
            Part::Scale(um) => ("scale_mismatch", both(), um.abs()),
            Part::Servo(um) => ("servo_mismatch", both(), um.abs()),
            Part::Backlash(a, um) => ("backlash", axis(a), um.abs()),
            Part::Spike(a, um, _) => ("reversal_spike", axis(a), um.abs()),
            Part::Play(a, um) => ("lateral_play", axis(a), um.abs()),
            Part::Vibration(a, um, ..) => ("vibration", axis(a), 2.0 * um),
            Part::Cyclic(a, um, pitch_mm, phase) => {
                let radial = |i: u32| {
                    let c = f64::from(i) / 20_000.0;
                    um * c * (TAU * self.radius_mm * c / pitch_mm + phase).sin()
                };
                let other = |i: u32| {
                    let c = -f64::from(i) / 20_000.0;
                    um * c * (TAU * self.radius_mm * c / pitch_mm + phase).sin()
                };
                let values: Vec<f64> = (0..=20_000).map(radial).chain((0..=20_000).map(other)).collect();
                let (mut low, mut high) = (0.0_f64, 0.0_f64);
                for value in values {
                    (low, high) = (low.min(value), high.max(value));
                }
                ("cyclic", axis(a), high - low)
            }
        };
        Truth { name, axis, um }
    }

    /// All samples: a standstill of 0.3 s, a lap counter-clockwise from 0, a standstill, a lap clockwise. `None` while it stands.
    pub fn samples(&self) -> Vec<(f64, f64, Option<At>)> {
        let lap_s = TAU / self.rad_per_s;
        let mut out = Vec::new();
        let mut i = 0_u32;
        loop {
            let time_s = f64::from(i) / self.rate_hz;
            i += 1;
            let first = time_s - 0.3;
            let second = first - lap_s - 0.3;
            let (theta, direction) = match (first, second) {
                (t, _) if t < 0.0 => (0.0, None),
                (t, _) if t < lap_s => (self.rad_per_s * t, Some(1.0)),
                (_, t) if t < 0.0 => (TAU, None),
                (_, t) if t < lap_s => (TAU - self.rad_per_s * t, Some(-1.0)),
                _ => return out,
            };
            out.push((time_s, theta, direction.map(|direction| At { theta, direction, time_s })));
        }
    }

    /// Noise of one sensor, µm: white, or of the time constant.
    pub fn noise(&self, sensor: u64, count: usize) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(1000 * self.seed + sensor);
        let keep =
            if self.correlation_s > 0.0 { (-1.0 / (self.rate_hz * self.correlation_s)).exp() } else { 0.0 };
        let fresh = (1.0 - keep * keep).sqrt();
        let mut value = 0.0;
        (0..count)
            .map(|_| {
                let [u, v] = [1.0 - random.random::<f64>(), random.random::<f64>()];
                let normal = (-2.0 * u.ln()).sqrt() * (TAU * v).cos();
                value = keep * value + fresh * normal;
                self.noise_um * value
            })
            .collect()
    }
}

fn between(random: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.random::<f64>()
}
