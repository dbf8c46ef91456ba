//! Errors of the controller and the simulator, assigned to the input file and key that caused them.

use anyhow::Error;
use shared::config::ConfigError;
use shared::interpolate::PathError;
use shared::machine::MachineError;

use files::error::InputError;
use model::machine::Machine;
use motion::MAX_AXES;
use plant::controller::ControllerError;
use plant::simulate::SimulationError;

/// The inputs of a run, and the names of their files.
pub struct Inputs<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// The machine's file.
    pub machine_file: &'a str,
    /// The motion's file.
    pub motion_file: &'a str,
}

impl Inputs<'_> {
    /// An [`InputError`] if an input was refused; any other error is passed on.
    pub fn error(&self, error: impl Into<SimulationError>) -> Error {
        use SimulationError::{Block, Controller, Gantry, Lacks, TooFast};

        let error = error.into();
        let input = match &error {
            Lacks { axis, key } => {
                InputError::expected(self.machine_file, "this key, which a closed loop requires", "none")
                    .at_key(&format!("axis.{axis}.{key}"))
            }
            TooFast { axis, key, step_s } => {
                let problem = format!(
                    "expected an axis that steps of 1 µs can resolve; with the masses of the axis, this value \
                     requires steps of {step_s:.1e} s"
                );
                InputError::new(self.machine_file, problem).at_key(&format!("axis.{axis}.{key}"))
            }
            Gantry { axis } => {
                let problem =
                    "a gantry is not simulated; the emulated board has one (`board bench add-beam`)";
                InputError::new(self.machine_file, problem).at_key(&format!("axis.{axis}.gantry_with"))
            }
            Controller(ControllerError::Refused(MachineError::Config { axis, error })) => {
                self.setting_error(*axis, error)
            }
            Controller(ControllerError::Axes(found)) => {
                let expected = format!("1 to {MAX_AXES} axes");
                InputError::expected(self.machine_file, expected, found).at_key("axis")
            }
            Controller(ControllerError::Port(problem)) => InputError::new("--port", problem),
            Block { index, error: PathError::BeyondTravel { axis } } => self.travel_error(*index, *axis),
            Block { index, error } => {
                let problem = format!("expected a block that the controller can run: {error}");
                InputError::new(self.motion_file, problem).at_key(&format!("block[{index}]"))
            }
            _ => return error.into(),
        };
        input.into()
    }

    fn travel_error(&self, index: usize, axis: u8) -> InputError {
        let axis = self.machine.axis.get_index(axis.into());
        let (name, [min, max]) = axis.map_or(("", [f64::NAN; 2]), |(name, axis)| {
            (name, axis.settings.limits.travel_mm.unwrap_or([f64::NAN; 2]))
        });
        let problem = format!(
            "expected a block within axis.{name}.travel_mm, {min} to {max} mm, of {}",
            self.machine_file
        );
        InputError::new(self.motion_file, problem).at_key(&format!("block[{index}]"))
    }

    fn setting_error(&self, axis: usize, error: &ConfigError) -> InputError {
        let name = error.name();
        // Keys of the machine file with another unit or name, and the factor to the unit of the file.
        let (key, factor) = match name {
            "velocity_loop_hz" => ("velocity_loop_rate_hz", 1.0),
            "fastest_m_per_s" => ("fastest_mm_per_s", 1e3),
            "following_error_limit_m" => ("following_error_limit_mm", 1e3),
            "scale_disagreement_limit_m" => ("scale_disagreement_limit_mm", 1e3),
            "frozen_encoder_limit_m" => ("frozen_encoder_limit_mm", 1e3),
            "travel_m" => ("travel_mm", 1e3),
            name => (name, 1.0),
        };
        let key = match (key, self.machine.axis.get_index(axis)) {
            ("velocity_loop_rate_hz", _) | (_, None) => "velocity_loop_rate_hz".to_owned(),
            (key, Some((axis, _))) => format!("axis.{axis}.{key}"),
        };
        let error = match *error {
            ConfigError::OutOfRange { name, min, max } => {
                ConfigError::OutOfRange { name, min: factor * min, max: factor * max }
            }
            error => error,
        };
        InputError::new(self.machine_file, format!("expected {}", error.expectation())).at_key(&key)
    }
}
