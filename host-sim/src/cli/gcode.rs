//! `lost-motion gcode`: a motion as a program of a control.

use std::path::PathBuf;

use anyhow::Result;

use super::outputs::{Output, check_outputs, print};
use files::error::InputError;
use files::output::write_whole;
use motion::Motion;
use motion::gcode::{self, Control};

/// The language of the program.
#[derive(Clone, Copy, clap::ValueEnum)]
pub enum Format {
    /// LinuxCNC.
    Linuxcnc,
    /// Siemens SINUMERIK.
    Siemens,
    /// Fanuc.
    Fanuc,
}

impl Format {
    /// A motion as a program; `source` names the motion in messages.
    ///
    /// # Errors
    /// If the motion has other axes than the control.
    pub fn program(self, motion: &Motion, source: &str) -> Result<String, InputError> {
        let control = match self {
            Self::Linuxcnc => Control::Linuxcnc,
            Self::Siemens => Control::Siemens,
            Self::Fanuc => Control::Fanuc,
        };
        gcode::program(motion, control).map_err(|error| InputError::new(source, error.to_string()))
    }
}

/// Arguments of `gcode`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Motion file.
    #[arg(long)]
    motion: PathBuf,
    /// The control.
    #[arg(long)]
    format: Format,
    /// Program to write.
    #[arg(long)]
    out: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// A motion that cannot be used, or has other axes than the control; an output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    check_outputs(&[&arguments.motion], &[Output::File("--out", Some(&arguments.out))])?;
    let motion = Motion::read(&arguments.motion)?;
    let program = arguments.format.program(&motion, &arguments.motion.display().to_string())?;
    write_whole(&arguments.out, |out| out.write_all(program.as_bytes()))?;
    print(&format!("Program: {}", arguments.out.display()))
}
