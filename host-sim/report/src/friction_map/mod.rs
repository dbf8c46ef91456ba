//! The page of a friction map: what was found, the curve before and after, and what either leaves.

pub mod sentences;

use std::path::{Path, PathBuf};

use crate::markup::{figure, key, list, mark, note, paragraph, section, text};
use crate::number::{fixed, percent};
use crate::plot::{Chart, Ink, Layer};
use crate::{file_name, page, write_page};
use trace::friction_map::FrictionMap;
use trace::friction_map::fit::Law;
use trace::friction_map::search::{Explained, Round};
use trace::friction_map::unexplained::Unexplained;

use files::output::OutputError;
use sentences::{remainder, sentences, table};

/// Writes the page into a folder, which is made where it is missing, and gives its path.
///
/// # Errors
/// If the folder cannot be made or the page not be written.
pub fn write(
    folder: &Path,
    map: &FrictionMap,
    explained: &Explained,
    rest: Option<&Unexplained>,
) -> Result<PathBuf, OutputError> {
    write_page(folder, &html(map, explained, rest))
}

/// The page.
#[must_use]
pub fn html(map: &FrictionMap, explained: &Explained, rest: Option<&Unexplained>) -> String {
    let lead = note(&format!(
        "Friction map {}: {} runs at constant speed. Declared: Coulomb and viscous friction, the same both ways.",
        file_name(&map.source),
        map.runs.len()
    ));
    let figures = format!("<pre>{}</pre>\n", text(&table(map, explained).join("\n")));
    let sections = [
        section("What was found", &list(&sentences(map, explained))),
        section("Error before and after", &figures),
        section("The map", &pictures(map, explained)),
        section("What was tried", &tried(&explained.searched.rounds)),
        section("What stays unexplained", &list(&remainder(map, explained, rest))),
    ]
    .concat();
    page(&format!("Friction of {}", file_name(&map.source)), &lead, &sections)
}

fn pictures(map: &FrictionMap, explained: &Explained) -> String {
    let (before, after) = (&explained.searched.declared.law, &explained.searched.fitted.law);
    let keys = [
        mark("cw", "measured: the mean of a run"),
        key("before", false, "Coulomb and viscous friction"),
        key("after", false, "with what was found"),
        key("noise", true, "within ± 2 standard errors of a mean"),
    ];
    let (drive, force, speed) = (map.unit.drive(), map.unit.force(), map.unit.speed());
    let mut layers: Vec<Layer> = map
        .runs
        .iter()
        .map(|run| Layer { ink: Ink::Third, points: vec![(run.velocity, run.force)], is_marked: true })
        .collect();
    layers.extend(curves(map, before, Ink::Before));
    layers.extend(curves(map, after, Ink::After));
    let x = format!("speed, {speed}");
    let all = Chart {
        size: (960, 260),
        title: "Friction over speed",
        description: "Measured runs, and the law before and after.",
        x: &x,
        y: &format!("{drive}, {force}"),
        noise: 0.0,
        layers,
    };
    let left = |ink: Ink, law: &Law| {
        let one = |side: f64| {
            let runs = map.runs.iter().filter(move |run| run.velocity * side > 0.0);
            let points = runs.map(|run| (run.velocity, run.force - law.force(run.velocity))).collect();
            Layer { ink, points, is_marked: true }
        };
        [one(-1.0), one(1.0)].into_iter().filter(|layer| !layer.points.is_empty())
    };
    let residual = Chart {
        size: (960, 220),
        title: "What is left over speed",
        description: "Measured minus law, before and after.",
        x: &x,
        y: &format!("residual, {force}"),
        noise: 2.0 * map.noise().unwrap_or(0.0),
        layers: left(Ink::Before, before).chain(left(Ink::After, after)).collect(),
    };
    format!(
        "<p class=\"legend\">{}</p>\n{}{}",
        keys.concat(),
        figure("wide", &all.svg(), "Measured and modelled."),
        figure("wide", &residual.svg(), "Measured minus modelled, from fits to all runs.")
    )
}

/// A law drawn over the speeds of the map, each way for itself.
fn curves(map: &FrictionMap, law: &Law, ink: Ink) -> Vec<Layer> {
    const POINTS: u32 = 120;
    let one = |side: f64| {
        let speeds = map.runs.iter().map(|run| side * run.velocity).filter(|speed| *speed > 0.0);
        let [low, high] = numerics::min_max(speeds);
        let at = |i: u32| {
            let velocity = side * (low + (high - low) * f64::from(i) / f64::from(POINTS));
            (velocity, law.force(velocity))
        };
        (high > low).then(|| Layer { ink, points: (0..=POINTS).map(at).collect(), is_marked: false })
    };
    [one(-1.0), one(1.0)].into_iter().flatten().collect()
}

/// Every round with its terms.
fn tried(rounds: &[Round]) -> String {
    let head = "<table>\n<thead><tr><th scope=\"col\">term</th><th class=\"n\" scope=\"col\">error of left-out runs</th>\
                <th class=\"n\" scope=\"col\">of left-out ranges</th><th class=\"n\" scope=\"col\">chance</th>\
                <th scope=\"col\">verdict</th></tr></thead>\n";
    let mut body = note(
        "How the error (rms) of runs and of ranges of speed that were left out changes with each term, and the chance \
         that a law without it gives so much (F test, one trial).",
    );
    for (number, round) in rounds.iter().enumerate() {
        let row = |(i, c): (usize, &trace::friction_map::search::Candidate)| {
            // Not a number where it was not asked: `clamp` keeps it, `max` would not.
            let change = |share: f64| match 100.0 * ((1.0 - share).clamp(0.0, f64::MAX).sqrt() - 1.0) {
                change if change.is_finite() && change < 1000.0 => format!("{} %", fixed(change, 1)),
                _ => "–".to_owned(),
            };
            let verdict = match (round.added == Some(i), c.is_supported(round.candidates.len())) {
                (true, _) => "added",
                (_, true) => "supported, but less",
                _ if !c.is_physical => "would need friction below none",
                _ => "not supported",
            };
            format!(
                "<tr><th scope=\"row\">{}</th><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
                 <td>{verdict}</td></tr>\n",
                text(c.term.meaning()),
                change(c.reduction),
                change(c.range_reduction),
                percent(100.0 * c.chance),
            )
        };
        let rows: String = round.candidates.iter().enumerate().map(row).collect();
        body += &format!("<h3>Round {}</h3>\n{head}<tbody>\n{rows}</tbody>\n</table>\n", number + 1);
    }
    if rounds.is_empty() { paragraph("Nothing could be tried.") } else { body }
}
