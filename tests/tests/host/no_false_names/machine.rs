//! Machines of the second simulator (`self-test`), with the machine file that declares them.

use files::log::{Log, Unit};
use model::axis::KeyNames;
use model::machine::Machine;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use self_test::draw::{self, Deviations, Drawn, Motion};
use self_test::plant::{Mechanics, Sinusoid};
use self_test::{motion, simulation};
use trace::{Identification, trace};

/// Pause between two motions of a session, s.
const PAUSE_S: f64 = 20.0;

/// A machine without undeclared effects, as drawn from a seed, and its session of five motions. Tests change its true
/// values or its machine file.
pub struct TestMachine {
    /// True and declared values.
    pub drawn: Drawn,
    session: [Motion; 5],
    seed: u64,
}

impl TestMachine {
    /// True mechanical values within 6 % of the declared ones, whose tolerance is 10 %.
    pub fn new(seed: u64) -> Self {
        Self::with_deviations(seed, &draw::WITHIN_TOLERANCE)
    }

    /// True mechanical values that differ from the declared ones by at most the given fractions.
    pub fn with_deviations(seed: u64, deviations: &Deviations) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let drawn = draw::machine(deviations, &mut random);
        Self { drawn, session: draw::session(&mut random), seed }
    }

    /// This machine with other true mechanical values of an axis.
    pub fn with_mechanics(mut self, axis: usize, change: impl Fn(&mut Mechanics)) -> Self {
        change(&mut self.drawn.axes[axis].mechanics);
        self
    }

    /// This machine with another value of a key in the machine file.
    pub fn with_declared(mut self, axis: usize, key: &str, change: impl Fn(f64) -> f64) -> Self {
        let before = self.declared(axis, key);
        let text = &mut self.drawn.declared[axis].text;
        let [old, new] = [before, change(before)].map(|value| format!("\n{key} = {value}\n"));
        *text = if text.contains(&old) {
            text.replacen(&old, &new, 1)
        } else {
            text.replacen(&format!("\n{key} = {before:.1}\n"), &new, 1)
        };
        assert!(text.contains(&new), "{text}");
        self
    }

    /// Value of a key in the machine file.
    pub fn declared(&self, axis: usize, key: &str) -> f64 {
        let mut lines = self.drawn.declared[axis].text.lines();
        let value = lines.find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "));
        value.unwrap().parse().unwrap()
    }

    /// The declared machine.
    pub fn file(&self) -> Machine {
        let [x, y] = &self.drawn.declared;
        let text = format!(
            "name = \"m\"\nsample_rate_hz = 1000.0\nvelocity_loop_rate_hz = 4000.0\n\n{}\n{}",
            x.text, y.text
        );
        Machine::parse(&text, "m.toml").unwrap()
    }

    /// The logs to fit and to validate.
    pub fn logs(&self) -> [Vec<Log>; 2] {
        let mut start_s = 0.0;
        let log = |(index, motion): (u64, &Motion)| {
            let positions = motion::sampled(motion.start, &motion.segments, motion.pace);
            let mut random = ChaCha8Rng::seed_from_u64(self.seed);
            random.set_stream(index);
            let times_s = [start_s, self.drawn.recorder.jitter_s];
            let log = simulation::run_jittered(&self.drawn.axes, &positions, times_s, &mut random);
            // Whole ms, as in a log.
            start_s = (1e3 * (start_s + PAUSE_S) + positions.len() as f64).round() / 1e3;
            Log { source: motion.name.to_owned(), ..log }
        };
        let logs: Vec<Log> = (1..).zip(&self.session).map(log).collect();
        let (fit, validate) = logs.into_iter().partition(|log| log.source.starts_with("fit"));
        [fit, validate]
    }

    /// The trace of its logs.
    pub fn trace(&self) -> Identification {
        self.trace_of(|_| {})
    }

    /// The trace of its logs, each changed.
    pub fn trace_of(&self, change: impl FnMut(&mut Log)) -> Identification {
        let [mut fit, mut validate] = self.logs();
        fit.iter_mut().chain(&mut validate).for_each(change);
        trace(&self.file(), &fit, &validate, &|_| {}).unwrap()
    }

    /// The trace of its logs as those of joints: a metre is 1000°, a newton a newton metre.
    pub fn trace_as_joints(&self) -> Identification {
        let mut file = self.file();
        for axis in file.axis.values_mut() {
            axis.settings.names = KeyNames::Rotary;
        }
        let [mut fit, mut validate] = self.logs();
        for axis in fit.iter_mut().chain(&mut validate).flat_map(|log| &mut log.axes) {
            axis.unit = Unit::Degree;
        }
        trace(&file, &fit, &validate, &|_| {}).unwrap()
    }
}

/// amplitude·sin(2πx/period + phase), from µm and mm.
pub fn wave_um(amplitude_um: f64, period_mm: f64, phase: f64) -> Sinusoid {
    Sinusoid { amplitude: 1e-6 * amplitude_um, period: 1e-3 * period_mm, phase }
}
