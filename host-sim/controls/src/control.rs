//! Controls, and the files for one.

/// A control with its own files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Control {
    /// LinuxCNC: `COMP_FILE` or `BACKLASH`, lines of the INI file.
    Linuxcnc,
    /// Siemens SINUMERIK: leadscrew error compensation.
    Siemens,
    /// Heidenhain: tables .COM.
    Heidenhain,
    /// Fanuc: parameters of the stored pitch error compensation.
    Fanuc,
    /// Beckhoff `TwinCAT` CNC: list kw.ssfk.
    Beckhoff,
    /// grblHAL: settings of the backlash.
    Grblhal,
    /// Marlin: M425.
    Marlin,
    /// Position, error in both directions.
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
    /// Greatest number of points of a table; 0: it has none.
    #[must_use]
    pub const fn most_points(self) -> usize {
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
