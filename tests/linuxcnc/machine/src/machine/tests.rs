use super::*;

/// Two axes of 100 kg each with a friction of 50 N.
const MACHINE: &str = r#"
name = "m"
sample_rate_hz = 1000.0
velocity_loop_rate_hz = 4000.0
[axis.x]
controller = "p"
position_gain_per_s = 200.0
feedforward_percent = 100.0
velocity_gain_n_s_per_m = 50000.0
table_mass_kg = 100.0
motor_mass_kg = 0.0
coulomb_n = 50.0
feedback = "motor"
[axis.y]
controller = "p"
position_gain_per_s = 200.0
feedforward_percent = 100.0
velocity_gain_n_s_per_m = 50000.0
table_mass_kg = 100.0
motor_mass_kg = 0.0
coulomb_n = 50.0
feedback = "motor"
"#;

/// Pins of x after a time (s) with a command over the time.
fn moved(command: Command, seconds: f64, at: impl Fn(f64) -> f64) -> AxisPins {
    let folder = std::env::temp_dir().join(format!("linuxcnc-machine-{}-{command:?}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("m.toml");
    std::fs::write(&path, MACHINE).unwrap();
    let mut machine = SimulatedMachine::read(&path, command).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    let mut pins = [AxisPins::default(); AXES];
    let mut time_s = 0.0;
    while time_s < seconds - 0.5e-3 {
        time_s += machine.period_s();
        pins[0].command = at(time_s);
        assert!(machine.step(&mut pins));
    }
    assert!(pins[1].motor.abs() < 1e-3, "y was not commanded: {pins:?}");
    pins[0]
}

/// 150 N less 50 N of friction on 100 kg: 1 m/s² over 0.1 s, less the 0.1 ms by which the drive's force is late. The velocity is the mean
/// of the last millisecond.
#[test]
fn a_force_accelerates() {
    let pins = moved(Command::Force, 0.1, |_| 150.0);
    assert!((pins.motor - 4.99).abs() < 0.01, "{pins:?}");
    assert!((pins.velocity - 99.4).abs() < 0.1, "{pins:?}");
}

/// Without an integral part the drive is slower than its command by friction over gain: 50 N over 50 000 N·s/m are 1 mm/s.
#[test]
fn a_velocity_is_followed_but_for_the_friction() {
    let pins = moved(Command::Velocity, 0.2, |_| 20.0);
    assert!((pins.velocity - 19.0).abs() < 0.1, "{pins:?}");
}

/// Friction over stiffness: 50 N over 200/s · 50 000 N·s/m are 5 µm behind the command.
#[test]
fn a_rotor_is_behind_its_field_by_friction_over_stiffness() {
    let pins = moved(Command::Position, 0.3, |time_s| 10.0 * time_s);
    assert!((3.0 - pins.motor - 5e-3).abs() < 0.5e-3, "{pins:?}");
}

#[test]
fn a_machine_of_one_axis_is_refused() {
    let path = std::env::temp_dir().join(format!("linuxcnc-machine-{}-one.toml", std::process::id()));
    std::fs::write(&path, MACHINE.split("[axis.y]").next().unwrap()).unwrap();
    let refused = SimulatedMachine::read(&path, Command::Force).err().unwrap().to_string();
    std::fs::remove_file(&path).unwrap();
    assert!(refused.contains("expected a machine of 2 axes, found 1 axes"), "{refused}");
}
