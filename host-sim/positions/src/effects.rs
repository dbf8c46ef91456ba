//! From the coefficients of a fit to effects: each is a linear part of them, with the interval of the fit.

use nalgebra::{DMatrix, DVector};

use files::format::{signed, significant};

use super::effect::{Effect, Parameter};
use super::source::{Feedback, Source, is_there};
use super::variant::{Columns, Gap, Mean};
use super::{drifts, wave};

/// The effects of a fit, the largest first. An effect whose interval contains zero is none.
#[must_use]
pub fn of(source: &Source<'_>) -> Vec<Effect> {
    let mut effects: Vec<Effect> = [offset(source), slope(source), backlash(source), map(source)]
        .into_iter()
        .flatten()
        .chain(waves(source))
        .chain(drifts::of(source))
        .collect();
    effects.sort_by(|a, b| b.um.total_cmp(&a.um));
    effects
}

/// Mean deviation of both directions over the targets.
fn offset(source: &Source<'_>) -> Option<Effect> {
    let columns = source.columns().mean;
    let [mean_row, _] = source.line_rows();
    let (row, of_one): (Vec<f64>, Vec<f64>) = match source.fit.variant.mean {
        Mean::Map => (mean_row, vec![1.0; columns.len()]),
        _ => (vec![1.0], vec![1.0]),
    };
    let found = source.value(&source.weights(&columns, &row));
    let part = found.0 * source.weights(&columns, &of_one);
    is_there(found).then(|| {
        let mut effect = source.effect("offset", found.0.abs(), part).with_rivals(["laser_zero"]);
        effect.parameters.insert("um", Parameter::number(found.0, found.1));
        effect.sentence = format!("all positions are off by {} µm in the mean", signed(found.0, 3));
        effect
    })
}

fn slope(source: &Source<'_>) -> Option<Effect> {
    let columns = source.columns().mean;
    let [_, slope_row] = source.line_rows();
    let along: Vec<f64> = source.grid.lines().column(1).iter().copied().collect();
    let (row, of_one) = match source.fit.variant.mean {
        Mean::Offset => return None,
        Mean::Map => (slope_row, along),
        _ => (vec![0.0, 1.0], vec![0.0, 1.0]),
    };
    let found = source.value(&source.weights(&columns, &row));
    let part = found.0 * source.weights(&columns, &of_one);
    let um = found.0.abs() * source.travel_m();
    is_there(found).then(|| {
        let mut effect =
            source.effect("pitch_progressive", um, part).with_rivals(source.of_scale("scale_gain"));
        effect.parameters.insert("slope_um_per_m", Parameter::number(found.0, found.1));
        effect.sentence = format!("the axis moves {} µm/m more than it is sent", signed(found.0, 3));
        effect
    })
}

/// Mean difference of the directions.
fn backlash(source: &Source<'_>) -> Option<Effect> {
    let columns = source.columns().gap;
    let [mean_row, _] = source.line_rows();
    let (row, of_one) = match source.fit.variant.gap {
        Gap::None => return None,
        Gap::Constant => (vec![1.0], vec![1.0]),
        Gap::Map => (mean_row, vec![1.0; columns.len()]),
    };
    let (width_um, half_um) = source.value(&source.weights(&columns, &row));
    let part = width_um * source.weights(&columns, &of_one);
    is_there((width_um, half_um)).then(|| {
        let is_gap = width_um > 0.0;
        let rivals: &[&str] = if is_gap { &["windup"] } else { &["backlash_compensation", "approaches_exchanged"] };
        let effect = source.effect("backlash", width_um.abs(), part);
        let mut effect = effect.with_rivals(rivals.iter().copied());
        effect.parameters.insert("width_um", Parameter::number(width_um.abs(), half_um));
        effect.signed_um = Some(width_um);
        let size = significant(width_um.abs(), 3);
        effect.sentence = if is_gap {
            format!("the axis stays behind by {size} µm after a reversal")
        } else {
            format!(
                "the axis comes {size} µm further in the direction of its motion than from the other side, the opposite of a gap"
            )
        };
        effect
    })
}

/// What is left over position without straight line and mean gap.
fn map(source: &Source<'_>) -> Option<Effect> {
    let Columns { mean, gap, .. } = source.columns();
    let knots = source.grid.knots_mm.len();
    let has_curve = source.fit.variant.mean == Mean::Map;
    let differ = source.fit.variant.gap == Gap::Map;
    if !has_curve && !differ {
        return None;
    }
    let bent = source.grid.without_line();
    let varying = DMatrix::identity(knots, knots).add_scalar(-1.0 / knots as f64);
    let row = |matrix: &DMatrix<f64>, index: usize| matrix.row(index).iter().copied().collect::<Vec<_>>();
    let weights = |sign: f64, index: usize| {
        let mut weights = DVector::zeros(source.fit.coefficients.len());
        if has_curve {
            weights += source.weights(&mean, &row(&bent, index));
        }
        if differ {
            weights -= 0.5 * sign * source.weights(&gap, &row(&varying, index));
        }
        weights
    };
    let curve = |sign: f64| -> (Vec<f64>, Vec<f64>) {
        (0..knots).map(|index| source.value_at_knot(&weights(sign, index))).unzip()
    };
    let (positive, negative) = (curve(1.0), curve(-1.0));
    let mut part = DVector::zeros(source.fit.coefficients.len());
    for (columns, matrix) in [(&mean, &bent), (&gap, &varying)] {
        if columns.len() == knots {
            let values = matrix * source.fit.coefficients.rows(columns.start, knots);
            part.rows_mut(columns.start, knots).copy_from(&values);
        }
    }
    let both = positive.0.iter().chain(if differ { &negative.0 } else { &positive.0 }).copied();
    let um = numerics::peak_to_peak(both);
    let rival = source.of_scale("scale_cyclic").filter(|_| !differ);
    let mut effect = source.effect("pitch_map", um, part).with_rivals(rival);
    effect.parameters.insert("positions_mm", source.knots());
    effect.parameters.insert("error_um", Parameter::list(positive.0, &positive.1));
    if differ {
        effect.parameters.insert("error_negative_um", Parameter::list(negative.0, &negative.1));
    }
    let ways = if differ { ", which differs with the direction" } else { "" };
    effect.sentence = format!("the deviation has a curve over position of {} µm{ways}", significant(um, 3));
    Some(effect)
}

/// Each wave with amplitude and phase; the interval of the amplitude is that along its phase.
fn waves(source: &Source<'_>) -> Vec<Effect> {
    let Mean::Waves(periods) = &source.fit.variant.mean else { return Vec::new() };
    let mean = source.columns().mean;
    let of = |(index, period_mm): (usize, &f64)| {
        let columns = mean.start + 2 + 2 * index..mean.start + 4 + 2 * index;
        let [sine, cosine] = [0, 1].map(|i| source.fit.coefficients[columns.start + i]);
        let amplitude_um = libm::hypot(sine, cosine);
        let weights = source.weights(&columns, &[sine / amplitude_um, cosine / amplitude_um]);
        let across = source.weights(&columns, &[-cosine / amplitude_um, sine / amplitude_um]);
        let half_um = source.fit.half_width(&weights);
        let half_rad = source.fit.half_width(&across) / amplitude_um;
        let part = source.weights(&columns, &[sine, cosine]);
        let aliases_mm = wave::aliases_mm(source.targets_mm, *period_mm);
        let rivals = [
            source.of_scale("scale_cyclic"),
            (source.feedback != Feedback::Scale).then_some("resolver_dividing"),
            (!aliases_mm.is_empty()).then_some("pitch_cyclic"),
        ];
        let mut effect =
            source.effect("pitch_cyclic", 2.0 * amplitude_um, part).with_rivals(rivals.into_iter().flatten());
        effect.parameters.insert("amplitude_um", Parameter::number(amplitude_um, half_um));
        effect
            .parameters
            .insert("period_mm", Parameter::number(*period_mm, period_half_mm(source, *period_mm, half_rad)));
        let phase_half_rad = half_rad * from_zero(source);
        effect.parameters.insert("phase_rad", Parameter::number(libm::atan2(cosine, sine), phase_half_rad));
        effect.aliases_mm = aliases_mm;
        effect.sentence = format!(
            "a periodic error of {} µm amplitude with a period of {} mm",
            significant(amplitude_um, 3),
            significant(*period_mm, 4)
        );
        is_there((amplitude_um, half_um)).then_some(effect)
    };
    periods.iter().enumerate().filter_map(of).collect()
}

/// By how much a phase at position zero is less sure than in the middle of the targets, as the period is not sure either.
fn from_zero(source: &Source<'_>) -> f64 {
    libm::hypot(source.grid.middle_mm() / spread_mm(source), 1.0)
}

/// Root mean square distance of the targets from their middle, mm.
fn spread_mm(source: &Source<'_>) -> f64 {
    let middle_mm = source.grid.middle_mm();
    numerics::rms(source.grid.knots_mm.iter().map(|mm| mm - middle_mm))
}

/// Half width of a period, mm: a phase is known to `half_rad` over targets of which the distances from the middle have the root mean
/// square D, so that the number of waves per mm is known to `half_rad`/(2π·D).
fn period_half_mm(source: &Source<'_>, period_mm: f64, half_rad: f64) -> f64 {
    period_mm * period_mm * half_rad / (std::f64::consts::TAU * spread_mm(source))
}
