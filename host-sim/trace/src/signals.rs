//! A log made ready for tracing: SI, smoothed, differentiated, with the noise of each channel.

use super::added::AddedForce;
use super::motor_path::MotorPath;
use files::log::{AxisLog, Log, Unit};

/// Half width of the smoothing window, s: it passes what a servo loop can follow and takes the
/// sensor's noise out of velocities.
const SMOOTHING_HALF_S: f64 = 0.005;

/// One axis of one log, SI (rotary axes: mm and N stand for deg and N·m).
#[derive(Clone, Debug)]
pub struct AxisSignals {
    /// Unit of the axis in its log; `None` where the log has no such axis.
    pub unit: Option<Unit>,
    /// What the controller was asked for.
    pub command: Option<Vec<f64>>,
    /// Motor reading.
    pub motor: Option<Smooth>,
    /// Where the motor has been between its samples.
    pub motor_path: Option<MotorPath>,
    /// Linear scale.
    pub table: Option<Smooth>,
    /// Tool-point probe.
    pub tool: Option<Smooth>,
    /// Samples at which the axis stands still: there friction is whatever it was left at, and creeps by
    /// what sensor noise makes the machine move; no model of the motion tells it.
    pub standing: Vec<bool>,
    /// Samples at which the force stands at its limit; empty where there is none.
    pub saturated: Vec<bool>,
    /// Drive force over the velocity tick that ends at the sample, N; its filtered value is
    /// [`Smooth::position`].
    pub force: Option<Smooth>,
    /// Known force on top of the controller's, a part of `force`; absent: none.
    pub added: Option<AddedForce>,
}

/// A channel with what was derived from it.
///
/// Measured and modelled signals pass the same filter before they are compared, so that what the
/// filter takes away is missing on both sides: `velocity` and `acceleration` are differences of the
/// filtered `position`.
#[derive(Clone, Debug)]
pub struct Smooth {
    /// As measured, m.
    pub raw: Vec<f64>,
    /// Filtered, m.
    pub position: Vec<f64>,
    /// Central difference of it, m/s.
    pub velocity: Vec<f64>,
    /// Second difference of it, m/s².
    pub acceleration: Vec<f64>,
    /// Standard deviation of the noise of `raw`.
    pub noise: f64,
    /// What is left of it in `position`.
    pub position_noise: f64,
    /// What becomes of it in `acceleration`.
    pub acceleration_noise: f64,
    /// Samples on either side of one that the filter uses.
    half: usize,
}

/// One log.
#[derive(Clone, Debug)]
pub struct Signals {
    /// Where it came from.
    pub source: String,
    /// First time of the session's clock, s.
    pub start_s: f64,
    /// Sample time, s.
    pub sample_s: f64,
    /// Whether its encoders may have been zeroed elsewhere than those of the first log that is fitted: it is another
    /// recording.
    pub has_own_zero: bool,
    /// In the order of the machine's axes.
    pub axes: Vec<AxisSignals>,
}

impl Signals {
    /// Prepares a log for a machine with these axes; axes that it lacks have no channels.
    #[must_use]
    pub fn new(log: &Log, axes: &[String]) -> Self {
        let sample_s = log.sample_time_s;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
        let half_window = ((SMOOTHING_HALF_S / sample_s).round() as usize).clamp(2, 50);
        let prepared = |name: &String| {
            let found = log.axes.iter().find(|axis| axis.name == *name);
            AxisSignals::new(found, sample_s, half_window)
        };
        Self {
            source: log.source.clone(),
            start_s: log.start_s,
            sample_s,
            has_own_zero: false,
            axes: axes.iter().map(prepared).collect(),
        }
    }

    /// Samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.axes.iter().find_map(AxisSignals::len).unwrap_or(0)
    }

    /// Whether there is no sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl AxisSignals {
    fn new(axis: Option<&AxisLog>, sample_s: f64, half: usize) -> Self {
        let metres = |channel: &Option<Vec<f64>>| -> Option<Vec<f64>> {
            channel.as_ref().map(|mm| mm.iter().map(|mm| 1e-3 * mm).collect())
        };
        let smooth = |channel| metres(channel).map(|raw| Smooth::new(raw, sample_s, half));
        let Some(axis) = axis else {
            return Self {
                unit: None,
                command: None,
                motor: None,
                motor_path: None,
                table: None,
                tool: None,
                standing: Vec::new(),
                saturated: Vec::new(),
                force: None,
                added: None,
            };
        };
        let motor = smooth(&axis.motor);
        let standing = motor.as_ref().map_or_else(Vec::new, |motor| standing(motor, sample_s));
        Self {
            unit: Some(axis.unit),
            command: metres(&axis.command),
            motor_path: motor.as_ref().map(|motor| MotorPath::new(motor, sample_s)),
            motor,
            standing,
            saturated: Vec::new(),
            table: smooth(&axis.table),
            tool: smooth(&axis.tool),
            force: axis.force.clone().map(|raw| Smooth::new(raw, sample_s, half)),
            added: axis.added_force.clone().map(|raw| AddedForce::new(raw, sample_s, half)),
        }
    }

    /// The same with the motor's path between its samples made anew, for an encoder with so much noise, m.
    #[must_use]
    pub fn with_path(mut self, noise_m: f64, sample_s: f64) -> Self {
        if let Some(motor) = &mut self.motor {
            motor.noise = noise_m;
            self.motor_path = Some(MotorPath::new(motor, sample_s));
        }
        self
    }

    /// The table, or the motor where no scale was logged: what a tool is carried by.
    #[must_use]
    pub fn table_or_motor(&self) -> Option<&Smooth> {
        self.table.as_ref().or(self.motor.as_ref())
    }

    /// Whether the axis goes anywhere: farther than presliding and noise, 0.01 mm or degrees.
    #[must_use]
    pub fn moves(&self) -> bool {
        const LEAST_M: f64 = 1e-5;
        let places = [&self.motor, &self.table].into_iter().flatten().map(|smooth| &smooth.raw);
        let places: Vec<&Vec<f64>> = places.chain(&self.command).collect();
        if places.is_empty() {
            // What was not looked at cannot be said to stand.
            return true;
        }
        numerics::max(places.into_iter().map(|places| numerics::peak_to_peak(places.iter().copied())))
            >= LEAST_M
    }

    fn len(&self) -> Option<usize> {
        let smooth = [&self.motor, &self.table, &self.tool, &self.force];
        let smooth = smooth.into_iter().flatten().map(|smooth| smooth.raw.len());
        self.command.as_ref().map(Vec::len).into_iter().chain(smooth).next()
    }
}

impl Smooth {
    /// Takes the middle of the cubic through 2·half + 1 samples around each (Savitzky and Golay,
    /// 1964); the ends take the cubic of the outermost full window.
    #[must_use]
    pub fn new(raw: Vec<f64>, sample_s: f64, half: usize) -> Self {
        let cubic = Cubic::new(half);
        let position = cubic.filtered(&raw);
        let (velocity, acceleration) = differences(&position, sample_s);
        let noise = noise(&raw);
        Self {
            noise,
            position_noise: noise * norm(&cubic.middle),
            acceleration_noise: noise * norm(&second_difference(&cubic.middle)) / (sample_s * sample_s),
            raw,
            position,
            velocity,
            acceleration,
            half,
        }
    }

    /// Position between samples `i` and `i + 1` (fraction 0 to 1) by positions and slopes.
    #[must_use]
    #[inline]
    pub fn between(&self, i: usize, fraction: f64, sample_s: f64) -> f64 {
        let (p0, p1) = (self.position[i], self.position[i + 1]);
        let (m0, m1) = (self.velocity[i] * sample_s, self.velocity[i + 1] * sample_s);
        let rise = p1 - p0;
        let t = fraction;
        p0 + t * (m0 + t * ((3.0 * rise - 2.0 * m0 - m1) + t * (m0 + m1 - 2.0 * rise)))
    }

    /// Samples on either side of one that shape its filtered value.
    #[must_use]
    pub const fn reach(&self) -> usize {
        self.half
    }

    /// Passes a modelled signal through the filter that this channel has passed.
    #[must_use]
    pub fn filtered(&self, values: &[f64]) -> Vec<f64> {
        Cubic::new(self.half).filtered(values)
    }
}

/// Samples within a standstill of 50 ms or more. A reversal is none: it passes through zero at once.
fn standing(motor: &Smooth, sample_s: f64) -> Vec<bool> {
    const LEAST_S: f64 = 0.05;
    const SLOWEST_M_PER_S: f64 = 10e-6;
    // The difference of two filtered samples, with room for four standard deviations.
    let slow = SLOWEST_M_PER_S.max(4.0 * motor.position_noise / (motor.half as f64 * sample_s));
    let mut standing = vec![false; motor.velocity.len()];
    let mut start = 0;
    for end in 0..=motor.velocity.len() {
        if motor.velocity.get(end).is_some_and(|velocity| velocity.abs() < slow) {
            continue;
        }
        if (end - start) as f64 * sample_s >= LEAST_S {
            standing[start..end].fill(true);
        }
        start = end + 1;
    }
    standing
}

/// First and second differences; the ends repeat their neighbours.
fn differences(position: &[f64], sample_s: f64) -> (Vec<f64>, Vec<f64>) {
    let n = position.len();
    if n < 3 {
        return (vec![0.0; n], vec![0.0; n]);
    }
    let inner = |i: usize| i.clamp(1, n - 2);
    let first = |i: usize| (position[inner(i) + 1] - position[inner(i) - 1]) / (2.0 * sample_s);
    let second = |i: usize| {
        let i = inner(i);
        ((position[i + 1] - position[i]) - (position[i] - position[i - 1])) / (sample_s * sample_s)
    };
    ((0..n).map(first).collect(), (0..n).map(second).collect())
}

/// Least-squares cubic over a symmetric window: its four coefficients are four weighted sums.
struct Cubic {
    weights: Vec<[f64; 4]>,
    /// Weights of the value in the middle.
    middle: Vec<f64>,
}

impl Cubic {
    fn new(half: usize) -> Self {
        let offsets: Vec<f64> = (0..=2 * half).map(|i| i as f64 - half as f64).collect();
        let moment = |p: i32| offsets.iter().map(|t| t.powi(p)).sum::<f64>();
        let (s0, s2, s4, s6) = (moment(0), moment(2), moment(4), moment(6));
        // Even and odd powers separate; each pair is a 2×2 system.
        let even = s0 * s4 - s2 * s2;
        let odd = s2 * s6 - s4 * s4;
        let weights: Vec<[f64; 4]> = offsets
            .iter()
            .map(|t| {
                [
                    (s4 - s2 * t * t) / even,
                    t * (s6 - s4 * t * t) / odd,
                    (s0 * t * t - s2) / even,
                    t * (s2 * t * t - s4) / odd,
                ]
            })
            .collect();
        let middle = weights.iter().map(|w| w[0]).collect();
        Self { weights, middle }
    }

    /// Every sample replaced by the cubic around it; the ends by that of the outermost full window.
    fn filtered(&self, raw: &[f64]) -> Vec<f64> {
        let (n, half) = (raw.len(), self.middle.len() / 2);
        if n <= 2 * half {
            return raw.to_vec();
        }
        // Weight by weight over all samples: each is then a sum of independent lanes.
        let mut inner = vec![0.0; n - 2 * half];
        for (offset, weight) in self.middle.iter().enumerate() {
            for (sum, value) in inner.iter_mut().zip(&raw[offset..]) {
                *sum += weight * value;
            }
        }
        let (first, last) = (&raw[..=2 * half], &raw[n - 2 * half - 1..]);
        let before = (0..half).map(|i| self.value(first, i as f64 - half as f64));
        let after = (1..=half).map(|i| self.value(last, i as f64));
        before.chain(inner.iter().copied()).chain(after).collect()
    }

    /// Value of the cubic through a window at an offset from its middle.
    fn value(&self, window: &[f64], offset: f64) -> f64 {
        let middle = window[window.len() / 2];
        let mut sums = [0.0; 4];
        for (value, weights) in window.iter().zip(&self.weights) {
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum += (value - middle) * weight;
            }
        }
        let [a, b, c, d] = sums;
        middle + a + offset * (b + offset * (c + offset * d))
    }
}

fn norm(weights: &[f64]) -> f64 {
    weights.iter().map(|w| w * w).sum::<f64>().sqrt()
}

/// The second difference of a kernel, which is longer by one on either side.
fn second_difference(kernel: &[f64]) -> Vec<f64> {
    let padded: Vec<f64> = [0.0; 2].into_iter().chain(kernel.iter().copied()).chain([0.0; 2]).collect();
    padded.windows(3).map(|w| w[2] - 2.0 * w[1] + w[0]).collect()
}

/// Standard deviation of the white noise in a channel, from its third differences, which take out
/// whatever a parabola follows: their variance is 20 times that of the noise. The median over
/// stretches of the log keeps corners out of it.
#[must_use]
pub fn noise(values: &[f64]) -> f64 {
    const STRETCH: usize = 64;
    let thirds: Vec<f64> = values.windows(4).map(|w| w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).collect();
    let variances: Vec<f64> = thirds
        .chunks(STRETCH)
        .map(|stretch| stretch.iter().map(|d| d * d).sum::<f64>() / (20.0 * stretch.len() as f64))
        .collect();
    numerics::median(&variances).unwrap_or(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_passes_unchanged_with_its_derivatives() {
        let dt = 1e-3;
        let f = |t: f64| 2.0 + 0.3 * t - 5.0 * t * t + 40.0 * t * t * t;
        let raw = (0..200).map(|i| f(f64::from(i) * dt)).collect();
        let smooth = Smooth::new(raw, dt, 5);
        for i in [1, 3, 100, 198] {
            let t = f64::from(i) * dt;
            let i = usize::try_from(i).unwrap();
            assert!((smooth.position[i] - f(t)).abs() < 1e-12);
            // A central difference of t³ is off by dt²: 40·1e-6.
            assert!((smooth.velocity[i] - (0.3 - 10.0 * t + 120.0 * t * t)).abs() < 5e-5);
            assert!((smooth.acceleration[i] - (-10.0 + 240.0 * t)).abs() < 1e-5);
        }
    }

    #[test]
    fn noise_is_found_beside_motion() {
        // ±1 alternating at random has σ = 1; 100 samples of it repeat without a pattern of period 3.
        let mut state = 1u32;
        let values: Vec<f64> = (0..20_000)
            .map(|i| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let sign = if state >> 31 == 0 { 1.0 } else { -1.0 };
                1e4 * (f64::from(i) * 1e-3).sin() + sign
            })
            .collect();
        assert!((noise(&values) - 1.0).abs() < 0.1, "{}", noise(&values));
    }
}
