//! Components of report pages. A page is one HTML file without references to other files; the same result gives the same bytes. It has one
//! script, which magnifies charts and circles and saves pictures and tables as files; the page is complete without it.
//!
//! - here: the page as a file: head, stylesheet, writing
//! - [`markup`]: HTML elements that several sections use
//! - `data`: the figures of a picture, which the page saves as CSV
//! - [`plot`]: line charts
//! - [`choice`]: other curves for a circle, one choice at a time
//! - `ticks`: the ticks of an axis
//! - [`polar`]: deviations over the angle of a circle, as ballbar users draw them

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod choice;
mod data;
pub mod markup;
pub mod plot;
pub mod polar;
mod ticks;

use std::path::{Path, PathBuf};

use maud::{DOCTYPE, Markup, PreEscaped, html};

use files::output::{OutputError, create_folder, write_whole};
use markup::text;

/// Name of the page in its folder.
pub const FILE_NAME: &str = "report.html";

/// The stylesheet of every page.
pub const STYLE: &str = include_str!("style.css");

/// The script that reads the figures of pictures, for the others.
const FIGURES: &str = include_str!("figures.js");

/// The script of the line charts: a cursor, and the horizontal axis magnified.
const CHART: &str = include_str!("chart.js");

/// The script of the circles: a slider for the magnification, the deviation under the pointer.
const POLAR: &str = include_str!("polar.js");

/// The script of the choices of other curves for a circle.
const CHOICE: &str = include_str!("choice.js");

/// The script of the buttons that save pictures and tables.
const SAVE: &str = include_str!("save.js");

/// Path of the page in a folder, if there is one.
#[must_use]
pub fn file_in(folder: Option<&PathBuf>) -> Option<PathBuf> {
    folder.map(|folder| folder.join(FILE_NAME))
}

/// A whole page; the title is plain text, and the heading of the page, too.
#[must_use]
pub fn render(title: &str, lead: &Markup, sections: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (text(title)) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                main {
                    header { h1 { (text(title)) } (lead) }
                    (sections)
                }
                script {
                    (PreEscaped(FIGURES))
                    @if sections.0.contains(polar::MARK) { (PreEscaped(POLAR)) }
                    @if sections.0.contains(choice::MARK) { (PreEscaped(CHOICE)) }
                    @if sections.0.contains(plot::MARK) { (PreEscaped(CHART)) }
                    (PreEscaped(SAVE))
                }
            }
        }
        "\n"
    };
    page.into_string()
}

/// Writes a page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(folder: &Path, html: &str) -> Result<PathBuf, OutputError> {
    let path = folder.join(FILE_NAME);
    create_folder(folder)?;
    write_whole(&path, |out| out.write_all(html.as_bytes()))?;
    Ok(path)
}

/// The last part of a path: pages do not show the folders of their author.
#[must_use]
pub fn file_name(source: &str) -> &str {
    source.rsplit(['/', '\\']).next().unwrap_or(source)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The value of a variable of a colour scheme: `#rgb` or `#rrggbb`, as parts of 0 to 1.
    fn colour(scheme: &str, name: &str) -> [f64; 3] {
        let (_, rest) = scheme.split_once(&format!("--{name}: #")).unwrap();
        let (digits, _) = rest.split_once(';').unwrap();
        let width = digits.len() / 3;
        [0, 1, 2].map(|i| {
            let value = u8::from_str_radix(&digits[i * width..(i + 1) * width], 16).unwrap();
            f64::from(value) / if width == 1 { 15.0 } else { 255.0 }
        })
    }

    /// Ratio of contrast by WCAG 2.
    fn contrast(a: [f64; 3], b: [f64; 3]) -> f64 {
        let linear =
            |part: f64| if part <= 0.040_45 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) };
        let luminance = |c: [f64; 3]| 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn words_and_lines_stand_out_in_every_colour_scheme() {
        let schemes: Vec<&str> = STYLE.split("  color-scheme: light").skip(1).collect();
        let dark = STYLE.split("prefers-color-scheme: dark").nth(1).unwrap();
        assert_eq!(schemes.len(), 2, "light and paper");
        for scheme in [schemes[0], dark, schemes[1]] {
            let page = colour(scheme, "page");
            // The words of a page, and those in the colour of a line, have 4.5; lines, 3 (WCAG 2.2, 1.4.3 and 1.4.11).
            for word in ["ink", "soft", "after", "before"] {
                let ratio = contrast(page, colour(scheme, word));
                assert!(ratio >= 4.5, "{word}: {ratio}");
            }
            for line in ["cw", "ccw"] {
                let ratio = contrast(page, colour(scheme, line));
                assert!(ratio >= 3.0, "{line}: {ratio}");
            }
        }
        assert!((contrast([0.0; 3], [1.0; 3]) - 21.0).abs() < 1e-9);
    }

    #[test]
    fn a_page_has_one_script_and_that_of_circles_where_there_is_one() {
        let plain = render("a", &Markup::default(), &html! { p { "b" } });
        assert_eq!(plain.matches("<script>").count(), 1);
        assert!(!plain.contains(POLAR) && plain.contains(SAVE));
        let circle = PreEscaped(polar::drawing("a", "b", &[], 1.0, ["x", "y"]));
        let page = render("a", &Markup::default(), &circle);
        assert_eq!(page.matches("<script>").count(), 1);
        assert!(page.contains(POLAR) && page.contains(SAVE));
    }
}
