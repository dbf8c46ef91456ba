//! The search for what is not linear in its parameter: spikes over their width, waves over their pitch, vibrations over their frequency.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use nalgebra::DMatrix;
use rayon::prelude::*;

use numerics::spectrum::PowerSpectrum;

use super::fit::{Fit, matrix};
use super::samples::Samples;
use super::term::{Shape, Term};

/// Widths of spikes, rad: least (in steps of the sampling, and at least), greatest, and number.
const MIN_WIDTH_STEPS: f64 = 3.0;
const WIDTHS_RAD: [f64; 2] = [0.3 * PI / 180.0, 15.0 * PI / 180.0];
const WIDTHS: u32 = 14;

/// Largest pitch, in radii: 2.5 periods over the diameter. A longer one resembles an oval and its harmonics.
const MAX_PITCH_RADII: f64 = 0.8;
/// Smallest pitch, in steps of the sampling along the path, and in radii.
const MIN_PITCH_STEPS: f64 = 4.0;
const MIN_PITCH_RADII: f64 = 2e-3;

/// Lowest frequency of a vibration, in turns of the circle; highest, in sample rates.
const MIN_TURNS: f64 = 12.0;
const MAX_RATES: f64 = 0.45;

/// Smallest ratio of a line's power to the median around it.
const MIN_LINE: f64 = 12.0;
/// Bins on either side over which the median is taken.
const AROUND: usize = 40;
/// Number of the highest bins that are tried, so that a slope at the lower end does not hide a line.
const TRIED: usize = 400;

/// Transforms are padded to this many times the length of the values.
const PADDING: usize = 4;

/// Terms that may be added, with the fall of the sum of squares, µm².
pub type Candidate = (f64, Vec<Term>);

/// The best spike of an axis.
#[must_use]
pub fn spike(samples: &Samples, fit: &Fit, axis: usize) -> Option<Candidate> {
    let [least, greatest] = WIDTHS_RAD;
    let least = least.max(MIN_WIDTH_STEPS * samples.step_rad());
    let widths =
        (0..WIDTHS).map(|i| least * libm::pow(greatest / least, f64::from(i) / f64::from(WIDTHS - 1)));
    let terms: Vec<Term> =
        widths.flat_map(|width| Shape::ALL.map(|shape| Term::Spike(axis, shape, width))).collect();
    let gain = |term: &Term| (fit.gain(&matrix(samples, &[*term])).0, vec![*term]);
    let best = terms.par_iter().map(gain).collect::<Vec<Candidate>>();
    best.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))
}

/// The best wave over the position of an axis.
#[must_use]
pub fn cyclic(samples: &Samples, fit: &Fit, axis: usize) -> Option<Candidate> {
    let radius = samples.radius_mm;
    let min_pitch = radius * MIN_PITCH_RADII.max(MIN_PITCH_STEPS * samples.step_rad());
    let bin_mm = 0.25 * min_pitch;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of bins")]
    let bins = (2.0 * radius / bin_mm).ceil() as usize + 1;
    // Means and not sums: an axis is slow at its ends, where more samples are.
    let mut sums = vec![(0.0, 0.0); bins];
    let (first, factors) = samples.seen(axis);
    for (i, (at, factor)) in samples.instants.iter().zip(&factors).enumerate() {
        let place = radius * (1.0 + at.position[axis]) / bin_mm;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the bins")]
        let bin = (place as usize).min(bins - 1);
        sums[bin].0 += factor * fit.residual[first + i];
        sums[bin].1 += 1.0;
    }
    let means: Vec<f64> = sums.iter().map(|(sum, count): &(f64, f64)| sum / count.max(1.0)).collect();
    let length = PADDING * bins;
    let power = PowerSpectrum::new(length).of(&means);
    let per_mm = |bin: f64| bin / (length as f64 * bin_mm);
    let lowest = length as f64 * bin_mm / (MAX_PITCH_RADII * radius);
    let highest = length as f64 * bin_mm / min_pitch;
    let peak = peak(&power, lowest, highest)?;
    let terms = |bin: f64| [false, true].map(|is_cosine| Term::Wave(axis, 1.0 / per_mm(bin), is_cosine));
    let gain = |bin: f64| fit.gain(&matrix(samples, &terms(bin))).0;
    let best = maximum(gain, [(peak - 1.5).max(lowest), peak + 1.5], 14);
    Some((gain(best), terms(best).to_vec()))
}

/// The best vibration of an axis; its phase differs from arc to arc.
#[must_use]
pub fn vibration(samples: &Samples, fit: &Fit, axis: usize) -> Option<Candidate> {
    let (sample_s, speed) = (samples.sample_s?, samples.speed_mm_s?);
    let series: Vec<Vec<f64>> = in_time(samples, fit, axis, sample_s);
    let longest = series.iter().map(Vec::len).max()?;
    let length = (PADDING * longest).next_power_of_two();
    let transform = PowerSpectrum::new(length);
    let mut power = vec![0.0; length / 2];
    for values in &series {
        let of_arc = transform.of(values);
        power.iter_mut().zip(of_arc).for_each(|(sum, value)| *sum += value);
    }
    let bins_per_hz = length as f64 * sample_s;
    let lowest = MIN_TURNS * speed / (TAU * samples.radius_mm) * bins_per_hz;
    let peak = peak(&power, lowest, MAX_RATES * length as f64)?;
    let line = |bin: f64| -> f64 {
        let hz = bin / bins_per_hz;
        series.iter().map(|values| power_at(values, hz * sample_s)).sum()
    };
    let hz = maximum(line, [peak - 1.5, peak + 1.5], 20) / bins_per_hz;
    let arcs = (0..samples.arcs.len()).filter(|&arc| !samples.arcs[arc].is_empty());
    let terms: Vec<Term> = arcs
        .flat_map(|arc| [false, true].map(|is_cosine| Term::Vibration(axis, hz, arc, is_cosine)))
        .collect();
    let columns: DMatrix<f64> = matrix(samples, &terms);
    Some((fit.gain(&columns).0, terms))
}

/// The residual of an axis in each arc, uniform in time: samples that were left out are zero.
fn in_time(samples: &Samples, fit: &Fit, axis: usize, sample_s: f64) -> Vec<Vec<f64>> {
    let (first, factors) = samples.seen(axis);
    let of_arc = |arc: &Range<usize>| {
        let Some(start) = samples.instants.get(arc.start).filter(|_| !arc.is_empty()) else {
            return Vec::new();
        };
        let mut values = Vec::new();
        for i in arc.clone() {
            let time_s = (samples.instants[i].time_s - start.time_s).abs();
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a number of samples"
            )]
            let place = (time_s / sample_s).round() as usize;
            values.resize(place.max(values.len()), 0.0);
            values.push(factors[i] * fit.residual[first + i]);
        }
        values
    };
    samples.arcs.iter().map(of_arc).collect()
}

/// |Σ value·exp(i·2π·f·k)|² per value, with the frequency f in turns per sample.
fn power_at(values: &[f64], turns: f64) -> f64 {
    let (sin, cos) = libm::sincos(TAU * turns);
    let (mut re, mut im, mut c, mut s) = (0.0, 0.0, 1.0, 0.0);
    for value in values {
        re += value * c;
        im += value * s;
        (c, s) = (c * cos - s * sin, s * cos + c * sin);
    }
    (re * re + im * im) / values.len().max(1) as f64
}

/// The bin with the most power between two bins among those that stand out of what surrounds them.
fn peak(power: &[f64], lowest: f64, highest: f64) -> Option<f64> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bins")]
    let [from, to] = [(lowest.ceil() as usize).max(1), (highest.floor() as usize).min(power.len())];
    let mut order: Vec<usize> = (from..to).collect();
    order.sort_by(|&a, &b| power[b].total_cmp(&power[a]));
    let is_line = |bin: usize| {
        let around = bin.saturating_sub(AROUND).max(from)..(bin + AROUND).min(to);
        let median = numerics::median(&power[around]).unwrap_or(0.0);
        let is_top = [bin - 1, bin + 1].iter().all(|&i| power.get(i).is_none_or(|p| *p <= power[bin]));
        is_top && power[bin] > MIN_LINE * median
    };
    order.into_iter().take(TRIED).find(|&bin| is_line(bin)).map(|bin| bin as f64)
}

/// Place of the maximum between two places (golden section).
fn maximum(f: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2], steps: usize) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let mut places = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let mut values = places.map(&f);
    for _ in 0..steps {
        if values[0] > values[1] {
            high = places[1];
            places = [high - GOLDEN * (high - low), places[0]];
            values = [f(places[0]), values[0]];
        } else {
            low = places[0];
            places = [places[1], low + GOLDEN * (high - low)];
            values = [values[1], f(places[1])];
        }
    }
    if values[0] > values[1] { places[0] } else { places[1] }
}
