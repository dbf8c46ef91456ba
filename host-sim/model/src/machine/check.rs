//! What a machine file has to fulfil beyond having the right keys of the right types.

mod loops;
mod nominal;

use super::instruments::InstrumentKeys;
use super::{Axis, Feedback, Machine};
use files::axis_name::{AXIS_NAME, is_axis_name};
use shared::units::TRAVEL_LIMIT_M;

use crate::bodies::Assembly;
use crate::effects::{Channel, Effect, NAMES, VelocityLag};
use crate::friction_curve::Curve;
use crate::servo;
use files::document::Document;
use files::error::InputError;

/// No machine needs a greater number in any of its units.
const GREATEST: f64 = 1e12;

/// No sensor is later than this.
const LONGEST_LATENCY_MS: f64 = 1000.0;

/// Effects that an axis has once: two of them would not add up to one.
const ONCE: [&str; 10] = [
    "stribeck",
    "presliding",
    "shear_thinning",
    "friction_memory",
    "preload_variation",
    "servo_mismatch",
    "velocity_lag",
    "thermal_drift",
    "resonance",
    "windup",
];

/// Faster loops than this are a slip of the unit.
const HIGHEST_RATE_HZ: f64 = 1e6;
/// Velocity steps within one position step; more is a slip, and would take for ever to simulate.
const MOST_VELOCITY_STEPS: f64 = 1000.0;

/// The range of a number, in the words of the error.
#[derive(Clone, Copy)]
enum Range {
    Positive,
    NotNegative,
    Signed,
    UpTo(f64),
    Within(f64),
}

impl Range {
    fn holds(self, value: f64) -> bool {
        match self {
            Self::Positive => value > 0.0 && value <= GREATEST,
            Self::NotNegative => (0.0..=GREATEST).contains(&value),
            Self::Signed => value.abs() <= GREATEST,
            Self::UpTo(greatest) => (0.0..=greatest).contains(&value),
            Self::Within(greatest) => value.abs() <= greatest,
        }
    }

    fn words(self) -> String {
        match self {
            Self::Positive => "a number above 0".to_owned(),
            Self::NotNegative => "a number not below 0".to_owned(),
            Self::Signed => format!("a number within ±{GREATEST:e}"),
            Self::UpTo(greatest) => format!("a number from 0 to {greatest}"),
            Self::Within(greatest) => format!("a number within ±{greatest}"),
        }
    }

    fn check(self, key: &str, value: f64, document: &Document<'_>) -> Result<(), InputError> {
        if self.holds(value) {
            return Ok(());
        }
        let at_most = if value > GREATEST { format!(", at most {GREATEST:e}") } else { String::new() };
        Err(document.refuse(key, &(self.words() + &at_most)))
    }
}

/// Checks a machine that was read from a document.
pub(super) fn machine(machine: &Machine, document: &Document<'_>) -> Result<(), InputError> {
    rates(machine, document)?;
    if machine.axis.is_empty() {
        return Err(document.refuse("axis", "at least one table [axis.NAME]"));
    }
    // Before anything else: in a key, a name with a point in it would look like two.
    if let Some(name) = machine.axis.keys().find(|name| !is_axis_name(name)) {
        return Err(document.refuse(&format!("axis.{name}"), AXIS_NAME));
    }
    for (name, axis) in &machine.axis {
        let key = format!("axis.{name}");
        let context = Context { key: &key, axis, document };
        context.ranges()?;
        context.controller()?;
        context.smoothing(machine.sample_rate_hz)?;
        context.filters(machine.velocity_rate_hz())?;
        context.travel()?;
        context.mechanics()?;
        context.nominal()?;
        context.log_offsets(machine.sample_rate_hz)?;
        for (index, effect) in axis.effect.iter().enumerate() {
            let effect_key = format!("{key}.effect[{index}]");
            parameters(effect, &effect_key, document)?;
            context.place(effect, &effect_key, machine)?;
            let once = |other: &Effect| other.name() == effect.name() && ONCE.contains(&effect.name());
            if axis.effect[..index].iter().any(once) {
                return Err(document.refuse(&effect_key, "this effect once"));
            }
        }
        sources(&machine.others(name), &key, document)?;
    }
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

/// The structure can be built, and has the axes of the machine.
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

/// An axis and where it stands.
struct Context<'a> {
    key: &'a str,
    axis: &'a Axis,
    document: &'a Document<'a>,
}

impl Context<'_> {
    fn refuse(&self, key: &str, what: &str) -> InputError {
        self.document.refuse(&format!("{}.{key}", self.key), what)
    }

    fn ranges(&self) -> Result<(), InputError> {
        use Range::{NotNegative, Positive, UpTo};

        let a = self.axis;
        let numbers = [
            ("position_gain_per_s", a.position_gain_per_s, Positive),
            ("feedforward_percent", a.feedforward_percent, UpTo(200.0)),
            ("velocity_gain_n_s_per_m", a.velocity_gain_n_s_per_m, Positive),
            ("velocity_integral_time_s", a.velocity_integral_time_s, Positive),
            ("force_limit_n", a.force_limit_n, Positive),
            ("smoothing_s", a.smoothing_s, Positive),
            ("smoothing_jerk_s", a.smoothing_jerk_s, Positive),
            ("smoothing_time_constant_s", a.smoothing_time_constant_s, Positive),
            ("notch_frequency_hz", a.notch_frequency_hz, Positive),
            ("notch_width_hz", a.notch_width_hz, Positive),
            ("notch_depth", a.notch_depth, UpTo(1.0)),
            ("low_pass_frequency_hz", a.low_pass_frequency_hz, Positive),
            ("low_pass_damping_ratio", a.low_pass_damping_ratio, Positive),
            ("following_error_limit_mm", a.following_error_limit_mm, Positive),
            ("stop_deceleration_m_per_s2", a.stop_deceleration_m_per_s2, Positive),
            ("saturation_time_s", a.saturation_time_s, Positive),
            ("scale_disagreement_limit_mm", a.scale_disagreement_limit_mm, UpTo(1e3 * TRAVEL_LIMIT_M)),
            ("fastest_mm_per_s", a.fastest_mm_per_s, Positive),
            ("frozen_encoder_limit_mm", a.frozen_encoder_limit_mm, Positive),
            ("motor_mass_kg", a.motor_mass_kg, NotNegative),
            ("table_mass_kg", a.table_mass_kg, NotNegative),
            ("stiffness_n_per_um", a.stiffness_n_per_um, Positive),
            ("damping_n_s_per_m", a.damping_n_s_per_m, NotNegative),
            ("coulomb_n", a.coulomb_n, NotNegative),
            ("viscous_n_s_per_m", a.viscous_n_s_per_m, NotNegative),
            ("motor_coulomb_n", a.motor_coulomb_n, NotNegative),
            ("presliding_stiffness_n_per_um", a.presliding_stiffness_n_per_um, Positive),
            ("presliding_damping_n_s_per_m", a.presliding_damping_n_s_per_m, NotNegative),
            ("plant_tolerance_percent", a.plant_tolerance_percent, UpTo(100.0)),
            ("lead_mm", a.lead_mm, Positive),
            ("resolver_pole_pairs", a.resolver_pole_pairs.map(f64::from), Positive),
            ("dual_feedback_time_constant_s", a.dual_feedback_time_constant_s, Positive),
        ];
        for (name, value, range) in numbers {
            if let Some(value) = value {
                range.check(&format!("{}.{name}", self.key), value, self.document)?;
            }
        }
        Ok(())
    }

    /// Some of the controller's keys without the others would silently leave out the motor stage.
    fn controller(&self) -> Result<(), InputError> {
        let axis = self.axis;
        let needed = [
            ("controller", axis.controller.is_some()),
            ("position_gain_per_s", axis.position_gain_per_s.is_some()),
            ("velocity_gain_n_s_per_m", axis.velocity_gain_n_s_per_m.is_some()),
        ];
        let optional = [
            ("feedforward_percent", axis.feedforward_percent.is_some()),
            ("velocity_integral_time_s", axis.velocity_integral_time_s.is_some()),
            ("force_limit_n", axis.force_limit_n.is_some()),
            ("smoothing_s", axis.smoothing_s.is_some()),
            ("smoothing_jerk_s", axis.smoothing_jerk_s.is_some()),
            ("smoothing_time_constant_s", axis.smoothing_time_constant_s.is_some()),
            ("notch_frequency_hz", axis.notch_frequency_hz.is_some()),
            ("notch_width_hz", axis.notch_width_hz.is_some()),
            ("notch_depth", axis.notch_depth.is_some()),
            ("low_pass_frequency_hz", axis.low_pass_frequency_hz.is_some()),
            ("low_pass_damping_ratio", axis.low_pass_damping_ratio.is_some()),
            ("travel_mm", axis.travel_mm.is_some()),
            ("following_error_limit_mm", axis.following_error_limit_mm.is_some()),
            ("stop_deceleration_m_per_s2", axis.stop_deceleration_m_per_s2.is_some()),
            ("saturation_time_s", axis.saturation_time_s.is_some()),
            ("scale_disagreement_limit_mm", axis.scale_disagreement_limit_mm.is_some()),
            ("fastest_mm_per_s", axis.fastest_mm_per_s.is_some()),
            ("frozen_encoder_limit_mm", axis.frozen_encoder_limit_mm.is_some()),
        ];
        let present = needed.iter().chain(&optional).find(|(_, present)| *present);
        let missing = needed.iter().find(|(_, present)| !present);
        if let (Some((present, _)), Some((missing, _))) = (present, missing) {
            return Err(self.refuse(missing, &format!("this key, as {present} is given")));
        }
        if let Some(limit_mm) = axis.frozen_encoder_limit_mm {
            let most_mm = axis.following_error_limit_mm.unwrap_or(1e3 * servo::FOLLOWING_ERROR_LIMIT_M);
            if limit_mm > most_mm {
                let what = format!("no more than following_error_limit_mm, {most_mm}");
                return Err(self.refuse("frozen_encoder_limit_mm", &what));
            }
        }
        if axis.feedback == Feedback::Dual && axis.dual_feedback_time_constant_s.is_none() {
            let what = "this key, as feedback is \"dual\"";
            return Err(self.refuse("dual_feedback_time_constant_s", what));
        }
        Ok(())
    }

    fn mechanics(&self) -> Result<(), InputError> {
        let axis = self.axis;
        let masses = [("motor_mass_kg", axis.motor_mass_kg), ("table_mass_kg", axis.table_mass_kg)];
        let massless = masses.iter().find(|(_, mass)| mass.unwrap_or(0.0) <= 0.0);
        if let (Some((key, _)), false) = (massless, axis.is_rigid()) {
            return Err(self.refuse(key, "a mass above 0, as stiffness_n_per_um is given"));
        }
        let presliding = axis.presliding_stiffness_n_per_um;
        if presliding.is_none() && axis.presliding_damping_n_s_per_m.is_some() {
            let what = "this key, as presliding_damping_n_s_per_m is given";
            return Err(self.refuse("presliding_stiffness_n_per_um", what));
        }
        if let Some(curve) = &axis.friction_curve {
            if axis.coulomb_n.is_some() {
                return Err(self.refuse("coulomb_n", "no such key, as friction_curve is given"));
            }
            curve.check().map_err(|expected| self.refuse("friction_curve", expected))?;
            if presliding.is_some() && matches!(curve, Curve::FallingRising(_)) {
                let what = "no such key, as a falling_rising curve leads through zero by itself";
                return Err(self.refuse("presliding_stiffness_n_per_um", what));
            }
        }
        // The bristles bend by coulomb / stiffness: without Coulomb friction there are none. A curve that leads
        // through zero has its own way from one direction to the other.
        let is_piecewise = matches!(axis.friction_curve, Some(Curve::Piecewise(_)));
        if presliding.is_some() && axis.coulomb_n.unwrap_or(0.0) <= 0.0 && !is_piecewise {
            let what = "a friction above 0, as presliding_stiffness_n_per_um is given";
            return Err(self.refuse("coulomb_n", what));
        }
        Ok(())
    }
}

impl Context<'_> {
    /// Whether there is something for an effect to act on.
    fn place(&self, effect: &Effect, key: &str, machine: &Machine) -> Result<(), InputError> {
        let what = match effect {
            Effect::Windup(windup) if windup.friction_n.is_some() => {
                if !self.axis.has_mass() {
                    return Ok(());
                }
                return Err(self
                    .document
                    .refuse(&format!("{key}.friction_n"), "no such key, as masses are given"));
            }
            Effect::Windup(_) if self.axis.is_rigid() && machine.structure.is_none() => {
                "this effect where stiffness_n_per_um is given: a rigid axis does not wind up"
            }
            Effect::Presliding(_) if self.axis.presliding_stiffness_n_per_um.is_some() => {
                "this effect where presliding_stiffness_n_per_um is not given"
            }
            Effect::Presliding(_) if self.axis.coulomb_n.unwrap_or(0.0) <= 0.0 => {
                "this effect where coulomb_n is above 0"
            }
            Effect::Squareness(_) if machine.axis.len() < 2 => "this effect where there is another axis",
            Effect::VelocityLag(lag) => {
                let longest_ms = VelocityLag::longest_ms(servo::rates(machine));
                return Range::UpTo(longest_ms).check(&format!("{key}.ms"), lag.ms, self.document);
            }
            Effect::Resonance(resonance) if resonance.channel != Channel::Tool => {
                return Err(self.document.refuse(&format!("{key}.channel"), "\"tool\""));
            }
            _ => return Ok(()),
        };
        Err(self.document.refuse(&format!("{key}.name"), what))
    }
}

/// Reads each effect alone: within the whole file serde loses the place of what is wrong in one.
pub(super) fn effects(document: &Document<'_>) -> Result<(), InputError> {
    for axis in document.children("axis") {
        let nominal = format!("{axis}.nominal");
        for effect in entries(axis, document).into_iter().chain(entries(&nominal, document)) {
            let name_key = format!("{effect}.name");
            let name: String = document.deserialize_at(&name_key)?;
            if !NAMES.contains(&name.as_str()) {
                let what = format!("one of {}", NAMES.join(", "));
                return Err(document.refuse(&name_key, &what));
            }
            numbers(effect, document)?;
            document.deserialize_at::<Effect>(effect)?;
        }
    }
    Ok(())
}

/// Keys of the `[[axis.NAME.effect]]` entries of an axis.
fn entries<'d>(axis: &str, document: &'d Document<'_>) -> Vec<&'d str> {
    let inside = document.children(&format!("{axis}.effect")).into_iter();
    // Were it a table by mistake, these would be its keys.
    inside.filter(|key| key.ends_with(']')).collect()
}

/// The parameters of an effect are numbers, but for the two that name something.
fn numbers(effect: &str, document: &Document<'_>) -> Result<(), InputError> {
    let names = ["name", "source", "channel"].map(|name| format!("{effect}.{name}"));
    for key in document.children(effect) {
        if names.iter().any(|name| name == key) {
            document.deserialize_at::<String>(key)?;
        } else if !document.is_number(key) {
            return Err(document.refuse(key, "a number"));
        }
    }
    Ok(())
}

/// Values at which an effect means nothing, or divides by zero.
fn parameters(effect: &Effect, key: &str, document: &Document<'_>) -> Result<(), InputError> {
    for (name, value) in effect.parameters() {
        let range = match name {
            "period_mm" | "presliding_mm" | "time_constant_s" | "velocity_mm_s" | "frequency_hz"
            | "stiffness_n_per_um" => Range::Positive,
            "width_um" | "damping_ratio" | "static_excess_n" | "friction_n" | "damping_n_s_per_m" => {
                Range::NotNegative
            }
            "ms" => Range::Within(LONGEST_LATENCY_MS),
            _ => Range::Signed,
        };
        range.check(&format!("{key}.{name}"), value, document)?;
    }
    match effect {
        Effect::ServoMismatch(mismatch) if mismatch.factor() <= 0.0 => {
            Err(document.refuse(&format!("{key}.percent"), "a number above -100"))
        }
        _ => Ok(()),
    }
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
