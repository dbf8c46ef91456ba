//! What was learned, for a terminal.

use files::format::significant;

use super::file::AnticoggingFile;

/// A table of the waves that were found, or that none was, and what else the passes show.
#[must_use]
pub fn of(file: &AnticoggingFile) -> String {
    let mut lines = Vec::new();
    let found: Vec<_> = file.waves.iter().filter(|wave| wave.found).collect();
    if found.is_empty() {
        lines.push(format!("No cogging above {} N was found.", significant(file.limit_n, 2)));
    } else {
        lines.push(format!(
            "{:<12}{:>14}{:>12}{:>12}{:>22}",
            "period mm", "amplitude N", "± N", "phase rad", "in other passes N"
        ));
        lines.extend(found.iter().map(|wave| {
            let [amplitude, error, held_out] =
                [wave.amplitude_n, wave.standard_error_n, wave.held_out_n].map(|n| significant(n, 3));
            format!(
                "{:<12.4}{amplitude:>14}{error:>12}{:>12.3}{held_out:>22}",
                wave.period_mm, wave.phase_rad
            )
        }));
        if found.len() < file.waves.len() {
            lines.push(format!(
                "No other wave of these periods above {} N was found.",
                significant(file.limit_n, 2)
            ));
        }
    }
    let unconfirmed = file.waves.iter().filter(|wave| !wave.found && wave.amplitude_n >= wave.least_n);
    lines.extend(unconfirmed.map(|wave| {
        format!(
            "The wave of {:.4} mm, {} N, is left out: the passes that the fit does not use do not confirm it.",
            wave.period_mm,
            significant(wave.amplitude_n, 3)
        )
    }));
    lines.push(String::new());
    lines.push(format!(
        "load {:.2} N (changes by {:.2} N over the travel), friction {:.2} N",
        file.summary.load_n, file.summary.load_change_n, file.summary.friction_n
    ));
    lines.push(format!(
        "force over the position in {} pairs of other passes: {} N rms, {} N without what was found",
        file.summary.held_out_pairs,
        significant(file.summary.before_n, 3),
        significant(file.summary.after_n, 3)
    ));
    lines.push(format!(
        "following error about its mean, as the board is set now: {} µm rms",
        significant(file.summary.following_error_um, 3)
    ));
    lines.join("\n")
}
