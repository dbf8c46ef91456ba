//! An axis with known parts, and the table that a laser would write of it.

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use positions::columns::Request;
use positions::effect::{Effect, Parameter};
use positions::source::Feedback;
use positions::{Analysis, Options, analyse, readings};

/// What an axis does; all in µm and mm.
#[derive(Clone, Debug)]
pub struct Axis {
    pub targets_mm: Vec<f64>,
    pub runs: usize,
    pub offset_um: f64,
    pub slope_um_per_m: f64,
    pub gap_um: f64,
    /// A curve at the targets.
    pub curve_um: Vec<f64>,
    /// What the gap is wider at the targets.
    pub gap_curve_um: Vec<f64>,
    pub wave: Option<Wave>,
    pub drift: Option<Drift>,
    pub noise_um: f64,
}

#[derive(Clone, Copy, Debug)]
pub struct Wave {
    pub amplitude_um: f64,
    pub period_mm: f64,
    pub phase_rad: f64,
}

/// amplitude·(1 − exp(−t/τ)), the same everywhere and along the axis.
#[derive(Clone, Copy, Debug)]
pub struct Drift {
    pub amplitude_um: f64,
    pub um_per_m: f64,
    pub time_constant_s: f64,
}

/// Time of a run, s, and whether it is in the table.
pub const RUN_S: f64 = 300.0;

impl Axis {
    /// An axis without any part, every 50 mm from 0 to 500 mm.
    pub fn quiet(noise_um: f64) -> Self {
        let targets_mm: Vec<f64> = (0..11).map(|i| 50.0 * f64::from(i)).collect();
        let zeros = vec![0.0; targets_mm.len()];
        Self {
            targets_mm,
            runs: 5,
            offset_um: 0.0,
            slope_um_per_m: 0.0,
            gap_um: 0.0,
            curve_um: zeros.clone(),
            gap_curve_um: zeros,
            wave: None,
            drift: None,
            noise_um,
        }
    }

    /// Deviation at a target, µm.
    fn deviation_um(&self, target: usize, sign: f64, time_s: f64) -> f64 {
        let x_mm = self.targets_mm[target];
        let wave = self
            .wave
            .map_or(0.0, |wave| wave.amplitude_um * (TAU * x_mm / wave.period_mm + wave.phase_rad).sin());
        let drift = self.drift.map_or(0.0, |drift| {
            (drift.amplitude_um + 1e-3 * drift.um_per_m * x_mm)
                * (1.0 - (-time_s / drift.time_constant_s).exp())
        });
        let gap = self.gap_um + self.gap_curve_um[target];
        self.offset_um + 1e-3 * self.slope_um_per_m * x_mm + self.curve_um[target] - 0.5 * sign * gap
            + wave
            + drift
    }

    /// The table.
    pub fn table(&self, seed: u64, has_times: bool) -> String {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let count = self.targets_mm.len();
        let mut text =
            format!("run,approach,target_mm,measured_mm{}\n", if has_times { ",time_s" } else { "" });
        for run in 0..self.runs {
            let there = (0..count).map(|target| (target, 1.0));
            let back = (0..count).rev().map(|target| (target, -1.0));
            for (reading, (target, sign)) in there.chain(back).enumerate() {
                let time_s = RUN_S * (run as f64 + reading as f64 / (2 * count) as f64);
                let um = self.deviation_um(target, sign, time_s) + self.noise_um * normal(&mut random);
                let target_mm = self.targets_mm[target];
                let approach = if sign > 0.0 { '+' } else { '-' };
                text += &format!("{},{approach},{target_mm},{:.6}", run + 1, target_mm + 1e-3 * um);
                text += &if has_times { format!(",{time_s:.1}\n") } else { "\n".to_owned() };
            }
        }
        text
    }

    /// The result of a table, with the loop closed by the motor.
    pub fn analysed(&self, seed: u64, has_times: bool) -> Analysis {
        let test = readings::of_text(&self.table(seed, has_times), "x.csv", &Request::default(), Vec::new())
            .unwrap();
        analyse(test, Vec::new(), &options()).unwrap()
    }
}

pub fn options() -> Options {
    Options { axis: "x".to_owned(), feedback: Feedback::Motor }
}

/// A normal deviate by the sum of twelve uniform ones.
pub fn normal(random: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
}

/// A number of either sign with a magnitude in a range.
pub fn signed(random: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    let size = random.random_range(low..high);
    if random.random::<bool>() { size } else { -size }
}

/// Values without their straight line over positions, by the textbook's sums.
pub fn without_line(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len() as f64;
    let (mean_x, mean_y) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let square: f64 = x.iter().map(|x| (x - mean_x).powi(2)).sum();
    let slope = x.iter().zip(y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum::<f64>() / square;
    x.iter().zip(y).map(|(x, y)| y - mean_y - slope * (x - mean_x)).collect()
}

/// The effect of a name.
pub fn effect<'a>(analysis: &'a Analysis, name: &str) -> Option<&'a Effect> {
    analysis.effects.iter().find(|effect| effect.name == name)
}

/// How many of the intervals of a parameter contain the true values, and how many there are.
pub fn covered(effect: &Effect, key: &str, truth: &[f64]) -> (usize, usize) {
    let intervals: Vec<[f64; 2]> = match &effect.parameters[key] {
        Parameter::Number { ci95, .. } => ci95.iter().copied().collect(),
        Parameter::Fitted { ci95, .. } => ci95.clone().unwrap_or_default(),
        Parameter::Given { .. } => Vec::new(),
    };
    assert_eq!(intervals.len(), truth.len(), "{effect:?}");
    let hits =
        intervals.iter().zip(truth).filter(|([low, high], truth)| low <= *truth && *truth <= high).count();
    (hits, truth.len())
}
