//! Periods of a residual over the position: least squares of a sine and a cosine at each of many periods (Lomb, 1976;
//! Scargle, 1982).

use std::f64::consts::TAU;

use super::residual_samples::Sample;
use model::effects::{ResidualWave, WaveOf};

/// Shortest period, mm.
const SHORTEST_MM: f64 = 0.5;

/// Number of periods over the travel of the longest wave: one that is longer is a shape, not a harmonic.
const MIN_WAVES: f64 = 2.0;

/// Frequencies per width 1/travel of a peak.
const OVERSAMPLING: f64 = 5.0;

/// Intervals of the position per shortest period in which the residual is averaged.
const BINS_PER_WAVE: f64 = 4.0;

/// Largest number of intervals. On a longer travel, only longer periods are searched.
const MAX_BINS: f64 = 4000.0;

/// Number of waves that are given.
const WAVES: usize = 2;

/// Steps of the golden section within a step of the frequency: 0.618¹² is 0.3 %.
const REFINEMENTS: usize = 12;

/// Number of polynomials that describe a shape, from degree 0 on: what varies over the travel in two waves or less. It is
/// fitted together with each wave, as it would otherwise contribute to the longest ones.
const POLYNOMIALS: usize = 6;

/// Mean residual over an interval of the position.
#[derive(Clone, Copy, Debug)]
struct Bin {
    position_mm: f64,
    mean: f64,
    count: f64,
    /// Polynomials that are orthonormal over all bins, each weighted by its count.
    shape: [f64; POLYNOMIALS],
}

/// The strongest waves of a residual over the position that remove at least the fraction `min_share` of its Σr² each.
#[must_use]
pub fn waves(of: WaveOf, samples: &[Sample], travel_mm: [f64; 2], min_share: f64) -> Vec<ResidualWave> {
    let length_mm = travel_mm[1] - travel_mm[0];
    let width_mm = (SHORTEST_MM / BINS_PER_WAVE).max(length_mm / MAX_BINS);
    let [lowest, highest] = [MIN_WAVES / length_mm, 1.0 / (BINS_PER_WAVE * width_mm)];
    if samples.is_empty() || lowest >= highest {
        return Vec::new();
    }
    let mut bins = bins(samples, travel_mm[0], width_mm);
    set_shapes(&mut bins, travel_mm);
    remove_shape(&mut bins);
    let total: f64 = samples.iter().map(|sample| sample.residual * sample.residual).sum();
    let step = 1.0 / (OVERSAMPLING * length_mm);
    let mut waves = Vec::new();
    for _ in 0..WAVES {
        let peak = strongest(&bins, lowest, highest, step);
        let frequency = refined(&bins, peak, step);
        let wave = Wave::of(&bins, frequency);
        // A residual that is strongest at the lowest frequency is a shape, of which the longest wave is a part.
        if wave.removed < min_share * total || peak < lowest + 0.5 * step {
            break;
        }
        for bin in &mut bins {
            bin.mean -= wave.value(bin.position_mm);
        }
        remove_shape(&mut bins);
        let (amplitude, phase_rad) =
            (libm::hypot(wave.sine, wave.cosine), libm::atan2(wave.cosine, wave.sine));
        waves.push(ResidualWave { of, period_mm: 1.0 / frequency, amplitude, phase_rad });
    }
    waves
}

fn bins(samples: &[Sample], from_mm: f64, width_mm: f64) -> Vec<Bin> {
    let mut sums: Vec<(f64, f64)> = Vec::new();
    for sample in samples {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a bin number")]
        let bin = ((sample.position_mm - from_mm) / width_mm).clamp(0.0, 2.0 * MAX_BINS) as usize;
        if bin >= sums.len() {
            sums.resize(bin + 1, (0.0, 0.0));
        }
        sums[bin] = (sums[bin].0 + sample.residual, sums[bin].1 + 1.0);
    }
    let bin = |(index, (sum, count)): (usize, (f64, f64))| {
        let position_mm = from_mm + width_mm * (index as f64 + 0.5);
        (count > 0.0).then(|| Bin { position_mm, mean: sum / count, count, shape: [0.0; POLYNOMIALS] })
    };
    sums.into_iter().enumerate().filter_map(bin).collect()
}

/// Computes the orthonormal polynomials (Gram and Schmidt).
fn set_shapes(bins: &mut [Bin], [from_mm, to_mm]: [f64; 2]) {
    for degree in 0..POLYNOMIALS {
        for bin in bins.iter_mut() {
            // −1 to 1; the next polynomial is the last one times x, less its parts along the others.
            let x = (2.0 * bin.position_mm - from_mm - to_mm) / (to_mm - from_mm);
            bin.shape[degree] = if degree == 0 { 1.0 } else { x * bin.shape[degree - 1] };
        }
        for other in 0..degree {
            let part: f64 = bins.iter().map(|bin| bin.count * bin.shape[degree] * bin.shape[other]).sum();
            for bin in bins.iter_mut() {
                bin.shape[degree] -= part * bin.shape[other];
            }
        }
        let square: f64 = bins.iter().map(|bin| bin.count * bin.shape[degree].powi(2)).sum();
        // Fewer bins than polynomials leave nothing but rounding.
        let scale = if square > 1e-12 { square.sqrt().recip() } else { 0.0 };
        for bin in bins.iter_mut() {
            bin.shape[degree] *= scale;
        }
    }
}

/// Subtracts the polynomials that fit the residual best.
fn remove_shape(bins: &mut [Bin]) {
    for degree in 0..POLYNOMIALS {
        let part: f64 = bins.iter().map(|bin| bin.count * bin.shape[degree] * bin.mean).sum();
        for bin in bins.iter_mut() {
            bin.mean -= part * bin.shape[degree];
        }
    }
}

/// The wave sine·sin(2πfx) + cosine·cos(2πfx) that removes most of the residual at a frequency f, 1/mm.
struct Wave {
    frequency: f64,
    sine: f64,
    cosine: f64,
    /// Decrease of Σr².
    removed: f64,
}

impl Wave {
    fn of(bins: &[Bin], frequency: f64) -> Self {
        let mut sums = Sums::default();
        for bin in bins {
            let (sine, cosine) = libm::sincos(TAU * frequency * bin.position_mm);
            sums.add(bin, sine, cosine);
        }
        let [sine, cosine] = sums.solution();
        Self { frequency, sine, cosine, removed: sums.removed() }
    }

    fn value(&self, position_mm: f64) -> f64 {
        let (sine, cosine) = libm::sincos(TAU * self.frequency * position_mm);
        self.sine * sine + self.cosine * cosine
    }
}

/// Normal equations of sine, cosine and polynomials.
#[derive(Clone, Copy, Default)]
struct Sums {
    sine2: f64,
    cosine2: f64,
    product: f64,
    of_sine: f64,
    of_cosine: f64,
    /// Sine and cosine along the polynomials.
    sine_shape: [f64; POLYNOMIALS],
    cosine_shape: [f64; POLYNOMIALS],
}

impl Sums {
    #[inline]
    fn add(&mut self, bin: &Bin, sine: f64, cosine: f64) {
        let [sines, cosines] = [bin.count * sine, bin.count * cosine];
        self.sine2 += sines * sine;
        self.cosine2 += cosines * cosine;
        self.product += sines * cosine;
        self.of_sine += bin.mean * sines;
        self.of_cosine += bin.mean * cosines;
        for (degree, shape) in bin.shape.iter().enumerate() {
            self.sine_shape[degree] += sines * shape;
            self.cosine_shape[degree] += cosines * shape;
        }
    }

    fn solution(&self) -> [f64; 2] {
        let dot = |a: &[f64; POLYNOMIALS], b: &[f64; POLYNOMIALS]| -> f64 {
            a.iter().zip(b).map(|(a, b)| a * b).sum()
        };
        // What is left of sine and cosine without their polynomials; the residual has none.
        let sine2 = self.sine2 - dot(&self.sine_shape, &self.sine_shape);
        let cosine2 = self.cosine2 - dot(&self.cosine_shape, &self.cosine_shape);
        let product = self.product - dot(&self.sine_shape, &self.cosine_shape);
        let determinant = sine2 * cosine2 - product * product;
        // A determinant near zero: the samples do not determine both.
        if determinant <= 1e-6 * self.sine2 * self.cosine2 {
            return [0.0; 2];
        }
        [
            (self.of_sine * cosine2 - self.of_cosine * product) / determinant,
            (self.of_cosine * sine2 - self.of_sine * product) / determinant,
        ]
    }

    fn removed(&self) -> f64 {
        let [sine, cosine] = self.solution();
        sine * self.of_sine + cosine * self.of_cosine
    }
}

/// The frequency of the grid with the strongest wave, 1/mm.
fn strongest(bins: &[Bin], lowest: f64, highest: f64, step: f64) -> f64 {
    // Sine and cosine of each bin advance from one frequency to the next by a rotation.
    let sin_cos = |frequency: f64| move |bin: &Bin| libm::sincos(TAU * frequency * bin.position_mm);
    let mut phases: Vec<(f64, f64)> = bins.iter().map(sin_cos(lowest)).collect();
    let rotations: Vec<(f64, f64)> = bins.iter().map(sin_cos(step)).collect();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some thousands")]
    let count = ((highest - lowest) / step) as usize;
    let mut best = (0.0, lowest);
    for index in 0..=count {
        let mut sums = Sums::default();
        for ((bin, phase), rotation) in bins.iter().zip(&mut phases).zip(&rotations) {
            let (sine, cosine) = *phase;
            sums.add(bin, sine, cosine);
            *phase = (sine * rotation.1 + cosine * rotation.0, cosine * rotation.1 - sine * rotation.0);
        }
        let removed = sums.removed();
        if removed > best.0 {
            best = (removed, lowest + step * index as f64);
        }
    }
    best.1
}

/// The frequency within a step of a frequency at which the wave is strongest, by golden section.
fn refined(bins: &[Bin], frequency: f64, step: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let removed = |frequency: f64| Wave::of(bins, frequency).removed;
    let [mut from, mut to] = [frequency - step, frequency + step];
    for _ in 0..REFINEMENTS {
        let [low, high] = [to - GOLDEN * (to - from), from + GOLDEN * (to - from)];
        if removed(low) > removed(high) { to = high } else { from = low }
    }
    0.5 * (from + to)
}

#[cfg(test)]
mod tests {
    use super::super::residual_samples::tests::moved;
    use super::*;

    /// A belt of 37 mm and a fifth of a lead of 16 mm. A peak over 150 mm is 37²/150 = 9 mm wide at 37 mm; with 0.1 of noise
    /// against an amplitude of 2 its position is known to some thousandths of that.
    #[test]
    fn two_waves_are_found_with_period_amplitude_and_phase() {
        let wave = |x: f64, period: f64, phase: f64| (TAU * x / period + phase).sin();
        let samples = moved(|x, _| 2.0 * wave(x, 37.0, 0.4) + 0.7 * wave(x, 3.2, -2.0));
        let found = waves(WaveOf::Table, &samples, [-75.0, 75.0], 0.01);
        let [belt, fifth] = &found[..] else { panic!("{found:?}") };
        assert!((belt.period_mm - 37.0).abs() < 0.3 && (belt.amplitude - 2.0).abs() < 0.05, "{belt:?}");
        assert!((belt.phase_rad - 0.4).abs() < 0.05, "{belt:?}");
        assert!((fifth.period_mm - 3.2).abs() < 0.01 && (fifth.amplitude - 0.7).abs() < 0.05, "{fifth:?}");
        assert!((fifth.phase_rad + 2.0).abs() < 0.15, "{fifth:?}");
    }

    #[test]
    fn a_shape_and_noise_have_no_period() {
        let shape = moved(|x, _| 2.0 * (TAU * x / 140.0).sin());
        let found = waves(WaveOf::Table, &shape, [-75.0, 75.0], 0.01);
        assert!(found.is_empty(), "{found:?}");
        assert!(waves(WaveOf::Force, &moved(|_, _| 0.0), [-75.0, 75.0], 0.01).is_empty());
        assert!(waves(WaveOf::Force, &[], [-75.0, 75.0], 0.05).is_empty());
    }
}
