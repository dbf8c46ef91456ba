//! Contour errors before, as predicted, and after a change, as a table of figures.

use serde_json::{Value, json};

use crate::ContourError;
use files::format::significant;

/// The quantities of a row: each before, predicted and after, µm.
pub const QUANTITIES: [&str; 3] = ["rms", "greatest", "circular deviation G"];

/// One motion before, as predicted, and after a change.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Name of the motion.
    pub name: String,
    /// Rms, greatest error and circular deviation G (ISO 230-4, the larger of both directions), each before, predicted and
    /// after, µm. `None`: not predicted, or no circle.
    pub figures: [[Option<f64>; 3]; QUANTITIES.len()],
}

impl Comparison {
    /// The comparison of three contour errors: before, predicted and after.
    #[must_use]
    pub fn new(name: &str, errors: &[ContourError; 3]) -> Self {
        let of = |value: fn(&ContourError) -> Option<f64>| errors.each_ref().map(value);
        Self {
            name: name.to_owned(),
            figures: [
                of(|error| Some(error.rms_um)),
                of(|error| Some(error.max_um)),
                of(ContourError::circular_um),
            ],
        }
    }

    /// As JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        let of = |[before, predicted, after]: [Option<f64>; 3]| json!({"before": before, "predicted": predicted, "after": after});
        let [rms, max, circular] = self.figures;
        json!({
            "name": self.name,
            "rms_um": of(rms),
            "max_um": of(max),
            "circular_deviation_um": of(circular),
        })
    }
}

/// The table for a terminal.
#[must_use]
pub fn text(rows: &[Comparison]) -> String {
    let [rms, greatest, circular] = QUANTITIES;
    let mut lines = vec![
        format!("{:<20}{rms:>30}{greatest:>30}{circular:>30}", "contour error, µm"),
        format!("{:<20}{}", "", format!("{:>10}{:>10}{:>10}", "before", "predicted", "after").repeat(3)),
    ];
    let cell = |value: &Option<f64>| {
        value.map_or(format!("{:>10}", "–"), |um| format!("{:>10}", significant(um, 3)))
    };
    lines.extend(rows.iter().map(|row| {
        let cells: String = row.figures.iter().flatten().map(cell).collect();
        format!("{:<20}{cells}", row.name)
    }));
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every line is as wide as its columns: a name and nine figures.
    #[test]
    fn figures_stand_under_their_headings() {
        let row = Comparison {
            name: "circle".to_owned(),
            figures: [[Some(1.5), None, Some(0.25)], [None; 3], [Some(-1.0), Some(2.0), Some(3.0)]],
        };
        let text = text(&[row]);
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines.iter().all(|line| line.chars().count() == 20 + 9 * 10), "{text}");
        let ends = |line: &str, word: &str| {
            line.find(word).map(|at| line[..at].chars().count() + word.chars().count())
        };
        assert_eq!(ends(lines[1], "before"), ends(lines[2], "1.50"));
        assert_eq!(ends(lines[0], "circular deviation G"), ends(lines[2], "3.00"));
    }
}
