//! Gaps of knowledge, of the kind `sparse`: a machine file or logs that lack something.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::draw::{self, Drawn};
use super::machine::AXES;
use super::truth::Truth;
use files::log::{Channel, Log};

/// The gaps. The number of a case determines the gap, in this order.
pub const NAMES: [&str; 11] = [
    "no_stiffness",
    "no_motor_coulomb",
    "no_force",
    "motor_and_force",
    "motor_and_tool",
    "tool_alone",
    "no_table",
    "no_controller",
    "no_masses",
    "coarse_log",
    "no_drive",
];

/// The gap of a case of the kind `sparse`.
#[must_use]
pub fn of_case(number: u64) -> &'static str {
    draw::in_turn(&NAMES, number)
}

/// Whether the machine file of a case with this gap declares the true mechanical values.
#[must_use]
pub fn is_declared_truly(name: &str) -> bool {
    name == "coarse_log"
}

/// Keys of the controller.
pub const CONTROLLER_KEYS: [&str; 8] = [
    "controller",
    "position_gain_per_s",
    "feedforward_percent",
    "velocity_gain_n_s_per_m",
    "velocity_integral_time_s",
    "force_limit_n",
    "feedback",
    "dual_feedback_time_constant_s",
];

/// Keys of the masses. A stiffness between unknown masses is refused in a machine file.
const MASS_KEYS: [&str; 4] = ["motor_mass_kg", "table_mass_kg", "stiffness_n_per_um", "damping_n_s_per_m"];

/// Keys of friction and of the accuracy of all mechanical values.
const FRICTION_KEYS: [&str; 6] = [
    "coulomb_n",
    "viscous_n_s_per_m",
    "motor_coulomb_n",
    "presliding_stiffness_n_per_um",
    "presliding_damping_n_s_per_m",
    "plant_tolerance_percent",
];

/// Keys of the machine file that a gap takes away.
fn lost_keys(name: &str) -> Vec<&'static str> {
    match name {
        "no_stiffness" => vec!["stiffness_n_per_um", "damping_n_s_per_m"],
        "no_motor_coulomb" => vec!["motor_coulomb_n"],
        "no_controller" => CONTROLLER_KEYS.to_vec(),
        "no_masses" => MASS_KEYS.to_vec(),
        // The pitch of the screw and the poles of the resolver are known alone.
        "no_drive" => [&CONTROLLER_KEYS[..], &MASS_KEYS, &FRICTION_KEYS].concat(),
        _ => Vec::new(),
    }
}

/// Channels of the logs that a gap takes away.
fn lost_channels(name: &str) -> &'static [Channel] {
    match name {
        "no_force" => &[Channel::Force],
        "motor_and_force" | "coarse_log" => &[Channel::Table, Channel::Tool],
        "motor_and_tool" => &[Channel::Table, Channel::Force],
        "tool_alone" => &[Channel::Motor, Channel::Table, Channel::Force],
        "no_table" => &[Channel::Table],
        "no_drive" => &[Channel::Tool, Channel::Force],
        _ => &[],
    }
}

/// Takes the keys of a gap out of a machine that has none of the other kinds' extras, and draws what it leaves unknown.
pub fn draw(name: &'static str, machine: &mut Drawn, random: &mut ChaCha8Rng) -> Vec<Truth> {
    for (axis, declared) in machine.axes.iter_mut().zip(&mut machine.declared) {
        declared.text = without(&declared.text, &lost_keys(name));
        match name {
            "no_motor_coulomb" => axis.mechanics.motor_coulomb_n = random.random_range(10.0..40.0),
            "coarse_log" => {
                axis.sensors.motor.steps_per_unit = if random.random_bool(0.5) { 2e3 } else { 1e3 };
            }
            _ => {}
        }
    }
    AXES.map(|axis| Truth { name, axis, parameters: Vec::new(), reference: None, phase_rad: 0.0 }).to_vec()
}

/// The text without the lines of some keys.
fn without(text: &str, keys: &[&str]) -> String {
    let key = |line: &str| line.split(" = ").next().unwrap_or_default().to_owned();
    let kept = text.lines().filter(|line| !keys.contains(&key(line).as_str()));
    kept.map(|line| format!("{line}\n")).collect()
}

/// Takes the channels of a gap out of the logs.
pub fn thin(name: &str, logs: &mut [Log]) {
    for axis in logs.iter_mut().flat_map(|log| &mut log.axes) {
        for channel in lost_channels(name) {
            match channel {
                Channel::Motor => axis.motor = None,
                Channel::Table => axis.table = None,
                Channel::Tool => axis.tool = None,
                Channel::Force => axis.force = None,
                Channel::Command | Channel::AddedForce | Channel::Temperature => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::super::chain;
    use super::*;

    #[test]
    fn cases_take_the_names_in_turn() {
        assert_eq!(
            [1, 2, 11, 12].map(of_case),
            ["no_stiffness", "no_motor_coulomb", "no_drive", "no_stiffness"]
        );
        assert_eq!(
            [1, 23, 24, 25].map(chain::of_case),
            ["feedback_late", "quant", "mode_on_table", "feedback_notch"]
        );
    }

    #[test]
    fn a_gap_takes_its_keys_away_and_leaves_a_valid_machine_file() {
        let mut random = ChaCha8Rng::seed_from_u64(6);
        for name in NAMES {
            let mut machine = draw::machine(&draw::WITHIN_TOLERANCE, &mut random);
            let before = machine.declared[0].text.lines().count();
            let extras = draw(name, &mut machine, &mut random);
            assert_eq!(extras.iter().map(|extra| extra.axis).collect::<Vec<_>>(), AXES);
            let text = &machine.declared[0].text;
            let lost = lost_keys(name).iter().filter(|key| **key != "dual_feedback_time_constant_s").count();
            let left = text.lines().count();
            // The time constant of dual feedback is declared in some machines.
            assert!((before - lost - 1..=before - lost).contains(&left), "{name}: {text}");
            let file =
                format!("name = \"m\"\nsample_rate_hz = 1000.0\nvelocity_loop_rate_hz = 4000.0\n\n{text}");
            assert!(
                trace::Machine::parse(&file, name).is_ok(),
                "{name}: {:?}",
                trace::Machine::parse(&file, name).err()
            );
        }
    }
}
