//! What a trace says about things that are outside the textbook catalogue: their names, and faults of the data.

use serde_json::{Value, json};

use super::accepted;
use super::naming::{Naming, fault, named};
use super::truth::Truth;

/// The name of an effect or fault, and its axis.
pub type Named = (String, String);

/// Kinds of data fault that a trace may report.
pub const FAULT_KINDS: [&str; 9] =
    ["slip", "stuck", "spike", "sign", "exchanged", "shifted", "rate", "unit", "dead"];

/// Things from outside and their names.
const NAMINGS: [Naming; 18] = [
    // A slope is a part of a shape, but does not name it.
    Naming { names: &["pitch_map"], ..named("pitch_shape", &["pitch_map", "pitch_progressive"]) },
    // A slope or a bow is a part of a shape, but does not name it.
    Naming {
        names: &["straightness_map"],
        ..named("guide_shape", &["straightness_map", "straightness", "squareness"])
    },
    Naming { estimated: Some(("yaw", &["um_per_m2"])), ..named("carriage_yaw", &["yaw"]) },
    named("friction_position", &["friction_map", "preload_variation", "friction_ripple"]),
    Naming {
        estimated: Some(("friction_warm_up", &["force_n", "time_constant_s"])),
        ..named("friction_warm_up", &["friction_warm_up"])
    },
    // Its viscosity is not that of a law with one slope: the slope depends on the reference.
    Naming {
        estimated: Some(("friction_temperature", &["level_n_per_c"])),
        ..named("friction_temperature", &["friction_temperature"])
    },
    Naming {
        estimated: Some(("motor_stribeck", &["static_excess_n", "velocity_mm_s"])),
        ..named("motor_stribeck", &["motor_stribeck"])
    },
    Naming {
        estimated: Some(("pitch_cyclic", &["amplitude_um"])),
        ..named("belt_37mm", &["pitch_cyclic", "pitch_map"])
    },
    Naming {
        estimated: Some(("pitch_cyclic", &["amplitude_um"])),
        ..named("screw_second_harmonic", &["pitch_cyclic", "pitch_map"])
    },
    Naming {
        estimated: Some(("position_load", &["slope_n_per_m"])),
        ..named("cable_drag", &["position_load"])
    },
    named("backlash_varies", &["backlash", "pitch_map"]),
    Naming { estimated: Some(("gravity", &["sine_n", "cosine_n"])), ..named("joint_gravity", &["gravity"]) },
    Naming {
        estimated: Some(("gear_hysteresis", &["force_n", "travel_um"])),
        ..named("gear_hysteresis", &["gear_hysteresis"])
    },
    Naming {
        estimated: Some(("pitch_cyclic", &["amplitude_um"])),
        ..named("gear_error", &["pitch_cyclic", "pitch_map"])
    },
    fault("scale_slip", "slip"),
    fault("scale_stuck", "stuck"),
    fault("probe_sign", "sign"),
    Naming { estimated: Some(("drive_lag", &["ms"])), ..named("slow_drive", &["drive_lag", "velocity_lag"]) },
];

fn naming(extra: &str) -> Option<&'static Naming> {
    NAMINGS.iter().chain(&accepted::NAMINGS).find(|naming| naming.extra == extra)
}

/// Whether an effect may be reported for a thing from outside, on the same axis, without being false.
#[must_use]
pub fn is_accepted(extra: &str, effect: &str) -> bool {
    naming(extra).is_some_and(|naming| naming.accepted.contains(&effect))
}

/// Whether an effect or kind of data fault names a thing from outside.
#[must_use]
pub fn is_name(extra: &str, found: &str) -> bool {
    naming(extra).is_some_and(|naming| naming.names.contains(&found) || naming.fault == Some(found))
}

/// The effect that has the parameters of a thing from outside, as a true effect with these parameters.
#[must_use]
pub fn as_effect(extra: &Truth) -> Option<Truth> {
    let (name, keys) = naming(extra.name)?.estimated?;
    let is_kept = |key: &str| keys.contains(&key) || key == "period_mm";
    let parameters = extra.parameters.iter().copied().filter(|(key, _)| is_kept(key)).collect();
    Some(Truth { name, parameters, ..extra.clone() })
}

/// Whether a thing from outside counts: the slow drive is the condition of a kind of cases, not what it tests.
#[must_use]
pub fn counts(extra: &Truth) -> bool {
    extra.name != "slow_drive"
}

/// A fault of the data that a trace reports.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportedFault {
    /// Kind and axis.
    pub name: Named,
    /// Instant on the clock of the session, s.
    pub at_s: Option<f64>,
    /// The entry in the JSON of the trace.
    pub entry: Value,
}

impl ReportedFault {
    /// From an entry of `data_faults`.
    #[must_use]
    pub fn new(entry: &Value) -> Self {
        let word = |key: &str| entry[key].as_str().unwrap_or_default().to_owned();
        Self { name: (word("kind"), word("axis")), at_s: entry["at_s"].as_f64(), entry: entry.clone() }
    }
}

/// What a trace says about one thing from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// The thing.
    pub extra: Truth,
    /// Effects and kinds of data fault that were reported for it.
    pub names: Vec<String>,
    /// Whether one of them is its name.
    pub is_named: bool,
    /// Whether the trace says that something on its axis stays unexplained.
    pub is_unexplained: bool,
    /// Error of the reported instant of a fault, s.
    pub instant_error_s: Option<f64>,
}

impl Answer {
    /// From the effects and faults found, and the axes with an unexplained residual.
    #[must_use]
    pub fn new(extra: &Truth, found: &[Named], faults: &[ReportedFault], unexplained: &[String]) -> Self {
        let of_axis = |(_, axis): &&Named| axis == extra.axis;
        let effects = found.iter().filter(of_axis).filter(|(name, _)| is_accepted(extra.name, name));
        let kinds = faults.iter().map(|fault| &fault.name);
        let kinds = kinds.filter(of_axis).filter(|(name, _)| is_name(extra.name, name));
        let names: Vec<String> = effects.chain(kinds).map(|(name, _)| name.clone()).collect();
        let of_extra =
            |fault: &&ReportedFault| fault.name.1 == extra.axis && is_name(extra.name, &fault.name.0);
        let errors = extra.parameter("at_s").into_iter().flat_map(|true_s| {
            faults.iter().filter(of_extra).filter_map(move |fault| Some((fault.at_s? - true_s).abs()))
        });
        Self {
            is_named: names.iter().any(|name| is_name(extra.name, name)),
            names,
            is_unexplained: unexplained.iter().any(|axis| axis == extra.axis),
            instant_error_s: errors.reduce(f64::min),
            extra: extra.clone(),
        }
    }

    /// Whether it is named, or at least reported as unexplained.
    #[must_use]
    pub fn is_described(&self) -> bool {
        self.is_named || self.is_unexplained
    }

    /// Its entry in the JSON of the self-test.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "truth": self.extra.json(),
            "names": self.names,
            "named": self.is_named,
            "described": self.is_described(),
            "instant_error_s": self.instant_error_s,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::score::tests::truth;
    use super::*;

    fn pairs(names: &[(&str, &str)]) -> Vec<Named> {
        names.iter().map(|(name, axis)| ((*name).to_owned(), (*axis).to_owned())).collect()
    }

    #[test]
    fn a_slope_is_accepted_for_a_shape_but_does_not_name_it() {
        let shape = truth("pitch_shape", "y", &[]);
        let slope = Answer::new(&shape, &pairs(&[("pitch_progressive", "y")]), &[], &["x".to_owned()]);
        assert_eq!((slope.is_named, slope.is_described()), (false, false));
        assert_eq!(slope.names, ["pitch_progressive"]);
        assert!(is_accepted("pitch_shape", "pitch_progressive"));
        let unexplained = Answer::new(&shape, &[], &[], &["y".to_owned()]);
        assert_eq!((unexplained.is_named, unexplained.is_described()), (false, true));
        let map = |axis| Answer::new(&shape, &pairs(&[("pitch_map", axis)]), &[], &[]);
        assert!(map("y").is_named && map("y").is_described());
        assert!(!map("x").is_named);
    }

    #[test]
    fn a_fault_is_named_by_its_kind_on_its_axis_and_the_nearest_instant_counts() {
        let slip = truth("scale_slip", "x", &[("at_s", 12.5), ("size_um", 8.0)]);
        let fault = |kind: &str, axis: &str, at_s: f64| {
            ReportedFault::new(&json!({"kind": kind, "axis": axis, "channel": "table", "at_s": at_s}))
        };
        let answer = |faults: &[ReportedFault]| Answer::new(&slip, &[], faults, &[]);
        let right = answer(&[fault("slip", "x", 30.0), fault("slip", "x", 12.502)]);
        assert!(right.is_named);
        assert!(right.instant_error_s.is_some_and(|error_s| (error_s - 0.002).abs() < 1e-9), "{right:?}");
        for wrong in [fault("stuck", "x", 12.5), fault("slip", "y", 12.5)] {
            let wrong = answer(&[wrong]);
            assert!(!wrong.is_described() && wrong.instant_error_s.is_none(), "{wrong:?}");
        }
    }

    #[test]
    fn the_parameters_of_a_thing_that_an_effect_describes_are_compared() {
        let drag = truth("cable_drag", "x", &[("slope_n_per_m", 1500.0)]);
        assert_eq!(as_effect(&drag), Some(truth("position_load", "x", &[("slope_n_per_m", 1500.0)])));
        assert_eq!(as_effect(&truth("pitch_shape", "x", &[("peak_to_peak_um", 9.0)])), None);
    }

    #[test]
    fn every_extra_that_is_drawn_has_a_naming() {
        use super::super::{draw, extra, fault, kind::Kind};
        use rand::SeedableRng;
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(2);
        let mut drawn = fault::NAMES.to_vec();
        for _ in 0..50 {
            for kind in Kind::ALL {
                let mut machine = draw::machine(&draw::WITHIN_TOLERANCE, &mut random);
                drawn.extend(extra::draw(kind, &mut machine, &mut random).iter().map(|extra| extra.name));
            }
        }
        drawn.sort_unstable();
        drawn.dedup();
        let mut known = NAMINGS.map(|naming| naming.extra);
        known.sort_unstable();
        assert_eq!(drawn, known);
    }
}
