//! The main job, with nothing to prepare: a machine with an undeclared effect is run, logged and traced.

mod draw;

pub use draw::{Drawn, draw};

use rayon::prelude::*;
use serde_json::{Value, json};

use files::error::InputError;
use files::log::Log;
use link::controller::Format;
use model::effects::Stage;
use model::machine::Machine;
use model::motion::Motion;
use plant::instruments::Instruments;
use plant::path;
use plant::simulate::{self, Run, SimulationError};
use trace::Trace;
use trace::outcome::{AxisTrace, StageError};

/// The declared machine.
pub use model::examples::DEMO_MACHINE as MACHINE;

/// Motions that are fitted, and when the session's clock stands where (s).
const FIT: [(&str, f64); 3] = [
    (include_str!("../../../motions/demo_circle.toml"), 0.0),
    (include_str!("../../../motions/demo_fast.toml"), 40.0),
    (include_str!("../../../motions/demo_travel.toml"), 60.0),
];

/// Motions that take part in no fit.
const VALIDATE: [(&str, f64); 2] = [
    (include_str!("../../../motions/demo_ballbar.toml"), 90.0),
    (include_str!("../../../motions/demo_corner.toml"), 120.0),
];

/// Why the demo failed.
#[derive(Debug, thiserror::Error)]
pub enum DemoError {
    /// A shipped file is not what it should be.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The simulated machine did not run.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}

/// What the demo did.
pub struct Demo {
    /// Seed of everything that was drawn.
    pub seed: u64,
    /// The machine as it is.
    pub drawn: Drawn,
    /// What the tracer, who was not told, made of its logs.
    pub trace: Trace,
}

/// Runs, logs and traces the machine of a seed.
///
/// # Errors
/// When a shipped file is unusable or the simulated machine does not run.
pub fn run(seed: u64, say: &(dyn Fn(&str) + Sync)) -> Result<Demo, DemoError> {
    let declared = Machine::parse(MACHINE, "machines/demo.toml")?;
    let drawn = draw(&declared, seed);
    say("running the machine");
    let [fit, validate] = logs(&drawn.truth, seed)?;
    let trace = trace::trace(&declared, &fit, &validate, say)?;
    Ok(Demo { seed, drawn, trace })
}

/// What a machine logs on the demo's motions: those that are fitted, and those that are not.
///
/// # Errors
/// When the machine does not run.
pub fn logs(machine: &Machine, seed: u64) -> Result<[Vec<Log>; 2], DemoError> {
    let motions: Vec<&(&str, f64)> = FIT.iter().chain(&VALIDATE).collect();
    let mut fit: Vec<Log> = motions
        .into_par_iter()
        .enumerate()
        .map(|(number, (motion, start_s))| log(machine, motion, *start_s, seed + number as u64))
        .collect::<Result<_, _>>()?;
    let validate = fit.split_off(FIT.len());
    Ok([fit, validate])
}

/// The log of a machine that runs a motion file, from a time of the session on, with the typical noise of a seed.
///
/// # Errors
/// If the motion cannot be read, or the machine does not run it.
pub fn log(machine: &Machine, motion: &str, start_s: f64, seed: u64) -> Result<Log, DemoError> {
    let motion = Motion::parse(motion, "a shipped motion")?;
    let path = path::of(&motion, machine, "a shipped motion")?;
    let mut controller = simulate::controller(machine, Format::Fixed, &path.start_m)?;
    let run = Run {
        machine,
        instruments: Instruments::typical(seed),
        start_m: &path.start_m,
        blocks: &path.blocks,
        start_s,
    };
    let mut log = run.log(controller.as_mut(), |_, _, _| {})?;
    log.source = motion.name;
    Ok(log)
}

/// The residual that the demo's figures are about, µm, on motions that were not fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Headline {
    /// Stage.
    pub stage: Stage,
    /// Declared model.
    pub before: f64,
    /// With what was found.
    pub after: f64,
    /// What no model can remove.
    pub noise: f64,
}

impl Demo {
    /// The axis with the effect.
    #[must_use]
    pub fn axis(&self) -> Option<&AxisTrace> {
        self.trace.axes.iter().find(|axis| axis.axis == self.drawn.axis)
    }

    /// The position stage of that axis whose residual fell most, in units of its noise; where none did, the one that
    /// stands highest above it.
    #[must_use]
    pub fn headline(&self) -> Option<Headline> {
        let errors = || self.axis().into_iter().flat_map(|axis| &axis.errors);
        let of_places = || errors().filter(|error| error.stage != Stage::Force);
        let most = |of: fn(&StageError) -> f64| of_places().max_by(|a, b| of(a).total_cmp(&of(b)));
        let fell = |error: &StageError| (error.before.validate - error.after.validate) / error.noise;
        let highest =
            most(fell).filter(|error| fell(error) > 1.0).or_else(|| most(|e| e.before.validate / e.noise))?;
        Some(Headline {
            stage: highest.stage,
            before: highest.before.validate,
            after: highest.after.validate,
            noise: highest.noise,
        })
    }

    /// Whether the tracer named exactly the undeclared effect.
    #[must_use]
    pub fn is_named(&self) -> bool {
        let found: Vec<(&str, &str)> = self
            .trace
            .axes
            .iter()
            .flat_map(|axis| axis.found.iter().map(|found| (axis.axis.as_str(), found.effect.name())))
            .collect();
        found == [(self.drawn.axis.as_str(), self.drawn.effect.name())]
    }

    /// The JSON of `demo --json`.
    #[must_use]
    pub fn json(&self) -> Value {
        let headline = self.headline();
        let parameters: serde_json::Map<String, Value> = self
            .drawn
            .effect
            .parameters()
            .into_iter()
            .map(|(name, value)| (name.to_owned(), json!({"value": value})))
            .collect();
        let mut truth = json!({
            "name": self.drawn.effect.name(),
            "axis": self.drawn.axis,
            "parameters": parameters,
        });
        if let (Some(source), Value::Object(truth)) = (trace::json::source(&self.drawn.effect), &mut truth) {
            truth.insert("source".to_owned(), json!(source));
        }
        json!({
            "seed": self.seed,
            "undeclared": [truth],
            "found": trace::json::effects(&self.trace),
            "residual_um": {
                "before": headline.map(|h| h.before),
                "after": headline.map(|h| h.after),
                "noise": headline.map(|h| h.noise),
            },
        })
    }
}
