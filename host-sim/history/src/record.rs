//! One trace of the machine, from the JSON that `lost-motion trace --json` writes, or from its model.

use std::collections::BTreeMap;
use std::fmt;

use files::error::InputError;
use indexmap::IndexMap;
use jiff::civil::Date;
use model::axis::KeyNames;
use model::machine::Machine;
use model::machine::evidence::Certainty;
use serde::Deserialize;
use serde_json::Value;

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

/// What a history needs of the JSON of a trace.
#[derive(Deserialize)]
struct Written {
    schema_version: u32,
    machine: Option<String>,
    circumstances: Option<Circumstances>,
    effects: Vec<Effect>,
    declared: Vec<Declared>,
    residual: Vec<Residual>,
    not_testable: Vec<NotTestable>,
    #[serde(default)]
    contour: Vec<Contour>,
    budget: Option<Budget>,
}

#[derive(Deserialize)]
struct Circumstances {
    serial: Option<String>,
    date: Option<String>,
    temperature_c: Option<f64>,
}

#[derive(Deserialize)]
struct Effect {
    name: String,
    axis: String,
    source: Option<String>,
    certainty: String,
    parameters: IndexMap<String, Parameter>,
}

type Interval = [Option<f64>; 2];

#[derive(Deserialize)]
#[serde(untagged)]
enum Parameter {
    One {
        value: f64,
        ci95: Interval,
    },
    Fitted {
        value: Vec<f64>,
        ci95: Vec<Interval>,
    },
    /// Lists that are not fitted, and what a later version may write.
    Other {},
}

#[derive(Deserialize)]
struct Declared {
    axis: String,
    key: String,
    fitted: f64,
    ci95: Option<Interval>,
}

#[derive(Deserialize)]
struct Residual {
    axis: String,
    channel: String,
    #[serde(flatten)]
    figures: BTreeMap<String, Value>,
}

#[derive(Deserialize)]
struct NotTestable {
    axis: String,
    effect: Option<String>,
}

#[derive(Deserialize)]
struct Contour {
    log: String,
    channel: String,
    rms_um: Option<f64>,
    #[serde(default)]
    circles: Vec<Circle>,
}

#[derive(Deserialize)]
struct Circle {
    circular_deviation_um: Option<f64>,
}

#[derive(Deserialize)]
struct Budget {
    motions: Vec<Motion>,
}

#[derive(Deserialize)]
struct Motion {
    name: String,
    whole_um: Sizes,
    causes: Vec<Cause>,
}

#[derive(Deserialize)]
struct Sizes {
    rms: f64,
    #[serde(rename = "G")]
    circular: Option<f64>,
}

#[derive(Deserialize)]
struct Cause {
    #[serde(rename = "cause")]
    name: String,
    axis: String,
    um: Sizes,
}

/// Whether a JSON text may be a trace: other results have no such keys.
fn is_trace(value: &Value) -> bool {
    ["schema_version", "verdict", "effects", "residual"].iter().all(|key| value.get(key).is_some())
}

impl Record {
    /// A trace from its JSON, with its date where the file says it, else `day`; `None` if it is the JSON of something else.
    ///
    /// # Errors
    /// Text that is no JSON, a trace of another version, a trace without a date.
    pub fn of_json(text: &str, source: &str, day: Option<Date>) -> Result<Option<Self>, InputError> {
        let value: Value =
            serde_json::from_str(text).map_err(|error| InputError::expected(source, "JSON", error))?;
        if !is_trace(&value) {
            return Ok(None);
        }
        let written: Written = serde_json::from_value(value)
            .map_err(|error| InputError::expected(source, "the JSON of `lost-motion trace --json`", error))?;
        if written.schema_version != 1 {
            let found = written.schema_version;
            return Err(InputError::expected(source, "schema_version 1", found).at_key("schema_version"));
        }
        let own = written.circumstances.as_ref().and_then(|circumstances| circumstances.date.as_deref());
        let own = own
            .map(|date| {
                let bad =
                    |_| InputError::expected(source, "a date, as 2026-11-27", files::error::quoted(date));
                date.parse().map_err(bad)
            })
            .transpose()?;
        let day = own.or(day).ok_or_else(|| undated(source))?;
        Ok(Some(written.record(source, day)))
    }

    /// A trace from the machine file that it wrote: the parameters of its effects. `None` if it is no machine file.
    ///
    /// # Errors
    /// A machine file that cannot be read, or one without a date.
    pub fn of_model(text: &str, source: &str, day: Option<Date>) -> Result<Option<Self>, InputError> {
        if !text.lines().any(|line| line.trim_start().starts_with("[axis.")) {
            return Ok(None);
        }
        let machine = Machine::parse(text, source)?;
        let day = day.ok_or_else(|| undated(source))?;
        let mut names = Names::default();
        let mut figures = IndexMap::new();
        for (axis, declared) in &machine.axis {
            let is_rotary = declared.settings.names == KeyNames::Rotary;
            for (index, effect) in declared.effect.iter().enumerate() {
                let of = names.of(axis, effect.name(), effect.distinction().source());
                let evidence = declared.evidence.get(index).filter(|known| known.effect == effect.name());
                let parameters = effect.declared_parameters();
                for (at, (parameter, value)) in parameters.iter().zip(effect.values()).enumerate() {
                    let half_width = evidence.and_then(|known| known.half_widths.get(at)).copied();
                    if parameter.is_list || half_width == Some(0.0) {
                        continue;
                    }
                    let (axis, of) = (axis.clone(), of.clone());
                    let name = Name { group: Group::Effect, axis, of, key: parameter.key_on(is_rotary) };
                    let trust = trust(evidence.map(|known| known.certainty), half_width);
                    figures.insert(name, Figure { value, half_width, trust });
                }
            }
        }
        Ok(Some(Self {
            source: source.to_owned(),
            day,
            machine: Some(machine.name),
            serial: None,
            temperature_c: None,
            figures,
            costs: BTreeMap::new(),
            not_testable: Vec::new(),
        }))
    }
}

/// How far a value of a model counts.
fn trust(certainty: Option<Certainty>, half_width: Option<f64>) -> Trust {
    match certainty {
        None | Some(Certainty::Declared) => Trust::Declared,
        Some(Certainty::Ambiguous) => Trust::Ambiguous,
        Some(Certainty::Certain) if half_width.is_some() => Trust::Certain,
        Some(Certainty::Certain) => Trust::NoInterval,
    }
}

fn undated(source: &str) -> InputError {
    InputError::expected(source, "a date in the file or in its name", "none")
        .with_advice("trace with --date, or name the file or its folder as 2026-11-27")
}

/// Names of effects that an axis has more than once are numbered in the order of the file.
#[derive(Default)]
struct Names(BTreeMap<(String, String), usize>);

impl Names {
    fn of(&mut self, axis: &str, effect: &str, source: Option<&str>) -> String {
        let name = source.map_or_else(|| effect.to_owned(), |source| format!("{effect}({source})"));
        let count = self.0.entry((axis.to_owned(), name.clone())).or_insert(0);
        *count += 1;
        if *count == 1 { name } else { format!("{name}#{count}") }
    }
}

impl Written {
    fn record(self, source: &str, day: Date) -> Record {
        let costs = self.costs();
        let (serial, temperature_c) =
            self.circumstances.map_or((None, None), |own| (own.serial, own.temperature_c));
        let mut figures = IndexMap::new();
        let mut names = Names::default();
        for effect in self.effects {
            let of = names.of(&effect.axis, &effect.name, effect.source.as_deref());
            let certain = if effect.certainty == "certain" { Trust::Certain } else { Trust::Ambiguous };
            for (key, parameter) in effect.parameters {
                for (key, value, interval) in parameter.values(&key) {
                    let name = Name { group: Group::Effect, axis: effect.axis.clone(), of: of.clone(), key };
                    if let Some(figure) = fitted(value, Some(interval), certain) {
                        figures.insert(name, figure);
                    }
                }
            }
        }
        for Declared { axis, key, fitted: value, ci95 } in self.declared {
            let name = Name { group: Group::Declared, axis, of: String::new(), key };
            if let Some(figure) = fitted(value, ci95, Trust::Certain) {
                figures.insert(name, figure);
            }
        }
        for residual in &self.residual {
            figures.extend(residual.left());
        }
        figures.extend(self.contour.iter().flat_map(Contour::figures));
        figures.extend(self.budget.iter().flat_map(|budget| &budget.motions).flat_map(Motion::figures));
        let not_testable = self.not_testable.into_iter();
        let not_testable = not_testable.filter_map(|entry| Some((entry.axis, entry.effect?))).collect();
        let Self { machine, .. } = self;
        Record {
            source: source.to_owned(),
            day,
            machine,
            serial,
            temperature_c,
            figures,
            costs,
            not_testable,
        }
    }

    /// What each effect costs on the motion on which it costs most.
    fn costs(&self) -> BTreeMap<(String, String), Cost> {
        let mut costs: BTreeMap<(String, String), Cost> = BTreeMap::new();
        for motion in self.budget.iter().flat_map(|budget| &budget.motions) {
            for cause in &motion.causes {
                let cost = Cost { motion: motion.name.clone(), um_rms: cause.um.rms };
                let largest =
                    costs.entry((cause.axis.clone(), cause.name.clone())).or_insert_with(|| cost.clone());
                if cost.um_rms > largest.um_rms {
                    *largest = cost;
                }
            }
        }
        costs
    }
}

/// A fitted value; `None` for one that was not fitted, whose interval has no width.
fn fitted(value: f64, interval: Option<Interval>, trust: Trust) -> Option<Figure> {
    match interval {
        Some([Some(low), Some(high)]) if high > low => {
            Some(Figure { value, half_width: Some(0.5 * (high - low)), trust })
        }
        Some([Some(_), Some(_)]) => None,
        _ => Some(Figure { value, half_width: None, trust: Trust::NoInterval }),
    }
}

impl Parameter {
    /// Keys, values and intervals; those of a list are numbered from 1.
    fn values(self, key: &str) -> Vec<(String, f64, Interval)> {
        match self {
            Self::One { value, ci95 } => vec![(key.to_owned(), value, ci95)],
            Self::Fitted { value, ci95 } => {
                let numbered = |(index, (value, ci95))| (format!("{key}[{index}]"), value, ci95);
                (1..).zip(value.into_iter().zip(ci95)).map(numbered).collect()
            }
            Self::Other {} => Vec::new(),
        }
    }
}

fn exact(value: f64) -> Figure {
    Figure { value, half_width: None, trust: Trust::Certain }
}

impl Residual {
    /// What is left after the trace, of held-out logs where there are some.
    fn left(&self) -> Option<(Name, Figure)> {
        let (key, after) = self.figures.iter().find(|(key, _)| key.starts_with("after_"))?;
        let rms = ["validate", "fit"].into_iter().find_map(|part| after.get(part)?.as_f64())?;
        let key = format!("{}_{}", self.channel, key.strip_prefix("after_")?);
        let name = Name { group: Group::Residual, axis: self.axis.clone(), of: "residual".to_owned(), key };
        Some((name, exact(rms)))
    }
}

fn of_tool(of: &str, key: &str, value: Option<f64>) -> Option<(Name, Figure)> {
    let (axis, of, key) = ("tool".to_owned(), of.to_owned(), key.to_owned());
    Some((Name { group: Group::Tool, axis, of, key }, exact(value?)))
}

impl Contour {
    /// Contour error as it was measured at the tool.
    fn figures(&self) -> Vec<(Name, Figure)> {
        if self.channel != "tool" {
            return Vec::new();
        }
        let circular = self.circles.iter().filter_map(|circle| circle.circular_deviation_um);
        let of = format!("measured.{}", self.log);
        let figures = [of_tool(&of, "rms_um", self.rms_um), of_tool(&of, "G_um", circular.reduce(f64::max))];
        figures.into_iter().flatten().collect()
    }
}

impl Motion {
    /// Contour error as the model predicts it.
    fn figures(&self) -> Vec<(Name, Figure)> {
        let Self { name, whole_um, .. } = self;
        let figures = [of_tool(name, "rms_um", Some(whole_um.rms)), of_tool(name, "G_um", whole_um.circular)];
        figures.into_iter().flatten().collect()
    }
}
