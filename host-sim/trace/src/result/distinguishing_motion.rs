//! The motion that distinguishes two effects best.
//!
//! Two machines, each with one of the effects, are simulated in six motions within the travel, speed and acceleration of the
//! logs. The motion is proposed in which a channel differs most, in units of its noise.

use crate::input::motion_range::MotionRange;
use crate::input::signals::Signals;
use crate::options::AdmissionOptions;
use files::log::{AxisLog, Log};
use model::machine::Machine;
use motion::{Lines, Motion};
use plant::instruments::Instruments;
use plant::machine_path::MachinePath;
use plant::simulate::{self, Run};
use shared::scalar::Format;

/// A motion that distinguishes two effects.
#[derive(Clone, Debug)]
pub struct Proposal {
    /// The motion.
    pub motion: Lines,
    /// Printed name of the motion.
    pub name: &'static str,
    /// Largest rms difference of a channel, in units of its noise.
    pub difference: f64,
}

impl Proposal {
    /// Text of the motion file.
    #[must_use]
    pub fn to_toml(&self) -> String {
        self.motion.to_toml(&format!("{}: tells two effects apart that the logs do not.", self.name))
    }
}

/// A motion that is tried.
struct Trial {
    name: &'static str,
    /// Strokes to both ends and back to the middle, each with its fractions of travel, speed and acceleration.
    strokes: &'static [[f64; 3]],
    /// Pause before the last stroke, s.
    pause_s: f64,
    /// Whether all axes except this one move, instead of this one.
    of_others: bool,
}

const TRIALS: [Trial; 6] = [
    Trial {
        name: "strokes at three speeds",
        strokes: &[[1.0, 0.1, 1.0], [1.0, 0.4, 1.0], [1.0, 1.0, 1.0]],
        pause_s: 0.2,
        of_others: false,
    },
    Trial {
        name: "strokes at three accelerations",
        strokes: &[[1.0, 1.0, 0.1], [1.0, 1.0, 0.4], [1.0, 1.0, 1.0]],
        pause_s: 0.2,
        of_others: false,
    },
    Trial { name: "slow strokes", strokes: &[[0.3, 0.05, 1.0]], pause_s: 0.2, of_others: false },
    Trial {
        name: "short quick strokes",
        strokes: &[[0.05, 1.0, 1.0], [0.1, 1.0, 1.0], [0.05, 1.0, 1.0]],
        pause_s: 0.2,
        of_others: false,
    },
    Trial {
        name: "a stroke, and the same after a pause",
        strokes: &[[1.0, 0.5, 1.0], [1.0, 0.5, 1.0]],
        pause_s: 60.0,
        of_others: false,
    },
    Trial {
        name: "strokes of the other axes alone",
        strokes: &[[1.0, 0.3, 1.0], [1.0, 1.0, 1.0]],
        pause_s: 0.2,
        of_others: true,
    },
];

/// The motion in which two machines with different models of one axis differ most; `None` if none can be simulated.
#[must_use]
pub fn propose(
    machines: [&Machine; 2],
    axis: usize,
    logs: &[Signals],
    options: &AdmissionOptions,
) -> Option<Proposal> {
    let names: Vec<&String> = machines[0].axis.keys().collect();
    let proposal = |trial: &Trial| {
        let motion = trial.motion(&names, axis, logs, options)?;
        // Both machines have the same noise, which cancels in the difference.
        let [a, b] = machines.map(|machine| run(machine, motion.motion()?, Instruments::typical(1)));
        let difference = difference(a?.axes.get(axis)?, b?.axes.get(axis)?);
        Some(Proposal { motion, name: trial.name, difference })
    };
    TRIALS.iter().filter_map(proposal).max_by(|a, b| a.difference.total_cmp(&b.difference))
}

/// The log of a motion on a machine; `None` if the machine file does not suffice to simulate it.
#[must_use]
pub fn run(machine: &Machine, motion: &Motion, instruments: Instruments) -> Option<Log> {
    let path = MachinePath::new(motion, machine, "proposal").ok()?;
    let mut controller = simulate::controller(machine, Format::F64, &path.start_m).ok()?;
    let run = Run { machine, instruments, start_m: &path.start_m, blocks: &path.blocks, start_s: 0.0 };
    run.log(controller.as_mut(), |_, _, _| {}).ok()
}

/// Largest rms difference of the channels of an axis in two logs, each channel relative to the one upstream, in units of the
/// noise of typical instruments (mm and N).
fn difference(a: &AxisLog, b: &AxisLog) -> f64 {
    let none = Vec::new();
    let rms = |of: &dyn Fn(&AxisLog) -> Vec<f64>, noise: f64| {
        numerics::rms(of(a).iter().zip(of(b)).map(|(a, b)| a - b)) / noise
    };
    let minus = |a: &Option<Vec<f64>>, b: &Option<Vec<f64>>| -> Vec<f64> {
        let (a, b) = (a.as_ref().unwrap_or(&none), b.as_ref().unwrap_or(&none));
        a.iter().zip(b).map(|(a, b)| a - b).collect()
    };
    numerics::max_abs([
        rms(&|log| minus(&log.motor, &log.command), 1e-5),
        rms(&|log| minus(&log.table, &log.motor), 2e-5),
        rms(&|log| minus(&log.tool, &log.table), 8e-5),
        rms(&|log| log.force.clone().unwrap_or_default(), 1.0),
    ])
}

impl Trial {
    /// The motion, within travel, speed and acceleration of the axes in the logs.
    fn motion(
        &self,
        names: &[&String],
        axis: usize,
        logs: &[Signals],
        options: &AdmissionOptions,
    ) -> Option<Lines> {
        let range = |index: usize| MotionRange::of(logs, index, options.min_travel_mm);
        let moving: Vec<usize> = (0..names.len()).filter(|&i| (i != axis) == self.of_others).collect();
        let ranges: Vec<MotionRange> = moving.iter().map(|&i| range(i)).collect::<Option<_>>()?;
        let speed = ranges.iter().map(|range| range.speed_mm_s).reduce(f64::min)?;
        let acceleration = ranges.iter().map(|range| range.acceleration_m_per_s2).reduce(f64::min)?;
        let at = |fraction: f64| {
            let position = move |(i, range): (&usize, &MotionRange)| {
                (names[*i].as_str(), range.middle_mm + fraction * range.half_mm)
            };
            moving.iter().zip(&ranges).map(position)
        };
        let others = (0..names.len()).filter(|i| !moving.contains(i));
        let at_rest = others.filter_map(|i| Some((names[i].as_str(), range(i)?.middle_mm)));
        let start_mm = at(0.0).chain(at_rest).map(|(name, mm)| (name.to_owned(), mm)).collect();
        let mut lines = Lines::begin(self.name, start_mm, [60.0 * speed, acceleration]);
        lines.dwell(0.5);
        for (i, [travel, speed_fraction, acceleration_fraction]) in self.strokes.iter().enumerate() {
            if i + 1 == self.strokes.len() {
                lines.dwell(self.pause_s);
            }
            for end in [1.0, -1.0, 0.0] {
                let pace = [60.0 * speed * speed_fraction, acceleration * acceleration_fraction];
                lines.line(at(end * travel), pace);
            }
        }
        Some(lines)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::SampleOptions;

    /// Latency is proportional to speed, in-talk to acceleration; slow motion does not distinguish them.
    #[test]
    fn proposes_a_motion_that_both_machines_can_run_and_that_distinguishes_them() {
        let machine = |effect: &str| {
            let text = format!("{}\n[[axis.x.effect]]\n{effect}", model::examples::VMC_MACHINE);
            Machine::parse(&text, "vmc.toml").unwrap()
        };
        let late = machine("name = \"latency\"\nchannel = \"tool\"\nms = 0.5\n");
        let intalk = machine("name = \"intalk\"\num_s2_per_m = 3.0\n");
        let circle = Motion::parse(model::examples::VMC_CIRCLE, "circle.toml").unwrap();
        let log = run(&late, &circle, Instruments::typical(1)).unwrap();
        let names: Vec<String> = late.axis.keys().cloned().collect();
        let logs = [Signals::new(&log, &names, &SampleOptions::default())];
        let proposal = propose([&late, &intalk], 0, &logs, &AdmissionOptions::default()).unwrap();
        let written = Motion::parse(&proposal.to_toml(), "proposal.toml").unwrap();
        assert_eq!(Some(&written), proposal.motion.motion());
        // In strokes at full speed, 33 mm/s times 0.5 ms are 17 µm, about two hundred times the noise of 80 nm.
        assert!((50.0..400.0).contains(&proposal.difference), "{proposal:?}");
    }
}
