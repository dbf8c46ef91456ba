//! The page of `circle`: the sentence, the figures, the parts, the magnified circle, and each part drawn alone.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use super::certificate;

use budget::limits::Judgement;
use circle::Analysis;
use circle::part::{Frame, Part};
use circle::text::{cells, figures, sentence, title};
use files::format::{signed, significant};
use files::output::OutputError;
use pages::file_name;
use pages::markup::{Column, figure, list, note, number_cell, paragraph, section, table, text, words_cell};
use pages::polar::{class, directions, division_for, drawing, magnification};

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(folder: &Path, analysis: &Analysis, limits: &[Judgement]) -> Result<PathBuf, OutputError> {
    pages::write(folder, &html(analysis, limits))
}

/// The page. The same result gives the same bytes.
#[must_use]
pub fn html(analysis: &Analysis, limits: &[Judgement]) -> String {
    let sections = html! {
        @if !limits.is_empty() { (section("Limits", &certificate::limits(limits))) }
        (section("Figures after ISO 230-4", &list(&figures(analysis))))
        (section("Radial deviation", &measured(analysis)))
        (section("What it is made of", &parts(analysis)))
        (section("Each part alone", &alone(analysis)))
    };
    let lead = paragraph(&sentence(analysis));
    pages::render(&format!("Circle: {}", file_name(&analysis.measured.source)), &lead, &sections)
}

/// The measured deviation in both directions, about the nominal centre.
fn measured(analysis: &Analysis) -> Markup {
    let lines: Vec<(&str, &[(f64, f64)])> = analysis
        .figures
        .directions
        .iter()
        .map(|direction| (class(direction.is_clockwise), &direction.points[..]))
        .collect();
    html! {
        div.circles { (picture(analysis, "As measured", &lines)) }
        (directions(analysis.figures.directions.iter().map(|direction| direction.is_clockwise)))
        @if !analysis.measured.notes.is_empty() { (list(&analysis.measured.notes)) }
    }
}

/// One polar picture with its caption.
fn picture(analysis: &Analysis, title: &str, lines: &[(&str, &[(f64, f64)])]) -> Markup {
    let values = || lines.iter().flat_map(|(_, points)| points.iter().map(|point| point.1));
    let [min, max] = numerics::min_max(values());
    let division_um = division_for(numerics::max_abs(values()));
    let times = magnification(division_um, 1e-3 * analysis.frame.radius_mm);
    let caption = format!(
        "{title}: {} to {} µm. One division is {} µm, magnified {} times.",
        signed(min, 2),
        signed(max, 2),
        significant(division_um, 1),
        significant(times, 2)
    );
    let [x, y] = &analysis.measured.axes;
    let name = format!("{title}: radial deviation over the angle");
    figure("", &drawing(&name, &caption, lines, division_um, [x, y]), &caption)
}

fn parts(analysis: &Analysis) -> Markup {
    if analysis.parts.is_empty() {
        return paragraph("No part stands out of the noise.");
    }
    let columns = [
        Column::Words("part"),
        Column::Words("axis"),
        Column::Numbers("µm"),
        Column::Numbers("95 % interval"),
        Column::Words("certainty"),
        Column::Words("may be confused with"),
        Column::Words(""),
    ];
    let rows = html! {
        @for part in &analysis.parts {
            @let [part, axis, um, interval, certainty, rivals, details] = cells(part);
            tr {
                td { (text(&part)) } td { (text(&axis)) } (number_cell(&um)) (number_cell(&interval))
                td { (text(&certainty)) } (words_cell(&rivals)) (words_cell(&details))
            }
        }
    };
    html! {
        (table("Parts of the radial deviation", &columns, &rows))
        (note(&format!(
            "µm: range of the radial deviation of a part alone over all angles and measured directions. Not explained by these parts: {} µm \
             rms.",
            significant(analysis.residual_um, 2)
        )))
    }
}

/// The curve of each part that has one.
fn alone(analysis: &Analysis) -> Markup {
    let drawn: Vec<&Part> = analysis.parts.iter().filter(|part| !part.terms.is_empty()).collect();
    html! {
        @if !drawn.is_empty() {
            div.circles {
                @for part in &drawn { (of_part(analysis, part)) }
            }
            (directions(analysis.figures.directions.iter().map(|direction| direction.is_clockwise)))
        }
    }
}

fn of_part(analysis: &Analysis, part: &Part) -> Markup {
    let Frame { directions, .. } = analysis.frame;
    let curves: Vec<(bool, Vec<(f64, f64)>)> = [false, true]
        .into_iter()
        .zip(directions)
        .filter(|(_, is_measured)| *is_measured)
        .map(|(is_clockwise, _)| (is_clockwise, analysis.frame.curve(&part.terms, is_clockwise)))
        .collect();
    let lines: Vec<(&str, &[(f64, f64)])> =
        curves.iter().map(|(is_clockwise, points)| (class(*is_clockwise), &points[..])).collect();
    picture(analysis, &format!("{} of {}", title(part), part.axis), &lines)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use circle::analyse;
    use circle::measured::Measured;
    use circle::radius_table::Nominal;
    use files::table::Table;

    /// An oval of 3·sin 2θ µm in both directions: one picture as measured, one of squareness. The name of the file is text.
    #[test]
    fn the_page_shows_the_circle_and_each_part_and_escapes_names() {
        let mut csv = "angle_deg,radius_um,direction\n".to_owned();
        for direction in ["ccw", "cw"] {
            for i in 0..3600_u32 {
                let angle = TAU * f64::from(i) / 3600.0;
                // A known ripple in place of noise.
                let um = 3.0 * (2.0 * angle).sin() + 0.05 * f64::from(i * 7919 % 101) / 101.0;
                csv += &format!("{},{um:.4},{direction}\n", angle.to_degrees());
            }
        }
        let name = "a<b>.csv".to_owned();
        let nominal = Nominal { radius_mm: Some(100.0), ..Nominal::default() };
        let table = Table::parse(csv.as_bytes(), &name).unwrap();
        let measured = Measured::of_radius_tables(vec![(table, name.clone())], nominal).unwrap();
        let analysis = analyse(measured).unwrap();
        let page = super::html(&analysis, &[]);
        assert!(page.contains("Circle: a&lt;b&gt;.csv") && !page.contains("a<b>"));
        assert!(page.contains("mostly made of squareness of xy"), "{}", super::sentence(&analysis));
        // Each picture has its division in a caption, and once more for screen readers.
        assert_eq!(page.matches("One division").count(), 2 * (1 + analysis.parts.len()));
        assert_eq!(page, super::html(&analysis, &[]));
    }
}
