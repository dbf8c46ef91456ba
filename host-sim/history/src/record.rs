//! One trace of the machine, from its JSON ([`super::trace_json`]) or its model ([`super::model_file`]).

use std::collections::BTreeMap;
use std::fmt;

use files::error::InputError;
use indexmap::IndexMap;
use jiff::civil::Date;

/// What a figure belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Group {
    /// A parameter of an effect that was found.
    Effect,
    /// A declared value, as it was fitted.
    Declared,
    /// The rms that the model leaves of a channel, of held-out logs where there are some.
    Residual,
    /// A contour error: of a log as it was measured, or of a standard motion as the model predicts it. It depends on the motion: its
    /// changes are not announced.
    Tool,
}

impl Group {
    /// Its name in files.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Effect => "effect",
            Self::Declared => "declared",
            Self::Residual => "residual",
            Self::Tool => "tool",
        }
    }
}

/// The name of a series of figures: `x.backlash.lost_motion_um`, `x.motor_mass_kg`, `x.residual.table_um`, `tool.circle.rms_um`.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Name {
    /// What the figure belongs to.
    pub group: Group,
    /// The axis; `tool` for contour errors.
    pub axis: String,
    /// The effect, the channel, the log or the motion; empty for a declared value.
    pub of: String,
    /// The key with its unit.
    pub key: String,
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { axis, of, key, .. } = self;
        if of.is_empty() { write!(f, "{axis}.{key}") } else { write!(f, "{axis}.{of}.{key}") }
    }
}

/// How far a figure of one trace counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trust {
    /// Nothing speaks against it.
    Certain,
    /// Another effect may be the cause.
    Ambiguous,
    /// The search ended at a bound, or gave no interval.
    NoInterval,
    /// In a model whose file alone says it: no trace has found it.
    Declared,
}

impl Trust {
    /// Its name in files.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Certain => "certain",
            Self::Ambiguous => "ambiguous",
            Self::NoInterval => "no_interval",
            Self::Declared => "declared",
        }
    }

    /// Whether the figure is monitored.
    #[must_use]
    pub const fn is_counted(self) -> bool {
        matches!(self, Self::Certain)
    }
}

/// A figure of one trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// Its value, in the unit of its name.
    pub value: f64,
    /// Half width of its 95 % interval, if it has one.
    pub half_width: Option<f64>,
    /// How far it counts.
    pub trust: Trust,
}

/// What an effect costs at the tool on a standard motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// The motion on which it costs most.
    pub motion: String,
    /// Its share of the contour error there, µm rms.
    pub um_rms: f64,
}

/// A trace at its date.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The file, below the folder.
    pub source: String,
    /// Its date.
    pub day: Date,
    /// Name of the machine, if the file has it.
    pub machine: Option<String>,
    /// Serial number of the machine, if the file has it.
    pub serial: Option<String>,
    /// Temperature at which it was logged, °C, if the file has it.
    pub temperature_c: Option<f64>,
    /// All figures.
    pub figures: IndexMap<Name, Figure>,
    /// Costs of the effects, by axis and effect.
    pub costs: BTreeMap<(String, String), Cost>,
    /// Effects that its logs cannot show, by axis and effect.
    pub not_testable: Vec<(String, String)>,
}

/// Names of effects that an axis has more than once are numbered in the order of the file.
#[derive(Default)]
pub(crate) struct Names(BTreeMap<(String, String), usize>);

impl Names {
    pub fn of(&mut self, axis: &str, effect: &str, source: Option<&str>) -> String {
        let name = source.map_or_else(|| effect.to_owned(), |source| format!("{effect}({source})"));
        let count = self.0.entry((axis.to_owned(), name.clone())).or_insert(0);
        *count += 1;
        if *count == 1 { name } else { format!("{name}#{count}") }
    }
}

/// The error of a trace without a date.
pub(crate) fn undated(source: &str) -> InputError {
    InputError::expected(source, "a date in the file or in its name", "none")
        .with_advice("trace with --date, or name the file or its folder as 2026-11-27")
}
