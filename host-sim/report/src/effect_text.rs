//! What an effect does with its parameters, as a clause of a sentence.

use super::number::{significant, with_spread};
use files::log::Unit;
use model::effects::{Channel, Effect};

/// What an effect does, with its parameters. The half widths of their 95 % intervals are in the order of
/// [`Effect::parameters`]; a missing one is left out of the text.
#[must_use]
#[expect(clippy::too_many_lines, reason = "one sentence an effect")]
pub fn effect(effect: &Effect, half_widths: &[f64]) -> String {
    let parameters = effect.parameters();
    let half = |i: usize| half_widths.get(i).copied().unwrap_or(0.0);
    let of = |i: usize, unit: &str| format!("{} {unit}", with_spread(parameters[i].1, half(i)));
    let size = |i: usize, unit: &str| format!("{} {unit}", with_spread(parameters[i].1.abs(), half(i)));
    let is_positive = parameters[0].1 >= 0.0;
    match effect {
        Effect::Backlash(_) => format!("{} backlash between screw and table", of(0, "µm")),
        Effect::PitchProgressive(_) => {
            let how = if is_positive { "further" } else { "less far" };
            format!("the screw carries the table {} {how} than its nominal lead", size(0, "µm/m"))
        }
        Effect::PitchCyclic(_) => {
            format!("the screw's pitch wobbles by {} every {}", of(0, "µm (amplitude)"), of(1, "mm"))
        }
        Effect::ResolverDividing(_) => {
            format!("the motor reading wobbles by {} every {}", of(0, "µm (amplitude)"), of(1, "mm"))
        }
        Effect::Windup(windup) if windup.friction_n.is_some() => {
            let turn = windup
                .presliding_mm
                .map_or_else(String::new, |_| format!(", which turns round over {}", of(2, "mm")));
            format!(
                "the drive force winds up the drive train, with {} between motor and table; friction before it takes \
                 {}{turn}",
                of(0, "N/µm"),
                of(1, "N")
            )
        }
        Effect::Windup(_) => {
            format!("the drive train has {} between motor and table, outside what is declared", of(0, "N/µm"))
        }
        Effect::Stribeck(_) => {
            format!("friction rises by {} towards standstill, below {}", of(0, "N"), of(1, "mm/s"))
        }
        Effect::FrictionAsymmetry(_) => {
            let [more, less] = if is_positive { ["+", "−"] } else { ["−", "+"] };
            let size = size(0, "N·s/m");
            format!(
                "viscous friction is {size} higher in {more} direction and as much lower in {less} direction"
            )
        }
        Effect::TorqueRipple(_) => {
            format!("the drive force ripples by {} every {}", of(0, "N (amplitude)"), of(1, "mm"))
        }
        Effect::ConstantLoad(_) => {
            let direction = if is_positive { "+" } else { "−" };
            format!("a constant load of {} against motion in {direction} direction", size(0, "N"))
        }
        Effect::Presliding(_) => format!(
            "friction builds up against a stiffness of {}, damped by {}, before the axis slides",
            of(0, "N/µm"),
            of(1, "N·s/m")
        ),
        Effect::ShearThinning(_) => format!(
            "sliding friction lacks {} at standstill and comes up to its level within {}",
            of(0, "N"),
            of(1, "mm/s")
        ),
        Effect::FrictionMemory(_) => {
            let how = if is_positive { "behind" } else { "ahead of" };
            format!("{} of viscous friction are {how} the speed, by {}", size(0, "N·s/m"), of(1, "s"))
        }
        Effect::PreloadVariation(_) => format!(
            "friction changes along the travel, from the middle at {} by {} and {}",
            of(0, "mm"),
            of(1, "N/m"),
            of(2, "N/m²")
        ),
        Effect::FrictionRipple(_) => {
            format!("friction goes up and down by {} every {}", of(0, "N (amplitude)"), of(1, "mm"))
        }
        Effect::ServoMismatch(_) => {
            let how = if is_positive { "above" } else { "below" };
            format!("the position gain lies {} {how} the declared one", size(0, "%"))
        }
        Effect::VelocityLag(_) => format!("the velocity loop acts on a speed that is {} old", of(0, "ms")),
        Effect::Intalk(_) => {
            format!("the tool leans by {} of the axis's own acceleration", of(0, "µm per m/s²"))
        }
        Effect::Crosstalk(e) => {
            format!("the tool leans by {} of acceleration of axis {}", of(0, "µm per m/s²"), e.source)
        }
        Effect::Squareness(_) => {
            format!("out of square, the tool goes astray by {} of the other axis's travel", of(0, "µm per m"))
        }
        Effect::Straightness(e) => {
            let near = significant(0.01 * e.um_per_m2.abs(), 2);
            format!(
                "the guide of axis {} is bent, which moves the tool by {} ({near} µm at 100 mm)",
                e.source,
                of(0, "µm/m²")
            )
        }
        Effect::ThermalDrift(_) => format!(
            "the tool drifts by {} while the machine warms up, with a time constant of {}",
            of(0, "µm"),
            of(1, "s")
        ),
        Effect::Latency(e) => {
            let channel = match e.channel {
                Channel::Table => "table reading",
                Channel::Tool => "tool reading",
                Channel::Force => "force",
            };
            let how = if is_positive { "late" } else { "early" };
            format!("the {channel} is logged {} {how}", size(0, "ms"))
        }
        Effect::Resonance(_) => format!(
            "the tool swings behind the table at {}, with a damping ratio of {}",
            of(0, "Hz"),
            of(1, "").trim_end()
        ),
    }
}

/// A text about an axis in the words and units of the axis: as it is for a linear one, translated for a rotary one.
#[must_use]
pub fn in_unit(unit: Unit, linear: String) -> String {
    if unit == Unit::Degree { rotary(&linear) } else { linear }
}

/// A text about a linear axis for a rotary one, where mm stand for degrees and N for N·m: 1 m is 1000°.
fn rotary(linear: &str) -> String {
    const WORDS: [(&str, &str); 18] = [
        ("screw's pitch", "gear's ratio"),
        ("screw", "gear"),
        ("nominal lead", "nominal ratio"),
        ("drive force", "drive torque"),
        ("of the force", "of the torque"),
        ("a force", "a torque"),
        ("µm per m/s²", "mdeg per 1000°/s²"),
        ("µm/m²", "mdeg per (1000°)²"),
        ("µm/m", "mdeg per 1000°"),
        ("µm per m", "mdeg per 1000°"),
        ("N/µm", "N·m/mdeg"),
        ("N·s/m", "N·m·s per 1000°"),
        ("µm at 100 mm", "mdeg at 100°"),
        ("µm", "mdeg"),
        (" mm/s", "°/s"),
        (" mm", "°"),
        (" N ", " N·m "),
        (" N,", " N·m,"),
    ];
    let said = WORDS.iter().fold(linear.to_owned(), |said, (linear, rotary)| said.replace(linear, rotary));
    said.strip_suffix(" N").map_or(said.clone(), |start| format!("{start} N·m"))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use model::effects::{NAMES, Stage, Surroundings, candidates};
    use model::machine::Axis;

    /// One effect of each kind, all its coordinates at 7.25 where their bounds allow.
    pub(crate) fn one_of_each() -> Vec<Effect> {
        let axis = Axis {
            table_mass_kg: Some(100.0),
            stiffness_n_per_um: Some(200.0),
            coulomb_n: Some(20.0),
            lead_mm: Some(10.0),
            resolver_pole_pairs: Some(2),
            ..Axis::default()
        };
        let around = Surroundings {
            axis: &axis,
            first: true,
            others: &["q".to_owned()],
            stages: &[Stage::Motor, Stage::Table, Stage::Tool, Stage::Force],
            travel_mm: [0.0, 100.0],
        };
        let all =
            [candidates(&around), candidates(&Surroundings { stages: &[Stage::Force], ..around })].concat();
        let first = |name: &&str| all.iter().find(|effect| effect.name() == *name).unwrap().clone();
        let moved = |effect: Effect| {
            let values: Vec<f64> =
                effect.coordinates().iter().map(|c| 7.25_f64.clamp(c.lower, c.upper)).collect();
            effect.at(&values)
        };
        NAMES.iter().map(first).map(moved).collect()
    }

    #[test]
    fn a_sign_is_told_in_words() {
        let said = |text: &str| {
            let effect: Effect = toml::from_str(text).unwrap();
            super::effect(&effect, &[])
        };
        assert_eq!(
            said("name = 'constant_load'\nforce_n = -3.5"),
            "a constant load of 3.500 N against motion in − direction"
        );
        assert!(said("name = 'servo_mismatch'\npercent = -4").contains("4.000 % below"));
        assert!(
            said("name = 'latency'\nchannel = 'tool'\nms = 2")
                .contains("tool reading is logged 2.000 ms late")
        );
        assert!(said("name = 'pitch_progressive'\nslope_um_per_m = -40").contains("40.00 µm/m less far"));
    }
}
