//! `lost-motion board upload`: settings of a machine file and a compensation.

use std::path::PathBuf;

use anyhow::Result;

use super::port::PortArguments;
use super::preload;
use crate::cli::compensation::check_margins;
use crate::cli::outputs::print;
use ::board::refusal::AXIS_NAMES;
use ::board::{BoardError, Client};
use commissioning::compensate::CompensationFile;
use commissioning::margins::MarginLimits;
use files::error::{InputError, quoted};
use model::machine::Machine;
use model::servo::{self, ServoParameters};
use shared::config::AxisSettings;
use shared::link::board_settings::UploadedSettings;
use shared::link::message::{MAX_AXES, Request, UploadKind};
use shared::link::refusal::Refusal;

/// Arguments of `board upload`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    port: PortArguments,
    /// Machine file: the controller's keys become the settings of the board.
    #[arg(long, alias = "settings")]
    machine: PathBuf,
    /// Compensation file, as `compensate` writes it.
    #[arg(long)]
    compensation: Option<PathBuf>,
    /// Save it to the flash of the board, for its next starts. The axes have to be homed again.
    #[arg(long)]
    save: bool,
}

/// Runs the command.
///
/// # Errors
/// Invalid input, a board that cannot be reached, a setting that it refuses.
pub fn run(arguments: &Arguments) -> Result<()> {
    let mut machine = Machine::read(&arguments.machine)?;
    let compensation = match &arguments.compensation {
        Some(path) => {
            let file = CompensationFile::read(path, &machine)?;
            check_margins(&file, &path.display().to_string(), &machine, MarginLimits::default())?;
            machine = file.applied_to(&machine);
            Some((file, path.display().to_string()))
        }
        None => None,
    };
    let source = arguments.machine.display().to_string();
    let mut settings = settings(&machine, &source)?;
    let file = compensation.as_ref().map(|(file, source)| (file, source.as_str()));
    let preloads = preload::complete(&mut settings, &machine, &source, file);
    let mut client = arguments.port.connect()?;
    check_axis_count(&machine, &source, &client)?;
    if arguments.save {
        client.begin_save()?;
    }
    let settings = UploadedSettings { rates: machine.rates(), axes: &settings };
    client.upload(UploadKind::Settings, &settings).map_err(|error| refused(error, &source))?;
    let mut done = format!("The board has the settings of {source}");
    if let Some((file, source)) = &compensation {
        send_compensation(&mut client, &machine, file, source)?;
        done += &format!(" and the compensation of {source}");
    }
    if arguments.save {
        client.command(&Request::Save)?;
        done += ", and has saved them: the axes have to be homed again";
    }
    print(&[vec![format!("{done}.")], preloads].concat().join("\n"))
}

/// That a machine file has other axes than the board.
pub fn of_other_axes(source: &str) -> InputError {
    InputError::expected(source, "the axes of the board, whose machine file --machine names", "others")
}

/// The settings of the axes from a machine file.
///
/// # Errors
/// A machine with axes that no board has, a key that is missing.
pub fn settings(machine: &Machine, source: &str) -> Result<Vec<AxisSettings>, InputError> {
    check_axes(machine, source)?;
    let axes = machine.axis.iter().map(|(name, axis)| {
        let settings = servo::settings(&axis.settings, &ServoParameters::of(&axis.effect));
        let gantry = servo::gantry(&axis.settings, machine.axis.keys());
        settings.map(|settings| AxisSettings { gantry, ..settings }).map_err(|key| {
            InputError::expected(source, "this key, which a controller requires", "none")
                .at_key(&format!("axis.{name}.{key}"))
        })
    });
    axes.collect()
}

/// A machine file is for a board with as many axes.
///
/// # Errors
/// A board with another number of axes.
pub fn check_axis_count(machine: &Machine, source: &str, client: &Client) -> Result<(), InputError> {
    let (count, board) = (machine.axis.len(), client.axes());
    if count == board {
        return Ok(());
    }
    let plural = if board == 1 { "axis" } else { "axes" };
    let expected = format!("{board} {plural}, as the board has ({})", AXIS_NAMES[..board].join(", "));
    Err(InputError::expected(source, expected, count).at_key("axis"))
}

/// The axes have to be those of the board, in its order: it knows them by their numbers.
fn check_axes(machine: &Machine, source: &str) -> Result<(), InputError> {
    if machine.axis.len() > MAX_AXES {
        let expected = format!("1 to {MAX_AXES} axes, as a board has");
        return Err(InputError::expected(source, expected, machine.axis.len()).at_key("axis"));
    }
    for (name, known) in machine.axis.keys().zip(AXIS_NAMES) {
        if name != known {
            let expected =
                format!("axis {known} here (a board has {}, in this order)", AXIS_NAMES.join(", "));
            let error = InputError::expected(source, expected, quoted(name));
            return Err(error.at_key(&format!("axis.{name}")));
        }
    }
    Ok(())
}

/// Sends the compensation of every axis; an axis without one gets an empty one.
fn send_compensation(
    client: &mut Client,
    machine: &Machine,
    file: &CompensationFile,
    source: &str,
) -> Result<()> {
    for (number, name) in (0u8..).zip(machine.axis.keys()) {
        let settings = file.axis.get(name).map(|axis| axis.compensation.clone()).unwrap_or_default();
        client
            .upload(UploadKind::Compensation { axis: number }, &settings)
            .map_err(|error| refused(error, source))?;
    }
    Ok(())
}

/// A setting that the board refuses is an error of the file.
fn refused(error: BoardError, source: &str) -> anyhow::Error {
    match &error {
        BoardError::Refused(Refusal::Setting { .. } | Refusal::TickRate { .. }) => {
            InputError::new(source, error.to_string()).into()
        }
        BoardError::Refused(Refusal::NoSuchAxis | Refusal::Axes { .. }) => {
            InputError::new(source, error.to_string()).at_key("axis").into()
        }
        _ => error.into(),
    }
}
