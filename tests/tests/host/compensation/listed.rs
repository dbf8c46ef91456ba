//! What is not compensated is listed with its reason, and the tests cover the catalogue.

use std::collections::BTreeSet;

use commissioning::compensate::Plan;
use model::effects::{Effect, EffectCompensation, KINDS, Kind};

use super::TESTED;
use super::runs::{PLAIN, machine, plan, usual, with};

/// An effect of a kind, with 1 as each of its values.
pub fn example(kind: &Kind) -> Effect {
    let mut entry = serde_json::Map::from_iter([("name".to_owned(), kind.name.into())]);
    entry.extend(kind.parameters.iter().map(|parameter| {
        let value = if parameter.is_list { vec![1.0, 2.0].into() } else { 1.0.into() };
        (parameter.key.to_owned(), value)
    }));
    for (key, _) in kind.named_keys {
        let value = match *key {
            "channel" => "tool",
            "part" => "scale",
            _ => "y",
        };
        entry.insert((*key).to_owned(), value.into());
    }
    serde_json::from_value(entry.into()).unwrap()
}

#[test]
fn each_compensated_effect_of_the_catalogue_is_tested() {
    let is_compensated = |kind: &&Kind| example(kind).compensation().is_compensated();
    let compensated: BTreeSet<&str> = KINDS.iter().filter(is_compensated).map(|kind| kind.name).collect();
    assert_eq!(TESTED.iter().copied().collect::<BTreeSet<_>>(), compensated);
}

/// All effects that a simulation has and that are not compensated, on one machine.
const NOT_COMPENSATED: [&str; 18] = [
    "name = \"drive_asymmetry\"\npercent = 3.0",
    "name = \"drive_dead_time\"\nms = 0.05",
    "name = \"computation_delay\"\nperiods = 0.1",
    "name = \"drive_lag\"\nms = 0.4",
    "name = \"velocity_lag\"\nms = 0.2",
    "name = \"latency\"\nchannel = \"table\"\nms = 1.0",
    "name = \"shear_thinning\"\nforce_n = 20.0\nvelocity_mm_s = 5.0",
    "name = \"friction_temperature\"\nreference_c = 20.0\nlevel_n_per_c = -1.0\nviscous_percent_per_c = -4.0\nsensor_late_s = 3.0",
    "name = \"quadratic_drag\"\nforce_n = 100.0",
    "name = \"scale_gain\"\num_per_m = 5.0",
    "name = \"scale_cyclic\"\namplitude_um = 0.5\nperiod_mm = 37.0",
    "name = \"thermal_growth\"\npart = \"scale\"\num_per_m = 5.0\ntime_constant_s = 20.0",
    "name = \"probe_rotation\"\num_per_m = 50.0",
    "name = \"probe_gain\"\num_per_m = 50.0",
    "name = \"stiffness_map\"\npositions_mm = [0, 100]\ncompliance_percent = [-10, 10]",
    "name = \"gear_hysteresis\"\nforce_n = 20.0\ntravel_um = 1.0",
    "name = \"thermal_rate\"\num_per_min = 0.5",
    "name = \"friction_memory\"\nviscous_n_s_per_m = 200.0\ntime_constant_s = 0.1",
];

#[test]
fn what_is_not_compensated_is_listed_with_its_reason() {
    let text = NOT_COMPENSATED.iter().fold(PLAIN.to_owned(), |text, effect| with(&text, effect));
    let machine = machine(&text);
    let plan = plan(&machine, &usual());
    for effect in &machine.axis["x"].effect {
        let EffectCompensation::Not { why, instead } = effect.compensation() else {
            panic!("{}", effect.name())
        };
        let listed = plan.not_compensated.iter().find(|not| not.effect == effect.name() && not.axis == "x");
        let listed = listed.unwrap_or_else(|| panic!("{} is not listed", effect.name()));
        assert_eq!((listed.why.as_str(), listed.instead.as_str()), (why, instead));
        assert!(!plan.items.iter().any(|item| item.effect == effect.name()));
    }
    // Nor does it reach a table of the force feed-forward by the part of the plant in which its law acts.
    let tables = |plan: &Plan| {
        let force = plan.file.axis["x"].compensation.force.as_ref();
        force.map(|force| {
            (force.friction.map.is_some(), force.friction.warm_up.is_some(), force.load.is_some())
        })
    };
    assert_eq!(tables(&plan), Some((false, false, false)));
    // Every kind that is not compensated is one of these, or cannot be on it: those of axes without masses or of steppers, and delays
    // within the machine's own controller.
    let not = |kind: &&Kind| !example(kind).compensation().is_compensated();
    let kinds: BTreeSet<&str> = KINDS.iter().filter(not).map(|kind| kind.name).collect();
    let not_simulated = ["windup", "microstep_error", "loop_delay", "position_delay"];
    let tested = machine.axis["x"].effect.iter().map(Effect::name).chain(not_simulated);
    assert_eq!(kinds, tested.collect::<BTreeSet<_>>());
}

/// The controller has tables of two periods: of three errors with periods that do not divide each other, the smallest is listed.
#[test]
fn an_error_for_which_no_table_is_left_is_listed() {
    let wave = |um: f64, mm: f64| {
        format!("name = \"pitch_cyclic\"\namplitude_um = {um:?}\nperiod_mm = {mm:?}\nphase_rad = 0.0")
    };
    let text = [wave(3.0, 10.0), wave(2.0, 37.0), wave(1.0, 23.0)]
        .iter()
        .fold(PLAIN.to_owned(), |text, e| with(&text, e));
    let plan = plan(&machine(&text), &usual());
    assert_eq!(plan.items.iter().filter(|item| item.effect == "pitch_cyclic").count(), 2);
    let listed: Vec<_> = plan.not_compensated.iter().filter(|not| not.effect == "pitch_cyclic").collect();
    assert!(listed.len() == 1 && listed[0].why.contains("tables of two periods"), "{listed:?}");
    assert_eq!(plan.file.axis["x"].compensation.screw.len(), 2);
}
