//! Errors over the position are compensated where they are known.

use commissioning::compensate::prediction::TestMotion;
use commissioning::compensate::{Plan, mapped};

use super::runs::{PLAIN, contour_um, log, machine, plan, usual, with};

/// A map of 6 µm at its ends at ± `half_mm`, with a straight line between them; beyond them it is constant.
fn model(half_mm: f64) -> String {
    let keys = format!("positions_mm = [{:?}, {half_mm:?}]\nerror_um = [-6.0, 6.0]", -half_mm);
    with(PLAIN, &format!("name = \"pitch_map\"\n{keys}"))
}

/// The circle of 20 mm.
fn planned(half_mm: f64) -> (TestMotion, Plan) {
    let test = usual();
    let plan = plan(&machine(&model(half_mm)), &test);
    (test, plan)
}

/// Knots at ±18 mm, a circle of 20 mm: 2 mm beyond them, 6 % of the mapped 36 mm. The table ends at the knots, where the controller
/// holds its values; the motion is named, and its prediction has no bound.
#[test]
fn a_table_ends_with_the_knots_and_the_motion_that_leaves_it_is_named() {
    let (_, plan) = planned(18.0);
    let x = &plan.file.axis["x"];
    let [from, to] = x.mapped_mm.unwrap();
    assert!((from + 18.0).abs() < 1e-9 && (to - 18.0).abs() < 1e-9, "{from} {to}");
    let table = &x.compensation.pitch.as_ref().unwrap().forward;
    let end_m = table.start_m + table.spacing_m * (table.values.len() - 1) as f64;
    assert!((table.start_m + 0.018).abs() < 1e-9 && (end_m - 0.018).abs() < 1e-9, "{table:?}");
    let [(motion, beyond)] = &plan.beyond[..] else { panic!("{:?}", plan.beyond) };
    assert_eq!((motion.as_str(), beyond.len(), beyond[0].axis.as_str()), ("circle", 1, "x"));
    let sentence = beyond[0].sentence();
    assert!(
        sentence.contains("-20.0 to 20.0 mm and leaves the mapped travel, -18.0 to 18.0 mm"),
        "{sentence}"
    );
    assert!(sentence.contains("the tables of pitch error hold their last values"), "{sentence}");
    let [prediction] = &plan.file.predicted[..] else { panic!("one motion") };
    assert_eq!(prediction.beyond_mapped, ["x"]);
    assert!(prediction.bound_percent > 99.0, "no bound of 15 %: {prediction:?}");
    // The file says so wherever it is read.
    let text = plan.file.to_toml().unwrap();
    let read = commissioning::compensate::CompensationFile::parse(&text, "c.toml", &machine(PLAIN)).unwrap();
    assert_eq!(read, plan.file);
    let reached_m = |least, greatest| move |name: &str| (name == "x").then_some([least, greatest]);
    assert_eq!(mapped::beyond(&read, reached_m(-0.02, 0.018)).len(), 1);
    // One hundredth of 36 mm is the rounding of knots.
    assert!(mapped::beyond(&read, reached_m(-0.0182, 0.0183)).is_empty());
}

/// Within the knots nothing is named.
#[test]
fn within_the_knots_a_prediction_has_its_bound() {
    let (_, plan) = planned(21.0);
    assert!(plan.beyond.is_empty() && plan.file.predicted[0].beyond_mapped.is_empty());
    assert!((plan.file.predicted[0].bound_percent - 15.0).abs() < 1e-9);
}

/// Knots at ±10 mm, and a true error that turns back beyond them: −6 and 6 µm at ±10 mm, 6 and −6 µm at ±20 mm. The circle of 20 mm is
/// beyond them for two thirds of its time, so that a table that holds 6 µm would be wrong by 12 µm at its ends. The error over the
/// position is left out, and the machine is better than without compensation.
#[test]
fn far_beyond_its_knots_a_map_is_not_used() {
    let (test, plan) = planned(10.0);
    assert!(!plan.items.iter().any(|item| item.effect == "pitch_map"), "{:?}", plan.items);
    let listed = plan.not_compensated.iter().find(|not| not.effect == "pitch_map").unwrap();
    assert!(listed.why.contains("leave its map by more than a tenth"), "{listed:?}");
    assert!(plan.file.axis["x"].compensation.pitch.is_none());
    assert_eq!(plan.file.predicted[0].beyond_mapped, ["x"], "what is predicted there is not known either");
    let knots = "positions_mm = [-20.0, -10.0, 10.0, 20.0]\nerror_um = [6.0, -6.0, 6.0, -6.0]";
    let truth = machine(&with(PLAIN, &format!("name = \"pitch_map\"\n{knots}")));
    let none = commissioning::compensate::CompensationFile::none(&truth);
    let [before_um, after_um] = [&none, &plan.file].map(|file| contour_um(&log(&truth, file, &test)));
    assert!(after_um < 0.95 * before_um && after_um > 0.5, "{before_um} {after_um}");
}
