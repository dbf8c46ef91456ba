//! A planned motion: it decides on machines of the second simulator, and is written as a motion and as a program.

use motion::Motion;
use self_test::plan_case::PlanCase;
use serde_json::Value;

use super::work_folder::WorkFolder;

/// Two machines of `self-test --plan --seed 777` whose short circle leaves a question. `docs/self-test.md` has the figures of more.
#[test]
fn a_planned_motion_decides_what_a_short_circle_leaves_open() {
    for number in [4, 5] {
        let case = PlanCase::draw(777, number).unwrap();
        let outcome = case.judged(&|_| {}).unwrap().unwrap();
        assert!(outcome.is_decided && outcome.false_names.is_empty(), "{outcome:?}");
        // Four rounds of strokes last some seconds; a session of three motions 28 s and more.
        let seconds = outcome.duration_s.unwrap();
        assert!((2.0..20.0).contains(&seconds), "{outcome:?}");
    }
}

/// The machining centre with an in-talk that its logs did not tell from a late probe.
fn model() -> String {
    format!(
        "{}\n[[axis.x.effect]]\nname = \"intalk\"\num_s2_per_m = 3.0\n[[axis.x.evidence]]\neffect = \"intalk\"\n\
         certainty = \"ambiguous\"\nhalf_widths = [2.0]\nrivals = [\"latency\"]\n[[axis.x.evidence.alternative]]\nname = \"latency\"\n\
         channel = \"tool\"\nms = 0.5\n",
        model::examples::VMC_MACHINE
    )
}

const LIMITS: &str = "--travel x=-40..40 --travel y=-40..40 --speed-mm-per-s 100 --acceleration-m-per-s2 2";

#[test]
fn a_plan_is_written_as_motion_program_and_json() {
    let folder = WorkFolder::with(&[("found.toml", &model())]);
    let said = folder.succeeds(&format!(
        "plan --model found.toml {LIMITS} --out P.toml --gcode P.ngc --format linuxcnc --json plan.json"
    ));
    assert!(said.contains("or latency") && said.matches("named it, certain").count() == 2, "{said}");
    let plan: Value = serde_json::from_str(&folder.read("plan.json")).unwrap();
    assert_eq!(plan["questions"][0]["candidates"], serde_json::json!(["intalk", "latency"]));
    assert_eq!(plan["questions"][0]["is_decided"], true);
    // 2 m/s² move the tool by 6 µm, 75 times the noise of the probe, in some hundred samples of each second: a fraction of a percent, and more than
    // the noise of all samples of a minute, 0.08/√60000/2 µm s²/m.
    let half_width = plan["expected"][0]["half_width_expected"].as_f64().unwrap();
    assert!((1e-4..0.1).contains(&half_width), "{plan}");
    let motion = Motion::parse(&folder.read("P.toml"), "P.toml").unwrap();
    for block in &motion.blocks {
        if let motion::Block::Line { to_mm, pace } = block {
            assert!(to_mm["x"].abs() <= 40.0 && to_mm["y"].abs() <= 40.0);
            assert!(pace.feed_mm_per_min <= 6000.0 && pace.acceleration_m_per_s2 <= 2.0);
        }
    }
    assert!(folder.read("P.ngc").contains("G21 G90"));
}

#[test]
fn a_plan_without_a_question_or_without_limits_writes_nothing() {
    let certain = model().replace("\"ambiguous\"", "\"certain\"");
    let folder = WorkFolder::with(&[("found.toml", &model()), ("certain.toml", &certain)]);
    let said = folder.succeeds(&format!("plan --model certain.toml {LIMITS} --out P.toml"));
    assert!(said.starts_with("No motion is planned"), "{said}");
    let error = folder.fails("plan --model found.toml --out P.toml --speed-mm-per-s 100", 2);
    assert!(error.contains("--travel: expected the travel of x"), "{error}");
    let error = folder.fails(&format!("plan --model found.toml {LIMITS} --time-s -1 --out P.toml"), 2);
    assert!(error.contains("--time-s: expected a finite number above 0"), "{error}");
    let error = folder.fails(&format!("plan --model found.toml {LIMITS} --time-s 1 --out P.toml"), 1);
    assert!(error.contains("no motion is written"), "{error}");
    let error = folder.fails("plan --model found.toml --travel x=40..-40 --out P.toml", 2);
    assert!(error.contains("x=-50..200"), "{error}");
    assert!(!folder.path().join("P.toml").exists());
}
