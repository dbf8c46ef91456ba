//! The lead of the screw against the gains of scale and probe.
//!
//! A scale with the gain e on a screw with the slope s shows s + e in the table stage; the tool, which is predicted from the scale, then
//! has the slope g − e with the gain g of the probe. Of three unknowns two are measured: where one of them alone explains both,
//! it is taken; otherwise a slope as large as scales have errors is that of the screw or of the scale.

use crate::dropped::{Dropped, Reason};
use crate::judge::axis_findings::AxisFindings;
use crate::judge::found_effect::FoundEffect;
use crate::judge::tool_slopes::Slope;
use crate::task::Progress;
use files::log::Unit;
use model::effects::{Effect, LEAST_SLOPE_UM_PER_M, SlopeOf, Stage};

/// Standard deviation of the gain of a linear scale, µm per m: ±10 µm/m of the grating and 1 to 2 K of its temperature.
const SCALE_UM_PER_M: f64 = 20.0;

/// Largest gain of a scale, in standard deviations.
const MOST: f64 = 3.0;

/// The findings with the scale named where the probe shows it, or as a rival where nothing does.
#[must_use]
pub fn decided(
    mut axis: AxisFindings,
    has_table: bool,
    min_size: f64,
    progress: &Progress<'_>,
) -> AxisFindings {
    decide(&mut axis, has_table, min_size, progress);
    axis
}

fn decide(axis: &mut AxisFindings, has_table: bool, min_size: f64, progress: &Progress<'_>) {
    if axis.unit == Unit::Degree {
        return;
    }
    let find = |axis: &AxisFindings, of: SlopeOf| {
        axis.found.iter().position(|found| found.effect.slope() == Some(of))
    };
    if !axis.residuals.iter().any(|error| error.stage == Stage::Table) {
        let probe = axis.found.iter_mut().find(|found| found.effect.slope() == Some(SlopeOf::Probe));
        if let Some(probe) = probe {
            doubt_probe(probe, has_table);
        }
        return;
    }
    let Some(screw) = find(axis, SlopeOf::Screw) else { return };
    let Some(of_table) = Slope::of_found(&axis.found[screw]) else { return };
    let probe = find(axis, SlopeOf::Probe);
    let Some(of_tool) = axis.tool_slopes.over_own else {
        doubt(&mut axis.found[screw]);
        return;
    };
    let sum = of_table.less(Slope { um_per_m: -of_tool.um_per_m, ..of_tool });
    if !of_tool.exceeds(LEAST_SLOPE_UM_PER_M, min_size) {
        return;
    }
    if !sum.exceeds(LEAST_SLOPE_UM_PER_M, min_size) {
        to_scale(axis, screw, of_table, progress);
        return;
    }
    for index in [Some(screw), probe].into_iter().flatten() {
        doubt(&mut axis.found[index]);
    }
}

/// A slope as large as the gain of a scale may be that of the scale; a larger one is uncertain by it.
fn doubt(found: &mut FoundEffect) {
    let Some(slope) = Slope::of_found(found) else { return };
    if slope.exceeds(MOST * SCALE_UM_PER_M, 0.0) {
        found.half_widths[0] = libm::hypot(slope.half_width, 2.0 * SCALE_UM_PER_M);
    } else {
        found.rivals.push(SlopeOf::Scale.effect(slope.um_per_m));
    }
}

/// The slope of a tool whose table stage could not be evaluated: from the motor to the tool it may be that of the screw, from the scale
/// to the tool that of the scale.
fn doubt_probe(found: &mut FoundEffect, has_table: bool) {
    if has_table {
        doubt(found);
    } else if let Some(Slope { um_per_m, .. }) = Slope::of_found(found) {
        found.rivals.push(SlopeOf::Screw.effect(um_per_m));
    }
}

/// Gives the slope of the screw to the scale, and drops the gain of the probe that made up for it.
fn to_scale(axis: &mut AxisFindings, screw: usize, slope: Slope, progress: &Progress<'_>) {
    let effect = SlopeOf::Scale.effect(slope.um_per_m);
    axis.found[screw].effect = effect.clone();
    axis.found[screw].rivals.clear();
    let is_of_probe = |found: &mut FoundEffect| found.effect.slope() == Some(SlopeOf::Probe);
    let leaves =
        |found: FoundEffect| Dropped::new(&found.effect, Reason::MadeUpForName, &axis.axis, progress);
    axis.dropped.extend(axis.found.extract_if(.., is_of_probe).map(leaves));
    let is_replaced = |effect: &Effect| matches!(effect.slope(), Some(SlopeOf::Screw | SlopeOf::Probe));
    while let Some(index) = axis.model.found().iter().position(is_replaced) {
        axis.model = axis.model.without(index);
    }
    axis.model = axis.model.with(effect);
}
