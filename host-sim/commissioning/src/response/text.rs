//! The measured frequency response for a terminal.

use super::file::{Margin, Margins, ResponseFile};
use super::margins::LEAST_COHERENCE;

/// Tables of margins and resonances, and the notches that are proposed.
#[must_use]
pub fn of(file: &ResponseFile) -> String {
    let mut lines = vec![format!(
        "{:<14}{:<14}{:>14}{:>18}{:>16}{:>10}",
        "loop", "", "crossover Hz", "phase margin deg", "gain margin dB", "at Hz"
    )];
    lines.extend(file.margins.iter().map(row));
    let used = file.tones.iter().filter(|tone| tone.coherence >= LEAST_COHERENCE).count();
    if used < file.tones.len() {
        let left_out = file.tones.len() - used;
        lines.push(format!(
            "{left_out} of {} tones have a coherence below {LEAST_COHERENCE} and are left out: a greater force or more periods raise it.",
            file.tones.len()
        ));
    }
    lines.push(String::new());
    if file.resonances.is_empty() {
        lines.push("No resonance stands out by 3 dB.".to_owned());
    }
    for resonance in &file.resonances {
        let width = resonance.width_hz.map_or(String::new(), |hz| format!(", {hz:.0} Hz wide"));
        lines.push(format!(
            "Resonance at {:.0} Hz, {:.1} dB above its sides{width}.",
            resonance.frequency_hz, resonance.height_db
        ));
    }
    if let Some(notch) = &file.notch {
        let is_one = notch.notch_frequency_hz.0.len() == 1;
        lines.push(format!(
            "{}: notch_frequency_hz = {}, notch_width_hz = {}, notch_depth = {}. `margins` shows what {}.",
            if is_one { "A notch for it" } else { "Notches for the highest, the highest first" },
            notch.notch_frequency_hz.toml(0),
            notch.notch_width_hz.toml(0),
            notch.notch_depth.toml(2),
            if is_one { "it costs" } else { "they cost" }
        ));
    }
    lines.join("\n")
}

fn row(margins: &Margins) -> String {
    let value = |margin: Option<Margin>, width: usize| {
        margin.map_or(format!("{:>width$}", "–"), |margin| format!("{:>width$.1}", margin.value))
    };
    let hz = |hz: Option<f64>, width: usize| {
        hz.map_or(format!("{:>width$}", "–"), |hz| format!("{hz:>width$.1}"))
    };
    format!(
        "{:<14}{:<14}{}{}{}{}",
        margins.r#loop,
        if margins.measured { "measured" } else { "machine file" },
        hz(margins.crossover_hz, 14),
        value(margins.phase_margin_deg, 18),
        value(margins.gain_margin_db, 16),
        hz(margins.gain_margin_db.map(|margin| margin.at_hz), 10)
    )
}
