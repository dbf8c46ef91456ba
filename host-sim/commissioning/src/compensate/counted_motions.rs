//! The motions whose contour error counts if the user gives none: a circle and corners, where the machine has them.

use files::error::InputError;
use model::machine::Machine;

use crate::compensate::mapped;
use crate::compensate::motions_within::{Travel, whole_travel};
use crate::compensate::prediction::TestMotion;

/// Time for which another control has compensated before a motion, s.
pub const SETTLE_S: f64 = 1.0;

const MOTIONS: [(&str, &str); 2] = [
    ("motions/circle.toml", include_str!("../../../motions/circle.toml")),
    ("motions/corner.toml", include_str!("../../../motions/corner.toml")),
];

/// The motions, which start at `start_s` on the session clock: circle and corner of the repository, if the machine has their axes, they stay
/// within its soft limits, and its maps cover them; else a circle, corners and travels within the limits or maps.
///
/// # Errors
/// A machine without a linear axis, for which there are none.
pub fn default(machine: &Machine, start_s: f64) -> Result<Vec<TestMotion>, InputError> {
    let usual: Vec<TestMotion> = MOTIONS
        .into_iter()
        .map(|(source, text)| TestMotion::parse(text, source, start_s))
        .collect::<Result<_, _>>()?;
    let travels = Travel::of(machine);
    if travels.is_empty() {
        let expected = "a motion of this machine, as none is usual for rotary axes";
        return Err(InputError::expected("--motion", expected, "none"));
    }
    Ok(if suit(machine, &usual) { usual } else { whole_travel(&travels, start_s) })
}

/// Whether a machine has the axes of motions, its maps are known there, and they stay within its soft limits.
fn suit(machine: &Machine, tests: &[TestMotion]) -> bool {
    let mut axes = 0..machine.axis.len();
    axes.all(|axis| mapped::is_far_beyond(machine, tests, axis).is_ok_and(|is_far| !is_far))
        && tests.iter().all(|test| is_within_limits(machine, test))
}

fn is_within_limits(machine: &Machine, test: &TestMotion) -> bool {
    let Ok(path) = test.nominal_path(machine) else { return false };
    machine.axis.values().enumerate().all(|(index, axis)| {
        let [least_mm, most_mm] = path.extent_m(index).map(|m| 1e3 * m);
        axis.settings.limits.travel_mm.is_none_or(|[from, to]| least_mm >= from && most_mm <= to)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(model: &str) -> Vec<String> {
        let machine = Machine::parse(model, "m.toml").unwrap();
        default(&machine, 0.0).unwrap().into_iter().map(|test| test.motion.name).collect()
    }

    #[test]
    fn the_default_motions_suit_the_machine() {
        assert_eq!(names(model::examples::DEMO_MACHINE), ["circle", "corner"]);
        let one = "name = 'laser'\nsample_rate_hz = 1000.0\n[axis.x]\nlead_mm = 10.0\n";
        let map = |from_mm: f64| {
            format!(
                "[[axis.x.effect]]\nname = 'pitch_map'\npositions_mm = [{from_mm:.1}, {:.1}]\nerror_um = [0.0, 5.0]\n",
                from_mm + 400.0
            )
        };
        assert_eq!(names(one), ["travel"]);
        assert_eq!(names(&format!("{one}{}", map(0.0))), ["travel"]);
        assert_eq!(names(&format!("{one}travel_mm = [0.0, 400.0]\n")), ["travel"]);
        let two = format!("{one}[axis.y]\nlead_mm = 10.0\n");
        assert_eq!(names(&format!("{two}{}", map(-200.0))), ["circle", "corner"]);
        assert_eq!(names(&format!("{two}{}", map(0.0))), ["circle", "corners", "travel"]);
        assert_eq!(names(&format!("{two}travel_mm = [0.0, 400.0]\n")), ["circle", "corners", "travel"]);
    }
}
