//! Effects that the logs cannot tell apart, and a motion that would.
//!
//! Two candidates that both explain a residual, neither better than chance beyond the other, are both named. Which
//! motion separates them is found by running it: both machines, the one with this effect and the one with that, go
//! through a handful of motions within the travel that the logs show, and the motion is proposed in which they differ
//! most, in units of what the sensors see.

use super::axis_model::AxisModel;
use super::candidates::{Candidate, LEAST_REDUCTION};
use super::held_out::{compare, scores};
use super::scope::Scope;
use super::signals::Signals;
use files::log::{AxisLog, Log};
use link::controller::Format;
use model::effects::Effect;
use model::machine::Machine;
use model::motion::Motion;
use plant::instruments::Instruments;
use plant::path;
use plant::simulate::{self, Run};

/// Below so many standard errors over the blocks of the logs a difference between two candidates may be chance.
const TOLD_APART: f64 = 2.0;

/// Two effects of which the logs show one, but not which.
#[derive(Clone, Debug)]
pub struct LookAlike {
    /// The one that was added: a little better.
    pub added: Effect,
    /// The one that explains as much.
    pub rival: Effect,
    /// The axis with the rival instead.
    pub with_rival: AxisModel,
    /// What would separate them; `None` where the machine file does not suffice to run it.
    pub proposal: Option<Proposal>,
}

/// A motion that separates two effects.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// A motion file.
    pub motion: String,
    /// In words.
    pub name: &'static str,
    /// Greatest difference that the effects make in a channel, rms, in units of its noise.
    pub apart: f64,
}

/// The candidates that explain as much as the one that was added.
#[must_use]
pub fn rivals(candidates: &[Candidate], added: usize, scope: &Scope) -> Vec<LookAlike> {
    let Some(best) = candidates[added].fitted.as_ref() else { return Vec::new() };
    let of_best = scores(best);
    let is_as_good = |candidate: &Candidate| {
        let Some(fitted) = candidate.fitted.as_ref().filter(|_| candidate.is_supported()) else {
            return false;
        };
        let apart = compare(&scores(fitted), &of_best, &scope.stages);
        apart.iter().all(|stage| stage.t < TOLD_APART || stage.reduction < LEAST_REDUCTION)
    };
    let others = candidates.iter().enumerate().filter(|(index, _)| *index != added);
    let alike = others.filter(|(_, candidate)| is_as_good(candidate));
    alike
        .filter_map(|(_, candidate)| {
            Some(LookAlike {
                added: candidates[added].effect.clone(),
                rival: candidate.effect.clone(),
                with_rival: candidate.fitted.as_ref()?.model.clone(),
                proposal: None,
            })
        })
        .collect()
}

/// A way of moving, and how it is said.
struct Trial {
    name: &'static str,
    /// Strokes to either end: share of the travel, of the speed and of the acceleration.
    strokes: &'static [[f64; 3]],
    /// Pause before the last stroke, s.
    pause_s: f64,
    /// Whether the other axes move instead.
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

/// The motion in which two machines that differ in one axis differ most.
#[must_use]
pub fn propose(machines: [&Machine; 2], axis: usize, logs: &[Signals]) -> Option<Proposal> {
    let names: Vec<&String> = machines[0].axis.keys().collect();
    let proposal = |trial: &Trial| {
        let motion = trial.motion(&names, axis, logs)?;
        let [a, b] = machines.map(|machine| run(machine, &motion));
        let apart = apart(a?.axes.get(axis)?, b?.axes.get(axis)?);
        Some(Proposal { motion, name: trial.name, apart })
    };
    TRIALS.iter().filter_map(proposal).max_by(|a, b| a.apart.total_cmp(&b.apart))
}

fn run(machine: &Machine, motion: &str) -> Option<Log> {
    let motion = Motion::parse(motion, "proposal").ok()?;
    let path = path::of(&motion, machine, "proposal").ok()?;
    let mut controller = simulate::controller(machine, Format::F64, &path.start_m).ok()?;
    let run = Run {
        machine,
        // Of both machines the same noise, which falls out of the difference.
        instruments: Instruments::typical(1),
        start_m: &path.start_m,
        blocks: &path.blocks,
        start_s: 0.0,
    };
    run.log(controller.as_mut(), |_, _, _| {}).ok()
}

/// By how much two logs of an axis differ, in units of the noise of typical instruments (mm and N).
fn apart(a: &AxisLog, b: &AxisLog) -> f64 {
    let none = Vec::new();
    let rms = |of: &dyn Fn(&AxisLog) -> Vec<f64>, noise: f64| {
        numerics::rms(of(a).iter().zip(of(b)).map(|(a, b)| a - b)) / noise
    };
    let less = |of: &Option<Vec<f64>>, what: &Option<Vec<f64>>| -> Vec<f64> {
        let (of, what) = (of.as_ref().unwrap_or(&none), what.as_ref().unwrap_or(&none));
        of.iter().zip(what).map(|(a, b)| a - b).collect()
    };
    numerics::max_abs([
        rms(&|log| less(&log.motor, &log.command), 1e-5),
        rms(&|log| less(&log.table, &log.motor), 2e-5),
        rms(&|log| less(&log.tool, &log.table), 8e-5),
        rms(&|log| log.force.clone().unwrap_or_default(), 1.0),
    ])
}

impl Trial {
    /// Its motion file, within the travel, speed and acceleration that the logs show of the axis.
    fn motion(&self, names: &[&String], axis: usize, logs: &[Signals]) -> Option<String> {
        let seen = |index: usize| Seen::of(logs, index);
        let moving: Vec<usize> = (0..names.len()).filter(|&i| (i != axis) == self.of_others).collect();
        let limits: Vec<Seen> = moving.iter().map(|&i| seen(i)).collect::<Option<_>>()?;
        let speed = limits.iter().map(|seen| seen.speed_mm_s).reduce(f64::min)?;
        let acceleration = limits.iter().map(|seen| seen.acceleration_m_per_s2).reduce(f64::min)?;
        let at = |share: f64| {
            let place = |(i, seen): (&usize, &Seen)| {
                format!("{} = {:.3}", names[*i], seen.middle_mm + share * seen.half_mm)
            };
            moving.iter().zip(&limits).map(place).collect::<Vec<_>>().join(", ")
        };
        let rest = (0..names.len()).filter(|i| !moving.contains(i));
        let still = rest.filter_map(|i| Some(format!("{} = {:.3}", names[i], seen(i)?.middle_mm)));
        let start: Vec<String> = std::iter::once(at(0.0)).chain(still).collect();
        let mut text = format!(
            "# {}: tells two effects apart that the logs do not.\nname = \"{}\"\nfeed_mm_per_min = {:.1}\n\
             acceleration_m_per_s2 = {:.3}\nstart_mm = {{ {} }}\n\n[[block]]\ndwell_s = 0.5\n",
            self.name,
            self.name,
            60.0 * speed,
            acceleration,
            start.join(", ")
        );
        for (i, [travel, pace, push]) in self.strokes.iter().enumerate() {
            if i + 1 == self.strokes.len() {
                text += &format!("\n[[block]]\ndwell_s = {:.1}\n", self.pause_s);
            }
            for end in [1.0, -1.0, 0.0] {
                text += &format!(
                    "\n[[block]]\nline_to_mm = {{ {} }}\nfeed_mm_per_min = {:.1}\nacceleration_m_per_s2 = {:.3}\n",
                    at(end * travel),
                    60.0 * speed * pace,
                    acceleration * push
                );
            }
        }
        Some(text)
    }
}

/// What the logs show an axis do.
struct Seen {
    middle_mm: f64,
    half_mm: f64,
    speed_mm_s: f64,
    acceleration_m_per_s2: f64,
}

impl Seen {
    fn of(logs: &[Signals], axis: usize) -> Option<Self> {
        let signals = || logs.iter().filter_map(|log| log.axes.get(axis)?.table_or_motor());
        let greatest = |of: &dyn Fn(&super::signals::Smooth) -> f64| signals().map(of).reduce(f64::max);
        let most = greatest(&|s| numerics::max(s.position.iter().copied()))?;
        let least = -greatest(&|s| numerics::max(s.position.iter().map(|m| -m)))?;
        let speed = greatest(&|s| numerics::max_abs(s.velocity.iter().copied()))?;
        let acceleration = greatest(&|s| numerics::max_abs(s.acceleration.iter().copied()))?;
        // An axis that stood still shows no limits that it could move within.
        (most > least && speed > 1e-3 && acceleration > 1e-2).then_some(Self {
            middle_mm: 500.0 * (most + least),
            half_mm: 500.0 * (most - least),
            speed_mm_s: 1e3 * speed,
            acceleration_m_per_s2: acceleration,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Latency shows in proportion to speed, in-talk in proportion to acceleration: of the logs of slow motion both are
    /// possible, and what is proposed must drive them apart.
    #[test]
    fn proposes_a_motion_that_both_machines_can_run_and_that_sets_them_apart() {
        let machine = |effect: &str| {
            let text = format!("{}\n[[axis.x.effect]]\n{effect}", model::examples::VMC_MACHINE);
            Machine::parse(&text, "vmc.toml").unwrap()
        };
        let late = machine("name = \"latency\"\nchannel = \"tool\"\nms = 0.5\n");
        let leaning = machine("name = \"intalk\"\num_s2_per_m = 3.0\n");
        let log = run(&late, model::examples::VMC_CIRCLE).unwrap();
        let names: Vec<String> = late.axis.keys().cloned().collect();
        let proposal = propose([&late, &leaning], 0, &[Signals::new(&log, &names)]).unwrap();
        Motion::parse(&proposal.motion, "proposal.toml").unwrap();
        // 33 mm/s and 0.5 ms are 17 µm, of which strokes at full speed show most: beside 80 nm some hundred times it.
        assert!((50.0..400.0).contains(&proposal.apart), "{proposal:?}");
    }
}
