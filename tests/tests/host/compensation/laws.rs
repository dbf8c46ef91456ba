//! Laws of residuals of x: what the controller executes, against their equations on the circle.

use super::runs::{Comparison, PLAIN, SPEED_MM_S, circle, machine, motion, plan, usual};
use super::theory::{Point, radial_rms_at_um, radial_rms_um};

/// A product as `[[axis.x.law]]` of a channel.
fn product(channel: &str, of: &str, coefficient: f64) -> String {
    let term = format!("kind = \"product\"\nof = {of}\ncoefficient = {coefficient:?}");
    law(channel, &term)
}

fn law(channel: &str, term: &str) -> String {
    format!("{PLAIN}\n[[axis.x.law]]\nchannel = \"{channel}\"\n[[axis.x.law.term]]\n{term}\n")
}

fn removes(text: &str, item: &str, expected_um: f64) {
    Comparison::of_item([PLAIN, text], item, &usual()).assert(expected_um, 0.1, 0.8);
}

/// Yaw of the other guideway times the lever; 0.02 µm/mm² at 20 mm, 20 mm.
#[test]
fn position_times_other_position() {
    let expected_um = radial_rms_um(|p| 2e4 * p.x_m() * p.y_m());
    removes(&product("tool", r#"["position_mm", "other_position_mm"]"#, 0.02), "law: x · y", expected_um);
}

#[test]
fn the_cube_of_the_other_position() {
    let expected_um = radial_rms_um(|p| (1e3 * p.y_m()).powi(3) * 1e-3);
    let of = r#"["other_position_mm", "other_position_mm", "other_position_mm"]"#;
    removes(&product("tool", of, 1e-3), "law: y · y · y", expected_um);
}

/// A law of the table, which a loop on the motor does not see.
#[test]
fn speed() {
    let expected_um = radial_rms_um(|p| 100.0 * p.v_m_per_s().abs());
    removes(&product("table", r#"["speed_m_per_s"]"#, 100.0), "law: |v_x|", expected_um);
}

#[test]
fn direction_times_other_position() {
    let expected_um = radial_rms_um(|p| 300.0 * p.v_m_per_s().signum() * p.y_m());
    let of = r#"["direction", "other_position_mm"]"#;
    removes(&product("tool", of, 0.3), "law: sign(v_x) · y", expected_um);
}

/// At 100 mm/s with limited jerk, as an in-talk: the ramps (30 % of the time) have their own acceleration.
#[test]
fn acceleration_times_other_position() {
    let expected_um = radial_rms_at_um(2e-3 * SPEED_MM_S, |p: Point| 1e3 * p.ax_m_per_s2() * p.y_m());
    let ramps = "acceleration_m_per_s2 = 1.0\nramps = \"s-curve\"\njerk_m_per_s3 = 10.0";
    let test = motion(&circle(2.0 * SPEED_MM_S, ramps, 0.0), 0.0);
    let text = product("tool", r#"["acceleration_m_per_s2", "other_position_mm"]"#, 1.0);
    Comparison::of_item([PLAIN, &text], "law: a_x · y", &test).assert(expected_um, 0.3, 0.8);
}

#[test]
fn a_wave_over_the_other_position() {
    let wave = |p: Point| (std::f64::consts::TAU * p.y_m() / 0.025).sin();
    let expected_um = radial_rms_um(|p| 5.0 * wave(p));
    let term = "kind = \"wave\"\nover = \"other_position_mm\"\nperiod_mm = 25.0\ncosine = 0.0\nsine = 5.0";
    removes(&law("tool", term), "law: wave over y with a period of 25.0 mm", expected_um);
}

/// With the scale in the loop, the same law of the table is none of the tool's; a hysteresis and a law of the force have no setting.
#[test]
fn what_is_not_executed_is_listed_with_its_reason() {
    let hysteresis = "kind = \"hysteresis\"\ndistance_mm = 3.0\ncoefficient = 4.0";
    let dual = product("table", r#"["speed_m_per_s"]"#, 100.0)
        .replace("feedback = \"motor\"", "feedback = \"table\"");
    for (text, name, why) in [
        (law("tool", hysteresis), "law: hysteresis of x over 3.0 mm", "memory of the direction"),
        (product("force", r#"["position_mm"]"#, 1.0), "law: x", "describes the force"),
        (product("motor", r#"["velocity_m_per_s"]"#, 1.0), "law: v_x", "follows its command"),
        (product("tool", r#"["time_s"]"#, 0.1), "law: t", "by the time"),
        (dual, "law: |v_x|", "reads the scale"),
    ] {
        let plan = plan(&machine(&text), &usual());
        let listed = plan.not_compensated.iter().find(|not| not.effect == name && not.axis == "x");
        let listed = listed.unwrap_or_else(|| panic!("{name}: {:?}", plan.not_compensated));
        assert!(listed.why.contains(why), "{listed:?}");
        assert!(!plan.items.iter().any(|item| item.effect.starts_with("law")), "{:?}", plan.items);
    }
}

/// The controller has three products: of four terms, the last is listed.
#[test]
fn a_product_for_which_no_place_is_left_is_listed() {
    let term = |of: &str| format!("[[axis.x.law.term]]\nkind = \"product\"\nof = {of}\ncoefficient = 0.05\n");
    let variables = [
        r#"["position_mm", "other_position_mm"]"#,
        r#"["other_position_mm", "other_position_mm"]"#,
        r#"["position_mm", "position_mm"]"#,
        r#"["position_mm", "direction"]"#,
    ];
    let terms: String = variables.iter().map(|of| term(of)).collect();
    let text = format!("{PLAIN}\n[[axis.x.law]]\nchannel = \"tool\"\n{terms}");
    let plan = plan(&machine(&text), &usual());
    assert_eq!(plan.file.axis["x"].compensation.products.len(), 3);
    let listed: Vec<_> = plan.not_compensated.iter().filter(|not| not.effect.starts_with("law")).collect();
    let [last] = listed[..] else { panic!("{listed:?}") };
    assert!(last.effect == "law: x · sign(v_x)" && last.why.contains("three products"), "{last:?}");
}
