//! Margins against closed forms and against the simulated closed loop.

mod closed_forms;
mod simulated;

use model::machine::Machine;
use plant::instruments::Instruments;

use super::{MarginLimits, axis_margins};

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

/// The margins of an axis with a gain schedule are the smallest of those of the axes that have the gain of one of its points. Before it is
/// homed, an axis whose gain depends on the position has the gain of the file, too.
#[test]
fn the_margins_with_a_gain_schedule_are_those_of_its_worst_gain() {
    let keys = |place: &str| {
        format!("gain_schedule_{place} = [0, 100, 200]\ngain_schedule_ratio = [0.5, 1.5, 0.8]\n")
    };
    let with_gain = |ratio: f64| {
        let mut machine = machine("p", "motor");
        let gain = &mut machine.axis.get_mut("x").unwrap().settings.controller.velocity_gain_n_s_per_m;
        *gain = gain.map(|gain| ratio * gain);
        machine
    };
    let margins = |machine: &Machine| {
        let margins = axis_margins::of_machine(machine, &instruments(), MarginLimits::default()).unwrap();
        let [axis] = margins.as_slice() else { panic!("{margins:?}") };
        [axis.velocity, axis.position]
            .map(|margins| [margins.gain_db, margins.phase_deg].map(|at| at.unwrap().0.value))
    };
    for (place, ratios) in
        [("position_mm", vec![0.5, 1.5, 0.8, 1.0]), ("speed_mm_per_s", vec![0.5, 1.5, 0.8])]
    {
        let text = machine("p", "motor")
            .to_toml()
            .replace("velocity_gain", &format!("{}velocity_gain", keys(place)));
        let found = margins(&Machine::parse(&text, "scheduled.toml").unwrap());
        let each: Vec<_> = ratios.iter().map(|ratio| margins(&with_gain(*ratio))).collect();
        for (part, kind) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let least = each.iter().map(|margins| margins[part][kind]).fold(f64::INFINITY, f64::min);
            assert!((found[part][kind] - least).abs() < 1e-9, "{place}: {found:?}, {each:?}");
        }
    }
}
