//! Tables of documents, to be compared with what a program prints.

use std::fs;
use std::path::Path;

/// The rows of the tables of a page of `docs` that begin with a head, each with its cells without marks of Markdown.
///
/// # Panics
/// If there is no such page.
#[must_use]
pub fn rows(page: &str, head: &str) -> Vec<Vec<String>> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("docs").join(page);
    let text = fs::read_to_string(page).expect("a page of the documentation");
    let mut rows = Vec::new();
    for table in text.split(&format!("\n{head}\n")).skip(1) {
        let lines = table.lines().skip(1).take_while(|line| line.starts_with('|'));
        rows.extend(lines.map(cells));
    }
    rows
}

fn cells(line: &str) -> Vec<String> {
    let cells = line.replace(r"\|", "¦");
    let cells = cells.trim().trim_matches('|').split('|');
    cells.map(|cell| cell.trim().trim_matches(['`', '*']).replace('¦', "|").replace('−', "-")).collect()
}

/// Half of a step of the last digit of a number.
///
/// # Panics
/// If it has more digits than an i32 counts.
#[must_use]
pub fn half_digit(number: &str) -> f64 {
    let digits = number.split_once('.').map_or(0, |(_, digits)| digits.len());
    0.5 * 0.1f64.powi(i32::try_from(digits).expect("a number of digits"))
}

/// Whether a cell is a value rounded to the cell's digits, or a bound above the value. The value may be off by a hundredth of a step more,
/// for the rounding of the rounding.
///
/// # Panics
/// If the cell is no number.
#[must_use]
pub fn shows(cell: &str, value: f64) -> bool {
    if let Some(bound) = cell.strip_prefix("< ") {
        return value < number(bound);
    }
    (number(cell) - value).abs() <= 1.02 * half_digit(cell)
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or_else(|_| panic!("no number: {text}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_is_a_rounded_value_or_a_bound() {
        assert!(
            shows("1.25", 1.2549) && shows("-1.25", -1.2451) && shows("12", 12.4) && shows("< 0.001", 0.0009)
        );
        assert!(!shows("1.25", 1.256) && !shows("1.25", -1.25) && !shows("< 0.001", 0.0011));
        assert_eq!(cells(r"| `a` | \|Q\| | **differs** | −1 | |"), ["a", "|Q|", "differs", "-1", ""]);
    }
}
