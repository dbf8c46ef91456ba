//! Keys of rotary axes: the text of a machine file with them, as one with the keys of linear axes, and back.
//!
//! Inside, an axis has the keys of linear axes, with degrees for mm, N·m for N and 1000° for a metre
//! ([`Unit`](crate::effects::Unit)). This is the one place where they meet those of rotary axes, which are in kg·m², N·m/rad and
//! degrees. An axis is rotary if one of its keys is.

use std::f64::consts::PI;

use files::document::Document;
use files::error::InputError;

use crate::axis::{KEYS as AXIS_KEYS, KeyNames, Settings};
use crate::effects::KINDS;

/// 1000°, which replace a metre, in radians: the factor from a value per radian to one per 1000°.
const RADIANS_PER_KDEG: f64 = 1000.0 * PI / 180.0;

/// A key of a rotary axis, the key of a linear axis in whose place it stands, and the factor from its value to that of the latter;
/// `None`: the values are the same.
struct RotaryKey {
    rotary: &'static str,
    linear: &'static str,
    factor: Option<f64>,
}

/// Keys of an axis that are not those of an effect.
const KEYS: &[RotaryKey] = &[
    key("motor_inertia_kg_m2", "motor_mass_kg", Some(RADIANS_PER_KDEG)),
    key("table_inertia_kg_m2", "table_mass_kg", Some(RADIANS_PER_KDEG)),
    key("stiffness_nm_per_rad", "stiffness_n_per_um", Some(1e-6 * RADIANS_PER_KDEG)),
    key("damping_nm_s_per_rad", "damping_n_s_per_m", Some(RADIANS_PER_KDEG)),
    key("coulomb_nm", "coulomb_n", None),
    key("viscous_nm_s_per_rad", "viscous_n_s_per_m", Some(RADIANS_PER_KDEG)),
    key("motor_coulomb_nm", "motor_coulomb_n", None),
    key("presliding_stiffness_nm_per_rad", "presliding_stiffness_n_per_um", Some(1e-6 * RADIANS_PER_KDEG)),
    key("presliding_damping_nm_s_per_rad", "presliding_damping_n_s_per_m", Some(RADIANS_PER_KDEG)),
    key("lead_deg", "lead_mm", None),
    key("velocity_gain_nm_s_per_rad", "velocity_gain_n_s_per_m", Some(RADIANS_PER_KDEG)),
    key("torque_limit_nm", "force_limit_n", None),
    key("preload_nm", "preload_n", None),
    key("pid_bias_deg_per_s", "pid_bias_mm_per_s", None),
    key("pid_deadband_mdeg", "pid_deadband_um", None),
    key("pid_max_error_deg", "pid_max_error_mm", None),
    key("pid_max_error_i_deg_s", "pid_max_error_i_mm_s", None),
    key("pid_max_error_d_deg_per_s", "pid_max_error_d_mm_per_s", None),
    key("pid_max_output_deg_per_s", "pid_max_output_mm_per_s", None),
    key("gain_schedule_position_deg", "gain_schedule_position_mm", None),
    key("gain_schedule_speed_deg_per_s", "gain_schedule_speed_mm_per_s", None),
    key("travel_deg", "travel_mm", None),
    key("following_error_limit_deg", "following_error_limit_mm", None),
    key("stop_deceleration_deg_per_s2", "stop_deceleration_m_per_s2", Some(1e-3)),
    key("scale_disagreement_limit_deg", "scale_disagreement_limit_mm", None),
    key("fastest_deg_per_s", "fastest_mm_per_s", None),
    key("frozen_encoder_limit_deg", "frozen_encoder_limit_mm", None),
    key("gantry_skew_limit_deg", "gantry_skew_limit_mm", None),
    key("gantry_offset_deg", "gantry_offset_mm", None),
];

/// Keys of what a fit says of the zeros and of the drive of an axis.
const LOG_OFFSETS: &[RotaryKey] = &[
    key("table_zero_mdeg", "table_zero_um", None),
    key("tool_zero_mdeg", "tool_zero_um", None),
    key("unexplained_mdeg", "unexplained_um", None),
    key("velocity_friction_deg_per_s2", "velocity_friction_m_per_s2", Some(1e-3)),
];

const fn key(rotary: &'static str, linear: &'static str, factor: Option<f64>) -> RotaryKey {
    RotaryKey { rotary, linear, factor }
}

/// Key and value of a setting as they stand in a file whose axes have these names of keys.
#[must_use]
pub fn written(linear_key: &'static str, value: f64, names: KeyNames) -> (&'static str, f64) {
    match KEYS.iter().find(|key| key.linear == linear_key) {
        Some(key) if names == KeyNames::Rotary => (key.rotary, value / key.factor.unwrap_or(1.0)),
        _ => (linear_key, value),
    }
}

/// A sentence on a key of an axis with the names of its file.
#[must_use]
pub fn in_words(sentence: &str, names: KeyNames) -> String {
    let words = sentence.split(' ').map(|word| {
        let key = KEYS.iter().find(|key| key.linear == word.trim_end_matches([',', '.']));
        key.filter(|_| names == KeyNames::Rotary)
            .map_or_else(|| word.to_owned(), |key| word.replace(key.linear, key.rotary))
    });
    words.collect::<Vec<_>>().join(" ")
}

/// Whether no key of an axis is one that has another name on rotary axes.
#[must_use]
pub fn is_neutral(settings: &Settings) -> bool {
    let is_given =
        |known: &RotaryKey| AXIS_KEYS.iter().any(|key| key.name == known.linear && (key.is_given)(settings));
    !KEYS.iter().any(is_given)
}

/// A text with the keys of linear axes.
pub(super) struct Linear {
    pub text: String,
    /// Names of the axes that had keys of rotary ones.
    pub axes: Vec<String>,
    /// Each key that was changed: as it is now, and as it was.
    pub renamed: Vec<(String, String)>,
}

/// The document with the keys of linear axes. Lines stay where they are.
///
/// # Errors
/// If an axis has keys of both.
pub(super) fn to_linear(document: &Document<'_>) -> Result<Linear, InputError> {
    let mut axes = Vec::new();
    let mut renaming = Renaming::default();
    for axis in document.children("axis") {
        let before = renaming.renamed.len();
        renaming.axis(document, axis, Direction::ToLinear);
        let Some((_, first)) = renaming.renamed.get(before) else { continue };
        let is_linear = |key: &&str| KEYS.iter().any(|known| known.linear == last(key));
        if let Some(mixed) = document.children(axis).into_iter().find(is_linear) {
            let problem = format!("expected a key of a rotary axis, as {} is one", last(first));
            return Err(document.error_at(mixed, &problem));
        }
        // Also of keys that are missing: an error may ask for one.
        renaming.renamed.extend(KEYS.iter().map(|key| {
            let [linear, rotary] = [key.linear, key.rotary].map(|key| format!("{axis}.{key}"));
            (linear, rotary)
        }));
        axes.push(axis["axis.".len()..].to_owned());
    }
    let text = document.replaced(&renaming.changes);
    Ok(Linear { text, axes, renamed: renaming.renamed })
}

/// The text of a machine file, whose keys are those of linear axes, with those of rotary axes on these axes.
pub(super) fn to_rotary(text: String, axes: &[&String]) -> String {
    if axes.is_empty() {
        return text;
    }
    let Ok(document) = Document::parse(&text, "machine") else { return text };
    let mut renaming = Renaming::default();
    for axis in axes {
        renaming.axis(&document, &format!("axis.{axis}"), Direction::ToRotary);
    }
    document.replaced(&renaming.changes)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Direction {
    ToLinear,
    ToRotary,
}

/// What changes in a text.
#[derive(Default)]
struct Renaming {
    /// Byte ranges and what replaces them.
    changes: Vec<(std::ops::Range<usize>, String)>,
    /// Paths of keys: new and old.
    renamed: Vec<(String, String)>,
}

impl Renaming {
    /// The keys of an axis, of its nominal values and tolerances, of its zeros, and of its effects.
    fn axis(&mut self, document: &Document<'_>, axis: &str, direction: Direction) {
        self.table(document, axis, (KEYS, direction), true);
        self.table(document, &format!("{axis}.nominal"), (KEYS, direction), true);
        self.table(document, &format!("{axis}.tolerance_percent"), (KEYS, direction), false);
        self.table(document, &format!("{axis}.log_offsets"), (LOG_OFFSETS, direction), true);
        for effects in [format!("{axis}.effect"), format!("{axis}.nominal.effect")] {
            for effect in document.children(&effects) {
                self.effect(document, effect, direction);
            }
        }
    }

    fn table(
        &mut self,
        document: &Document<'_>,
        table: &str,
        (keys, direction): (&[RotaryKey], Direction),
        has_values: bool,
    ) {
        for path in document.children(table) {
            let is_it = |key: &&RotaryKey| last(path) == key.old_and_new(direction)[0];
            let Some(key) = keys.iter().find(is_it) else { continue };
            self.key(document, path, key.old_and_new(direction)[1]);
            if let Some(factor) = key.factor.filter(|_| has_values) {
                let factor = if direction == Direction::ToLinear { factor } else { 1.0 / factor };
                let scaled = document.number(path).map(|value| to_15_digits(value * factor));
                self.changes.extend(scaled.map(|value| (document.value_span(path), format!("{value:?}"))));
            }
        }
    }

    /// The keys of an effect have the same values on rotary axes.
    fn effect(&mut self, document: &Document<'_>, effect: &str, direction: Direction) {
        let Some(name) = document.word(&format!("{effect}.name")) else { return };
        for parameter in KINDS.iter().filter(|kind| kind.name == name).flat_map(|kind| kind.parameters) {
            let [old, new] = match direction {
                Direction::ToLinear => [true, false].map(|is_rotary| parameter.key_on(is_rotary)),
                Direction::ToRotary => [false, true].map(|is_rotary| parameter.key_on(is_rotary)),
            };
            let path = format!("{effect}.{old}");
            let is_done = self.renamed.iter().any(|(_, old)| *old == path);
            if old != new && document.has(&path) && !is_done {
                self.key(document, &path, &new);
            }
        }
    }

    fn key(&mut self, document: &Document<'_>, path: &str, new: &str) {
        let parent = &path[..path.len() - last(path).len()];
        self.changes.push((document.name_span(path), new.to_owned()));
        self.renamed.push((format!("{parent}{new}"), path.to_owned()));
    }
}

impl RotaryKey {
    const fn old_and_new(&self, direction: Direction) -> [&'static str; 2] {
        match direction {
            Direction::ToLinear => [self.rotary, self.linear],
            Direction::ToRotary => [self.linear, self.rotary],
        }
    }
}

/// The last part of a path of keys.
fn last(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

/// A number without the last digit of a double, which a factor and its inverse do not keep.
fn to_15_digits(value: f64) -> f64 {
    format!("{value:.14e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Machine;
    use files::log::{AxisLog, Log, Unit};

    const TEXT: &str = "name = 'robot'\nsample_rate_hz = 1000.0\n[axis.c]\nmotor_inertia_kg_m2 = 0.134\ntable_inertia_kg_m2 = 0.5\n\
        stiffness_nm_per_rad = 2e5\nviscous_nm_s_per_rad = 3.5\ncoulomb_nm = 12.0\nlead_deg = 3.6\n\
        [axis.c.tolerance_percent]\nmotor_inertia_kg_m2 = 8.0\n[[axis.c.effect]]\nname = 'backlash'\nwidth_mdeg = 4.0\n";

    /// τ = J·α with α in rad/s² is τ = m·a with a in 1000°/s²: m = J·1000·π/180 = 17.453·J. A torsional stiffness of 2·10⁵ N·m/rad is
    /// 2·10⁵·π/180 N·m a degree, a thousandth of it a millidegree.
    #[test]
    fn values_per_radian_become_those_per_1000_degrees() {
        let machine = Machine::parse(TEXT, "m.toml").unwrap();
        let mechanics = &machine.axis["c"].settings.mechanics;
        let is = |value: Option<f64>, expected: f64| (value.unwrap() / expected - 1.0).abs() < 1e-12;
        assert!(is(mechanics.motor_mass_kg, 0.134 * 17.453_292_519_943_295), "{mechanics:?}");
        assert!(is(mechanics.stiffness_n_per_um, 2e5 * PI / 180.0 * 1e-3), "{mechanics:?}");
        assert!(is(mechanics.viscous_n_s_per_m, 3.5 * 17.453_292_519_943_295));
        assert_eq!((mechanics.coulomb_n, mechanics.lead_mm), (Some(12.0), Some(3.6)));
        assert!(is(Some(machine.axis["c"].settings.tolerance("motor_mass_kg")), 0.08));
    }

    #[test]
    fn a_rotary_axis_is_written_with_its_own_keys_and_numbers() {
        let machine = Machine::parse(TEXT, "m.toml").unwrap();
        let written = machine.to_toml();
        for line in [
            "motor_inertia_kg_m2 = 0.134\n",
            "stiffness_nm_per_rad = 200000.0\n",
            "width_mdeg = 4.0\n",
            "motor_inertia_kg_m2 = 8.0\n",
        ] {
            assert!(written.contains(line), "{line:?} in {written}");
        }
        assert_eq!(Machine::parse(&written, "m.toml").unwrap(), machine);
    }

    #[test]
    fn errors_name_the_key_of_the_file() {
        let refused = |text: &str| Machine::parse(text, "m.toml").unwrap_err().to_string();
        let negative = TEXT.replace("0.134", "-0.134");
        let expected =
            "m.toml: line 4: axis.c.motor_inertia_kg_m2: expected a number not below 0, found -0.134";
        assert_eq!(refused(&negative), expected);
        let word = TEXT.replace("12.0", "'much'");
        let expected = "m.toml: line 8: axis.c.coulomb_nm: expected a number, found 'much'";
        assert_eq!(refused(&word), expected);
        let missing = TEXT.replace("table_inertia_kg_m2 = 0.5\n", "");
        let expected = "m.toml: line 3: axis.c.table_inertia_kg_m2: expected a mass above 0, as stiffness_nm_per_rad is given, found none";
        assert_eq!(refused(&missing), expected);
        let mixed = TEXT.replace("coulomb_nm", "coulomb_n");
        let expected = "m.toml: line 8: axis.c.coulomb_n: expected a key of a rotary axis, as motor_inertia_kg_m2 is one";
        assert_eq!(refused(&mixed), expected);
    }

    /// Of an axis of which nothing else is known, the effects say that it is rotary.
    #[test]
    fn an_axis_with_the_effects_of_a_rotary_one_is_rotary() {
        let text = "name = 'm'\nsample_rate_hz = 1000.0\n[axis.c]\n[[axis.c.effect]]\nname = 'pitch_progressive'\n\
            slope_mdeg_per_kdeg = -288.0\n";
        let machine = Machine::parse(text, "m.toml").unwrap();
        assert_eq!(machine.axis["c"].settings.names, KeyNames::Rotary);
        assert_eq!(machine.axis["c"].effect[0].values(), [-288.0]);
        assert_eq!(Machine::parse(&machine.to_toml(), "m.toml").unwrap(), machine);
    }

    #[test]
    fn an_axis_with_the_zeros_of_a_rotary_one_is_rotary() {
        let text = "name = 'm'\nsample_rate_hz = 1000.0\n[axis.c]\n[axis.c.log_offsets]\ntable_zero_mdeg = -3.5\n\
            velocity_friction_deg_per_s2 = 900.0\n";
        let machine = Machine::parse(text, "m.toml").unwrap();
        let offsets = machine.axis["c"].log_offsets.unwrap();
        assert_eq!([offsets.table_zero_um, offsets.velocity_friction_m_per_s2], [Some(-3.5), Some(0.9)]);
        assert_eq!(machine.axis["c"].settings.names, KeyNames::Rotary);
        assert_eq!(Machine::parse(&machine.to_toml(), "m.toml").unwrap(), machine);
    }

    #[test]
    fn an_axis_is_named_as_its_logs_unless_a_key_says_otherwise() {
        let text = "name = 'm'\nsample_rate_hz = 1000.0\n[axis.a]\n[axis.b]\nlead_mm = 5.0\n[axis.x]\n";
        let units = [("a", Unit::Degree), ("b", Unit::Degree), ("x", Unit::Millimetre)];
        let axes = units.map(|(name, unit)| AxisLog::new(name, unit)).to_vec();
        let log = Log::new("log.csv", 0.0, 1e-3, axes);
        let named = Machine::parse(text, "m.toml").unwrap().named_as_logs([&log]);
        let names = named.axis.values().map(|axis| axis.settings.names);
        assert!(names.eq([KeyNames::Rotary, KeyNames::Linear, KeyNames::Linear]));
    }

    /// Each key of an axis with a length or force in its unit has a name for rotary axes, and no other has.
    #[test]
    fn every_key_in_mm_or_newtons_has_one_in_degrees_or_newton_metres() {
        let has_unit = |name: &str| {
            ["_mm", "_um", "_n", "_kg"].iter().any(|unit| name.ends_with(unit))
                || ["_mm_", "_n_", "_m_per"].iter().any(|unit| name.contains(unit))
        };
        for key in AXIS_KEYS {
            let is_known = KEYS.iter().any(|known| known.linear == key.name);
            assert_eq!(is_known, has_unit(key.name), "{}", key.name);
        }
    }
}
