//! The effect `lost_motion` of a machine file: friction and presliding describe the sliding together, and one without the other is refused.

use super::work_folder::{MACHINE, TRACE, WorkFolder, log};

/// A machine without masses and stiffness, with the effect on axis y.
fn machine(keys: &str) -> String {
    let of_drive_train = [
        "motor_mass",
        "table_mass",
        "stiffness",
        "damping",
        "coulomb",
        "viscous",
        "motor_coulomb",
        "presliding",
    ];
    let kept = MACHINE.lines().filter(|line| !of_drive_train.iter().any(|key| line.starts_with(key)));
    let kept: Vec<&str> = kept.collect();
    format!("{}\n\n[[axis.y.effect]]\nname = \"lost_motion\"\nwidth_um = 5.0\n{keys}\n", kept.join("\n"))
}

#[test]
fn friction_and_presliding_are_given_together() {
    for (keys, missing, given) in [
        ("friction_m_per_s2 = 0.5", "presliding_um", "friction_m_per_s2"),
        ("presliding_um = 5.0", "friction_m_per_s2", "presliding_um"),
    ] {
        let machine = machine(keys);
        let line = machine.lines().position(|line| line == "[[axis.y.effect]]").unwrap() + 1;
        let folder = WorkFolder::with(&[("machine.toml", machine.as_str()), ("fit.csv", log())]);
        let message = folder.fails(TRACE, 2);
        let expected = format!(
            "lost-motion: machine.toml: line {line}: axis.y.effect[0].{missing}: expected a value beside {given}, found none\n"
        );
        assert_eq!(message, expected);
        assert!(!folder.path().join("out.json").exists());
    }
    for keys in ["", "friction_m_per_s2 = 0.5\npresliding_um = 5.0"] {
        let machine = machine(keys);
        let folder = WorkFolder::with(&[("machine.toml", machine.as_str()), ("fit.csv", log())]);
        folder.succeeds("trace --machine machine.toml --fit fit.csv --evaluate");
    }
}
