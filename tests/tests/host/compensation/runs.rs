//! Machines with an effect, their compensation, and the error that the effect causes with and without its item.

use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex};

use commissioning::compensate::controller_host::ControllerHost;
use commissioning::compensate::planning::Planning;
use commissioning::compensate::prediction::{self, TestMotion};
use commissioning::compensate::{CompensationFile, Plan};
use contour::LoggedMotion;
use files::log::{Channel, Log};
use model::machine::Machine;
use plant::instruments::Instruments;

/// The machine without undeclared effects.
pub const PLAIN: &str = include_str!("../../../../host-sim/machines/demo.toml");

/// A circle of 20 mm in each direction, with a change of direction at rest, from an angle (degrees) on.
pub fn circle(mm_s: f64, ramps: &str, from_deg: f64) -> String {
    let (feed, (y, x)) = (60.0 * mm_s, from_deg.to_radians().sin_cos());
    let arc = |turns: f64| {
        format!(
            "[[block]]\narc = {{ plane = [\"x\", \"y\"], centre_mm = {{ x = 0.0, y = 0.0 }}, turns = {turns:?} }}\n\
             [[block]]\ndwell_s = 0.2\n"
        )
    };
    format!(
        "name = \"circle\"\nfeed_mm_per_min = {feed:?}\n{ramps}\nstart_mm = {{ x = {:?}, y = {:?} }}\n\
         [[block]]\ndwell_s = 0.2\n{}{}",
        20.0 * x,
        20.0 * y,
        arc(1.0),
        arc(-1.0)
    )
}

/// Speed on the circle of most tests, mm/s: 5.7 s, of which 0.6 s after [`START_S`] are at rest or in ramps.
pub const SPEED_MM_S: f64 = 50.0;

/// The circle of most tests.
pub fn usual() -> TestMotion {
    motion(&circle(SPEED_MM_S, "acceleration_m_per_s2 = 1.0", 0.0), 0.0)
}

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
    TestMotion::parse(text, "motion.toml", start_s).unwrap()
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
        watched: &[],
        instruments: Instruments::default(),
        set_at_s: test.start_s,
    };
    planning.plan().unwrap()
}

/// The compensation of a machine for a motion, once for each of them.
fn kept_plan(text: &str, test: &TestMotion) -> Arc<Plan> {
    static PLANS: LazyLock<Mutex<HashMap<String, Arc<Plan>>>> = LazyLock::new(Mutex::default);
    let key = format!("{text}{test:?}");
    let kept = PLANS.lock().unwrap().get(&key).cloned();
    kept.unwrap_or_else(|| {
        let plan = Arc::new(plan(&machine(text), test));
        PLANS.lock().unwrap().insert(key, plan.clone());
        plan
    })
}

/// The log of a machine with ideal sensors.
pub fn log(machine: &Machine, file: &CompensationFile, test: &TestMotion) -> Log {
    prediction::log(machine, file, test, (Instruments::default(), ControllerHost::Host)).unwrap()
}

/// Contour error, µm rms.
pub fn contour_um(log: &Log) -> f64 {
    LoggedMotion::of(log).unwrap().contour_error().unwrap().rms_um
}

/// What an effect of the x axis does to the tool on the circle, µm rms.
#[derive(Debug)]
#[expect(clippy::struct_field_names, reason = "the unit")]
pub struct Comparison {
    /// Radial error that the effect adds without its item.
    caused_um: f64,
    /// Radial error that it adds with its item.
    left_um: f64,
    /// Contour error of the machine without the effect, with the effect without its item, and with it.
    pub contour_um: [f64; 3],
}

impl Comparison {
    /// An effect, given by its keys, on the usual circle.
    pub fn of(effect: &str) -> Self {
        Self::on(PLAIN, effect, &usual())
    }

    /// An effect of a machine: without its item, the compensation is that of the machine without the effect.
    pub fn on(plain: &str, effect: &str, test: &TestMotion) -> Self {
        let text = with(plain, effect);
        let name = machine(&text).axis["x"].effect[0].name().to_owned();
        Self::of_item([plain, &text], &name, test)
    }

    /// A machine file without and with an error of x, which has an item of a name.
    pub fn of_item(texts: [&str; 2], name: &str, test: &TestMotion) -> Self {
        let [rest, all] = texts.map(|text| kept_plan(text, test));
        let is_item =
            |item: &commissioning::compensate::listed::Item| item.effect == name && item.axis == "x";
        assert!(all.items.iter().any(is_item), "{name} is not compensated: {:?}", all.not_compensated);
        Self::of_machines(texts.map(machine), test, [&rest.file, &all.file])
    }

    /// An effect of a machine with compensation files without and with its item.
    pub fn between(
        plain: &str,
        effect: &str,
        test: &TestMotion,
        [rest, all]: [&CompensationFile; 2],
    ) -> Self {
        Self::of_machines([machine(plain), machine(&with(plain, effect))], test, [rest, all])
    }

    fn of_machines(
        [plain, machine]: [Machine; 2],
        test: &TestMotion,
        [rest, all]: [&CompensationFile; 2],
    ) -> Self {
        let logs = [log(&plain, rest, test), log(&machine, rest, test), log(&machine, all, test)];
        Self {
            caused_um: radial_difference_um(&logs[1], &logs[0]),
            left_um: radial_difference_um(&logs[2], &logs[0]),
            contour_um: logs.each_ref().map(contour_um),
        }
    }

    /// Asserts that the effect adds its expected error, µm rms, within a fraction, that its item removes at least a share of
    /// that, and that the contour error becomes smaller.
    pub fn assert(&self, expected_um: f64, fraction: f64, share: f64) {
        self.assert_caused(expected_um, fraction);
        self.assert_removed(share);
        assert!(self.contour_um[2] < self.contour_um[1], "{self:?}");
    }

    pub fn assert_caused(&self, expected_um: f64, fraction: f64) {
        let bound_um = fraction * expected_um;
        let is_expected = (self.caused_um - expected_um).abs() <= bound_um;
        assert!(is_expected, "{self:?}: expected {expected_um} ± {bound_um} µm");
    }

    pub fn assert_removed(&self, share: f64) {
        let removed = 1.0 - self.left_um / self.caused_um;
        assert!(removed >= share, "{self:?}: {removed} is removed, expected {share}");
    }
}

/// The start of a log, s: at rest the axis creeps through its presliding to the corrected position, and reaches it within 0.2 s
/// after the start of the motion at 0.2 s.
const START_S: f64 = 0.6;

/// Rms of the difference of two tool paths along the radius, µm.
pub fn radial_difference_um(log: &Log, other: &Log) -> f64 {
    let radial = |log: &Log| -> Vec<f64> {
        let channel = |axis: &str, channel| log.axis(axis).unwrap().channel(channel).unwrap();
        let (x, y) = (channel("x", Channel::Command), channel("y", Channel::Command));
        let along = |i: usize| {
            let [tool_x, tool_y] = ["x", "y"].map(|axis| channel(axis, Channel::Tool)[i]);
            1e3 * (tool_x * x[i] + tool_y * y[i]) / x[i].hypot(y[i])
        };
        let is_counted = |i: &usize| *i as f64 * log.sample_time_s >= START_S;
        (0..log.len()).filter(is_counted).map(along).collect()
    };
    let (one, two) = (radial(log), radial(other));
    assert_eq!(one.len(), two.len());
    (one.iter().zip(&two).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / one.len() as f64).sqrt()
}
