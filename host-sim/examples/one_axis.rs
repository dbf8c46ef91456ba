//! One axis in closed loop: machine and motion file as text, the controller in this process in fixed point, the simulated
//! machine, and the following error computed from the log.
//!
//! `cargo run --release -p host-sim --example one_axis`

use model::machine::Machine;
use motion::Motion;
use plant::instruments::Instruments;
use plant::machine_path::MachinePath;
use plant::simulate::{Run, controller};
use shared::scalar::Format;

/// Kp = 40 1/s without feed-forward: at 50 mm/s the following error is 50/40 = 1.25 mm.
const MACHINE: &str = r#"
name = "one axis"
sample_rate_hz = 1000.0
velocity_loop_rate_hz = 4000.0

[axis.x]
controller = "p"
position_gain_per_s = 40.0
velocity_gain_n_s_per_m = 30000.0
velocity_integral_time_s = 0.02
motor_mass_kg = 100.0
table_mass_kg = 150.0
stiffness_n_per_um = 150.0
damping_n_s_per_m = 3000.0
coulomb_n = 200.0
viscous_n_s_per_m = 300.0
"#;

const MOTION: &str = r#"
name = "there and back"
feed_mm_per_min = 3000.0
acceleration_m_per_s2 = 1.0
start_mm = { x = 0.0 }

[[block]]
line_to_mm = { x = 40.0 }

[[block]]
line_to_mm = { x = 0.0 }

[[block]]
dwell_s = 0.3
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!(
        "largest following error: {:.3} mm (expected: 50 mm/s / (40 1/s) = 1.25 mm)",
        largest_following_error_mm()?
    );
    Ok(())
}

fn largest_following_error_mm() -> Result<f64, Box<dyn std::error::Error>> {
    let machine = Machine::parse(MACHINE, "machine.toml")?;
    let path = MachinePath::new(&Motion::parse(MOTION, "motion.toml")?, &machine, "motion.toml")?;
    let mut controller = controller(&machine, Format::Fixed, &path.start_m)?;
    let run = Run {
        machine: &machine,
        instruments: Instruments::typical(1),
        start_m: &path.start_m,
        blocks: &path.blocks,
        start_s: 0.0,
    };
    let log = run.log(controller.as_mut(), |_, _, _| {})?;
    let axis = &log.axes[0];
    let channels = axis.command.iter().flatten().zip(axis.motor.iter().flatten());
    Ok(numerics::max_abs(channels.map(|(command, motor)| command - motor)))
}

#[test]
fn the_following_error_is_velocity_over_gain() -> Result<(), Box<dyn std::error::Error>> {
    // Tolerance of 2 %, as the velocity loop overshoots at the end of a ramp.
    let error_mm = largest_following_error_mm()?;
    assert!((1.25..1.02 * 1.25).contains(&error_mm), "{error_mm}");
    Ok(())
}
