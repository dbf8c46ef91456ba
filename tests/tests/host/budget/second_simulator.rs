//! Causes taken out of the machines of the second simulator.

use std::fmt::Write;

use contour::LoggedMotion;
use files::log::Log;
use model::machine::Machine;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use self_test::draw::{self, Drawn};
use self_test::effect;
use self_test::machine::{AXES, Axis};
use self_test::motion::{Pace, Segment, sampled};
use self_test::sensors::Sensors;
use self_test::simulation;
use self_test::truth::{NAMES, Truth};

use super::on_circle;

/// A machine of the second simulator with two effects, and the model that says so.
struct Known {
    drawn: Drawn,
    truths: Vec<Truth>,
    model: Machine,
}

/// A cause in the second simulator.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cause {
    Lag,
    GainDifference,
    Friction(usize),
    Effect(usize),
}

impl Known {
    fn new(seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut drawn = draw::machine(&draw::TRUE, &mut random);
        // Where gains differ, little else counts on a circle.
        if seed % 2 == 1 {
            give_same_gains(&mut drawn);
        }
        // A delay of a reading in the log makes no error of the tool, and in this simulator there is no Stribeck friction without a friction
        // whose part it is.
        let is_drawn = |name: &&str| !["latency", "stribeck"].contains(name);
        let names: Vec<&str> = NAMES.into_iter().filter(is_drawn).collect();
        let number = usize::try_from(seed).unwrap();
        let [first, second] = [number, number / names.len() + 3 * number + 1];
        let truths: Vec<Truth> = [(first, 0), (second, 1)]
            .into_iter()
            .map(|(number, axis)| effect::draw(names[number % names.len()], axis, &drawn, &mut random))
            .collect();
        let model = model(&drawn, &truths);
        Self { drawn, truths, model }
    }

    fn causes(&self) -> Vec<Cause> {
        let [x, y] = &self.drawn.axes;
        let has_difference = (x.servo.position_gain_per_s - y.servo.position_gain_per_s).abs() > 0.0;
        let of_gains = has_difference.then_some(Cause::GainDifference);
        let effects = (0..self.truths.len()).map(Cause::Effect);
        let declared = [Cause::Lag, Cause::Friction(0), Cause::Friction(1)];
        declared.into_iter().chain(of_gains).chain(effects).collect()
    }

    /// Name and axis of a cause in a budget.
    fn name(&self, cause: Cause) -> (&'static str, Option<&'static str>) {
        match cause {
            Cause::Lag => ("following_lag", None),
            Cause::GainDifference => ("declared_gain_difference", None),
            Cause::Friction(axis) => ("friction_reversal", Some(AXES[axis])),
            Cause::Effect(number) => (self.truths[number].name, Some(self.truths[number].axis)),
        }
    }

    /// The log of the circle with some causes; the lag always acts. Exact sensors.
    fn log(&self, causes: &[Cause]) -> Log {
        let mut axes: [Axis; 2] = self.drawn.axes.clone();
        if !causes.contains(&Cause::GainDifference) {
            let mean = |of: fn(&Axis) -> f64| 0.5 * axes.iter().map(of).sum::<f64>();
            let gain_per_s = mean(|axis| axis.servo.position_gain_per_s);
            let feedforward = mean(|axis| axis.servo.feedforward);
            for axis in &mut axes {
                (axis.servo.position_gain_per_s, axis.servo.feedforward) = (gain_per_s, feedforward);
            }
        }
        for (index, axis) in axes.iter_mut().enumerate() {
            axis.sensors = Sensors::default();
            if !causes.contains(&Cause::Friction(index)) {
                let mechanics = &mut axis.mechanics;
                (mechanics.viscous_n_s_per_m, mechanics.motor_coulomb_n) = (0.0, 0.0);
                // Bristles of no stiffness carry no force; their deflection is divided by the Coulomb friction.
                (mechanics.presliding_n_per_m, mechanics.presliding_n_s_per_m) = (0.0, 0.0);
                mechanics.coulomb_n = 1e-6;
            }
        }
        for (number, truth) in self.truths.iter().enumerate() {
            if causes.contains(&Cause::Effect(number)) {
                let axis = AXES.iter().position(|axis| *axis == truth.axis).unwrap();
                effect::apply(truth, &mut axes[axis]);
            }
        }
        let pause = Segment::Dwell(0.2);
        let segments =
            [Segment::Dwell(0.5), Segment::Arc([0.0; 2], 1.0), pause, Segment::Arc([0.0; 2], -1.0), pause];
        let pace = Pace { speed: 50.0, acceleration: 1000.0, ..Pace::default() };
        let positions = sampled([30.0, 0.0], &segments, pace);
        simulation::run(&axes, &positions, 0.0, &mut ChaCha8Rng::seed_from_u64(0))
    }

    /// Rms of the contour error, µm: with all causes, and for each alone and with all but it.
    fn errors_um(&self) -> (f64, Vec<[f64; 2]>) {
        let causes = self.causes();
        let (lag, all) = (self.log(&[Cause::Lag]), self.log(&causes));
        let each = causes.iter().map(|cause| {
            if *cause == Cause::Lag {
                return [rms_um(&lag), rms_um(&less(&all, &lag))];
            }
            let others: Vec<Cause> = causes.iter().copied().filter(|other| other != cause).collect();
            [rms_um(&less(&self.log(&[*cause]), &lag)), rms_um(&self.log(&others))]
        });
        (rms_um(&all), each.collect())
    }
}

/// Gives y the position gain and the feed-forward of x, which its machine file says, too.
fn give_same_gains(drawn: &mut Drawn) {
    let [x, y] = &mut drawn.axes;
    (y.servo.position_gain_per_s, y.servo.feedforward) = (x.servo.position_gain_per_s, x.servo.feedforward);
    let [x, y] = &mut drawn.declared;
    for key in ["position_gain_per_s", "feedforward_percent"] {
        let line = |text: &str| text.lines().find(|line| line.starts_with(key)).unwrap().to_owned();
        y.text = y.text.replace(&line(&y.text), &line(&x.text));
    }
}

/// The machine file with the true values and effects.
fn model(drawn: &Drawn, truths: &[Truth]) -> Machine {
    let mut text = "name = \"m\"\nsample_rate_hz = 1000.0\nvelocity_loop_rate_hz = 4000.0\n".to_owned();
    for (axis, declared) in AXES.iter().zip(&drawn.declared) {
        writeln!(text, "{}", declared.text).unwrap();
        for truth in truths.iter().filter(|truth| truth.axis == *axis) {
            writeln!(text, "[[axis.{axis}.effect]]\nname = \"{}\"", truth.name).unwrap();
            for (key, value) in &truth.parameters {
                writeln!(text, "{key} = {value:?}").unwrap();
            }
            if let Some((key, reference)) = truth.reference {
                writeln!(text, "{key} = \"{reference}\"").unwrap();
            }
            if truth.parameters.iter().any(|(key, _)| *key == "period_mm") {
                writeln!(text, "phase_rad = {:?}", truth.phase_rad).unwrap();
            }
        }
    }
    Machine::parse(&text, "m.toml").unwrap()
}

fn rms_um(log: &Log) -> f64 {
    LoggedMotion::of(log).unwrap().contour_error().unwrap().rms_um
}

/// A log whose tool is not displaced as in another.
fn less(log: &Log, other: &Log) -> Log {
    let mut log = log.clone();
    for (axis, other) in log.axes.iter_mut().zip(&other.axes) {
        let (command, tool) = (other.command.as_ref().unwrap(), other.tool.as_ref().unwrap());
        let own = axis.tool.as_mut().unwrap();
        own.iter_mut()
            .zip(command.iter().zip(tool))
            .for_each(|(own, (command, tool))| *own -= tool - command);
    }
    log
}

/// What the budget of a model says of a machine of the second simulator.
struct Compared {
    seed: u64,
    /// First of the ranking, and the true first.
    first: [String; 2],
    /// Whole, µm rms: of the budget, and true.
    whole_um: [f64; 2],
    /// Of each cause, µm rms: what goes away with it, in squares: of the budget, and true.
    gone_um: Vec<(String, [f64; 2])>,
}

fn compared(seed: u64) -> Compared {
    let known = Known::new(seed);
    let budget = on_circle(&known.model);
    let (whole_um, each) = known.errors_um();
    let root = |square: f64| square.max(0.0).sqrt();
    let share = |[alone, without]: [f64; 2]| 0.5 * (alone.powi(2) + whole_um.powi(2) - without.powi(2));
    let causes = known.causes();
    let title = |(name, axis): (&str, Option<&str>)| format!("{name} {}", axis.unwrap_or("all"));
    let by_share = |a: &usize, b: &usize| share(each[*a]).abs().total_cmp(&share(each[*b]).abs());
    let first = (0..causes.len()).max_by(by_share).unwrap();
    let gone_um = causes.iter().zip(&each).map(|(cause, [_, without])| {
        let (name, axis) = known.name(*cause);
        let found = budget.causes.iter().find(|found| found.name == name && found.axis.as_deref() == axis);
        let of_budget = root(budget.whole.rms.powi(2) - found.unwrap().without.rms.powi(2));
        (title((name, axis)), [of_budget, root(whole_um.powi(2) - without.powi(2))])
    });
    let of_budget = &budget.causes[0];
    Compared {
        seed,
        first: [title((of_budget.name, of_budget.axis.as_deref())), title(known.name(causes[first]))],
        whole_um: [budget.whole.rms, whole_um],
        gone_um: gone_um.collect(),
    }
}

/// Of machines with these seeds, how many have the true first cause first; each whole is right within 5 %, and what goes away with a cause
/// of at least half of the whole within 15 %. What goes away is a difference of squares: of a smaller cause, it has the error of the whole.
fn right_firsts(seeds: std::ops::Range<u64>) -> usize {
    let mut right = 0;
    for compared in seeds.map(compared) {
        let Compared { seed, first, whole_um: [said, whole_um], gone_um } = compared;
        println!("{seed}: {first:?}, {said:.3} of {whole_um:.3} µm, {gone_um:.2?}");
        assert!((said / whole_um - 1.0).abs() < 0.05, "{seed}: {said} instead of {whole_um} µm");
        for (name, [said, gone]) in gone_um.iter().filter(|(_, [_, gone])| *gone > 0.5 * whole_um) {
            assert!((said / gone - 1.0).abs() < 0.15, "{seed}: {name}: {said} instead of {gone} µm");
        }
        right += usize::from(first[0] == first[1]);
    }
    right
}

/// Ten machines; `long` has fifty.
#[test]
fn the_first_cause_is_the_true_one() {
    assert!(right_firsts(0..10) >= 9);
}

/// The aim: the first of the ranking is the true first on 48 of 50 machines.
#[test]
fn the_first_cause_is_the_true_one_on_fifty_machines() {
    let right = right_firsts(100..150);
    println!("{right} of 50");
    assert!(right >= 48, "{right} of 50");
}
