//! grblHAL and Marlin: they have a backlash an axis and no table.

use std::fmt::Write;

use crate::control::{ControlFile, Written};
use crate::errors::AxisErrors;

/// First setting of the backlash in grblHAL: that of X; the next axes follow.
const GRBLHAL_BACKLASH: usize = 160;

/// Settings of grblHAL, mm.
#[must_use]
pub fn grblhal(axes: &[AxisErrors<'_>]) -> Written {
    let line = |axis: &AxisErrors<'_>| {
        let letters = ["x", "y", "z", "a", "b", "c"];
        let number =
            letters.iter().position(|letter| axis.axis.eq_ignore_ascii_case(letter)).unwrap_or(axis.number);
        format!("${}={:.4}\n", GRBLHAL_BACKLASH + number, 1e-3 * axis.backlash_um)
    };
    let text: String = axes.iter().filter(|axis| axis.backlash_um > 0.0).map(line).collect();
    of(text, "grblhal.txt", "grblHAL has these settings if it was built with ENABLE_BACKLASH_COMPENSATION.")
}

/// The command of Marlin, mm.
#[must_use]
pub fn marlin(axes: &[AxisErrors<'_>]) -> Written {
    let mut words = String::new();
    for axis in axes.iter().filter(|axis| axis.backlash_um > 0.0) {
        let _ = write!(words, " {}{:.4}", axis.upper(), 1e-3 * axis.backlash_um);
    }
    let text = if words.is_empty() { String::new() } else { format!("M425 F1{words}\nM500\n") };
    of(
        text,
        "marlin.gcode",
        "Marlin has this command if it was built with BACKLASH_COMPENSATION and BACKLASH_GCODE.",
    )
}

fn of(text: String, name: &str, remark: &str) -> Written {
    if text.is_empty() {
        return Written::default();
    }
    Written { files: vec![ControlFile { name: name.to_owned(), text }], remarks: vec![remark.to_owned()] }
}
