//! `lost-motion board home`: moves an axis to its reference.

use anyhow::{Result, bail};

use super::port::{AxisArguments, check_value};
use super::simple::wait;
use crate::cli::outputs::print;
use crate::cli::stop;
use ::board::{BoardError, refusal};
use files::error::InputError;
use shared::homing::HardStopSettings;
use shared::link::refusal::SettingProblem;
use shared::link::report::HomingReport;
use shared::link::{Refusal, Request};

/// Acceleration of a homing to a hard stop, m/s².
const ACCELERATION_M_PER_S2: f64 = 0.5;

/// Arguments of `board home`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    axis: AxisArguments,
    /// Home to a hard stop with this force limit; its sign is the direction. Without it: to the mark of the home switch.
    #[arg(long, value_name = "NEWTONS", allow_negative_numbers = true, requires = "search_mm")]
    stop_force_n: Option<f64>,
    /// Greatest distance to the hard stop.
    #[arg(long, value_name = "MM", allow_negative_numbers = true, requires = "stop_force_n")]
    search_mm: Option<f64>,
    /// Speed towards the hard stop, and back.
    #[arg(long, value_name = "MM_PER_MIN", allow_negative_numbers = true, default_value_t = 180.0)]
    stop_speed_mm_per_min: f64,
    /// Time for which the axis has to stand at the hard stop with the force at its limit.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, default_value_t = 0.03)]
    standstill_s: f64,
    /// Distance by which the axis backs off from the hard stop.
    #[arg(long, value_name = "MM", allow_negative_numbers = true, default_value_t = 2.0)]
    back_off_mm: f64,
    /// Position of the axis at the hard stop.
    #[arg(long, value_name = "MM", allow_negative_numbers = true, default_value_t = 0.0)]
    stop_at_mm: f64,
}

/// The request. Its numbers are checked here: the drives are switched on before the board gets it.
fn request(arguments: &Arguments, axis: u8) -> Result<Request, InputError> {
    let (Some(force_n), Some(search_mm)) = (arguments.stop_force_n, arguments.search_mm) else {
        return Ok(Request::Home { axis });
    };
    let Arguments { stop_speed_mm_per_min, standstill_s, back_off_mm, stop_at_mm, .. } = *arguments;
    let is_force = force_n != 0.0 && force_n.is_finite();
    check_value("--stop-force-n", "newtons other than 0, signed", is_force, force_n)?;
    for (option, value, most) in [
        ("--search-mm", search_mm, 1e4),
        ("--stop-speed-mm-per-min", stop_speed_mm_per_min, 1e4),
        ("--standstill-s", standstill_s, 10.0),
        ("--back-off-mm", back_off_mm, 1e4),
    ] {
        let expected = format!("a number above 0 and up to {most}");
        check_value(option, &expected, value > 0.0 && value <= most, value)?;
    }
    check_value("--stop-at-mm", "a number from -10000 to 10000", stop_at_mm.abs() <= 1e4, stop_at_mm)?;
    let settings = HardStopSettings {
        force_n,
        speed_m_per_s: stop_speed_mm_per_min / 60e3,
        acceleration_m_per_s2: ACCELERATION_M_PER_S2,
        standstill_s,
        search_distance_m: 1e-3 * search_mm,
        back_off_distance_m: 1e-3 * back_off_mm,
        stop_position_m: 1e-3 * stop_at_mm,
    };
    Ok(Request::HomeToStop { axis, settings })
}

/// Only the board knows the limits of the axis.
fn refused(error: BoardError, arguments: &Arguments) -> anyhow::Error {
    let BoardError::Refused(Refusal::Setting {
        name,
        problem: SettingProblem::AboveCeiling { ceiling, .. },
        ..
    }) = &error
    else {
        return error.into();
    };
    let force_n = arguments.stop_force_n.unwrap_or_default();
    let (option, expected, found) = match name.as_str() {
        "force_limit_n" => {
            ("--stop-force-n", format!("at most {ceiling} N, the force limit of the axis"), force_n)
        }
        "saturation_time_s" => {
            let expected = format!("at most {ceiling} s, the saturation_time_s of the axis");
            ("--standstill-s", expected, arguments.standstill_s)
        }
        _ => {
            let most = 60e3 * ceiling / arguments.standstill_s;
            let expected = format!("at most {most:.0} (half of {name} in --standstill-s)");
            ("--stop-speed-mm-per-min", expected, arguments.stop_speed_mm_per_min)
        }
    };
    InputError::expected(option, expected, found).into()
}

/// Enables the drives if they are off, moves an axis to its reference and waits for the end.
///
/// # Errors
/// Invalid arguments, a board that cannot be reached or refuses it, an axis that was not homed.
pub fn run(arguments: &Arguments) -> Result<()> {
    let axis = arguments.axis.number()?;
    let request = request(arguments, axis)?;
    let mut client = arguments.axis.connect()?;
    stop::write_partial_result();
    client.enable()?;
    stop::check_before_motion()?;
    client.command(&request).map_err(|error| refused(error, arguments))?;
    wait(&mut client)?;
    let status = client.status()?;
    let name = &arguments.axis.axis;
    match status.homing {
        HomingReport::Homed => {
            let at_mm = 1e3 * status.axes[usize::from(axis)].command.to_m();
            print(&format!("{name} is homed; it is at {at_mm:.4} mm."))
        }
        HomingReport::Failed(failure) => bail!("{name}: not homed: {}", refusal::homing(failure)),
        HomingReport::None | HomingReport::Running => Err(BoardError::Unexpected.into()),
    }
}
