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
        let half_um = 0.5 * axis.backlash_um;
        let mut row = |position_mm: f64, forward_um: f64, backward_um: f64| {
            let _ =
                writeln!(text, "{position_mm:.4},{:.3},{:.3}", forward_um - half_um, backward_um + half_um);
        };
        match &axis.table {
            Some(table) => {
                let errors = table.forward_um.iter().zip(&table.backward_um);
                for (position_mm, (forward_um, backward_um)) in table.positions_mm().zip(errors) {
                    row(position_mm, *forward_um, *backward_um);
                }
            }
            None => row(0.0, 0.0, 0.0),
        }
        written.files.push(ControlFile { name: format!("{}.csv", axis.axis), text });
    }
    if !written.files.is_empty() {
        written.remarks.push("An error is the actual less the commanded position.".to_owned());
    }
    written
}
