//! Machines with an effect, their compensation, and the contour error that the effect causes with and without its item.

use std::f64::consts::TAU;

use compensate::Plan;
use compensate::plan::Planning;
use compensate::prediction::TestMotion;
use model::machine::Machine;
use model::motion::Motion;
use plant::instruments::Instruments;

/// The machine without undeclared effects.
pub const PLAIN: &str = include_str!("../../../host-sim/machines/demo.toml");

/// Radius of the circle, mm, and speed on it, mm/s.
pub const RADIUS_MM: f64 = 20.0;
pub const SPEED_MM_S: f64 = 50.0;

/// A circle in each direction, with a change of direction at rest; 5.6 s.
pub const CIRCLE: &str = r#"name = "circle of 20 mm"
feed_mm_per_min = 3000.0
acceleration_m_per_s2 = 1.0
start_mm = { x = 20.0, y = 0.0 }

[[block]]
dwell_s = 0.2

[[block]]
arc = { plane = ["x", "y"], centre_mm = { x = 0.0, y = 0.0 }, turns = 1.0 }

[[block]]
dwell_s = 0.2

[[block]]
arc = { plane = ["x", "y"], centre_mm = { x = 0.0, y = 0.0 }, turns = -1.0 }

[[block]]
dwell_s = 0.1
"#;

/// The machine file with an effect of its x axis.
pub fn with(machine: &str, effect: &str) -> String {
    format!("{machine}\n[[axis.x.effect]]\n{effect}\n")
}

/// A text with each `from`, which must exist, replaced.
pub fn changed(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "no {from}");
    text.replace(from, to)
}

/// A motion that starts at a time on the session clock, s.
pub fn motion(text: &str, start_s: f64) -> TestMotion {
    TestMotion { motion: Motion::parse(text, "motion.toml").unwrap(), source: "motion.toml".to_owned(), start_s }
}

pub fn machine(text: &str) -> Machine {
    Machine::parse(text, "machine.toml").unwrap()
}

/// The compensation of a machine for a motion, set at the start of the motion.
pub fn plan(machine: &Machine, test: &TestMotion) -> Plan {
    let planning = Planning {
        model: machine,
        model_file: "machine.toml",
        tests: std::slice::from_ref(test),
        instruments: Instruments::of(machine, 1),
        set_at_s: test.start_s,
    };
    planning.plan().unwrap()
}

/// What an effect does to the contour error, µm rms over the motion.
#[derive(Debug)]
pub struct Compensated {
    name: String,
    /// The machine without the effect, compensated.
    floor_um: f64,
    /// The machine with the effect and all of its compensation but that of the effect.
    without_um: f64,
    /// The machine with the effect and all of its compensation.
    with_um: f64,
}

impl Compensated {
    /// The effect of the x axis of a machine, given by its keys, on the circle.
    pub fn of(effect: &str) -> Self {
        Self::on(PLAIN, effect, &motion(CIRCLE, 0.0))
    }

    pub fn on(plain: &str, effect: &str, test: &TestMotion) -> Self {
        let floor_um = plan(&machine(plain), test).file.predicted[0].after_um;
        let machine = machine(&with(plain, effect));
        let name = machine.axis["x"].effect[0].name().to_owned();
        let plan = plan(&machine, test);
        let item = plan.items.iter().find(|item| item.effect == name && item.axis == "x");
        let item = item.unwrap_or_else(|| panic!("{name} is not compensated: {:?}", plan.not_compensated));
        Self { name, floor_um, without_um: item.before_um, with_um: item.after_um }
    }

    /// Part of the contour error that the effect causes without its item, µm rms.
    pub fn caused_um(&self) -> f64 {
        (self.without_um.powi(2) - self.floor_um.powi(2)).max(0.0).sqrt()
    }

    /// What is left of it with its item, µm rms.
    pub fn left_um(&self) -> f64 {
        (self.with_um.powi(2) - self.floor_um.powi(2)).max(0.0).sqrt()
    }

    /// Asserts that the effect causes an error within a fraction of its equation, µm rms, and that its item removes at least a
    /// share of it.
    pub fn assert(&self, expected_um: f64, fraction: f64, share: f64) {
        let caused_um = self.caused_um();
        eprintln!("RESULT {:<24} expected {expected_um:8.3} caused {caused_um:8.3} left {:8.3} removed {:.3} {self:?}", self.name, self.left_um(), 1.0 - self.left_um() / caused_um);
        let bound_um = fraction * expected_um;
        assert!((caused_um - expected_um).abs() <= bound_um, "{self:?}: causes {caused_um} of {expected_um} ± {bound_um} µm");
        let removed = 1.0 - self.left_um() / caused_um;
        assert!(removed >= share, "{self:?}: {removed} of what it causes is removed");
    }
}

/// Rms of the contour error on the circle, µm, for an error of x, µm, that is a function of the angle and of the direction (1 or
/// −1) in which the angle changes: its part along the radius is that times cos θ.
pub fn radial_rms_um(error_um: impl Fn(f64, f64) -> f64) -> f64 {
    const STEPS: u32 = 36_000;
    let square = |direction: f64| {
        let angles = (0..STEPS).map(|i| TAU * (f64::from(i) + 0.5) / f64::from(STEPS));
        angles.map(|theta| (error_um(theta, direction) * theta.cos()).powi(2)).sum::<f64>() / f64::from(STEPS)
    };
    (0.5 * (square(1.0) + square(-1.0))).sqrt()
}

/// Position of x on the circle, m.
pub fn position_m(theta: f64) -> f64 {
    1e-3 * RADIUS_MM * theta.cos()
}

/// Velocity of x on the circle, m/s.
pub fn velocity_m_per_s(theta: f64, direction: f64) -> f64 {
    -1e-3 * SPEED_MM_S * direction * theta.sin()
}

/// Acceleration of x on the circle, m/s².
pub fn acceleration_m_per_s2(theta: f64) -> f64 {
    -1e-3 * SPEED_MM_S.powi(2) / RADIUS_MM * theta.cos()
}
