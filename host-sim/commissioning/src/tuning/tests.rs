use super::*;
use crate::margins::axis_margins::AxisLoops;

/// A rigid axis: 100 kg, velocity loop at 8 kHz, position loop at 2 kHz, no lag of drive or sensors.
pub const RIGID: &str = r#"name = "rigid"
sample_rate_hz = 2000.0
velocity_loop_rate_hz = 8000.0

[instruments]
drive_time_constant_ms = 0.0

[axis.x]
controller = "p"
position_gain_per_s = 20.0
velocity_gain_n_s_per_m = 5000.0
velocity_integral_time_s = 0.05
motor_mass_kg = 40.0
table_mass_kg = 60.0
"#;

pub fn machine(text: &str) -> Machine {
    Machine::parse(text, "test.toml").unwrap()
}

/// With sampling alone, the loop Kv/(m·s) lags by 1.5 ticks: one half by the hold of the force, one half by the difference of the
/// reading, and one by the next tick's force at the latest. With 14° of the integral part, 45° remain at ωc·1.0…1.5 ticks = 31°,
/// so that ωc lies between 0.36 and 0.54 a tick; the gain margin of 10 dB asks for about a third of the gain of 2 a tick at which
/// such a loop is unstable, 0.63.
#[test]
fn the_velocity_loop_of_a_rigid_axis_is_as_fast_as_its_sampling_allows() {
    let machine = machine(RIGID);
    let limits = MarginLimits { gain_db: 10.0, phase_deg: 45.0 };
    let instruments = Instruments::of(&machine, 0);
    let tuned = velocity_loop::fastest(&machine, &instruments, limits, &[]).unwrap();
    let controller = &tuned.axis["x"].settings.controller;
    let per_tick = controller.velocity_gain_n_s_per_m.unwrap() / 100.0 / 8000.0;
    assert!((0.3..0.65).contains(&per_tick), "{per_tick}");
    let corner =
        controller.velocity_integral_time_s.unwrap() * controller.velocity_gain_n_s_per_m.unwrap() / 100.0;
    assert!((corner - 4.0).abs() < 1e-9);
    assert!(AxisLoops::of_machine(&tuned, &instruments).unwrap()[0].velocity().meet(limits));
}

/// One count of 1 µm in a tick of 125 µs is 8 mm/s; 1 % of 400 N over it is 500 N·s/m.
#[test]
fn a_coarse_encoder_limits_the_velocity_gain() {
    let coarse = RIGID
        .replace("[axis.x]", "motor_resolution_um = 1.0\n\n[axis.x]")
        .replace("controller = \"p\"", "controller = \"p\"\nforce_limit_n = 400.0");
    // A crossover of 5 rad/s with 100 kg would be below the slowest that is tried: a tenth of the mass.
    let coarse = machine(&coarse.replace("40.0", "4.0").replace("60.0", "6.0"));
    let limits = MarginLimits::default();
    let tuned = velocity_loop::fastest(&coarse, &Instruments::of(&coarse, 0), limits, &[]).unwrap();
    let gain = tuned.axis["x"].settings.controller.velocity_gain_n_s_per_m.unwrap();
    assert!(gain <= 500.0 && gain > 500.0 / 1.05, "{gain}");
}

/// Every proposed loop has the margins, the best one is better than the declared one, and P with feed-forward follows a circle
/// better than without.
#[test]
fn a_proposal_has_its_margins_and_a_smaller_error() {
    let machine = machine(model::examples::DEMO_MACHINE);
    let limits = MarginLimits { gain_db: 8.0, phase_deg: 40.0 };
    let circle = include_str!("../../../motions/demo_ballbar.toml");
    let tests = [TestMotion::parse(circle, "demo_ballbar.toml", 0.0).unwrap()];
    let instruments = Instruments::of(&machine, 1);
    let tuning = Tuning { machine: &machine, instruments, limits, tests: &tests, measured: &[] };
    let proposal = tuning.propose().unwrap();
    // Both laws on the motor, with four feed-forwards each.
    assert_eq!(proposal.tried.len(), 8);
    for tried in &proposal.tried {
        for axis in &tried.margins {
            assert!(axis.velocity.meet(limits) && axis.position.meet(limits), "{axis:?}");
        }
    }
    let best = proposal.best().unwrap();
    let [best_um, declared_um] = [best, &proposal.declared].map(|tried| tried.contour_um.unwrap());
    assert!(best_um < 0.5 * declared_um, "{best_um} µm");
    let of = |percent: f64| {
        let is = |tried: &&Tried| {
            tried.candidate.is_some_and(|c| {
                c.law == model::axis::Law::P && (c.feedforward_percent - percent).abs() < 1e-9
            })
        };
        proposal.tried.iter().find(is).unwrap().contour_um
    };
    assert!(of(100.0) < of(0.0));
}
