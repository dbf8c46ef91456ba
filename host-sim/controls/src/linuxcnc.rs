//! LinuxCNC: a `COMP_FILE` of each axis, or `BACKLASH`, and the lines of the INI file.
//!
//! With `COMP_FILE_TYPE = 1` a line is the nominal position and the trims of both directions, which are added to the command:
//! motor-pos-cmd = pos-cmd + trim. At most 256 ascending lines. It takes the place of `BACKLASH`, of which half is added in the
//! direction of motion. What the friction needs is in [`crate::linuxcnc_force`].

use std::fmt::Write;

use model::axis::{Drive, Feedback};

use crate::control::{ControlFile, Written};
use crate::errors::AxisErrors;
use crate::linuxcnc_force;

/// The files.
#[must_use]
pub fn write(axes: &[AxisErrors<'_>]) -> Written {
    let mut written = Written::default();
    let mut ini = String::new();
    for axis in axes {
        let axis = &linuxcnc_force::with_stretch(axis);
        let force = linuxcnc_force::lines(axis);
        if !force.is_empty() {
            written.remarks.push(format!("{}: {}.", axis.axis, linuxcnc_force::WIRING));
        }
        if axis.has_errors() && axis.declared.sensors.feedback != Feedback::Motor {
            written.remarks.push(format!("{}: {}.", axis.axis, linuxcnc_force::ON_SCALE));
        }
        let lines = ini_lines(axis) + &force;
        if !lines.is_empty() {
            let _ = write!(ini, "[JOINT_{}]\n# axis {}\n{lines}\n", axis.number, axis.axis);
        }
        if axis.table.is_some() {
            written.files.push(ControlFile { name: comp_file(axis), text: trims(axis) });
        }
    }
    if !ini.is_empty() {
        let text = format!(
            "# Lines for the INI file of the machine: they take the place of those of the same name.\n\n{ini}"
        );
        written.files.push(ControlFile { name: "joints.ini".to_owned(), text });
        written.remarks.push(
            "Joints are numbered as the axes of the machine file. The positions of a COMP_FILE are joint positions after homing, which have to be those of the logs."
                .to_owned(),
        );
    }
    written
}

fn comp_file(axis: &AxisErrors<'_>) -> String {
    format!("{}.comp", axis.axis)
}

/// A line per position: the trims are the errors with the opposite sign.
fn trims(axis: &AxisErrors<'_>) -> String {
    let mut text = String::new();
    for [position_mm, forward_um, reverse_um] in axis.rows() {
        let _ = writeln!(text, "{position_mm:.4} {:.6} {:.6}", -1e-3 * forward_um, -1e-3 * reverse_um);
    }
    text
}

fn ini_lines(axis: &AxisErrors<'_>) -> String {
    let mut lines = String::new();
    if axis.table.is_some() {
        let _ = writeln!(lines, "COMP_FILE = {}\nCOMP_FILE_TYPE = 1", comp_file(axis));
    } else if axis.backlash_um > 0.0 {
        let _ = writeln!(lines, "BACKLASH = {:.6}", 1e-3 * axis.backlash_um);
    }
    let (declared, changed) = (&axis.declared.controller, &axis.compensation.controller);
    if declared.drive == Drive::Stepper {
        return lines;
    }
    let mut line = |key: &str, was: Option<f64>, now: f64| {
        let was = was.map_or_else(|| "not known".to_owned(), |was| format!("{was:.6}"));
        let _ = writeln!(lines, "# {key} was {was}\n{key} = {now:.6}");
    };
    if let Some(gain_per_s) = changed.position_gain_per_s {
        line("P", declared.position_gain_per_s, gain_per_s);
    }
    let percent = changed.feedforward_percent.or(declared.feedforward_percent);
    let ff1 = |percent: Option<f64>| percent.map(|percent| 0.01 * percent);
    if let Some(now) = ff1(changed.feedforward_percent) {
        line("FF1", ff1(declared.feedforward_percent), now);
    }
    // The velocity T ahead of the command is that of the command and T times its acceleration.
    if let (Some(ahead_s), Some(ff1)) = (changed.feedforward_ahead_s, ff1(percent)) {
        line("FF2", axis.declared.pid.ff2_s, ff1 * ahead_s);
    }
    lines
}
