//! The resonances as a text.

use std::fmt::Write;

use super::AxisResonances;
use super::mode::{Estimate, Peak, Shape};

/// A sentence, a table of the peaks, and the modes as effects of a machine file; `effect`: name of the effect of a mode of the tool.
#[must_use]
pub fn of(axes: &[AxisResonances], effect: &str) -> String {
    let mut text = axes.iter().map(sentence).collect::<Vec<_>>().join("\n");
    if axes.iter().all(|axis| axis.peaks.is_empty()) {
        return text;
    }
    text += "\n\naxis    frequency Hz   damping ratio      rms m/s²  what it is\n";
    for axis in axes {
        for peak in &axis.peaks {
            let [frequency, damping, name] = cells(peak);
            // Writing into a text does not fail.
            let _ = writeln!(
                text,
                "{:<4}{frequency:>16}{damping:>16}{:>14.3}  {name}",
                axis.axis, peak.rms_m_per_s2
            );
        }
    }
    text += "\nThe intervals cover an excitation of constant density (a tap) and one that grows with its frequency (a sweep).\n\
             Which axis of the machine excites a resonance, these accelerations do not say.";
    let effects: Vec<String> =
        axes.iter().flat_map(|axis| &axis.peaks).filter_map(|peak| entry(peak, effect)).collect();
    if !effects.is_empty() {
        text +=
            "\n\nIn a machine file, at the axis that excites it, where a log with the tool can confirm it:\n";
        text += &effects.join("\n");
    }
    text
}

fn sentence(axis: &AxisResonances) -> String {
    let modes: Vec<String> = axis.peaks.iter().filter_map(mode).collect();
    let others = axis.peaks.len() - modes.len();
    let found = match modes.as_slice() {
        [] => "no resonance found".to_owned(),
        [one] => format!("a resonance at {one}"),
        all => format!("resonances at {}", all.join(", ")),
    };
    let rest = match others {
        0 => String::new(),
        1 => "; one further peak is no resolved resonance".to_owned(),
        _ => format!("; {others} further peaks are no resolved resonances"),
    };
    format!("{}: {found}{rest}.", axis.axis)
}

fn mode(peak: &Peak) -> Option<String> {
    match peak.shape {
        Shape::Mode { frequency_hz, damping_ratio } => {
            Some(format!("{} Hz (damping ratio {})", in_hz(frequency_hz), as_ratio(damping_ratio)))
        }
        Shape::Narrow { .. } | Shape::NoMode { .. } => None,
    }
}

/// A frequency with its interval, of which 0.1 is shown at least.
fn in_hz(estimate: Estimate) -> String {
    format!("{:.1} ± {:.1}", estimate.value, estimate.half_width().max(0.05))
}

/// A damping ratio with its interval, of which 0.001 is shown at least.
fn as_ratio(estimate: Estimate) -> String {
    format!("{:.3} ± {:.3}", estimate.value, estimate.half_width().max(5e-4))
}

fn cells(peak: &Peak) -> [String; 3] {
    match peak.shape {
        Shape::Mode { frequency_hz, damping_ratio } => {
            [in_hz(frequency_hz), as_ratio(damping_ratio), "resonance of the tool".to_owned()]
        }
        Shape::Narrow { frequency_hz, damping_ratio_below } => [
            format!("{frequency_hz:.1}"),
            format!("below {damping_ratio_below:.3}"),
            "forced vibration, or a resonance with little damping".to_owned(),
        ],
        Shape::NoMode { frequency_hz } => [
            format!("{frequency_hz:.1}"),
            "unknown".to_owned(),
            "no single mode: several that overlap, or the end of a sweep".to_owned(),
        ],
    }
}

/// A mode as an effect of a machine file.
fn entry(peak: &Peak, effect: &str) -> Option<String> {
    match peak.shape {
        Shape::Mode { frequency_hz, damping_ratio } => Some(format!(
            "  {{ name = \"{effect}\", frequency_hz = {:.2}, damping_ratio = {:.4} }}",
            frequency_hz.value, damping_ratio.value
        )),
        Shape::Narrow { .. } | Shape::NoMode { .. } => None,
    }
}
