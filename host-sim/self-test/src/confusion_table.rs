//! A confusion matrix as a picture: one row an effect that was there, one column an effect that was found.

use crate::confusion::Confusion;
use report::markup::{svg, text};

/// Size of a cell, and of the words beside and above the cells.
const CELL: (u32, u32) = (34, 22);
const BESIDE: u32 = 150;
const ABOVE: u32 = 118;

/// The picture; rows and columns of which nothing was seen are left out.
pub fn picture(confusion: &Confusion) -> String {
    let cells: Vec<_> = confusion.cells().collect();
    let sum = |is_in: &dyn Fn(&str, &str) -> bool| -> usize {
        cells.iter().filter(|(row, column, _)| is_in(row, column)).map(|cell| cell.2).sum()
    };
    let rows: Vec<(&str, usize)> = confusion
        .rows
        .iter()
        .map(|&row| (row, sum(&|r, _| r == row)))
        .filter(|(_, total)| *total > 0)
        .collect();
    // An effect that was there has its column, found or not: else the diagonal would break.
    let is_row = |column: &str| rows.iter().any(|(row, _)| *row == column);
    let columns: Vec<&str> = confusion
        .columns
        .iter()
        .copied()
        .filter(|column| is_row(column) || sum(&|_, c| c == *column) > 0)
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let [across, down] = [columns.len(), rows.len()].map(|n| u32::try_from(n).unwrap_or(0));
    let right = BESIDE + across * CELL.0;
    let bottom = ABOVE + down * CELL.1;
    let mut body = String::new();
    for (x, column) in (BESIDE..).step_by(CELL.0 as usize).zip(&columns) {
        let (x, y) = (x + CELL.0 / 2 + 4, ABOVE - 8);
        body += &format!(
            "<text class=\"label\" font-size=\"12\" transform=\"translate({x} {y}) rotate(-55)\">{}</text>\n",
            said(column)
        );
    }
    for (y, (row, total)) in (ABOVE..).step_by(CELL.1 as usize).zip(&rows) {
        let middle = y + CELL.1 / 2 + 4;
        body += &format!(
            "<text class=\"label\" font-size=\"12\" text-anchor=\"end\" x=\"{}\" y=\"{middle}\">{}</text>\n",
            BESIDE - 10,
            said(row)
        );
        for (x, column) in (BESIDE..).step_by(CELL.0 as usize).zip(&columns) {
            let count = confusion.of(row, column);
            if count > 0 {
                let class = if Confusion::is_right(row, column) { "hit" } else { "slip" };
                // Even a single case of many is to be seen, and its number in front of a row's all.
                let strength = 0.2 + 0.4 * count as f64 / *total as f64;
                body += &format!(
                    "<rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{}\" height=\"{}\" \
                     fill-opacity=\"{strength:.2}\"/>\n<text class=\"count\" font-size=\"12\" text-anchor=\"middle\" \
                     x=\"{}\" y=\"{middle}\">{count}</text>\n",
                    CELL.0,
                    CELL.1,
                    x + CELL.0 / 2
                );
            }
        }
    }
    for y in (ABOVE..=bottom).step_by(CELL.1 as usize) {
        body += &format!("<line class=\"grid\" x1=\"{BESIDE}\" y1=\"{y}\" x2=\"{right}\" y2=\"{y}\"/>\n");
    }
    for x in (BESIDE..=right).step_by(CELL.0 as usize) {
        body += &format!("<line class=\"grid\" x1=\"{x}\" y1=\"{ABOVE}\" x2=\"{x}\" y2=\"{bottom}\"/>\n");
    }
    // The last words lean out over the last column; a small matrix is not blown up to the width of the page.
    svg(
        ((right + 90).max(980), bottom + 4),
        "What was taken for what",
        "Each row is an effect that was there, each column an effect that was found; the numbers count cases.",
        &body,
    )
}

fn said(name: &str) -> String {
    text(&name.replace('_', " "))
}
