//! Scores of traces in JSON.

use super::*;

pub fn truth(name: &'static str, axis: &'static str, parameters: &[(&'static str, f64)]) -> Truth {
    Truth { name, axis, parameters: parameters.to_vec(), reference: None, phase_rad: 0.0 }
}

pub fn found(name: &str, axis: &str, parameters: &Value) -> Value {
    json!({"name": name, "axis": axis, "parameters": parameters})
}

#[test]
fn a_case_is_exact_if_all_names_and_axes_are_right() {
    let truths = [truth("backlash", "x", &[("width_um", 10.0)]), truth("squareness", "x", &[])];
    let named = |effects: &[Value]| Outcome::new(1, &truths, &json!({"effects": effects}));
    let both = [found("squareness", "x", &json!({})), found("backlash", "x", &json!({}))];
    assert!(named(&both).is_exact());
    let wrong_axis = [both[0].clone(), found("backlash", "y", &json!({}))];
    let outcome = named(&wrong_axis);
    assert!(!outcome.is_exact());
    assert_eq!(outcome.missed(), [&truths[0]]);
    assert_eq!(outcome.false_finds(), [&("backlash".to_owned(), "y".to_owned())]);
    assert!(!named(&both[..1]).is_exact());
}

#[test]
fn an_effect_from_outside_the_catalogue_must_be_described() {
    let truths = [
        truth("vibration", "x", &[("frequency_hz", 119.0)]),
        truth("local_defect", "y", &[("centre_mm", 10.0), ("width_mm", 8.0)]),
    ];
    let described = |unexplained: Value| {
        let outcome = Outcome::new(1, &truths, &json!({"effects": [], "unexplained": unexplained}));
        assert!(outcome.is_exact() && !outcome.is_clean());
        outcome.described
    };
    let time = |hz: f64| json!({"axis": "x", "variable": "time", "frequency_hz": hz});
    let position = |mm: f64| json!({"axis": "y", "variable": "position", "centre_mm": mm});
    assert_eq!(described(json!([time(120.4), position(17.9)])), [true, true]);
    assert_eq!(described(json!([time(120.6), position(18.1)])), [false, false]);
    assert_eq!(described(json!([])), [false, false]);
}

#[test]
fn errors_are_relative_and_coverage_is_that_of_the_interval() {
    let truths = [truth("backlash", "x", &[("width_um", 10.0)])];
    let width = |value: f64, ci95: [f64; 2]| {
        let effects = [found("backlash", "x", &json!({"width_um": {"value": value, "ci95": ci95}}))];
        Outcome::new(1, &truths, &json!({"effects": effects})).estimates.remove(0)
    };
    let inside = width(9.5, [8.9, 10.1]);
    assert!((inside.error() - 0.05).abs() < 1e-12);
    assert!(inside.is_covered());
    assert!(!width(9.5, [9.4, 9.6]).is_covered());
}

#[test]
fn effects_of_one_name_are_told_apart_by_their_period() {
    let period = |value: f64, amplitude: f64| {
        let exact = |value: f64| json!({"value": value, "ci95": [value, value]});
        found("pitch_cyclic", "x", &json!({"amplitude_um": exact(amplitude), "period_mm": exact(value)}))
    };
    let trace = json!({"effects": [period(10.0, 5.0), period(37.2, 2.5)]});
    let lead = [truth("pitch_cyclic", "x", &[("amplitude_um", 5.0), ("period_mm", 10.0)])];
    let belt = [truth("belt_37mm", "x", &[("amplitude_um", 2.0), ("period_mm", 37.0)])];
    let outcome = Outcome::new(1, &lead, &trace).with_kind(Kind::Foreign, &belt, &trace);
    let amplitudes: Vec<f64> =
        outcome.estimates.iter().filter(|e| !e.is_declared()).map(Estimate::error).collect();
    assert_eq!(amplitudes.len(), 2);
    assert!(amplitudes[0] < 1e-12 && (amplitudes[1] - 0.25).abs() < 1e-12, "{amplitudes:?}");
}

/// A second wave under the name of a true one is false, and certain although the true one is certain, too; 1.9 % are within 2 %.
#[test]
fn a_wave_with_another_period_is_another_effect() {
    let wave = |mm: f64, certainty: &str| {
        let parameters = json!({"period_mm": {"value": mm, "ci95": [mm, mm]}});
        json!({"name": "resolver_dividing", "axis": "y", "parameters": parameters, "certainty": certainty})
    };
    let truths = [truth("resolver_dividing", "y", &[("amplitude_um", 6.0), ("period_mm", 10.0)])];
    let score = |effects: &[Value]| {
        let outcome = Outcome::new(1, &truths, &json!({"effects": effects}));
        [
            outcome.missed().len(),
            outcome.false_finds().len(),
            outcome.certain_false_finds().len(),
            outcome.duplicates(),
        ]
    };
    let right = wave(10.19, "certain");
    assert_eq!(score(std::slice::from_ref(&right)), [0, 0, 0, 0]);
    assert_eq!(score(&[right.clone(), wave(20.0, "certain")]), [0, 1, 1, 0]);
    assert_eq!(score(&[right.clone(), wave(20.0, "ambiguous")]), [0, 1, 0, 0]);
    assert_eq!(score(&[right.clone(), right]), [0, 0, 0, 1]);
    assert_eq!(score(&[wave(20.0, "certain")]), [1, 1, 1, 0]);
}

#[test]
fn an_effect_that_stands_for_something_outside_is_not_false_but_others_are() {
    let shape = [truth("pitch_shape", "y", &[])];
    let of = |names: &[(&str, &str)]| {
        let effects: Vec<_> = names.iter().map(|(name, axis)| found(name, axis, &json!({}))).collect();
        let trace = json!({"effects": effects, "data_faults": [
            {"kind": "slip", "axis": "x", "at_s": 1.0}, {"kind": "slip", "axis": "x", "at_s": 2.0}]});
        Outcome::new(1, &[], &trace).with_kind(Kind::Shape, &shape, &trace)
    };
    let accepted = of(&[("pitch_progressive", "y")]);
    assert!(accepted.is_exact() && !accepted.is_clean());
    assert_eq!(accepted.false_faults(), [&("slip".to_owned(), "x".to_owned())]);
    let false_name = of(&[("pitch_cyclic", "y"), ("pitch_cyclic", "y"), ("pitch_progressive", "x")]);
    assert_eq!(false_name.false_finds().len(), 2);
    assert!(!false_name.is_exact());
    assert_eq!(accepted.name(), "shape case 1");
}

#[test]
fn ratios_are_those_of_the_held_out_logs() {
    let residual = json!([
        {"axis": "x", "channel": "table", "after_um": {"fit": 9.0, "validate": 0.3}, "noise_um": 0.2},
        {"axis": "y", "channel": "force", "after_n": {"fit": 9.0, "validate": 4.0}, "noise_n": 2.0},
    ]);
    let outcome = Outcome::new(1, &[], &json!({"residual": residual, "effects": []}));
    assert_eq!(outcome.ratios[1], ("y force".to_owned(), 2.0));
    assert!((outcome.ratios[0].1 - 1.5).abs() < 1e-12);
    assert!(outcome.is_clean() && outcome.is_exact());
}

#[test]
fn a_false_effect_is_certain_unless_it_is_called_ambiguous() {
    let of = |certainty: Value| {
        let mut effect = found("intalk", "x", &json!({}));
        effect["certainty"] = certainty;
        Outcome::new(1, &[], &json!({"effects": [effect]}))
    };
    let [certain, unsaid, ambiguous] = [json!("certain"), Value::Null, json!("ambiguous")]
        .map(|certainty| of(certainty).certain_false_finds().len());
    assert_eq!((certain, unsaid, ambiguous), (1, 1, 0));
    assert_eq!(of(json!("ambiguous")).false_finds().len(), 1);
}
