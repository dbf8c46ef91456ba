//! `lost-motion improve`: log, trace, compensate and run again, until nothing more is gained.

use std::path::{Path, PathBuf};

use anyhow::{Error, Result};

use super::margins::LimitArguments;
use super::outputs::{Output, check_outputs, print, write_json};
use super::progress::Progress;
use commissioning::compensate::controller_host::ControllerHost;
use commissioning::compensate::prediction::TestMotion;
use commissioning::compensate::round_trip::SimulatedMachine;
use files::error::InputError;
use files::output::{remove, write_whole};
use improve::outcome::Improvement;
use improve::{ImproveError, Improving};
use model::machine::Machine;
use motion::Motion;
use plant::instruments::Instruments;
use report::before_after::RoundTripMotion;
use report::improvement_page;

/// Time on the session clock between the starts of two motions, s.
const MOTION_EVERY_S: f64 = 60.0;

/// Names of the files in the folder of `--out`.
const FILES: [&str; 3] = ["model.toml", "compensation.toml", "improvement.json"];

/// Arguments of `improve`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Machine file with the declared model.
    #[arg(long)]
    machine: PathBuf,
    /// Machine file with the effects of the machine that is simulated and improved.
    #[arg(long)]
    plant: PathBuf,
    /// Motion that is logged for the trace; may be given several times.
    #[arg(long, required = true)]
    fit: Vec<PathBuf>,
    /// Motion whose contour error is to become smaller, and whose log is held out of the fits; may be given several times.
    #[arg(long, required = true)]
    motion: Vec<PathBuf>,
    /// Greatest number of rounds.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u8).range(1..=20))]
    rounds: u8,
    /// Folder for model.toml, compensation.toml and improvement.json of the last round that is kept, and report.html; it is created.
    #[arg(long)]
    out: PathBuf,
    /// Run the controller on the emulated core.
    #[arg(long)]
    emulated: bool,
    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    limits: LimitArguments,
}

/// Runs the command.
///
/// # Errors
/// Invalid input, a motion that cannot be executed, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let outputs = FILES.map(|name| arguments.out.join(name));
    let page = pages::file_in(Some(&arguments.out));
    let motions = arguments.fit.iter().chain(&arguments.motion);
    let inputs: Vec<&Path> =
        [&arguments.machine, &arguments.plant].into_iter().chain(motions).map(PathBuf::as_path).collect();
    let files = outputs.iter().chain(&page).map(|path| Output::InNewFolder("--out", Some(path)));
    check_outputs(&inputs, &files.collect::<Vec<_>>())?;
    let limits = arguments.limits.checked()?;
    let (declared, plant) = (Machine::read(&arguments.machine)?, Machine::read(&arguments.plant)?);
    check_plant(&declared, &plant, &arguments.plant)?;
    let (fit, judged) = motions_of(arguments)?;
    let machine_under_test = SimulatedMachine {
        machine: &plant,
        instruments: Instruments::of(&plant, arguments.seed),
        controller_host: if arguments.emulated { ControllerHost::EmulatedCore } else { ControllerHost::Host },
    };
    let improving = Improving { declared: &declared, machine_under_test, fit: &fit, judged: &judged, limits };
    let progress = Progress::start();
    let improvement =
        improving.improve(usize::from(arguments.rounds), &|what| progress.show(what)).map_err(|error| {
            match error {
                ImproveError::Input(error) => Error::from(error),
                ImproveError::Run(error) => Error::from(error),
            }
        })?;
    drop(progress);
    let page = write(arguments, &declared, &improvement)?;
    print(&format!("{}\n\nReport: {}", improvement.text(), page.display()))
}

/// Checks that the machine that runs has the name and the axes of the declared one.
fn check_plant(declared: &Machine, plant: &Machine, file: &Path) -> Result<(), InputError> {
    let file = file.display().to_string();
    if declared.name != plant.name {
        let expected = format!("the machine {}", declared.name);
        return Err(InputError::expected(&file, expected, &plant.name).at_key("name"));
    }
    let names = |machine: &Machine| machine.axis.keys().cloned().collect::<Vec<_>>().join(", ");
    if names(declared) != names(plant) {
        let expected = format!("the axes {}", names(declared));
        return Err(InputError::expected(&file, expected, names(plant)).at_key("axis"));
    }
    Ok(())
}

/// The motions of the fit, one after the other on the session clock, and those that are judged, all at the time at which the
/// compensation is set, after them.
fn motions_of(arguments: &Arguments) -> Result<(Vec<TestMotion>, Vec<TestMotion>), InputError> {
    let read = |path: &PathBuf, start_s: f64| TestMotion::read(path, start_s);
    let fit = arguments.fit.iter().zip(0u32..);
    let fit: Vec<TestMotion> =
        fit.map(|(path, number)| read(path, MOTION_EVERY_S * f64::from(number))).collect::<Result<_, _>>()?;
    let set_at_s = MOTION_EVERY_S * fit.len() as f64;
    let judged: Vec<TestMotion> =
        arguments.motion.iter().map(|path| read(path, set_at_s)).collect::<Result<_, _>>()?;
    for test in &judged {
        if let Some(same) = fit.iter().find(|fitted| is_same_motion(fitted, test)) {
            let expected = "a motion that is not one of --fit: its log is held out of the fits";
            return Err(InputError::expected(&test.source, expected, format!("that of {}", same.source)));
        }
    }
    Ok((fit, judged))
}

/// Whether two motions differ at most by their names.
fn is_same_motion(one: &TestMotion, other: &TestMotion) -> bool {
    one.motion == Motion { name: one.motion.name.clone(), ..other.motion.clone() }
}

/// Writes model, compensation and figures of the round that is kept, and the page of all rounds.
fn write(arguments: &Arguments, declared: &Machine, improvement: &Improvement) -> Result<PathBuf> {
    let axes: Vec<String> = declared.axis.keys().cloned().collect();
    let motions: Vec<RoundTripMotion> = improvement
        .comparisons()
        .into_iter()
        .map(|(name, errors)| RoundTripMotion { name: name.to_owned(), axes: axes.clone(), errors })
        .collect();
    let page = improvement_page::write(&arguments.out, &declared.name, &improvement.sentences(), &motions)?;
    let [model, compensation, json] = FILES.map(|name| arguments.out.join(name));
    if let Some(kept) = improvement.kept() {
        write_whole(&model, |out| out.write_all(kept.model.to_toml().as_bytes()))?;
        let toml = kept.plan.file.to_toml()?;
        write_whole(&compensation, |out| out.write_all(toml.as_bytes()))?;
    } else {
        // Those of an earlier run do not belong to this page.
        [model, compensation].iter().try_for_each(|path| remove(path))?;
    }
    write_json(Some(&json), &improvement.json())?;
    Ok(page)
}
