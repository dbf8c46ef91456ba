//! The study for a terminal.

use super::SensorStudy;
use super::row::Row;

/// The sentences and a table.
#[must_use]
pub fn of(study: &SensorStudy) -> String {
    let mut lines = study.verdicts();
    lines.push(String::new());
    lines.push(format!(
        "Contour error in µm without and with compensation, margins at Kp = {}/s; highest Kp with {} dB and {}°.",
        study.position_gain_per_s, study.gain_margin_db, study.phase_margin_deg
    ));
    let pair = |name: &str| format!("{name:>20}");
    lines.push(format!(
        "{:<10}{:<5}{:>9}{:>9}{:>9}{}{}{}{}",
        "feedback",
        "law",
        "gain dB",
        "phase °",
        "Kp 1/s",
        pair("circle rms"),
        pair("circle G"),
        pair("corner rms"),
        pair("corner greatest")
    ));
    lines.extend(study.rows.iter().map(row));
    lines.push("\nDual feedback, P control, over its time constant:".to_owned());
    lines.push(format!("{:>12}{:>18}{:>16}", "constant ms", "circle rms µm", "highest Kp 1/s"));
    for point in &study.crossovers {
        let gain = point.highest_position_gain_per_s.map_or("–".to_owned(), |gain| format!("{gain:.1}"));
        lines.push(format!("{:>12.0}{:>18.2}{gain:>16}", 1e3 * point.time_constant_s, point.circle_rms_um));
    }
    lines.join("\n")
}

fn row(row: &Row) -> String {
    let number = |value: Option<f64>| value.map_or(format!("{:>9}", "–"), |value| format!("{value:>9.1}"));
    let (before, after) = (row.uncompensated, row.compensated);
    let pairs = [
        (before.circle_rms_um, after.circle_rms_um),
        (before.circular_um, after.circular_um),
        (before.corner_rms_um, after.corner_rms_um),
        (before.corner_max_um, after.corner_max_um),
    ];
    let pairs = pairs.map(|(before, after)| format!("{before:>11.2}{after:>9.2}"));
    format!(
        "{:<10}{:<5}{}{}{}{}",
        row.feedback,
        row.controller,
        number(row.gain_margin_db),
        number(row.phase_margin_deg),
        number(row.highest_position_gain_per_s),
        pairs.concat()
    )
}
