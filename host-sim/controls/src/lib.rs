//! Compensation files of other controls, from the compensation of a model.
//!
//! - [`errors`]: what an axis does beside its command, as a table over the position and a backlash
//! - [`linuxcnc`], [`siemens`], [`heidenhain`], [`fanuc`], [`beckhoff`]: tables of these controls
//! - [`backlash_only`]: grblHAL and Marlin, which have no tables
//! - [`table`]: the errors as CSV
//! - [`left_out`]: what none of them takes, and what to do instead
//!
//! An error is that of the table or tool: actual − commanded position. Positions are those of the logs; a control counts from its own
//! machine zero, so both must be the same. None of this needs masses or gains. The sources of the formats are named in `docs/controls.md`.

pub mod backlash_only;
pub mod beckhoff;
pub mod errors;
pub mod fanuc;
pub mod heidenhain;
pub mod left_out;
pub mod linuxcnc;
pub mod siemens;
pub mod table;

#[cfg(test)]
mod tests;

use compensate::CompensationFile;
use model::machine::Machine;

use errors::AxisErrors;

/// A control with its own files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// LinuxCNC: `COMP_FILE` or `BACKLASH`, and gains of its pid.
    Linuxcnc,
    /// Siemens SINUMERIK: leadscrew error compensation.
    Siemens,
    /// Heidenhain: non-linear axis-error compensation.
    Heidenhain,
    /// Fanuc: stored pitch error compensation.
    Fanuc,
    /// Beckhoff `TwinCAT` CNC: leadscrew error compensation.
    Beckhoff,
    /// grblHAL: backlash.
    Grblhal,
    /// Marlin: backlash.
    Marlin,
    /// Tables for any other control.
    Csv,
}

/// A file for a control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ControlFile {
    /// Name in its folder.
    pub name: String,
    /// Its text.
    pub text: String,
}

/// The files of a compensation for a control, and what its user has to know.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Written {
    /// The files.
    pub files: Vec<ControlFile>,
    /// Sentences.
    pub remarks: Vec<String>,
}

impl Control {
    /// Greatest number of points of a table.
    const fn most_points(self) -> usize {
        match self {
            Self::Linuxcnc | Self::Heidenhain => 256,
            Self::Siemens => 200,
            Self::Fanuc => 128,
            Self::Beckhoff => 1500,
            Self::Csv => 4096,
            Self::Grblhal | Self::Marlin => 0,
        }
    }
}

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
