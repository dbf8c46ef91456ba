//! Compensation files of other controls, from the compensation of a model.
//!
//! - [`control`]: the controls, and a file for one
//! - [`errors`]: the deviation of an axis from its command, as a table over the position and a backlash
//! - [`linuxcnc`], [`siemens`], [`heidenhain`], [`fanuc`], [`beckhoff`]: tables of these controls
//! - [`linuxcnc_force`]: friction and masses for LinuxCNC
//! - [`backlash_only`]: grblHAL and Marlin, which have no tables
//! - [`table`]: the errors as CSV
//! - [`left_out`]: compensations that none of them supports, and what to do instead
//!
//! An error is that of the table or tool: actual − commanded position. Positions are those of the logs; a control counts from its own
//! machine zero, so both must be the same. None of this needs masses or gains. The sources of the formats are named in `docs/controls.md`.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod backlash_only;
pub mod beckhoff;
pub mod control;
pub mod errors;
pub mod fanuc;
pub mod heidenhain;
pub mod left_out;
pub mod linuxcnc;
pub mod linuxcnc_force;
pub mod siemens;
pub mod table;

#[cfg(test)]
mod tests;

use commissioning::compensate::CompensationFile;
use model::machine::Machine;

pub use control::{Control, ControlFile, Written};
use errors::AxisErrors;

/// The files of a compensation of a machine for a control.
#[must_use]
pub fn write(control: Control, machine: &Machine, compensation: &CompensationFile) -> Written {
    let axes = AxisErrors::all(machine, compensation, control.most_points());
    let mut written = match control {
        Control::Linuxcnc => linuxcnc::write(&axes),
        Control::Siemens => siemens::write(&axes),
        Control::Heidenhain => heidenhain::write(&axes),
        Control::Fanuc => fanuc::write(&axes),
        Control::Beckhoff => beckhoff::write(&axes),
        Control::Grblhal => backlash_only::grblhal(&axes),
        Control::Marlin => backlash_only::marlin(&axes),
        Control::Csv => table::write(&axes),
    };
    for axis in &axes {
        written.remarks.extend(axis.unresolved.iter().cloned());
        written.remarks.extend(left_out::of(control, axis));
    }
    written
}
