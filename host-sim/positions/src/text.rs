//! The result for a terminal: a sentence, the figures, the effects, and what was assumed.

use files::format::{fixed, signed, significant};

use super::analysis::{Analysis, FitValidate};
use super::effect::{Certainty, Effect, Parameter};
use super::iso::Position;

/// Greatest number of effects in the sentence.
const MAX_MENTIONED: usize = 3;

/// An effect is named in the sentence from this fraction of the largest.
const MENTIONED: f64 = 0.2;

/// All lines.
#[must_use]
pub fn of(analysis: &Analysis) -> String {
    let mut lines = vec![sentence(analysis), String::new()];
    lines.extend(figures(analysis));
    lines.push(String::new());
    if !analysis.effects.is_empty() {
        lines.push(row(["effect", "µm", "parameters", "certainty", "may be confused with"]));
        lines.extend(analysis.effects.iter().map(|effect| row(cells(effect).each_ref().map(String::as_str))));
        lines.push(String::new());
    }
    lines.extend(residuals(analysis));
    lines.extend(floor(analysis));
    lines.extend(analysis.notes.iter().cloned());
    lines.join("\n")
}

/// What the deviation is mostly made of.
#[must_use]
pub fn sentence(analysis: &Analysis) -> String {
    let Analysis { axis, residual, .. } = analysis;
    let whole = match (analysis.figures.accuracy, analysis.figures.systematic) {
        (Some(um), _) => format!("Axis {axis} positions with A = {} µm", significant(um, 3)),
        (None, Some(um)) => format!("Axis {axis} positions with E = {} µm", significant(um, 3)),
        (None, None) => {
            format!("Axis {axis} is {} µm rms off its targets", significant(residual.before.fit, 3))
        }
    };
    let largest_um = analysis.effects.first().map_or(0.0, |effect| effect.um);
    let mentioned = analysis.effects.iter().filter(|effect| effect.um >= MENTIONED * largest_um);
    let named: Vec<String> = mentioned
        .take(MAX_MENTIONED)
        .map(|effect| format!("{} ({} µm)", title(effect), significant(effect.um, 3)))
        .collect();
    if named.is_empty() {
        return format!("{whole}; no effect stands out of the scatter.");
    }
    format!("{whole}, mostly made of {}.", named.join(", "))
}

/// Name of an effect in words.
#[must_use]
pub fn title(effect: &Effect) -> String {
    effect.name.replace('_', " ")
}

/// The figures of ISO 230-2 in three lines, and why some are not given.
#[must_use]
pub fn figures(analysis: &Analysis) -> Vec<String> {
    let line = |(name, [both, positive, negative]): (&str, [String; 3])| {
        format!("{name:<27} {both:>8} {positive:>8} {negative:>8}")
    };
    let mut lines = vec![format!("{:<27} {:>8} {:>8} {:>8}", "ISO 230-2, µm", "both", "↑", "↓")];
    lines.extend(figure_rows(analysis).map(line));
    lines.extend(figure_remarks(analysis));
    lines
}

/// A figure in µm with two decimals; a dash if there is none.
#[must_use]
pub fn figure_um(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| fixed(value, 2))
}

/// The figures of ISO 230-2 that there are of both directions together and of each, µm.
#[must_use]
pub fn figure_rows(analysis: &Analysis) -> [(&'static str, [String; 3]); 3] {
    let f = &analysis.figures;
    [
        ("accuracy A", [f.accuracy, f.accuracy_positive, f.accuracy_negative].map(figure_um)),
        (
            "systematic deviation E",
            [f.systematic, f.systematic_positive, f.systematic_negative].map(figure_um),
        ),
        (
            "repeatability R",
            [f.repeatability, f.repeatability_positive, f.repeatability_negative].map(figure_um),
        ),
    ]
}

/// The other figures of ISO 230-2, of what they are, and why some are not given.
#[must_use]
pub fn figure_remarks(analysis: &Analysis) -> Vec<String> {
    let f = &analysis.figures;
    let mut lines = vec![
        format!(
            "mean deviation's range M = {}, reversal B = {}, its mean B̄ = {}",
            figure_um(f.mean_range),
            figure_um(f.reversal),
            figure_um(f.mean_reversal)
        ),
        format!(
            "{} runs, {} targets from {} to {} mm",
            analysis.test.runs(),
            analysis.positions.len(),
            position(analysis.positions.first()),
            position(analysis.positions.last())
        ),
    ];
    lines.extend(analysis.figure_notes.iter().cloned());
    lines
}

/// A position to the micrometre, without zeros at its end.
fn position(at: Option<&Position>) -> String {
    let mm = at.map_or(0.0, |at| at.target_mm);
    let rounded = (1e3 * mm).round() / 1e3;
    rounded.to_string().replace('-', "−")
}

/// The residual before and after, and what a table alone reaches.
#[must_use]
pub fn residuals(analysis: &Analysis) -> Vec<String> {
    let line = |(name, FitValidate { fit, validate }): (&str, FitValidate)| {
        let validate = validate
            .map_or_else(String::new, |um| format!(", {} µm rms of the validation runs", fixed(um, 2)));
        format!("{name:<33} {:>6} µm rms of the fitted runs{validate}", fixed(fit, 2))
    };
    let mut lines: Vec<String> = residual_rows(analysis).map(line).into();
    if let Some(um) = analysis.residual.left_out {
        lines.push(format!("{:<33} {:>6} µm rms", "runs left out of the fit", fixed(um, 2)));
    }
    lines
}

/// The residual of the readings: as they are, less a table, less the effects.
#[must_use]
pub const fn residual_rows(analysis: &Analysis) -> [(&'static str, FitValidate); 3] {
    let residual = &analysis.residual;
    [
        ("as measured", residual.before),
        ("less a table of means", residual.table),
        ("less the effects found", residual.after),
    ]
}

/// What no table gets below; `None` where the readings do not tell the scatter.
#[must_use]
pub fn floor(analysis: &Analysis) -> Option<String> {
    let um = analysis.scatter_um?;
    Some(format!(
        "A table cannot reach below the repeatability: ± {} µm (2s) scatter from approach to approach, which no model takes, and the drift from run to run on top.",
        significant(2.0 * um, 2)
    ))
}

/// The cells of an effect's row.
#[must_use]
pub fn cells(effect: &Effect) -> [String; 5] {
    let rivals: Vec<String> = effect.rivals.iter().map(|rival| rival.replace('_', " ")).collect();
    let certainty = if effect.certainty == Certainty::Certain { "certain" } else { "ambiguous" };
    [
        title(effect),
        significant(effect.um, 3),
        parameters(effect),
        certainty.to_owned(),
        if rivals.is_empty() { "–".to_owned() } else { rivals.join(", ") },
    ]
}

/// The numbers with their intervals; of a list, how many.
#[must_use]
pub fn parameters(effect: &Effect) -> String {
    let shown = effect.parameters.iter().filter_map(|(key, parameter)| match parameter {
        Parameter::Number { value, ci95: Some([low, high]) } => Some(format!(
            "{key} {} ({} to {})",
            signed_if(effect, *value),
            signed_if(effect, *low),
            signed_if(effect, *high)
        )),
        Parameter::Number { value, ci95: None } => Some(format!("{key} {}", signed_if(effect, *value))),
        Parameter::Given { value } => Some(format!("{} positions", value.len())),
        Parameter::Fitted { .. } => None,
    });
    let mut shown: Vec<String> = shown.collect();
    if effect.signed_um.is_some_and(|um| um < 0.0) {
        shown.push("of the wrong sign for a gap".to_owned());
    }
    if !effect.aliases_mm.is_empty() {
        let all: Vec<String> = effect.aliases_mm.iter().map(|mm| significant(*mm, 3)).collect();
        shown.push(format!("or {} mm", all.join(", ")));
    }
    shown.join(", ")
}

fn signed_if(effect: &Effect, value: f64) -> String {
    let is_size = matches!(effect.name, "backlash" | "pitch_cyclic");
    if is_size { significant(value, 4) } else { signed(value, 4) }
}

fn row(cells: [&str; 5]) -> String {
    let [effect, um, parameters, certainty, rivals] = cells;
    format!("{effect:<17} {um:>6}  {parameters:<52} {certainty:<9}  {rivals}").trim_end().to_owned()
}
