//! `lost-motion board response`: the frequency response of an axis at rest, measured with a small force of a few tones.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Result, bail};

use super::consent;
use super::port::{AxisArguments, check_value};
use super::record;
use super::upload;
use crate::cli::outputs::{Output, check_outputs, print, write_json};
use crate::cli::progress::Progress;
use crate::cli::stop;
use ::board::{BoardError, Client, motion};
use commissioning::margins::{AxisMargins, MarginLimits, axis_margins};
use commissioning::response::file::{Conditions, ControllerKeys};
use commissioning::response::tones::Range;
use commissioning::response::{Plan, PlanError, Point, Record, ResponseFile, spectrum, text};
use files::error::InputError;
use model::machine::Machine;
use plant::instruments::Instruments;
use shared::capture::{CaptureState, Trigger};
use shared::config::{AxisSettings, Rates};
use shared::excitation::ExcitationSettings;
use shared::link::Refusal;
use shared::link::message::Request;
use shared::link::report::Activity;
use shared::safety::Power;

/// Time from the start of a force to the first recording, in which the axis settles: shorter than a silence that ends the force.
const SETTLING: Duration = Duration::from_millis(300);

/// Time between two looks at a recording.
const POLL: Duration = Duration::from_millis(20);

/// Longest measurement of one group of tones.
const MAX_PERIODS: usize = 100;

/// Arguments of `board response`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    axis: AxisArguments,
    /// Lowest frequency.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, default_value_t = 10.0)]
    from_hz: f64,
    /// Highest frequency.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, default_value_t = 2000.0)]
    to_hz: f64,
    /// Sum of the amplitudes of the tones that act at once, N. Above the friction of the axis, or its table does not move.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    force_n: f64,
    /// Number of tones, 2 to 200.
    #[arg(long, default_value_t = 32)]
    tones: usize,
    /// Tones that act at once, 1 to 8: fewer have greater amplitudes, and take longer.
    #[arg(long, default_value_t = 4)]
    at_once: usize,
    /// Periods that are recorded of each tone; the coherence is that between them.
    #[arg(long, default_value_t = 4)]
    periods: usize,
    /// Machine file with the settings that the board has; default: that of the emulated board.
    #[arg(long)]
    machine: Option<PathBuf>,
    /// Write the response as JSON.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Do not ask before the drives are switched on and the force acts.
    #[arg(long)]
    yes: bool,
}

/// Runs the command.
///
/// # Errors
/// Invalid arguments, no consent, a board that cannot be reached or refuses the force, drives that go off, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let axis = arguments.axis.number()?;
    check(arguments)?;
    let inputs: Vec<_> = arguments.machine.iter().map(PathBuf::as_path).collect();
    check_outputs(&inputs, &[Output::File("--out", arguments.out.as_ref())])?;
    let declared = Declared::read(arguments, axis)?;
    let mut client = arguments.axis.connect()?;
    declared.check_axis_count(&client)?;
    let tick_hz = client.welcome().rates.velocity_loop_hz;
    let range = Range {
        from_hz: arguments.from_hz,
        to_hz: arguments.to_hz,
        tones: arguments.tones,
        at_once: arguments.at_once,
    };
    let plan = Plan::new(&range, tick_hz).map_err(of_option)?;
    consent::ask(&consequence(arguments), arguments.yes)?;
    stop::write_partial_result();
    check_force(&mut client, &plan, axis, arguments.force_n)?;
    client.enable()?;
    stop::check_before_motion()?;
    let measured = measure(&mut client, arguments, axis, (&plan, &declared));
    // Also after a failure: nothing is to act any longer than it has to.
    let stopped = client.command(&Request::Stop);
    let points = measured?;
    stopped?;
    let at_m = client.status()?.axes[usize::from(axis)].command.to_m();
    let conditions = Conditions {
        board: client.welcome().board.to_string(),
        axis: arguments.axis.axis.clone(),
        at_mm: 1e3 * at_m,
        force_n: arguments.force_n,
        tones_at_once: arguments.at_once,
        periods: arguments.periods,
        period_s: f64::from(plan.period_ticks) / tick_hz,
        tick_rate_hz: tick_hz,
        controller: declared.controller,
    };
    let file = ResponseFile::new(conditions, &points, &declared.margins);
    write_json(arguments.out.as_ref(), &file)?;
    let written = arguments.out.as_ref().map_or(String::new(), |path| format!(" in {}", path.display()));
    print(&format!(
        "{}: {} tones from {:.1} to {:.1} Hz{written}.\n\n{}",
        arguments.axis.axis,
        points.len(),
        points.first().map_or(0.0, |point| point.frequency_hz),
        points.last().map_or(0.0, |point| point.frequency_hz),
        text::of(&file)
    ))
}

/// Checks the numbers that do not depend on the board.
fn check(arguments: &Arguments) -> Result<(), InputError> {
    let force_n = arguments.force_n;
    check_value("--force-n", "newtons above 0", force_n > 0.0 && force_n.is_finite(), force_n)?;
    let periods = arguments.periods;
    if !(1..=MAX_PERIODS).contains(&periods) {
        return Err(InputError::expected("--periods", format!("a number from 1 to {MAX_PERIODS}"), periods));
    }
    Ok(())
}

/// An invalid range is an error of the option.
fn of_option(error: PlanError) -> InputError {
    let option = match error {
        PlanError::From { .. } => "--from-hz",
        PlanError::To { .. } => "--to-hz",
        PlanError::Tones => "--tones, --at-once",
    };
    InputError::new(option, error.to_string())
}

/// What is going to happen, for the question.
fn consequence(arguments: &Arguments) -> String {
    format!(
        "response switches the drives on if they are off, and shakes {} with up to {} N from {} to {} Hz",
        arguments.axis.axis, arguments.force_n, arguments.from_hz, arguments.to_hz
    )
}

/// What a machine file says of the axis.
struct Declared {
    machine: Machine,
    source: String,
    settings: AxisSettings,
    controller: ControllerKeys,
    rates: Rates,
    margins: AxisMargins,
}

impl Declared {
    fn read(arguments: &Arguments, axis: u8) -> Result<Self> {
        let (machine, source) = record::machine_of(arguments.machine.as_deref())?;
        let settings = upload::settings(&machine, &source)?;
        let margins =
            axis_margins::of_machine(&machine, &Instruments::of(&machine, 0), MarginLimits::default())
                .map_err(|error| InputError::new(&source, error.to_string()))?;
        let lacks = || upload::of_other_axes(&source);
        let (_, keys) = machine.axis.get_index(usize::from(axis)).ok_or_else(lacks)?;
        Ok(Self {
            controller: (&keys.settings).into(),
            settings: settings.get(usize::from(axis)).copied().ok_or_else(lacks)?,
            rates: machine.rates(),
            margins: margins.into_iter().nth(usize::from(axis)).ok_or_else(lacks)?,
            machine,
            source,
        })
    }

    /// The machine has to have as many axes as the board.
    fn check_axis_count(&self, client: &Client) -> Result<(), InputError> {
        upload::check_axis_count(&self.machine, &self.source, client)
    }
}

/// Lets the board check the forces before the drives are on: those that it accepts are refused as the drives are off.
fn check_force(client: &mut Client, plan: &Plan, axis: u8, force_n: f64) -> Result<()> {
    if client.status()?.power.is_on() {
        return Ok(());
    }
    for group in &plan.groups {
        let refused = client.command(&Request::Excite(plan.excitation(group, axis, force_n)));
        if let Err(BoardError::Refused(
            Refusal::Setting { .. } | Refusal::Excitation(_) | Refusal::NoSuchAxis,
        )) = refused
        {
            return Ok(refused?);
        }
    }
    Ok(())
}

/// Measures every group of tones. Points in ascending order.
fn measure(
    client: &mut Client,
    arguments: &Arguments,
    axis: u8,
    (plan, declared): (&Plan, &Declared),
) -> Result<Vec<Point>> {
    let progress = Progress::start();
    let tick_hz = client.welcome().rates.velocity_loop_hz;
    let mut points = Vec::new();
    for (number, group) in plan.groups.iter().enumerate() {
        let excitation = plan.excitation(group, axis, arguments.force_n);
        client.command(&Request::Excite(excitation.clone()))?;
        client.listen(SETTLING)?;
        let mut records = Vec::new();
        for period in 0..arguments.periods {
            progress.show(&format!("tones {}/{}, period {}", number + 1, plan.groups.len(), period + 1));
            records.push(record(client, &excitation)?);
        }
        let lines = spectrum::lines(&excitation, &records, tick_hz)
            .map_err(|problem| BoardError::Refused(Refusal::Excitation(problem)))?;
        points.extend(lines.iter().map(|line| Point::of(line, &declared.settings, declared.rates)));
    }
    points.sort_by(|one, other| one.frequency_hz.total_cmp(&other.frequency_hz));
    Ok(points)
}

/// Records a period of a force that acts.
fn record(client: &mut Client, excitation: &ExcitationSettings) -> Result<Record> {
    let samples = u32::from(excitation.period_ticks) + 1;
    client.command(&Request::Arm { trigger: Trigger::Now, samples })?;
    let report = loop {
        client.listen(POLL)?;
        if stop::is_interrupted() {
            return Err(stop::Stopped { done: 0, asked: 1, what: "responses; the force is off" }.into());
        }
        let report = client.capture_report()?;
        if report.state == CaptureState::Complete {
            break report;
        }
    };
    let status = client.status()?;
    if status.power != Power::On {
        return Err(motion::stopped(&status).into());
    }
    if status.activity != Activity::Response {
        bail!("the force has ended: this program was silent for too long, or another one has stopped it");
    }
    if report.samples < samples {
        bail!(
            "a period does not fit the memory of the board for recordings, {} bytes: a higher --from-hz has shorter ones",
            client.welcome().capture_bytes
        );
    }
    let samples = client.read_capture()?;
    let of = |value: fn(&::board::samples::AxisSample) -> f64| {
        samples.iter().map(|sample| value(&sample[usize::from(excitation.axis)])).collect()
    };
    Ok(Record {
        start_tick: report.start,
        motor_m: of(|axis| axis.motor_m),
        table_m: samples.iter().map(|sample| sample[usize::from(excitation.axis)].table_m).collect(),
        force_n: of(|axis| axis.force_n),
    })
}
