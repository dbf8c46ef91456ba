//! Effects and their parameters in short form, for tables.

use files::format::{fixed, significant};
use model::effects::{Effect, Parameter};

/// Name and parameters of an effect, for a table; of a list, its least and greatest value.
#[must_use]
pub fn brief(effect: &Effect, is_rotary: bool) -> String {
    let name = effect.name().replace('_', " ");
    let from = effect.distinction().source().map_or_else(String::new, |source| format!(" from {source}"));
    let number = |value: f64| if value.abs() < 0.1 { fixed(value, 4) } else { significant(value, 3) };
    let value = |same: &[(&Parameter, f64)]| {
        let (parameter, first) = same[0];
        let [least, greatest] = numerics::min_max(same.iter().map(|(_, value)| *value));
        let range = if parameter.is_list {
            format!("{} to {}", number(least), number(greatest))
        } else {
            number(first)
        };
        format!("{} {}", parameter.title(), parameter.unit.with(&range, is_rotary)).trim().to_owned()
    };
    let declared = effect.declared_parameters().into_iter().zip(effect.values());
    let shown: Vec<_> = declared.filter(|(parameter, _)| parameter.period.is_none()).collect();
    let lists = shown.chunk_by(|(a, _), (b, _)| a.is_list && a.key == b.key);
    format!("{name}{from}: {}", lists.map(value).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_shown_by_its_range() {
        let map = "name = 'friction_map'\npositions_mm = [-20, 30, 80]\nfriction_n = [4, -6, 2]";
        assert_eq!(
            brief(&toml::from_str(map).unwrap(), false),
            "friction map: positions −20.0 to 80.0 mm, friction −6.00 to 4.00 N"
        );
    }

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
