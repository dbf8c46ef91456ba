//! Machines and motions as text, their runs, and measurements on the logs.

use files::log::{Channel, Log};
use model::axis::Settings;
use model::machine::Machine;
use motion::Motion;
use plant::instruments::Instruments;
use plant::machine_path::MachinePath;
use plant::simulate::{Run, controller};
use shared::scalar::Format;

/// The machine without effects.
pub const PLAIN: &str = include_str!("../../../../host-sim/machines/vmc.toml");

/// Settling time, s: the slowest pole of both loops is at −29 1/s, and e^(−29·0.4) = 1e-5.
pub const SETTLED_S: f64 = 0.4;

/// Tolerance of runs that should be equal: rounding and what is left of transients, µm and N.
pub const ROUNDING_UM: f64 = 0.003;
pub const ROUNDING_N: f64 = 0.2;

pub const CHANNELS: [Channel; 5] =
    [Channel::Command, Channel::Motor, Channel::Table, Channel::Tool, Channel::Force];

/// The machine with an effect of its x axis.
pub fn with(effect: &str) -> String {
    format!("{PLAIN}\n[[axis.x.effect]]\n{effect}\n")
}

/// The settings of the machine's x axis.
pub fn declared() -> Settings {
    Machine::parse(PLAIN, "vmc.toml").unwrap().axis["x"].settings.clone()
}

/// A text with its first occurrence of `from`, which must exist, replaced.
pub fn changed(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "no {from}");
    text.replacen(from, to, 1)
}

/// A motion from x = 0 along x with a stop at each point: end (mm) and feed (mm/s) of each line, 0.5 m/s².
pub fn lines(points: &[(f64, f64)]) -> String {
    let block = |(x_mm, mm_s): &(f64, f64)| {
        let feed = 60.0 * mm_s;
        format!("[[block]]\nline_to_mm = {{ x = {x_mm:?} }}\nfeed_mm_per_min = {feed:?}\n")
    };
    let head = "name = \"lines\"\nfeed_mm_per_min = 1000.0\nacceleration_m_per_s2 = 0.5\n";
    let blocks: String = points.iter().map(block).collect();
    format!("{head}start_mm = {{ x = 0.0, y = 0.0 }}\n{blocks}[[block]]\ndwell_s = 0.3\n")
}

/// A motion of turns about the origin from (radius, 0).
pub fn circle(radius_mm: f64, mm_s: f64, turns: f64) -> String {
    format!(
        "name = \"circle\"\nfeed_mm_per_min = {:?}\nacceleration_m_per_s2 = 10.0\n\
         start_mm = {{ x = {radius_mm:?}, y = 0.0 }}\n[[block]]\n\
         arc = {{ plane = [\"x\", \"y\"], centre_mm = {{ x = 0.0, y = 0.0 }}, turns = {turns:?} }}\n",
        60.0 * mm_s
    )
}

/// Runs a machine with ideal instruments.
pub fn run(machine: &str, motion: &str) -> RunLog {
    run_with(machine, motion, 0.0, |_| Instruments::default())
}

/// Runs a machine with instruments, from a time of the session on.
pub fn run_with(
    machine: &str,
    motion: &str,
    start_s: f64,
    instruments: fn(&Machine) -> Instruments,
) -> RunLog {
    let machine = Machine::parse(machine, "machine.toml").unwrap();
    let path =
        MachinePath::new(&Motion::parse(motion, "motion.toml").unwrap(), &machine, "motion.toml").unwrap();
    let instruments = instruments(&machine);
    let run = Run { machine: &machine, instruments, start_m: &path.start_m, blocks: &path.blocks, start_s };
    let mut controller = controller(&machine, Format::Fixed, &path.start_m).unwrap();
    RunLog { log: run.log(controller.as_mut(), |_, _, _| {}).unwrap() }
}

/// The log of a run.
pub struct RunLog {
    pub log: Log,
}

impl RunLog {
    /// A channel in mm or N.
    pub fn channel(&self, axis: &str, channel: Channel) -> &[f64] {
        self.log.axis(axis).unwrap().channel(channel).unwrap()
    }

    pub fn force_n(&self) -> &[f64] {
        self.channel("x", Channel::Force)
    }

    /// A channel of x minus another one, µm.
    pub fn difference_um(&self, channel: Channel, other: Channel) -> Vec<f64> {
        difference(self.channel("x", channel), self.channel("x", other)).iter().map(|mm| 1e3 * mm).collect()
    }

    /// A channel of x minus that of another run, µm (N for the force).
    pub fn change(&self, channel: Channel, plain: &Self) -> Vec<f64> {
        let unit = if channel == Channel::Force { 1.0 } else { 1e3 };
        let difference = difference(self.channel("x", channel), plain.channel("x", channel));
        difference.iter().map(|value| unit * value).collect()
    }

    /// Table − motor of x minus that of another run, µm.
    pub fn drive_train_change_um(&self, plain: &Self) -> Vec<f64> {
        let drive_train = |run: &Self| run.difference_um(Channel::Table, Channel::Motor);
        difference(&drive_train(self), &drive_train(plain))
    }

    /// Samples at which the command of x has had a constant velocity (signed) for [`SETTLED_S`].
    pub fn steady(&self, mm_s: f64) -> Vec<usize> {
        let step_mm = mm_s * self.log.sample_time_s;
        let command = self.channel("x", Channel::Command);
        let is_steady = |i: usize| (command[i] - command[i - 1] - step_mm).abs() < 1e-6 * step_mm.abs();
        self.lasting(is_steady)
    }

    /// Samples at which the command of x has had a constant acceleration for [`SETTLED_S`], in + direction.
    pub fn accelerating(&self, m_per_s2: f64) -> Vec<usize> {
        let expected_mm = 1e3 * m_per_s2 * self.log.sample_time_s.powi(2);
        let command = self.channel("x", Channel::Command);
        let second_difference = |i: usize| command[i] - 2.0 * command[i - 1] + command[i - 2];
        self.lasting(|i| i > 1 && (second_difference(i) - expected_mm).abs() < 1e-3 * expected_mm)
    }

    fn lasting(&self, holds: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut since = 0;
        let mut samples = Vec::new();
        for i in 1..self.log.len() {
            since = if holds(i) { since + 1 } else { 0 };
            if f64::from(since) * self.log.sample_time_s > SETTLED_S {
                samples.push(i);
            }
        }
        assert!(samples.len() > 50, "only {} samples", samples.len());
        samples
    }

    /// Asserts that every channel of every axis equals that of another run to the last bit, except some of x.
    pub fn assert_same(&self, plain: &Self, except: &[Channel]) {
        for axis in &plain.log.axes {
            for channel in CHANNELS {
                if axis.name == "x" && except.contains(&channel) {
                    continue;
                }
                let same = self.channel(&axis.name, channel) == axis.channel(channel).unwrap();
                assert!(same, "{} of {} differs from the run without", channel.word(), axis.name);
            }
        }
    }
}

pub fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

pub fn mean(values: &[f64], samples: &[usize]) -> f64 {
    samples.iter().map(|&i| values[i]).sum::<f64>() / samples.len() as f64
}

/// Asserts that the values at all samples are near an expected one.
pub fn assert_all(values: &[f64], samples: &[usize], expected: f64, bound: f64, what: &str) {
    for &i in samples {
        assert!((values[i] - expected).abs() < bound, "{what}: {} at {i}, expected {expected}", values[i]);
    }
}

pub fn assert_near(found: f64, expected: f64, bound: f64, what: &str) {
    assert!((found - expected).abs() < bound, "{what}: {found}, expected {expected} ± {bound}");
}

/// Root mean square.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// Coefficients of the columns, and of a constant as the last one, by least squares.
pub fn fit<const N: usize>(columns: [&[f64]; N], values: &[f64]) -> Vec<f64> {
    let ones = vec![1.0; values.len()];
    let mut all = columns.to_vec();
    all.push(&ones);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let row = |column: &&[f64]| -> Vec<f64> {
        all.iter().map(|other| dot(column, other)).chain([dot(column, values)]).collect()
    };
    let mut rows: Vec<Vec<f64>> = all.iter().map(row).collect();
    // The normal equations are positive definite: no pivoting.
    for pivot in 0..=N {
        let scale = rows[pivot][pivot];
        rows[pivot].iter_mut().for_each(|value| *value /= scale);
        let pivot_row = rows[pivot].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != pivot) {
            let factor = row[pivot];
            row.iter_mut().zip(&pivot_row).for_each(|(value, part)| *value -= factor * part);
        }
    }
    rows.iter().map(|row| row[N + 1]).collect()
}

/// The values at some samples.
pub fn at(values: &[f64], samples: &[usize]) -> Vec<f64> {
    samples.iter().map(|&i| values[i]).collect()
}
