//! The errors of each axis as CSV: position, error in positive and in negative direction, with half of the backlash each.

use std::fmt::Write;

use crate::control::{ControlFile, Written};
use crate::errors::AxisErrors;

/// The files.
#[must_use]
pub fn write(axes: &[AxisErrors<'_>]) -> Written {
    let mut written = Written::default();
    for axis in axes.iter().filter(|axis| axis.has_errors()) {
        let mut text = "position_mm,error_forward_um,error_backward_um\n".to_owned();
        // The backlash is the same at every position.
        let half_um = 0.5 * axis.backlash_um;
        let alone = axis.table.is_none().then_some([0.0, -half_um, half_um]);
        for [position_mm, forward_um, backward_um] in axis.rows().chain(alone) {
            let _ = writeln!(text, "{position_mm:.4},{forward_um:.3},{backward_um:.3}");
        }
        written.files.push(ControlFile { name: format!("{}.csv", axis.axis), text });
    }
    if !written.files.is_empty() {
        written.remarks.push("An error is the actual less the commanded position.".to_owned());
    }
    written
}
