//! The result for a terminal: a sentence, the figures, the parts, and what was assumed.

use files::format::{fixed, signed, significant};

use super::Analysis;
use super::iso::Direction;
use super::part::{Name, Part};

/// A part is named in the sentence from this fraction of the largest.
const MENTIONED: f64 = 0.5;

/// Greatest number of parts in the sentence.
const MAX_MENTIONED: usize = 3;

/// All lines.
#[must_use]
pub fn of(analysis: &Analysis) -> String {
    let mut lines = vec![sentence(analysis), String::new()];
    lines.extend(figures(analysis));
    lines.push(String::new());
    if !analysis.parts.is_empty() {
        lines.push(row(["part", "axis", "µm", "95 % interval", "certainty", "may be confused with", ""]));
        lines.extend(analysis.parts.iter().map(|part| row(cells(part).each_ref().map(String::as_str))));
        lines.push(String::new());
    }
    lines.push(format!("Not explained by these parts: {} µm rms.", significant(analysis.residual_um, 2)));
    lines.extend(analysis.measured.notes.iter().cloned());
    lines.join("\n")
}

/// What the deviation is mostly made of. Centre and radius are left out of it, as they are no error of form.
#[must_use]
pub fn sentence(analysis: &Analysis) -> String {
    let whole = format!("The circle deviates by G = {} µm", significant(analysis.figures.circular_um(), 3));
    let form: Vec<&Part> = analysis.parts.iter().filter(|part| is_of_form(part)).collect();
    let Some(largest) = form.first() else {
        return format!("{whole}; no part stands out of the noise.");
    };
    let mentioned = form.iter().filter(|part| part.um >= MENTIONED * largest.um).take(MAX_MENTIONED);
    let named: Vec<String> = mentioned
        .map(|part| format!("{} of {} ({} µm)", title(part), part.axis, significant(part.um, 3)))
        .collect();
    format!("{whole}, mostly made of {}.", named.join(", "))
}

/// Whether a part changes the form of the circle.
fn is_of_form(part: &Part) -> bool {
    !matches!(part.name, Name::Centre | Name::Radius | Name::FollowingLag)
}

/// Name of a part in words.
#[must_use]
pub fn title(part: &Part) -> String {
    part.name.word().replace('_', " ")
}

/// The figures of ISO 230-4 and what was measured.
#[must_use]
pub fn figures(analysis: &Analysis) -> Vec<String> {
    let Analysis { measured, figures, frame, .. } = analysis;
    let direction = |direction: &Direction| {
        let way = if direction.is_clockwise { "clockwise" } else { "counter-clockwise" };
        let mut text = format!(
            "{way}: {} turns, {}°, G = {} µm",
            fixed(direction.turns, 2),
            fixed(direction.covered_deg, 0),
            significant(direction.circular_um, 3)
        );
        if measured.has_nominal_radius {
            let [min, max] = direction.radial_um.map(|um| signed(um, 3));
            text += &format!(", F = {min} to {max} µm");
        }
        text
    };
    let speed = frame.speed_mm_s.map_or(String::new(), |speed| format!(" at {} mm/s", significant(speed, 3)));
    let mut lines = vec![format!(
        "Radius {} mm{speed}, axes {} and {}, measured: {}.",
        significant(frame.radius_mm, 4),
        measured.axes[0],
        measured.axes[1],
        measured.channel
    )];
    lines.extend(figures.directions.iter().map(direction));
    if let (Some(h), Some(g_b)) = (figures.hysteresis_um, figures.bidirectional_um) {
        lines.push(format!(
            "both directions: H = {} µm, G(b) = {} µm",
            significant(h, 3),
            significant(g_b, 3)
        ));
    } else {
        lines.push("H and G(b) need both directions.".to_owned());
    }
    lines
}

/// The cells of a part's row.
#[must_use]
pub fn cells(part: &Part) -> [String; 7] {
    let [low, high] = part.ci95.map(|um| significant(um, 3));
    let rivals: Vec<String> = part.rivals.iter().map(|rival| rival.replace('_', " ")).collect();
    [
        title(part),
        part.axis.clone(),
        significant(part.um, 3),
        format!("{low} to {high}"),
        if part.is_certain() { "certain" } else { "ambiguous" }.to_owned(),
        if rivals.is_empty() { "–".to_owned() } else { rivals.join(", ") },
        details(part),
    ]
}

/// Width, pitch, frequency, delay; how a backlash or spike is signed.
#[must_use]
pub fn details(part: &Part) -> String {
    let mut words: Vec<String> = Vec::new();
    for detail in &part.details {
        let value = significant(detail.value, 4);
        match (detail.key, part.name) {
            ("signed_um", Name::Backlash) if detail.value < 0.0 => {
                words.push("compensated too much".to_owned());
            }
            ("signed_um", Name::ReversalSpike) => {
                words.push(if detail.value > 0.0 { "outwards" } else { "inwards" }.to_owned());
            }
            ("signed_um", Name::Radius) => {
                words.push(if detail.value > 0.0 { "larger" } else { "smaller" }.to_owned());
            }
            ("width_deg", _) => words.push(format!("width {value}°")),
            ("width_ms", _) => words.push(format!("{value} ms")),
            ("pitch_mm", _) => words.push(format!("pitch {value} mm")),
            ("frequency_hz", _) => words.push(format!("{value} Hz")),
            ("delay_ms", _) => words.push(format!("delay {value} ms")),
            _ => {}
        }
    }
    words.join(", ")
}

fn row(cells: [&str; 7]) -> String {
    let [part, axis, um, interval, certainty, rivals, details] = cells;
    let line = format!("{part:<15} {axis:<5} {um:>8}  {interval:<18} {certainty:<10} {rivals:<30} {details}");
    line.trim_end().to_owned()
}
