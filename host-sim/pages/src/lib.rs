//! Components of report pages. A page is one HTML file without references to other files; the same result gives the same bytes. Its only
//! script is that of the circles, which are complete without it.
//!
//! - here: the page as a file: head, stylesheet, writing
//! - [`markup`]: HTML elements that several sections use
//! - [`plot`]: line charts
//! - [`polar`]: deviations over the angle of a circle, as ballbar users draw them

pub mod markup;
pub mod plot;
pub mod polar;

use std::path::{Path, PathBuf};

use maud::{DOCTYPE, Markup, PreEscaped, html};

use files::output::{OutputError, create_folder, write_whole};
use markup::text;

/// Name of the page in its folder.
pub const FILE_NAME: &str = "report.html";

/// The stylesheet of every page.
pub const STYLE: &str = include_str!("style.css");

/// The script of the circles: a slider for the magnification, the deviation under the pointer.
const POLAR: &str = include_str!("polar.js");

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
                @if sections.0.contains(polar::MARK) { script { (PreEscaped(POLAR)) } }
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
