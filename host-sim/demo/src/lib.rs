//! The demonstration: a machine with one undeclared effect is simulated, logged and traced, then compensated and run again.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod draw;
pub mod round_trips;
pub mod second_machine;

pub use draw::{Drawn, draw, draw_several};

use rayon::prelude::*;
use serde_json::{Value, json};

use commissioning::compensate::controller_host::ControllerHost;
use commissioning::compensate::file::CompensationFile;
use commissioning::compensate::limits::Limits;
use commissioning::compensate::plan::Plan;
use commissioning::compensate::planning::Planning;
use commissioning::compensate::prediction::{PredictionError, TestMotion};
use commissioning::compensate::round_trip::{self, Compared, MachineUnderTest, SimulatedMachine};
use contour::log_error::LogError;
use files::error::InputError;
use files::log::Log;
use model::effects::Stage;
use model::machine::Machine;
use motion::Motion;
use plant::instruments::Instruments;
use plant::machine_path::MachinePath;
use plant::simulate::{self, Run, SimulationError};
use shared::scalar::Format;
use trace::AxisIdentification;
use trace::Identification;
use trace::judge::StageResidual;

/// The declared machine.
pub use model::examples::DEMO_MACHINE as MACHINE;

/// Motions of the fit, and the session time at which each starts, s.
const FIT: [(&str, f64); 3] = [
    (include_str!("../../motions/demo_circle.toml"), 0.0),
    (include_str!("../../motions/demo_fast.toml"), 40.0),
    (include_str!("../../motions/demo_travel.toml"), 60.0),
];

/// Motions of the validation. They are not used in the fit.
const VALIDATE: [(&str, f64); 2] = [
    (include_str!("../../motions/demo_ballbar.toml"), 90.0),
    (include_str!("../../motions/demo_corner.toml"), 120.0),
];

/// Motions on whose predicted contour error the compensation is chosen: those of the validation.
const CHOSEN_ON: [&str; 2] =
    [include_str!("../../motions/demo_ballbar.toml"), include_str!("../../motions/demo_corner.toml")];

/// Motions before and after: one of the logs, and one that was never used.
const RUN_ON: [&str; 2] =
    [include_str!("../../motions/demo_ballbar.toml"), include_str!("../../motions/circle.toml")];

/// Time on the session clock at which the compensation is set and the motions are executed again, s.
const SET_AT_S: f64 = 150.0;

/// Why the demo failed.
#[derive(Debug, thiserror::Error)]
pub enum DemoError {
    /// A shipped file is invalid.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The simulated machine did not complete a motion.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The compensation cannot be planned or applied.
    #[error(transparent)]
    Compensation(#[from] PredictionError),
}

/// The result of one demonstration.
pub struct Demo {
    /// The machine and its trace.
    pub traced: Traced,
    /// The compensation of the traced model, and the motions before and after it.
    pub compensated: Compensated,
    /// Where the controller ran with the compensation.
    pub controller_host: ControllerHost,
}

/// A machine with one undeclared effect, and the trace of its logs.
pub struct Traced {
    /// Seed of the machine, its effect and the noise.
    pub seed: u64,
    /// The true machine and its undeclared effect.
    pub drawn: Drawn,
    /// The trace of its logs, from the declared machine alone.
    pub trace: Identification,
    /// The contour errors of its logs.
    pub contour_errors: Vec<LogError>,
}

/// A machine after its compensation.
pub struct Compensated {
    /// The compensation.
    pub plan: Plan,
    /// The motions before, as predicted, and after.
    pub motions: Vec<Compared>,
    /// What limits the error that is left.
    pub limits: Limits,
}

/// Simulates, logs, traces and compensates the machine of a seed, and executes motions before and after; `progress` receives the
/// name of each step as it starts.
///
/// # Errors
/// If a shipped file is invalid, the simulated machine does not complete a motion, or the compensation is refused.
pub fn run(seed: u64, progress: &(dyn Fn(&str) + Sync)) -> Result<Demo, DemoError> {
    let traced = traced(seed, progress)?;
    progress("compensating the machine");
    let instruments = Instruments::typical(seed);
    let machine_under_test = SimulatedMachine {
        machine: &traced.drawn.truth,
        instruments,
        controller_host: ControllerHost::found(),
    };
    let model = traced.trace.better_machine();
    let before = CompensationFile::none(&model);
    let compensated = compensated(&model, (&machine_under_test, &before), seed)?;
    let controller_host = machine_under_test.controller_host;
    Ok(Demo { traced, compensated, controller_host })
}

/// Simulates, logs and traces the machine of a seed; `progress` receives the name of each step as it starts.
///
/// # Errors
/// If a shipped file is invalid or the simulated machine does not complete a motion.
pub fn traced(seed: u64, progress: &(dyn Fn(&str) + Sync)) -> Result<Traced, DemoError> {
    let declared = Machine::parse(MACHINE, "machines/demo.toml")?;
    let drawn = draw(&declared, seed);
    progress("running the machine");
    let [fit, validate] = logs(&drawn.truth, seed)?;
    let trace = trace::trace(&declared, &fit, &validate, progress)?;
    let contour_errors = LogError::all(fit.iter().chain(&validate));
    Ok(Traced { seed, drawn, trace, contour_errors })
}

/// Compensates a machine by its traced model, and executes a motion of its logs and one that was never used with the settings that
/// it has before, and with its compensation.
///
/// # Errors
/// If the model or the machine cannot be simulated, or the compensation is refused.
pub fn compensated(
    model: &Machine,
    (machine_under_test, before): (&dyn MachineUnderTest, &CompensationFile),
    seed: u64,
) -> Result<Compensated, DemoError> {
    let instruments = Instruments::typical(seed);
    let tests = CHOSEN_ON.map(test_motion).into_iter().collect::<Result<Vec<_>, _>>()?;
    // The gain that the demonstration states is that of its own motions; `compensate` watches others, too.
    let planning = Planning {
        model,
        model_file: "the traced model",
        tests: &tests,
        watched: &[],
        instruments,
        set_at_s: SET_AT_S,
    };
    let plan = planning.plan()?;
    let run_on = RUN_ON.map(test_motion).into_iter().collect::<Result<Vec<_>, _>>()?;
    let motions =
        round_trip::compare(machine_under_test, (model, instruments), [before, &plan.file], &run_on)?;
    let [_, _, after_um] = round_trip::totals_um(&motions);
    let limits = Limits::measure(machine_under_test, (model, instruments), &plan.file, &run_on, after_um)?;
    Ok(Compensated { plan, motions, limits })
}

fn test_motion(text: &str) -> Result<TestMotion, InputError> {
    TestMotion::parse(text, "a shipped motion", SET_AT_S)
}

/// Logs of a machine on the demonstration's motions: those of the fit, and those of the validation.
///
/// # Errors
/// If the machine does not complete a motion.
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

/// Log of a machine on a motion (the text of a motion file) that starts at a session time, s, with typical noise.
///
/// # Errors
/// If the motion is invalid, or the machine does not complete it.
pub fn log(machine: &Machine, motion: &str, start_s: f64, seed: u64) -> Result<Log, DemoError> {
    let motion = Motion::parse(motion, "a shipped motion")?;
    let path = MachinePath::new(&motion, machine, "a shipped motion")?;
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

/// The residual reported by the demonstration, µm rms, on the validation motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Headline {
    /// Stage of the residual.
    pub stage: Stage,
    /// With the declared model.
    pub before: f64,
    /// With the effects found.
    pub after: f64,
    /// Measurement noise, which no model removes.
    pub noise: f64,
}

impl Traced {
    /// Identification of the axis with the undeclared effect.
    #[must_use]
    pub fn axis(&self) -> Option<&AxisIdentification> {
        self.trace.axes().iter().find(|axis| axis.axis == self.drawn.axis)
    }

    /// The position stage of that axis with the largest decrease of the residual relative to its noise. If none
    /// decreases by more than its noise, the stage with the largest residual relative to its noise.
    #[must_use]
    pub fn headline(&self) -> Option<Headline> {
        let errors = || self.axis().into_iter().flat_map(|axis| &axis.residuals);
        let positions = || errors().filter(|error| error.stage != Stage::Force);
        let max_by = |of: fn(&StageResidual) -> f64| positions().max_by(|a, b| of(a).total_cmp(&of(b)));
        let decrease = |error: &StageResidual| (error.before.validate - error.after.validate) / error.noise;
        let error = max_by(decrease)
            .filter(|error| decrease(error) > 1.0)
            .or_else(|| max_by(|e| e.before.validate / e.noise))?;
        Some(Headline {
            stage: error.stage,
            before: error.before.validate,
            after: error.after.validate,
            noise: error.noise,
        })
    }

    /// Whether the trace found exactly the undeclared effect, on its axis.
    #[must_use]
    pub fn is_named(&self) -> bool {
        self.trace.found_names() == [format!("{}: {}", self.drawn.axis, self.drawn.effect.name())]
    }
}

impl Demo {
    /// The JSON of `demo --json`.
    #[must_use]
    pub fn json(&self) -> Value {
        let Self { traced, compensated, .. } = self;
        let headline = traced.headline();
        let effect = &traced.drawn.effect;
        let parameters: serde_json::Map<String, Value> = effect
            .parameters()
            .into_iter()
            .map(|(name, value)| (name.to_owned(), json!({"value": value})))
            .collect();
        let mut truth = json!({
            "name": effect.name(),
            "axis": traced.drawn.axis,
            "parameters": parameters,
        });
        if let (Some(source), Value::Object(truth)) = (effect.distinction().source(), &mut truth) {
            truth.insert("source".to_owned(), json!(source));
        }
        let [before, predicted, after] = round_trip::totals_um(&compensated.motions);
        json!({
            "seed": traced.seed,
            "undeclared": [truth],
            "found": trace::json::effects(&traced.trace),
            "residual_um": {
                "before": headline.map(|h| h.before),
                "after": headline.map(|h| h.after),
                "noise": headline.map(|h| h.noise),
            },
            "contour_error_um": {"before": before, "predicted": predicted, "after": after},
            "limits": compensated.limits.json(),
            "motions": compensated.motions.iter().map(|motion| motion.comparison().json()).collect::<Vec<_>>(),
            "compensation": commissioning::compensate::json::of(&compensated.plan),
        })
    }
}
