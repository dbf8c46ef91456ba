//! Effects and their parameters as briefly as a table needs them.

use super::number::{fixed, significant};
use model::effects::Effect;
use trace::json::source;

/// How the names of parameters end, and the unit that this stands for; longer ones first.
const UNITS: [(&str, &str); 16] = [
    ("um_s2_per_m", "µm per m/s²"),
    ("um_per_m2", "µm/m²"),
    ("um_per_m", "µm/m"),
    ("n_per_um", "N/µm"),
    ("n_s_per_m", "N·s/m"),
    ("percent", "%"),
    ("n_per_m2", "N/m²"),
    ("n_per_m", "N/m"),
    ("mm_s", "mm/s"),
    ("um", "µm"),
    ("mm", "mm"),
    ("ms", "ms"),
    ("rad", "rad"),
    ("hz", "Hz"),
    ("n", "N"),
    ("s", "s"),
];

/// Name of a parameter, empty where its key is a unit only, and its unit.
#[must_use]
pub fn parameter(key: &str) -> (String, &'static str) {
    let of_unit = |(end, unit): &(&str, &'static str)| {
        let name = key.strip_suffix(end)?;
        (name.is_empty() || name.ends_with('_'))
            .then(|| (name.replace('_', " ").trim_end().to_owned(), *unit))
    };
    UNITS.iter().find_map(of_unit).unwrap_or_else(|| (key.replace('_', " "), ""))
}

/// Name and parameters of an effect, for a table.
#[must_use]
pub fn brief(effect: &Effect) -> String {
    let name = effect.name().replace('_', " ");
    let from = source(effect).map_or_else(String::new, |source| format!(" from {source}"));
    let value = |(key, value): (&str, f64)| {
        let (name, unit) = parameter(key);
        let value = if value.abs() < 0.1 { fixed(value, 4) } else { significant(value, 3) };
        format!("{name} {value} {unit}").trim().to_owned()
    };
    let shown = effect.parameters().into_iter().filter(|(key, _)| !key.starts_with("phase"));
    format!("{name}{from}: {}", shown.map(value).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::super::effect_text::tests::one_of_each;
    use super::*;

    #[test]
    fn a_parameter_is_named_without_its_unit() {
        assert_eq!(parameter("static_excess_n"), ("static excess".to_owned(), "N"));
        assert_eq!(parameter("velocity_mm_s"), ("velocity".to_owned(), "mm/s"));
        assert_eq!(parameter("um_per_m2"), (String::new(), "µm/m²"));
        assert_eq!(parameter("damping_ratio"), ("damping ratio".to_owned(), ""));
        let crosstalk: Effect =
            toml::from_str("name = 'crosstalk'\num_s2_per_m = 1.4147\nsource = 'y'").unwrap();
        assert_eq!(brief(&crosstalk), "crosstalk from y: 1.41 µm per m/s²");
        let ripple = "name = 'torque_ripple'\namplitude_n = 0.4438\nperiod_mm = 5.0\nphase_rad = 2.0";
        assert_eq!(
            brief(&toml::from_str(ripple).unwrap()),
            "torque ripple: amplitude 0.444 N, period 5.00 mm"
        );
    }

    #[test]
    fn every_effect_has_units_that_a_table_can_name() {
        for effect in one_of_each() {
            for (key, _) in effect.parameters() {
                assert!(!parameter(key).1.is_empty() || key == "damping_ratio", "{key}");
            }
        }
    }
}
