//! The page of a comparison of number formats: sentences, the table, and the errors over time.

use std::path::{Path, PathBuf};

use crate::compare::motion::Motion;
use crate::compare::pipeline::Pipeline;
use crate::compare::{Comparison, Row};
use files::output::OutputError;
use link::controller::Format;
use report::markup::{figure, key, note, paragraph, section, text};
use report::number::significant;
use report::plot::{Chart, Ink, Layer};
use report::{page, write_page};

/// Writes the page into a folder, which is made where it is missing, and gives its path.
///
/// # Errors
/// If the folder cannot be made or the page not be written.
pub fn write(folder: &Path, comparison: &Comparison, said: &[String]) -> Result<PathBuf, OutputError> {
    write_page(folder, &html(comparison, said))
}

/// The page; the sentences stand on top.
#[must_use]
pub fn html(comparison: &Comparison, said: &[String]) -> String {
    let lead: String = said.iter().map(|sentence| paragraph(sentence)).collect();
    let sections =
        [section("Errors and cost", &table(comparison)), section("Over time", &charts(comparison))].concat();
    page("Fixed point against floating point", &lead, &sections)
}

/// Nanometres for people: three digits, and nothing below a picometre.
#[must_use]
pub fn nanometres(nm: f64) -> String {
    match nm {
        0.0 => "0".to_owned(),
        nm if nm < 1e-3 => "< 0.001".to_owned(),
        nm => significant(nm, 3),
    }
}

fn table(comparison: &Comparison) -> String {
    let what = "Command: distance from the point of the exact path at which the command in double precision stands \
                in that tick. Position: distance of the table from the table in the run in double precision. Drift, \
                of the long run: last command to programmed end along the path, or movement of the mean table \
                position, whichever is more. Instructions: median of the ticks with path and position loops, emulated \
                Cortex-M4F.";
    let rows: String = comparison.rows.iter().map(row).collect();
    let spread = "<th class=\"n\" scope=\"col\">max</th><th class=\"n\" scope=\"col\">rms</th>";
    format!(
        "{}<table>\n<thead>\n<tr><th rowspan=\"2\" scope=\"col\">motion</th><th rowspan=\"2\" \
         scope=\"col\">arithmetic</th><th colspan=\"2\" scope=\"colgroup\">command, nm</th><th colspan=\"2\" \
         scope=\"colgroup\">position, nm</th><th class=\"n\" rowspan=\"2\" scope=\"col\">drift, nm</th><th class=\"n\" \
         rowspan=\"2\" scope=\"col\">instructions<br>a tick</th></tr>\n<tr>{spread}{spread}</tr>\n</thead>\n\
         <tbody>\n{rows}</tbody>\n</table>\n",
        note(what)
    )
}

fn row(row: &Row) -> String {
    let cell = |said: String| format!("<td class=\"n\">{}</td>", text(&said));
    let spread =
        |s: crate::compare::errors::Spread| [cell(nanometres(s.max)), cell(nanometres(s.rms))].concat();
    let or_none = |said: Option<String>| cell(said.unwrap_or_else(|| "–".to_owned()));
    format!(
        "<tr><th scope=\"row\">{}</th><td>{}</td>{}{}{}{}</tr>\n",
        text(&row.motion.replace('_', " ")),
        text(&row.scalar.replace("_position", ", positions too")),
        spread(row.command_error_nm),
        spread(row.position_error_nm),
        or_none(row.drift_nm.map(nanometres)),
        or_none(row.instructions_per_tick.map(|count| count.to_string())),
    )
}

fn charts(comparison: &Comparison) -> String {
    let legend = [
        key("after", false, "fixed point"),
        key("before", false, "f32, and on the right f32 with f32 positions"),
    ];
    let of_motion = |motion: Motion| {
        let layer = |pipeline, ink| {
            let row = comparison.of(pipeline).find(|row| row.motion == motion.name());
            Layer { ink, points: row.map(|row| row.curve.clone()).unwrap_or_default(), is_marked: false }
        };
        let chart = |size, mut layers: Vec<Layer>| {
            let unit = scale(&mut layers);
            Chart {
                size,
                title: &format!("Table error over time, {}", motion.name()),
                description: "Distance from the table in the run in double precision.",
                x: "time, s",
                y: &format!("from f64, {unit}"),
                noise: 0.0,
                layers,
            }
            .svg()
        };
        let close = vec![
            layer(Pipeline::Of(Format::F32), Ink::Before),
            layer(Pipeline::Of(Format::Fixed), Ink::After),
        ];
        let far = vec![layer(Pipeline::F32Position, Ink::Before)];
        format!(
            "<h3>{}</h3>\n<div class=\"stage\">\n{}{}</div>\n",
            text(&motion.name().replace('_', " ")),
            figure("", &chart((590, 190), close), ""),
            figure("", &chart((354, 190), far), "")
        )
    };
    let charts: String = Motion::ALL.into_iter().map(of_motion).collect();
    let what = "Greatest distance of each of up to 400 pieces of a motion. Of the long run the two minutes at its \
                beginning and the two at its end, between which only the path runs.";
    format!("{}<p class=\"legend\">{}</p>\n{charts}", note(what), legend.concat())
}

/// Makes nm into the unit in which the greatest value has few digits, and names it.
fn scale(layers: &mut [Layer]) -> &'static str {
    let points = || layers.iter().flat_map(|layer| &layer.points);
    let most = numerics::max_abs(points().map(|point| point.1));
    let (unit, factor) = match most {
        most if most >= 1e6 => ("mm", 1e-6),
        most if most >= 1e3 => ("µm", 1e-3),
        _ => ("nm", 1.0),
    };
    for point in layers.iter_mut().flat_map(|layer| &mut layer.points) {
        point.1 *= factor;
    }
    unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_told_from_next_to_nothing() {
        assert_eq!(nanometres(0.0), "0");
        assert_eq!(nanometres(4e-9), "< 0.001");
        assert_eq!(nanometres(0.528_09), "0.528");
        assert_eq!(nanometres(922_228_459.7), "922000000");
    }
}
