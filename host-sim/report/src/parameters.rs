//! Effects and their parameters in short form, for tables.

use files::format::{fixed, significant};
use model::effects::{Effect, Parameter};

/// Name and parameters of an effect, for a table.
#[must_use]
pub fn brief(effect: &Effect, is_rotary: bool) -> String {
    let name = effect.name().replace('_', " ");
    let from = effect.distinction().source().map_or_else(String::new, |source| format!(" from {source}"));
    let value = |(parameter, value): (&Parameter, f64)| {
        let number = if value.abs() < 0.1 { fixed(value, 4) } else { significant(value, 3) };
        format!("{} {}", parameter.title(), parameter.unit.with(&number, is_rotary)).trim().to_owned()
    };
    let shown = effect.declared_parameters().iter().zip(effect.values());
    let shown = shown.filter(|(parameter, _)| parameter.period.is_none());
    format!("{name}{from}: {}", shown.map(value).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_is_named_without_its_unit() {
        let crosstalk: Effect =
            toml::from_str("name = 'crosstalk'\num_s2_per_m = 1.4147\nsource = 'y'").unwrap();
        assert_eq!(brief(&crosstalk, false), "crosstalk from y: 1.41 µm per m/s²");
        let ripple = "name = 'torque_ripple'\namplitude_n = 0.4438\nperiod_mm = 5.0\nphase_rad = 2.0";
        assert_eq!(
            brief(&toml::from_str(ripple).unwrap(), false),
            "torque ripple: amplitude 0.444 N, period 5.00 mm"
        );
    }
}
