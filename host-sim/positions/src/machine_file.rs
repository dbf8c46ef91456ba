//! The effects found, in a machine file.

use indexmap::IndexMap;

use files::error::{InputError, quoted};
use model::effects::{
    Backlash, Effect, GrowingPart, PitchCyclic, PitchMap, PitchProgressive, ThermalDrift, ThermalGrowth,
    ThermalRate,
};
use model::machine::{Axis, Machine};

use super::analysis::Analysis;
use super::effect;

/// Rate that a machine file must have, Hz: the usual one of a position loop. Nothing here depends on it.
const RATE_HZ: f64 = 1000.0;

/// A machine with the effects found appended to its axis, and what was left out of it, a sentence each. The axis gets the travel of the test as its
/// soft limits if it has none: beyond it, nothing is known of its errors. Without a declared machine, it
/// has nothing but the axis: everything else is unknown.
///
/// # Errors
/// If the declared machine has no such axis.
pub fn of(
    analysis: &Analysis,
    declared: Option<(Machine, &str)>,
) -> Result<(Machine, Vec<String>), InputError> {
    let mut notes = Vec::new();
    let effects = effects(analysis, &mut notes);
    let name = &analysis.axis;
    let Some((mut machine, file)) = declared else {
        let mut axis = Axis { effect: effects, ..Axis::default() };
        notes.extend(limit(&mut axis, analysis));
        notes.push(
            "The model has nothing but the effects found; --machine M.toml adds them to a machine, which simulate and the prediction of compensate need."
                .to_owned(),
        );
        let machine = Machine {
            name: format!("positioning test of {name}"),
            sample_rate_hz: RATE_HZ,
            velocity_loop_rate_hz: None,
            instruments: None,
            axis: IndexMap::from([(name.clone(), axis)]),
            structure: None,
        };
        return Ok((machine, notes));
    };
    let names: Vec<&str> = machine.axis.keys().map(String::as_str).collect();
    let expected = format!("an axis of {file}: {}", names.join(", "));
    let axis =
        machine.axis.get_mut(name).ok_or_else(|| InputError::expected("--axis", expected, quoted(name)))?;
    // Two effects of a kind that may be there once would be refused.
    axis.effect.retain(|old| effects.iter().all(|new| new.name() != old.name()));
    axis.effect.extend(effects);
    notes.extend(limit(axis, analysis));
    Ok((machine, notes))
}

/// Gives an axis without soft limits those of the test; the sentence about it.
fn limit(axis: &mut Axis, analysis: &Analysis) -> Option<String> {
    let targets_mm = &analysis.grid.knots_mm;
    let ends_mm = [*targets_mm.first()?, *targets_mm.last()?];
    if axis.settings.limits.travel_mm.is_some() || ends_mm[0] >= ends_mm[1] {
        return None;
    }
    axis.settings.limits.travel_mm = Some(ends_mm);
    Some(format!(
        "In the model, travel_mm of {} is that of the test, {} to {} mm: beyond it, nothing is known of its errors.",
        analysis.axis, ends_mm[0], ends_mm[1]
    ))
}

/// The effects that a machine file can hold.
fn effects(analysis: &Analysis, notes: &mut Vec<String>) -> Vec<Effect> {
    let mut effects = Vec::new();
    let is_reversed = analysis.effects.iter().any(|effect| effect.signed_um.is_some_and(|um| um < 0.0));
    for found in &analysis.effects {
        match known(found, is_reversed) {
            Some(effect) => effects.push(effect),
            None if is_reversed && matches!(found.name, "backlash" | "pitch_map") => {}
            None => {
                notes.push(format!("Not in the model: {}, {}.", super::text::title(found), why(found.name)));
            }
        }
    }
    if is_reversed {
        effects.push(reversed(analysis));
        notes.push(
            "The reversal is the opposite of a gap. In the model it is the difference of the two curves of a pitch map, which a control's table can have; simulate takes a gap below zero for none."
                .to_owned(),
        );
    }
    effects
}

const fn why(name: &str) -> &'static str {
    match name.as_bytes() {
        b"offset" => "which is a matter of the zero",
        _ => "which has no times",
    }
}

/// The effect of the catalogue.
fn known(found: &effect::Effect, is_reversed: bool) -> Option<Effect> {
    let value = |key: &str| found.value(key);
    Some(match found.name {
        "pitch_progressive" => {
            Effect::PitchProgressive(PitchProgressive { slope_um_per_m: value("slope_um_per_m")? })
        }
        "backlash" if !is_reversed => Effect::Backlash(Backlash { width_um: value("width_um")? }),
        "pitch_map" if !is_reversed => Effect::PitchMap(PitchMap {
            positions_mm: found.list("positions_mm")?.to_vec(),
            error_um: found.list("error_um")?.to_vec(),
            error_negative_um: found.list("error_negative_um").map(<[f64]>::to_vec),
        }),
        "pitch_cyclic" => Effect::PitchCyclic(PitchCyclic {
            amplitude_um: value("amplitude_um")?,
            period_mm: value("period_mm")?,
            phase_rad: value("phase_rad")?,
            fitted_period_mm: None,
        }),
        "thermal_drift" => Effect::ThermalDrift(ThermalDrift {
            amplitude_um: value("amplitude_um")?,
            time_constant_s: value("time_constant_s")?,
        }),
        "thermal_rate" => Effect::ThermalRate(ThermalRate { um_per_min: value("um_per_min")? }),
        "thermal_growth" => Effect::ThermalGrowth(ThermalGrowth {
            part: GrowingPart::Screw,
            um_per_m: value("um_per_m")?,
            time_constant_s: value("time_constant_s")?,
        }),
        _ => return None,
    })
}

/// The curves of both directions with a gap below zero: those of the map, if there is one, and half of the gap.
fn reversed(analysis: &Analysis) -> Effect {
    let knots = analysis.grid.knots_mm.len();
    let map = analysis.effects.iter().find(|effect| effect.name == "pitch_map");
    let positive = map.and_then(|map| map.list("error_um")).map_or_else(|| vec![0.0; knots], <[f64]>::to_vec);
    let negative =
        map.and_then(|map| map.list("error_negative_um")).map_or_else(|| positive.clone(), <[f64]>::to_vec);
    let gap_um: f64 = analysis.effects.iter().filter_map(|effect| effect.signed_um).sum();
    let moved = |values: Vec<f64>, um: f64| values.into_iter().map(|value| value + um).collect::<Vec<_>>();
    Effect::PitchMap(PitchMap {
        positions_mm: analysis.grid.knots_mm.clone(),
        error_um: moved(positive, -0.5 * gap_um),
        error_negative_um: Some(moved(negative, 0.5 * gap_um)),
    })
}
