//! Heidenhain iTNC 530, TNC 640, `MANUALplus` 620: compensation tables `.COM`.
//!
//! Column AXISPOS has the position from the machine datum, the column of the axis the value in positive direction, and BACKLASH that in
//! negative direction, mm. At most 256 lines. The documentation calls the values compensation values of an error that is positive where
//! the travel is too long; it leaves open whether a table has the error or its opposite, so the file has the error.

use std::fmt::Write;

use crate::control::{ControlFile, Written};
use crate::errors::AxisErrors;

/// The files.
#[must_use]
pub fn write(axes: &[AxisErrors<'_>]) -> Written {
    let mut written = Written::default();
    for axis in axes {
        if axis.table.is_none() {
            if axis.backlash_um > 0.0 {
                written.remarks.push(format!(
                    "{}: enter {:.4} mm as its backlash (MP710, or CfgAxisComp/backLash).",
                    axis.axis,
                    1e-3 * axis.backlash_um
                ));
            }
            continue;
        }
        let name = axis.upper();
        let mut text = format!("BEGIN {name}.COM MM\nNR AXISPOS BACKLASH {name}\n");
        for (nr, [position_mm, forward_um, backward_um]) in axis.rows().enumerate() {
            let [forward_mm, backward_mm] = [forward_um, backward_um].map(|um| 1e-3 * um);
            let _ = writeln!(text, "{nr} {position_mm:+.5} {backward_mm:+.5} {forward_mm:+.5}");
        }
        text += "[END]\n";
        written.files.push(ControlFile { name: format!("{name}.COM"), text });
    }
    if !written.files.is_empty() {
        written.remarks.push(
            "Sign: the documentation of Heidenhain leaves it open. Enter the table of one axis, move 100 mm and measure: if the error has doubled, change all signs. The assignment table (.CMA) must name the .COM file."
                .to_owned(),
        );
    }
    written
}
