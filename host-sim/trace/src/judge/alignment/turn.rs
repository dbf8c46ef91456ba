//! Squareness of the axes against the angle of the probe.
//!
//! In the tool stage of the first axis both are the slope over the second table: A = squareness + angle. In that of the second axis
//! only the angle of the probe appears: B = −angle, which is the value of its `probe_rotation`. What neither axis alone shows, both
//! together do.

use crate::judge::axis_findings::AxisFindings;
use crate::judge::found_effect::FoundEffect;
use crate::judge::tool_slopes::Slope;
use model::effects::{Effect, LEAST_SLOPE_UM_PER_M, SlopeOf, Stage};

/// The findings with squareness and angle separated, of a machine with two axes.
#[must_use]
pub fn separated(mut axes: Vec<AxisFindings>, min_size: f64) -> Vec<AxisFindings> {
    if let [first, second] = &mut axes[..] {
        separate(first, second, min_size);
    }
    axes
}

fn separate(first: &mut AxisFindings, second: &AxisFindings, min_size: f64) {
    let sum = first.found.iter().position(|found| found.effect.slope() == Some(SlopeOf::Axes));
    let turn = second.found.iter().find(|found| found.effect.slope() == Some(SlopeOf::ProbeAngle));
    let angle = turn.and_then(Slope::of_found);
    if sum.is_none() && angle.is_none() {
        return;
    }
    let Some(measured) = second.tool_slopes.over_other else {
        // Without the second axis, nothing tells the two apart.
        if let Some(index) = sum {
            let um_per_m = first.found[index].effect.values()[0];
            first.found[index].rivals.push(SlopeOf::ProbeAngle.effect(um_per_m));
        }
        return;
    };
    let Some(of_first) = first.tool_slopes.over_other else { return };
    let total = Slope {
        um_per_m: sum.map_or(0.0, |index| first.found[index].effect.values()[0]),
        half_width: of_first.half_width,
    };
    let angle = Slope { um_per_m: angle.map_or(0.0, |angle| angle.um_per_m), ..measured };
    let squareness = total.less(angle);
    let is_square = !squareness.exceeds(LEAST_SLOPE_UM_PER_M, min_size);
    if let (true, Some(index)) = (angle.um_per_m == 0.0, sum) {
        first.found[index].half_widths = vec![squareness.half_width];
        if is_square {
            first.found[index].rivals.push(SlopeOf::ProbeAngle.effect(total.um_per_m));
        }
        return;
    }
    let rotation = if is_square { total } else { angle };
    let template = template(first, sum);
    if let Some(template) = template {
        put(first, sum, &template, (!is_square).then_some(squareness), rotation);
    }
}

/// The result whose stage and residuals those of squareness and angle are: both together have the effect of their sum.
fn template(axis: &AxisFindings, sum: Option<usize>) -> Option<FoundEffect> {
    if let Some(index) = sum {
        return Some(axis.found[index].clone());
    }
    let error = axis.residual(Stage::Tool)?;
    let effect = SlopeOf::Axes.effect(0.0);
    Some(FoundEffect::new((effect, Vec::new()), error.stage, [error.after; 2]))
}

/// Puts squareness and angle in the place of their sum.
fn put(
    axis: &mut AxisFindings,
    sum: Option<usize>,
    template: &FoundEffect,
    squareness: Option<Slope>,
    rotation: Slope,
) {
    if let Some(index) = sum {
        axis.found.remove(index);
        let of_model = axis.model.found().iter().position(|effect| effect.slope() == Some(SlopeOf::Axes));
        if let Some(index) = of_model {
            axis.model = axis.model.without(index);
        }
    } else if squareness.is_none() {
        return;
    }
    let mut add = |effect: Effect, slope: Slope| {
        axis.model = axis.model.with(effect.clone());
        axis.found.push(FoundEffect { effect, half_widths: vec![slope.half_width], ..template.clone() });
    };
    if let Some(slope) = squareness {
        add(SlopeOf::Axes.effect(slope.um_per_m), slope);
    }
    add(SlopeOf::ProbeAngle.effect(rotation.um_per_m), rotation);
}
