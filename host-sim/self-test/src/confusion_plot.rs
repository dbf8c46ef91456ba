//! A confusion matrix as a picture: a row for each true effect, a column for each effect found.

use maud::{Markup, html};

use crate::confusion::Confusion;
use pages::markup::{Attributes, svg, text};

/// Width and height of a cell, width of the names next to the rows, height of the names above the columns, in pixels
/// of the page.
const CELL: (u32, u32) = (34, 22);
const LEFT: u32 = 150;
const TOP: u32 = 118;

const TITLE: &str = "Confusion matrix";
const DESCRIPTION: &str = "Each row is a true effect, each column an effect found; the numbers count cases.";

/// The SVG element, without rows and columns that are empty; an empty text for an empty matrix.
pub fn picture(confusion: &Confusion) -> String {
    let (rows, columns) = used(confusion);
    if rows.is_empty() {
        return String::new();
    }
    let [width, height] = [columns.len(), rows.len()].map(|n| u32::try_from(n).unwrap_or(0));
    let right = LEFT + width * CELL.0;
    let bottom = TOP + height * CELL.1;
    let body = html! {
        @for (x, column) in (LEFT..).step_by(CELL.0 as usize).zip(&columns) { (column_name(column, x)) }
        @for (y, (row, total)) in (TOP..).step_by(CELL.1 as usize).zip(&rows) {
            text.label font-size="12" text-anchor="end" x=(LEFT - 10) y=(y + CELL.1 / 2 + 4) { (in_words(row)) }
            @for (x, column) in (LEFT..).step_by(CELL.0 as usize).zip(&columns) {
                (cell(confusion, (row, column), *total, (x, y)))
            }
        }
        (grid(right, bottom))
    };
    // The slanted name of the last column extends beyond it. The minimum keeps the scale of a small matrix.
    svg(((right + 90).max(980), bottom + 4), Attributes::default(), (TITLE, DESCRIPTION), &body)
}

/// Rows that are not empty, each with its sum, and columns that are not empty or have a row of the same name, so that
/// the diagonal is complete.
fn used(confusion: &Confusion) -> (Vec<(&'static str, usize)>, Vec<&'static str>) {
    let cells: Vec<_> = confusion.cells().collect();
    let sum = |is_in: &dyn Fn(&str, &str) -> bool| -> usize {
        cells.iter().filter(|(row, column, _)| is_in(row, column)).map(|cell| cell.2).sum()
    };
    let rows = confusion.rows.iter().map(|&row| (row, sum(&|r, _| r == row)));
    let rows: Vec<_> = rows.filter(|(_, total)| *total > 0).collect();
    let has_row = |column: &str| rows.iter().any(|(row, _)| *row == column);
    let columns = confusion.columns.iter().copied();
    let columns = columns.filter(|column| has_row(column) || sum(&|_, c| c == *column) > 0).collect();
    (rows, columns)
}

fn column_name(name: &str, x: u32) -> Markup {
    let transform = format!("translate({} {}) rotate(-55)", x + CELL.0 / 2 + 4, TOP - 8);
    html! {
        text.label font-size="12" transform=(transform) { (in_words(name)) }
    }
}

/// The count of a cell on a coloured ground; nothing for a count of 0.
fn cell(confusion: &Confusion, (row, column): (&str, &str), total: usize, (x, y): (u32, u32)) -> Markup {
    let count = confusion.of(row, column);
    let class = if Confusion::is_right(row, column) { "hit" } else { "slip" };
    // From 0.2, where a single case of many is still visible, to 0.6, where the number on it is still legible.
    let opacity = 0.2 + 0.4 * count as f64 / total as f64;
    html! {
        @if count > 0 {
            rect class=(class) x=(x) y=(y) width=(CELL.0) height=(CELL.1) fill-opacity=(format_args!("{opacity:.2}")) {}
            text.count font-size="12" text-anchor="middle" x=(x + CELL.0 / 2) y=(y + CELL.1 / 2 + 4) { (count) }
        }
    }
}

fn grid(right: u32, bottom: u32) -> Markup {
    html! {
        @for y in (TOP..=bottom).step_by(CELL.1 as usize) { line.grid x1=(LEFT) y1=(y) x2=(right) y2=(y) {} }
        @for x in (LEFT..=right).step_by(CELL.0 as usize) { line.grid x1=(x) y1=(TOP) x2=(x) y2=(bottom) {} }
    }
}

fn in_words(name: &str) -> Markup {
    text(&name.replace('_', " "))
}
