//! The detection curve as text, and its page.

use std::path::{Path, PathBuf};

use maud::html;

use super::detection::Detection;
use super::detection_curve::Curve;
use super::detection_plot;
use super::text_summary::{counted, percent};
use files::output::OutputError;
use pages::markup::{figure, legend, note, paragraph, point_entry, preformatted, section};

const NOTE: &str = "Above: fraction of the effects of a size that were found by name and axis, with its 95 % interval. \
                    Below: each case by effect. The size of an effect is the rms of its contribution to its main \
                    residual channel over the logs to fit, divided by the noise of the sensor of that channel.";

/// Size at which the effects that are always found are counted, in units of the noise.
const FEW_NOISES: f64 = 3.0;

/// The curve in sentences.
#[must_use]
pub fn sentences(seed: u64, detections: &[Detection], curve: &Curve) -> Vec<String> {
    let machines = counted(detections.len(), "machine");
    let false_names = detections.iter().filter(|detection| !detection.false_names.is_empty()).count();
    let found = detections.iter().filter(|detection| detection.is_found).count();
    let reliable = curve.reliable_from().map_or_else(String::new, |size| {
        format!(" From {} times the noise on, at least 95 % of each size were found.", digits(size))
    });
    let trusted = curve.trusted_from().map_or_else(
        || {
            "At the largest size at which a name was given, fewer than 95 % of the names are correct."
                .to_owned()
        },
        |size| {
            format!("From {} times the noise on, at least 95 % of the names given are correct.", digits(size))
        },
    );
    vec![
        format!(
            "{machines} with one effect each, drawn from seed {seed}, with sizes of 0.1 to 30 times the noise."
        ),
        format!(
            "{} found; of {}, {} always found from {FEW_NOISES} times the noise on.{reliable}",
            if found == 1 { "1 effect was".to_owned() } else { format!("{found} effects were") },
            counted(curve.effects.len(), "name"),
            match curve.always_found_from(FEW_NOISES) {
                1 => "1 was".to_owned(),
                count => format!("{count} were"),
            }
        ),
        format!("On {} an effect was named that is not there. {trusted}", counted(false_names, "machine")),
    ]
}

/// The table of sizes, that of effects, and the false names.
#[must_use]
pub fn tables(detections: &[Detection], curve: &Curve) -> String {
    let mut lines = vec![format!(
        "{:<14}{:>8}{:>8}{:>16}{:>14}{:>12}",
        "size / noise", "cases", "found", "95 % interval", "false names", "ambiguous"
    )];
    for bin in curve.bins.iter().filter(|bin| bin.found.trials > 0) {
        let [low, high] = bin.found.interval().map(percent);
        lines.push(format!(
            "{:<14}{:>8}{:>8}{:>16}{:>14}{:>12}",
            digits(bin.size),
            bin.found.trials,
            percent(bin.found.fraction()),
            format!("{low} to {high}"),
            bin.with_false_name,
            bin.with_ambiguous_name
        ));
    }
    lines.push(format!("\n{:<24}{:>8}{:>14}{:>18}", "effect", "cases", "found from", "largest missed"));
    for effect in &curve.effects {
        let shown = |size: Option<f64>| size.map_or_else(|| "–".to_owned(), digits);
        lines.push(format!(
            "{:<24}{:>8}{:>14}{:>18}",
            effect.name,
            effect.points.len(),
            shown(effect.found_from()),
            shown(effect.largest_missed())
        ));
    }
    let named: Vec<String> = detections.iter().filter_map(wrong_line).collect();
    if !named.is_empty() {
        lines.push(String::new());
        lines.extend(named);
    }
    lines.join("\n") + "\n"
}

/// The false names of a case, and the ambiguous ones.
fn wrong_line(detection: &Detection) -> Option<String> {
    let Detection { number, truth, size, false_names, ambiguous_names, .. } = detection;
    let listed = |how: &str, names: &[(String, String)]| {
        let names: Vec<_> = names.iter().map(|(name, axis)| format!("{name} on {axis}")).collect();
        (!names.is_empty()).then(|| format!("; {how} {}", names.join(", ")))
    };
    let wrong: Vec<String> = [("false", false_names), ("ambiguous", ambiguous_names)]
        .iter()
        .filter_map(|(how, names)| listed(how, names))
        .collect();
    (!wrong.is_empty()).then(|| {
        format!(
            "case {number}: true {} on {} ({} × noise){}",
            truth.name,
            truth.axis,
            digits(*size),
            wrong.concat()
        )
    })
}

/// A size with two digits.
fn digits(size: f64) -> String {
    match size {
        s if s >= 10.0 => format!("{s:.0}"),
        s if s >= 1.0 => format!("{s:.1}"),
        s => format!("{s:.2}"),
    }
}

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write_page(
    folder: &Path,
    lead: &[String],
    detections: &[Detection],
    curve: &Curve,
) -> Result<PathBuf, OutputError> {
    let entries = [point_entry("after", "found"), point_entry("before", "not found")];
    let lead = html! {
        @for sentence in lead { (paragraph(sentence)) }
    };
    let picture = html! {
        (note(NOTE))
        (legend(&entries))
        (figure("", &detection_plot::picture(curve), ""))
    };
    let tables = preformatted("Sizes and effects", &tables(detections, curve));
    let sections = html! {
        (section("Detection curve", &picture))
        (section("Sizes and effects", &tables))
    };
    pages::write(folder, &pages::render("Detection of effects by size", &lead, &sections))
}

#[cfg(test)]
mod tests {
    use super::super::detection_curve::tests::detections;
    use super::*;

    #[test]
    fn sizes_effects_and_false_names_are_listed() {
        let detections = detections();
        let curve = Curve::new(&detections);
        let sentences = sentences(1, &detections, &curve);
        assert!(
            sentences[1].starts_with("4 effects were found; of 2 names, 2 were always found from 3 times"),
            "{sentences:?}"
        );
        assert!(sentences[1].contains("From 9.6 times the noise on, at least 95 %"), "{sentences:?}");
        assert!(sentences[2].starts_with("On 1 machine an effect was named"), "{sentences:?}");
        assert!(
            sentences[2].contains("From 0.98 times the noise on, at least 95 % of the names"),
            "{sentences:?}"
        );
        let text = tables(&detections, &curve);
        let cells = |start: &str| -> Vec<String> {
            let line = text.lines().find(|line| line.starts_with(start)).unwrap();
            line.split_whitespace().map(str::to_owned).collect()
        };
        assert_eq!(cells("3.1")[1..5], ["2", "50", "%", "9"].map(str::to_owned));
        assert_eq!(cells("windup"), ["windup", "3", "9.0", "2.9"]);
        assert!(text.contains("case 2: true windup on x (0.30 × noise); false intalk on x"), "{text}");
        assert!(text.contains("case 4: true windup on x (2.9 × noise); ambiguous latency on y"), "{text}");
    }

    #[test]
    fn the_page_has_a_point_for_every_case() {
        let folder = tempfile::tempdir().unwrap();
        let detections = detections();
        let page = write_page(folder.path(), &[], &detections, &Curve::new(&detections)).unwrap();
        let html = std::fs::read_to_string(page).unwrap();
        // 7 cases: 4 found, 3 not; 6 sizes occur, each with a point of the curve. A legend has one of each.
        assert_eq!(html.matches("<circle class=\"before\"").count(), 3 + 1);
        assert_eq!(html.matches("<circle class=\"after\"").count(), 4 + 6 + 1);
    }
}
