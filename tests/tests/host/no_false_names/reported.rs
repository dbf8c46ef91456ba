//! What a trace reports, compared with the truth.

use trace::AxisIdentification;
use trace::certainty::is_certain;
use trace::judge::found_effect::FoundEffect;
use trace::{Identification, verdict};

/// Half widths of a 95 % interval that a value may be off: three standard deviations, which one of 400 true values exceeds.
pub const HALF_WIDTHS: f64 = 1.5;

/// Axes and names of the effects found, by axis.
pub fn named(trace: &Identification) -> Vec<(&str, &str)> {
    let of_axis =
        |axis: &'_ AxisIdentification| axis.found.iter().map(|found| found.effect.name()).collect::<Vec<_>>();
    let mut named: Vec<_> = trace
        .axes()
        .iter()
        .flat_map(|axis| of_axis(axis).into_iter().map(|name| (axis.axis.as_str(), name)))
        .collect();
    named.sort_unstable();
    named
}

/// Axes and names of the effects that are reported as facts.
pub fn certain(trace: &Identification) -> Vec<(&str, &str)> {
    let of_axis = |axis| move |found: &_| is_certain(axis, found);
    let mut certain = Vec::new();
    for axis in trace.axes() {
        let names = axis.found.iter().filter(|found| of_axis(axis)(found)).map(|found| found.effect.name());
        certain.extend(names.map(|name| (axis.axis.as_str(), name)));
    }
    certain
}

/// Keys of the declared values that are reported to be outside their tolerance.
pub fn beyond_tolerance(trace: &Identification) -> Vec<&str> {
    let values = trace.axes().iter().flat_map(|axis| &axis.declared_values);
    values.filter(|value| value.is_beyond_tolerance).map(|value| value.key).collect()
}

/// Everything that a failed assertion should show.
pub fn context(trace: &Identification) -> String {
    format!("{:?}\n{}", verdict::of(trace), report::sentences::summary(trace, None).join("\n"))
}

/// Asserts that exactly these effects were found, given by axis and then name.
pub fn assert_named(trace: &Identification, expected: &[(&str, &str)]) {
    assert_eq!(named(trace), expected, "{}", context(trace));
}

/// The effect of this name on an axis.
pub fn found<'a>(trace: &'a Identification, axis: usize, name: &str) -> &'a FoundEffect {
    let mut found = trace.axes()[axis].found.iter().filter(|found| found.effect.name() == name);
    found.next().unwrap_or_else(|| panic!("{name}: {}", context(trace)))
}

/// Asserts that a parameter of an effect agrees with the truth within its interval, whose half width is above zero and at
/// most `max_half_width`, in the unit of the key.
pub fn assert_value(found: &FoundEffect, key: &str, truth: f64, max_half_width: f64) {
    let parameters = found.effect.parameters();
    let index = parameters.iter().position(|(name, _)| *name == key).unwrap();
    let (value, half_width) = (parameters[index].1, found.half_widths[index]);
    let context = format!("{key}: {value} ± {half_width}, truth {truth}");
    assert!((value - truth).abs() <= HALF_WIDTHS * half_width, "{context}");
    assert!(half_width > 0.0 && half_width <= max_half_width, "{context}");
}
