//! Whether a change of the settings of a machine's drives leaves its loops too little margin.

use super::axis_margins::{AxisLoops, LoopMargins, MarginError, MarginLimits};
use files::error::InputError;
use model::machine::Machine;
use plant::instruments::Instruments;

/// A loop that a change leaves with too little margin.
#[derive(Clone, Debug, PartialEq)]
pub struct TooLittle {
    /// Name of the axis.
    pub axis: String,
    /// `velocity` or `position`.
    pub loop_name: &'static str,
    /// What the loop would have, in words.
    pub found: String,
    /// What it must have, in words.
    pub expected: String,
}

/// Checks that the change of a file (`source`) leaves the loops of a machine these margins. A machine that lacks the keys that they follow
/// from cannot be simulated either, and is refused there.
///
/// # Errors
/// The axis whose drive settings take a loop below the limits.
pub fn check(
    before: &Machine,
    after: &Machine,
    limits: MarginLimits,
    source: &str,
) -> Result<(), InputError> {
    match first_too_little(before, after, &Instruments::of(before, 0), limits) {
        Ok(Some(refused)) => {
            let expected = format!("settings that leave the {} loop {}", refused.loop_name, refused.expected);
            let key = format!("axis.{}.controller", refused.axis);
            Err(InputError::expected(source, expected, refused.found).at_key(&key))
        }
        Ok(None) | Err(_) => Ok(()),
    }
}

/// The first loop whose margins a change takes below the limits: it is below them after the change, and was not as low
/// before. A machine whose loops are below the limits already may be used and improved.
///
/// # Errors
/// The first axis that lacks a key of its controller or its masses.
pub fn first_too_little(
    before: &Machine,
    after: &Machine,
    instruments: &Instruments,
    limits: MarginLimits,
) -> Result<Option<TooLittle>, MarginError> {
    let was = AxisLoops::of_machine(before, instruments)?;
    let is = AxisLoops::of_machine(after, instruments)?;
    let axes = before.axis.iter().zip(after.axis.values()).zip(was.iter().zip(&is));
    for (((name, old), new), (was, is)) in axes {
        if old.settings == new.settings {
            continue;
        }
        let loops =
            [("velocity", was.velocity(), is.velocity()), ("position", was.position(), is.position())];
        for (loop_name, was, is) in loops {
            if !is.meet(limits) && is_lower(&is, &was) {
                let MarginLimits { gain_db, phase_deg } = limits;
                return Ok(Some(TooLittle {
                    axis: name.clone(),
                    loop_name,
                    found: words(&is),
                    expected: format!(
                        "a gain margin of at least {gain_db} dB and a phase margin of at least {phase_deg}°"
                    ),
                }));
            }
        }
    }
    Ok(None)
}

/// Whether a margin is lower than it was.
fn is_lower(is: &LoopMargins, was: &LoopMargins) -> bool {
    /// Below this, the difference of two margins is that of two roundings.
    const SAME: f64 = 1e-6;
    if is.unstable.is_some() || was.unstable.is_some() {
        return was.unstable.is_none();
    }
    let pairs = [(is.gain_db, was.gain_db), (is.phase_deg, was.phase_deg)];
    pairs.into_iter().any(|(is, was)| {
        let value = |margin: Option<(super::margin::At, _)>| margin.map_or(f64::INFINITY, |(at, _)| at.value);
        value(is) < value(was) - SAME
    })
}

fn words(margins: &LoopMargins) -> String {
    if let Some(condition) = margins.unstable {
        return format!("an unstable loop ({})", condition.name());
    }
    let gain = margins.gain_db.map(|(at, condition)| format!("{:.1} dB ({})", at.value, condition.name()));
    let phase = margins.phase_deg.map(|(at, condition)| format!("{:.1}° ({})", at.value, condition.name()));
    gain.into_iter().chain(phase).collect::<Vec<_>>().join(" and ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::margins::tests::{instruments, machine};

    fn with_gain(gain_per_s: f64) -> Machine {
        let mut machine = machine("p", "table");
        machine.axis[0].settings.controller.position_gain_per_s = Some(gain_per_s);
        machine
    }

    fn too_little(before: &Machine, after: &Machine) -> Option<TooLittle> {
        first_too_little(before, after, &instruments(), MarginLimits::default()).unwrap()
    }

    #[test]
    fn a_change_below_the_limits_is_named_and_one_back_towards_them_is_not() {
        let loops = AxisLoops::of_machine(&with_gain(50.0), &instruments()).unwrap().remove(0);
        let highest = loops.highest_position_gain_per_s(MarginLimits::default()).unwrap();
        let [low, below, above, unstable] = [0.5, 0.99, 1.01, 20.0].map(|factor| with_gain(factor * highest));
        assert_eq!(too_little(&low, &below), None);
        let found = too_little(&low, &above).unwrap();
        assert_eq!((found.axis.as_str(), found.loop_name), ("x", "position"));
        assert!(too_little(&low, &unstable).unwrap().found.contains("unstable"));
        // Already below the limits: a lower gain is an improvement, the same gain no change.
        assert_eq!(too_little(&unstable, &above), None);
        assert_eq!(too_little(&above, &above), None);
    }
}
