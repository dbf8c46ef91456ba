//! What a trace reports, compared with the truth.

use trace::outcome::AxisTrace;
use trace::validation::found_effect::FoundEffect;
use trace::{Trace, verdict};

/// Half widths of a 95 % interval that a value may be off: three standard deviations, which one of 400 true values exceeds.
pub const HALF_WIDTHS: f64 = 1.5;

/// Axes and names of the effects found, by axis.
pub fn named(trace: &Trace) -> Vec<(&str, &str)> {
    let of_axis =
        |axis: &'_ AxisTrace| axis.found.iter().map(|found| found.effect.name()).collect::<Vec<_>>();
    let mut named: Vec<_> = trace
        .axes
        .iter()
        .flat_map(|axis| of_axis(axis).into_iter().map(|name| (axis.axis.as_str(), name)))
        .collect();
    named.sort_unstable();
    named
}

/// Everything that a failed assertion should show.
pub fn context(trace: &Trace) -> String {
    format!("{:?}\n{}", verdict::of(trace), report::sentences::summary(trace).join("\n"))
}

/// Asserts that exactly these effects were found, given by axis and then name.
pub fn assert_named(trace: &Trace, expected: &[(&str, &str)]) {
    assert_eq!(named(trace), expected, "{}", context(trace));
}

/// The effect of this name on an axis.
pub fn found<'a>(trace: &'a Trace, axis: usize, name: &str) -> &'a FoundEffect {
    let mut found = trace.axes[axis].found.iter().filter(|found| found.effect.name() == name);
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
