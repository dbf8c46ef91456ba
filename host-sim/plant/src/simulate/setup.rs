//! The controller of a machine file.

use shared::config::AxisSettings;
use shared::units::Position;

use super::error::SimulationError;
use crate::controller::Controller;
use crate::parameters::AxisParameters;
use model::machine::{Machine, rotary};
use model::servo;
use shared::scalar::Format;

/// Most steps of the plant per tick: a stiffer machine is refused.
const MAX_SUBSTEPS: f64 = 500.0;

/// A controller in this process for a machine at rest at `start_m`, one position per axis.
///
/// # Errors
/// When the file lacks a key or a setting is refused.
pub fn controller(
    machine: &Machine,
    format: Format,
    start_m: &[f64],
) -> Result<Box<dyn Controller>, SimulationError> {
    let (settings, start) = controller_setup(machine, start_m)?;
    Ok(crate::controller::in_process(format, machine.rates(), &settings, &start)?)
}

/// Settings and start of the axes, for a controller in this process or on a chip.
///
/// # Errors
/// The key that the machine file lacks, or whose value needs steps that are too short.
pub fn controller_setup(
    machine: &Machine,
    start_m: &[f64],
) -> Result<(Vec<AxisSettings>, Vec<Position>), SimulationError> {
    let mut settings = Vec::new();
    for ((name, axis), parameters) in machine.axis.iter().zip(AxisParameters::of_machine(machine)) {
        let names = axis.settings.names;
        let lacks =
            |key| SimulationError::Lacks { axis: name.clone(), key: rotary::written(key, 1.0, names).0 };
        if parameters.motor_mass_kg + parameters.table_mass_kg <= 0.0 {
            return Err(lacks("table_mass_kg"));
        }
        let (key, step_s) = parameters.step_limit();
        if step_s * machine.velocity_rate_hz() * MAX_SUBSTEPS < 1.0 {
            return Err(SimulationError::TooFast { axis: name.clone(), key, step_s });
        }
        if axis.settings.gantry.gantry_with.is_some() {
            return Err(SimulationError::Gantry { axis: name.clone() });
        }
        if let Some(effect) = parameters.servo.not_in_controller() {
            return Err(SimulationError::NotSimulated { axis: name.clone(), effect });
        }
        let axis = servo::settings(&axis.settings, &parameters.servo).map_err(lacks)?;
        // The simulated machine has no brake that a motion had to wait for.
        settings.push(AxisSettings { brake: None, ..axis });
    }
    let start = start_m.iter().map(|&m| Position::from_m(m).unwrap_or_default()).collect();
    Ok((settings, start))
}
