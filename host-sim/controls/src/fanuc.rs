//! Fanuc Series 16i, 18i, 21i, 0i, 30i: stored pitch error compensation and backlash, as parameters.
//!
//! A point has the change of the compensation since the point before it, seen from the negative end, in detection units times a
//! magnification, from −7 to 7. The compensation is the error with the opposite sign. At most 128 points an axis.

use std::fmt::Write;

use crate::control::{ControlFile, Written};
use crate::errors::{AxisErrors, ErrorTable};

/// Detection unit of most machines, µm.
const DETECTION_UM: f64 = 1.0;

/// Greatest value of a point.
const GREATEST: f64 = 7.0;

/// Number of points between the first points of two axes.
const POINTS_PER_AXIS: usize = 128;

/// The files.
#[must_use]
pub fn write(axes: &[AxisErrors<'_>]) -> Written {
    let mut written = Written::default();
    let mut text = String::new();
    for axis in axes.iter().filter(|axis| axis.has_errors()) {
        let number = axis.number + 1;
        let _ = writeln!(text, "; axis {}", axis.axis);
        if let Some(table) = &axis.table {
            text += &points(axis, table);
        }
        let _ = writeln!(text, "N1851 A{number} P{:.0}", axis.mean_backlash_um() / DETECTION_UM);
    }
    if !text.is_empty() {
        written.files.push(ControlFile { name: "parameters.txt".to_owned(), text });
        written.remarks.push(format!(
            "Values are in a detection unit of {DETECTION_UM} µm; 3624 is the distance of the points in 0.001 mm. The reference point is taken at the position 0. \
             Sign: enter the points of one axis, move along them and measure; if the error has doubled, change all signs."
        ));
    }
    written
}

/// Parameters 3620 to 3624 and the points. Each is rounded with what was rounded before it, so that the sum does not drift.
fn points(axis: &AxisErrors<'_>, table: &ErrorTable) -> String {
    let number = axis.number + 1;
    let wanted: Vec<f64> = table.mean_um().map(|um| -um / DETECTION_UM).collect();
    let steps = || wanted.windows(2).map(|pair| pair[1] - pair[0]);
    let magnification = (numerics::max_abs(steps()) / GREATEST).ceil().max(1.0);
    let first = axis.number * POINTS_PER_AXIS;
    let last = first + wanted.len() - 1;
    // The point nearest to the position 0.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index of the table")]
    let at_reference =
        (-table.start_mm / table.spacing_mm).round().clamp(0.0, (wanted.len() - 1) as f64) as usize;
    let mut text = format!(
        "N3620 A{number} P{}\nN3621 A{number} P{first}\nN3622 A{number} P{last}\nN3623 A{number} P{magnification:.0}\nN3624 A{number} P{:.0}\n",
        first + at_reference,
        1e3 * table.spacing_mm
    );
    let mut sum = wanted.first().copied().unwrap_or(0.0);
    for (k, wanted) in wanted.iter().enumerate() {
        let step = ((wanted - sum) / magnification).round();
        sum += step * magnification;
        let _ = writeln!(text, "N{} P{step:.0}", 10_000 + first + k);
    }
    text
}
