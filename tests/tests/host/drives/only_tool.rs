//! Machines with a probe at the tool and no linear scale.

use super::{Command, SAMPLE_S, Simulated, behind_gap, found, log, machine, stepping, swinging};
use trace::{Identification, trace};

/// A motor that follows its command, and a tool behind a gap (mm) and a screw with a relative error of its lead and a periodic error (mm)
/// with the lead of 10 mm. The tool is in the place of the table.
fn simulated(command: Command, seconds: u32, [gap, slope, periodic]: [f64; 3]) -> Simulated {
    let command: Vec<f64> = (0..1000 * seconds).map(|i| command(SAMPLE_S * f64::from(i))).collect();
    let screw = |x: &f64| (1.0 + slope) * x + periodic * (std::f64::consts::TAU * x / 10.0 + 0.3).sin();
    let table = behind_gap(&command.iter().map(screw).collect::<Vec<f64>>(), gap);
    Simulated { motor: command.clone(), command, table }
}

fn traced(truth: [f64; 3], seed: u64) -> Identification {
    let probed = |name: &str, seed, command, seconds| {
        let mut log = log(name, seed, simulated(command, seconds, truth), true);
        log.axes[0].tool = log.axes[0].table.take();
        log
    };
    let logs = [
        probed("swing.csv", seed, swinging as Command, 12),
        probed("step.csv", seed + 100, stepping, 15),
        probed("held.csv", seed + 200, |t| swinging(t + 3.0), 8),
    ];
    trace(&machine("lead_mm = 10.0\n"), &logs[..2], &logs[2..], &|_| {}).unwrap()
}

#[test]
fn a_screw_error_and_lost_motion_are_found_at_the_tool() {
    let trace = traced([7e-3, 0.0, 2.5e-3], 1);
    let (_, width_um, half) = found(&trace, "lost_motion").unwrap();
    assert!((width_um - 7.0).abs() < half.max(0.1) && half < 0.3, "{width_um} ± {half}");
    let (_, amplitude_um, half) = found(&trace, "pitch_cyclic").unwrap();
    assert!((amplitude_um - 2.5).abs() < half.max(0.05) && half < 0.2, "{amplitude_um} ± {half}");
}

/// From the motor to the tool, a slope is that of the screw or of the probe.
#[test]
fn a_slope_is_that_of_the_screw_or_of_the_probe() {
    let trace = traced([0.0, 80e-6, 0.0], 2);
    let (slope, um_per_m, half) = found(&trace, "pitch_progressive").unwrap();
    assert!((um_per_m - 80.0).abs() < half.max(0.5) && half < 5.0, "{um_per_m} ± {half}");
    assert_eq!(slope.rival_names(), ["probe_gain"]);
}

#[test]
fn a_tool_that_follows_the_motor_has_no_effect() {
    assert_eq!(super::names(&traced([0.0; 3], 3)), [""; 0]);
}
