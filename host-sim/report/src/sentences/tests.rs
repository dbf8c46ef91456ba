use super::*;
use model::axis::{Controller, Drive, KeyNames, Mechanics, Sensors, Settings};
use model::effects::{
    Effect, EffectContext, KINDS, ResidualOverOther, ResidualShape, Stage, initial_guesses, names,
};
use trace::fit::fit_data::FitAndValidationRms;

/// A residual of which maps are started.
fn shape() -> ResidualShape {
    let over = ResidualOverOther { source: "q".to_owned(), travel_mm: [0.0, 100.0], knots: 4 };
    ResidualShape {
        pitch_knots: Some(5),
        friction_knots: Some(4),
        stiffness_knots: Some(4),
        tool_over_others: vec![over],
        ..ResidualShape::default()
    }
}

/// One effect of each kind, all its coordinates at 7.25 where their bounds allow.
fn one_of_each() -> Vec<Effect> {
    let axis = Settings {
        mechanics: Mechanics {
            motor_mass_kg: Some(20.0),
            table_mass_kg: Some(100.0),
            stiffness_n_per_um: Some(200.0),
            coulomb_n: Some(20.0),
            viscous_n_s_per_m: Some(500.0),
            lead_mm: Some(10.0),
            ..Mechanics::default()
        },
        controller: Controller { velocity_integral_time_s: Some(0.02), ..Controller::default() },
        sensors: Sensors { resolver_pole_pairs: Some(5), ..Sensors::default() },
        ..Settings::default()
    };
    let context = EffectContext {
        axis: &axis,
        logged: model::effects::LoggedChannels::ALL,
        first: true,
        others: &["q".to_owned()],
        stages: &[Stage::Motor, Stage::Table, Stage::Tool, Stage::Force],
        travel_mm: [0.0, 100.0],
        effects: &[],
        residual: &shape(),
    };
    let alone = EffectContext { stages: &[Stage::Force], ..context };
    let second = EffectContext { first: false, ..context };
    let stepper = Settings {
        controller: Controller { drive: Drive::Stepper, ..Controller::default() },
        mechanics: Mechanics { lead_mm: Some(5.0), ..Mechanics::default() },
        ..Settings::default()
    };
    let logged = model::effects::LoggedChannels { force: false, ..context.logged };
    let stepper = EffectContext { axis: &stepper, logged, ..context };
    let turning = Settings { names: KeyNames::Rotary, ..axis.clone() };
    let rotary = EffectContext { axis: &turning, ..context };
    let of_scale =
        ["name = 'scale_gain'\num_per_m = 5", "name = 'scale_cyclic'\namplitude_um = 1\nperiod_mm = 40"]
            .map(|effect| toml::from_str(effect).unwrap());
    let mut all = [
        initial_guesses(&context),
        initial_guesses(&alone),
        initial_guesses(&second),
        initial_guesses(&stepper),
        initial_guesses(&rotary),
        of_scale.to_vec(),
    ]
    .concat();
    all.extend(KINDS.iter().flat_map(|kind| (kind.assumed)()));
    let first = |name: &&str| all.iter().find(|effect| effect.name() == *name).unwrap().clone();
    let moved = |effect: Effect| {
        let values: Vec<f64> =
            effect.coordinates().iter().map(|c| 7.25_f64.clamp(c.lower, c.upper)).collect();
        effect.at(&values)
    };
    names().iter().map(first).map(moved).collect()
}

#[test]
fn every_effect_of_the_catalogue_has_a_sentence_with_its_axis_and_values() {
    for effect in one_of_each() {
        let parameters = effect.parameters();
        let half_widths = vec![0.01; parameters.len()];
        let stage = effect.stages()[0];
        let [before, after] = [100.0, 9.4].map(|validate| FitAndValidationRms { fit: 1.0, validate });
        let found = FoundEffect::new((effect, half_widths), stage, [before, after]);
        let text = worded("ax", Unit::Millimetre, &found, true, None);
        assert!(text.starts_with("ax: "), "{text}");
        assert!(
            text.contains(", certain; it explains the ")
                && text.contains(", which is 91 % smaller with it. "),
            "{text}"
        );
        assert!(text.ends_with(&format!("To do: {}.", found.effect.compensation().remedy())), "{text}");
        let declared = found.effect.declared_parameters();
        for ((name, value), parameter) in parameters.iter().zip(&declared) {
            if name.starts_with("phase") || parameter.is_list {
                continue;
            }
            // A number that is not fitted has no interval.
            let is_fitted = !found.effect.coordinates().is_empty();
            let value = if is_fitted { with_spread(*value, 0.01) } else { value.to_string() };
            assert!(text.contains(&value), "{name} {value} in: {text}");
        }
        // Of a map, the sentence contains both ends and the range: five or four knots.
        if let Some(count) = declared.iter().filter(|p| p.key == "positions_mm").count().checked_sub(1) {
            let values = found.effect.values();
            let size = numerics::peak_to_peak(values[count + 1..].iter().copied());
            for value in [with_spread(values[0], 0.01), with_spread(values[count], 0.01)] {
                assert!(text.contains(&value), "{value} in: {text}");
            }
            assert!(text.contains(&with_spread(size, 0.01 * 2.0f64.sqrt())), "{size} in: {text}");
            assert!(text.contains(&format!("({} knots)", count + 1)), "{text}");
        }
        if let Some(source) = found.effect.distinction().source() {
            assert!(text.contains(&format!("axis {source}")), "{text}");
        }
    }
}

#[test]
fn an_effect_that_no_held_out_motion_shows_is_reported_as_such() {
    let effect: Effect = toml::from_str("name = 'backlash'\nwidth_um = 9.8").unwrap();
    let [before, after] = [100.0, 103.2].map(|validate| FitAndValidationRms { fit: 1.0, validate });
    let mut found = FoundEffect::new((effect, vec![0.1]), Stage::Table, [before, after]);
    assert_eq!(
        worded("x", Unit::Millimetre, &found, false, None),
        "x: 9.8 ± 0.1 µm backlash between screw and table; the held-out motions neither show nor refute it: their \
         table residual is 3 % larger."
    );
    found.before.validate = f64::NAN;
    assert_eq!(
        worded("x", Unit::Millimetre, &found, false, None),
        "x: 9.8 ± 0.1 µm backlash between screw and table; no held-out motion has a table residual to show it."
    );
    let slope = "name = 'pitch_progressive'\nslope_um_per_m = 12.5";
    found.rivals.push(toml::from_str(slope).unwrap());
    let text = worded("x", Unit::Millimetre, &found, false, None);
    assert!(
        text.starts_with("x: either 9.8 ± 0.1 µm backlash") && text.contains(", or the screw moves"),
        "{text}"
    );
}
