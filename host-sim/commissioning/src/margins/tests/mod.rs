//! Margins against closed forms and against the simulated closed loop.

mod closed_forms;
mod simulated;

use model::machine::Machine;
use plant::instruments::Instruments;

/// One axis with a spring, without Coulomb friction: the simulation of it is linear.
pub fn machine(controller: &str, feedback: &str) -> Machine {
    let text = format!(
        "name = \"linear\"\nsample_rate_hz = 1000.0\nvelocity_loop_rate_hz = 4000.0\n[axis.x]\ncontroller = \"{controller}\"\n\
         position_gain_per_s = 50.0\nvelocity_gain_n_s_per_m = 60000.0\nvelocity_integral_time_s = 0.016\n\
         motor_mass_kg = 90.0\ntable_mass_kg = 160.0\nstiffness_n_per_um = 60.0\ndamping_n_s_per_m = 6000.0\n\
         viscous_n_s_per_m = 1000.0\nlead_mm = 10.0\nfeedback = \"{feedback}\"\n"
    );
    let time = if feedback == "dual" { "dual_feedback_time_constant_s = 0.03\n" } else { "" };
    Machine::parse(&(text + time), "linear.toml").unwrap()
}

/// Sensors without noise and quantisation; a drive lag, and latencies of a part of a tick and of more than one.
pub fn instruments() -> Instruments {
    Instruments {
        drive_time_constant_s: 2e-4,
        motor_latency_s: 1e-4,
        table_latency_s: 4e-4,
        ..Instruments::default()
    }
}
