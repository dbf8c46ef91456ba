//! Checks of a machine file beyond the names and types of its keys.

mod empirical;
mod gantry;
mod law;
mod loops;
mod nominal;

use files::axis_name::{AXIS_NAME, is_axis_name};
use files::document::Document;
use files::error::InputError;

use super::axis::Axis;
use super::declared::Machine;
use super::instruments::InstrumentKeys;
use super::rotary;
use crate::axis::{Drive, Feedback, KEYS, Key, PerNotch, Settings};
use crate::bodies::Assembly;
use crate::effects::{Effect, KINDS, LONGEST_LATENCY_MS, Occurrence, Placement, names};
use crate::friction_curve::Curve;
use crate::range::Range;
use crate::servo;

/// Highest loop rate. A higher rate has a wrong unit.
const HIGHEST_RATE_HZ: f64 = 1e6;
/// Largest number of velocity-loop ticks per position-loop tick. More are a typing error, and too slow to simulate.
const MOST_VELOCITY_STEPS: f64 = 1000.0;

/// Checks a machine that was read from a document.
pub(super) fn machine(machine: &Machine, document: &Document<'_>) -> Result<(), InputError> {
    rates(machine, document)?;
    if machine.axis.is_empty() {
        return Err(document.refuse("axis", "at least one table [axis.NAME]"));
    }
    // Checked first, as a name that contains a dot would be read as two parts of a key.
    if let Some(name) = machine.axis.keys().find(|name| !is_axis_name(name)) {
        return Err(document.refuse(&format!("axis.{name}"), AXIS_NAME));
    }
    for (name, axis) in &machine.axis {
        let key = format!("axis.{name}");
        let context = Context { key: &key, axis, settings: &axis.settings, document };
        context.ranges()?;
        context.controller()?;
        context.smoothing(machine.sample_rate_hz)?;
        context.filters(machine.velocity_rate_hz())?;
        context.gain_schedule(machine.rates())?;
        context.holding()?;
        context.travel()?;
        context.mechanics()?;
        context.tolerances()?;
        context.nominal()?;
        context.evidence()?;
        context.empirical(machine)?;
        context.law(machine)?;
        context.log_offsets(machine.sample_rate_hz)?;
        for (index, effect) in axis.effect.iter().enumerate() {
            let effect_key = format!("{key}.effect[{index}]");
            parameters(effect, &effect_key, document)?;
            context.place(effect, &effect_key, machine)?;
            let is_second =
                |other: &Effect| other.name() == effect.name() && effect.occurrence() == Occurrence::Once;
            if axis.effect[..index].iter().any(is_second) {
                return Err(document.refuse(&effect_key, "at most one effect of this name"));
            }
        }
        sources(&machine.others(name), &key, document)?;
    }
    gantry::gantries(machine, document)?;
    instruments(machine, document)?;
    structure(machine, document)
}

fn instruments(machine: &Machine, document: &Document<'_>) -> Result<(), InputError> {
    for (name, value) in machine.instruments.iter().flat_map(InstrumentKeys::all) {
        if let Some(value) = value {
            let range = if name.ends_with("latency_ms") {
                Range::UpTo(LONGEST_LATENCY_MS)
            } else {
                Range::NotNegative
            };
            range.check(&format!("instruments.{name}"), value, document)?;
        }
    }
    Ok(())
}

/// Checks that the structure is valid and has the axes of the machine.
fn structure(machine: &Machine, document: &Document<'_>) -> Result<(), InputError> {
    let Some(structure) = &machine.structure else { return Ok(()) };
    if !structure.axis.keys().eq(machine.axis.keys()) {
        let names: Vec<&str> = machine.axis.keys().map(String::as_str).collect();
        return Err(
            document.refuse("structure.axis", &format!("the axes of the machine: {}", names.join(", ")))
        );
    }
    match Assembly::of(structure) {
        Ok(_) => Ok(()),
        Err(error) => {
            let text = error.to_string();
            Err(match text.split_once(": ") {
                Some((key, problem)) => document.error_at(&format!("structure.{key}"), problem),
                None => document.error_at("structure", &text),
            })
        }
    }
}

fn rates(machine: &Machine, document: &Document<'_>) -> Result<(), InputError> {
    let possible = |rate_hz: f64| rate_hz > 0.0 && rate_hz <= HIGHEST_RATE_HZ;
    let what = format!("a rate above 0 and up to {HIGHEST_RATE_HZ}");
    if !possible(machine.sample_rate_hz) {
        return Err(document.refuse("sample_rate_hz", &what));
    }
    let (velocity_hz, key) = (machine.velocity_rate_hz(), "velocity_loop_rate_hz");
    if !possible(velocity_hz) {
        return Err(document.refuse(key, &what));
    }
    let steps = velocity_hz / machine.sample_rate_hz;
    let whole = (steps - steps.round()).abs() < 1e-9 * steps;
    if whole && (1.0..=MOST_VELOCITY_STEPS).contains(&steps.round()) {
        return Ok(());
    }
    let times = format!("sample_rate_hz ({}) times 1 to {MOST_VELOCITY_STEPS}", machine.sample_rate_hz);
    Err(document.refuse(key, &format!("{times}, a whole number")))
}

/// An axis with its key in the document.
struct Context<'a> {
    key: &'a str,
    axis: &'a Axis,
    settings: &'a Settings,
    document: &'a Document<'a>,
}

/// Keys of the velocity loop, of the force that it outputs, and of the brake that waits for this force.
const OF_VELOCITY_LOOP: &[&str] = &[
    "velocity_gain_n_s_per_m",
    "velocity_integral_time_s",
    "velocity_observer_hz",
    "gain_schedule_position_mm",
    "gain_schedule_speed_mm_per_s",
    "gain_schedule_ratio",
    "force_limit_n",
    "notch_frequency_hz",
    "notch_width_hz",
    "notch_depth",
    "low_pass_frequency_hz",
    "low_pass_damping_ratio",
    "preload_n",
    "brake_release_s",
    "brake_engage_s",
    "gantry_with",
    "gantry_skew_limit_mm",
    "gantry_offset_mm",
];

/// Keys of the position loop.
const OF_POSITION_LOOP: &[&str] = &[
    "controller",
    "position_gain_per_s",
    "feedforward_percent",
    "feedforward_ahead_s",
    "dual_feedback_time_constant_s",
];

/// Whether an axis with such a drive may have a key.
fn has_key(drive: Drive, key: &str) -> bool {
    match drive {
        Drive::Torque => key != "full_steps_per_turn" && !is_of_pid(key),
        Drive::Velocity => key != "full_steps_per_turn" && !OF_VELOCITY_LOOP.contains(&key),
        Drive::Stepper => {
            !OF_VELOCITY_LOOP.contains(&key) && !OF_POSITION_LOOP.contains(&key) && !is_of_pid(key)
        }
    }
}

/// Whether a key is a term of LinuxCNC's position loop.
fn is_of_pid(key: &str) -> bool {
    key.starts_with("pid_")
}

impl Context<'_> {
    fn refuse(&self, key: &str, what: &str) -> InputError {
        let what = rotary::in_words(what, self.settings.names);
        self.document.refuse(&format!("{}.{key}", self.key), &what)
    }

    fn ranges(&self) -> Result<(), InputError> {
        for key in KEYS {
            let Some(range) = key.range else { continue };
            let values = (key.numbers)(self.settings);
            for (index, value) in values.iter().enumerate() {
                let name = PerNotch::key(key.name, index, values.len());
                range.check(&format!("{}.{name}", self.key), *value, self.document)?;
            }
        }
        Ok(())
    }

    /// Refuses keys of loops that the kind of drive does not have. What is missing is unknown: the tracer says what that costs.
    fn controller(&self) -> Result<(), InputError> {
        let Settings { controller, limits, sensors, .. } = self.settings;
        let refused = |key: &&Key| (key.is_given)(self.settings) && !has_key(controller.drive, key.name);
        if let Some(key) = KEYS.iter().find(refused) {
            let what = format!("no such key, as drive is \"{}\"", controller.drive.word());
            return Err(self.refuse(key.name, &what));
        }
        // Without a controller, its filters and limits would have no effect, but for the travel: tables and motions are within it.
        let of_controller =
            |key: &&Key| ["schedule", "filters", "limits"].contains(&key.group) && key.name != "travel_mm";
        let given = KEYS.iter().filter(of_controller).find(|key| (key.is_given)(self.settings));
        if let (Drive::Torque, None, Some(given)) = (controller.drive, controller.law, given) {
            return Err(self.refuse("controller", &format!("a value beside {}", given.name)));
        }
        if let Some(limit_mm) = limits.frozen_encoder_limit_mm {
            let most_mm = limits.following_error_limit_mm.unwrap_or(1e3 * servo::FOLLOWING_ERROR_LIMIT_M);
            if limit_mm > most_mm {
                let what = format!("no more than following_error_limit_mm, {most_mm}");
                return Err(self.refuse("frozen_encoder_limit_mm", &what));
            }
        }
        if sensors.feedback == Feedback::Dual && sensors.dual_feedback_time_constant_s.is_none() {
            let what = "a value beside feedback = \"dual\"";
            return Err(self.refuse("dual_feedback_time_constant_s", what));
        }
        Ok(())
    }

    fn mechanics(&self) -> Result<(), InputError> {
        let mechanics = &self.settings.mechanics;
        let masses = [("motor_mass_kg", mechanics.motor_mass_kg), ("table_mass_kg", mechanics.table_mass_kg)];
        let massless = masses.iter().find(|(_, mass)| mass.unwrap_or(0.0) <= 0.0);
        // With both masses unknown, the stiffness says nothing yet; with one of them, the other one was forgotten.
        let is_divided =
            mechanics.stiffness_n_per_um.is_some() && masses.iter().any(|(_, mass)| mass.is_some());
        if let (Some((key, _)), true) = (massless, is_divided) {
            return Err(self.refuse(key, "a mass above 0, as stiffness_n_per_um is given"));
        }
        let presliding = mechanics.presliding_stiffness_n_per_um;
        if presliding.is_none() && mechanics.presliding_damping_n_s_per_m.is_some() {
            let what = "a value beside presliding_damping_n_s_per_m";
            return Err(self.refuse("presliding_stiffness_n_per_um", what));
        }
        if let Some(curve) = &mechanics.friction_curve {
            if mechanics.coulomb_n.is_some() {
                return Err(self.refuse("coulomb_n", "no such key, as friction_curve is given"));
            }
            curve.check().map_err(|expected| self.refuse("friction_curve", expected))?;
            if presliding.is_some() && matches!(curve, Curve::FallingRising(_)) {
                let what = "no such key, as a falling_rising curve is continuous at zero velocity";
                return Err(self.refuse("presliding_stiffness_n_per_um", what));
            }
        }
        // The deflection of the bristles is coulomb / stiffness: without Coulomb friction there are no bristles. A
        // falling_rising curve is continuous at zero velocity and needs none.
        let is_piecewise = matches!(mechanics.friction_curve, Some(Curve::Piecewise(_)));
        if presliding.is_some() && mechanics.coulomb_n.unwrap_or(0.0) <= 0.0 && !is_piecewise {
            let what = "a friction above 0, as presliding_stiffness_n_per_um is given";
            return Err(self.refuse("coulomb_n", what));
        }
        Ok(())
    }
}

impl Context<'_> {
    /// Checks that the axis may have the effect.
    fn place(&self, effect: &Effect, key: &str, machine: &Machine) -> Result<(), InputError> {
        let place = Placement {
            axis: self.settings,
            axes: machine.axis.len(),
            has_structure: machine.structure.is_some(),
            rates: machine.rates(),
        };
        effect.misplaced(&place).map_or(Ok(()), |misplaced| {
            Err(self.document.refuse(&format!("{key}.{}", misplaced.key), &misplaced.expected))
        })
    }
}

/// Reads each effect separately. If the whole file is read, serde does not report the key of an error in an effect.
pub(super) fn effects(document: &Document<'_>) -> Result<(), InputError> {
    for axis in document.children("axis") {
        let evidence = indexed(&format!("{axis}.evidence"), document).into_iter();
        let alternatives = evidence.flat_map(|entry| indexed(&format!("{entry}.alternative"), document));
        let effects = [axis.to_owned(), format!("{axis}.nominal")].map(|of| entries(&of, document));
        for effect in effects.into_iter().flatten().chain(alternatives) {
            let name_key = format!("{effect}.name");
            let name: String = document.deserialize_at(&name_key)?;
            if !names().contains(&name.as_str()) {
                let what = format!("one of {}", names().join(", "));
                return Err(document.refuse(&name_key, &what));
            }
            numbers(effect, &name, document)?;
            document.deserialize_at::<Effect>(effect)?;
        }
    }
    Ok(())
}

/// Keys of the `[[axis.NAME.effect]]` entries of an axis.
fn entries<'d>(axis: &str, document: &'d Document<'_>) -> Vec<&'d str> {
    indexed(&format!("{axis}.effect"), document)
}

/// Keys of the entries of an array of tables.
fn indexed<'d>(array: &str, document: &'d Document<'_>) -> Vec<&'d str> {
    // If it is a table by mistake, its children are keys without an index.
    document.children(array).into_iter().filter(|key| key.ends_with(']')).collect()
}

/// Checks the types of the keys of an effect with this name: `name`, `source`, `channel`, `part` and the optional names of its kind are texts, all
/// others numbers or lists of numbers.
fn numbers(effect: &str, name: &str, document: &Document<'_>) -> Result<(), InputError> {
    let kinds = || KINDS.iter().filter(|kind| kind.name == name);
    let parameters = kinds().flat_map(|kind| kind.parameters);
    let lists: Vec<String> = parameters
        .filter(|parameter| parameter.is_list)
        .map(|list| format!("{effect}.{}", list.key))
        .collect();
    let optional = kinds().flat_map(|kind| kind.optional_named_keys).map(|(key, _)| *key);
    let names = ["name", "source", "channel", "part"].into_iter().chain(optional);
    let names: Vec<String> = names.map(|name| format!("{effect}.{name}")).collect();
    for key in document.children(effect) {
        if names.iter().any(|name| name == key) {
            document.deserialize_at::<String>(key)?;
        } else if lists.iter().any(|list| list == key) {
            let values = document.children(key);
            if values.is_empty() || !values.iter().all(|value| document.is_number(value)) {
                return Err(document.refuse(key, "a list of numbers"));
            }
        } else if !document.is_number(key) {
            return Err(document.refuse(key, "a number"));
        }
    }
    Ok(())
}

/// Checks the ranges of an effect's parameters.
fn parameters(effect: &Effect, key: &str, document: &Document<'_>) -> Result<(), InputError> {
    let declared = effect.declared_parameters();
    declared.iter().zip(effect.values()).enumerate().try_for_each(|(i, (parameter, value))| {
        let key = format!("{key}.{}", parameter.key);
        if !parameter.is_list {
            return parameter.range.check(&key, value, document);
        }
        let first = declared.iter().position(|other| other.key == parameter.key).unwrap_or(i);
        parameter.range.check(&format!("{key}[{}]", i - first), value, document)
    })
}

fn sources(others: &[String], key: &str, document: &Document<'_>) -> Result<(), InputError> {
    for effect in entries(key, document) {
        let source = format!("{effect}.source");
        if !document.children(effect).contains(&source.as_str()) {
            continue;
        }
        if !others.contains(&document.deserialize_at(&source)?) {
            let names = if others.is_empty() { "there is none".to_owned() } else { others.join(", ") };
            return Err(document.refuse(&source, &format!("the name of another axis ({names})")));
        }
    }
    Ok(())
}
