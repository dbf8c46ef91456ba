//! A controller on a chip, as the [`Controller`] that the simulator and the recorder know.
//!
//! [`remote`] speaks the [`shared::protocol`] over any connection; [`emulator`] is the connection to a
//! core that QEMU emulates.

pub mod controller;
pub mod emulator;
pub mod remote;

use std::path::PathBuf;
use std::time::Duration;

use shared::config::{AxisSettings, Rates};
use shared::units::Position;

use crate::controller::{Controller, ControllerError, Format};
use emulator::Emulator;
use files::error::quoted;
use remote::Remote;

/// Opens a port and sets its controller up, drives off.
///
/// `port` is `emulated`, for the program that `cargo emulated` has built, or `emulated:PATH` for
/// another build of it. Each of its answers may take as long as `patience`.
///
/// # Errors
/// [`ControllerError::Refused`] as from [`crate::controller::in_process`] where settings are refused;
/// [`ControllerError::Port`] where there is no such port, or it has too few axes;
/// [`ControllerError::Link`] where the program or the emulator is missing, or does not answer.
pub fn open(
    port: &str,
    patience: Duration,
    format: Format,
    rates: Rates,
    settings: &[AxisSettings],
    start: &[Position],
) -> Result<Box<dyn Controller>, ControllerError> {
    let program = match port.split_once(':') {
        None if port == "emulated" => emulator::default_program(),
        Some(("emulated", path)) if !path.is_empty() => PathBuf::from(path),
        _ => {
            return Err(ControllerError::Port(format!(
                "expected emulated or emulated:PROGRAM (a board on a serial port cannot be reached yet), found {}",
                quoted(port)
            )));
        }
    };
    let link = Emulator::start(&program, patience).map_err(ControllerError::Link)?;
    Ok(Box::new(Remote::set_up(link, format, rates, settings, start)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(port: &str) -> String {
        let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
        let opened =
            open(port, emulator::PATIENCE, Format::Fixed, rates, &[AxisSettings::default()], &[Position(0)]);
        opened.err().expect("nothing is there to open").to_string()
    }

    #[test]
    fn names_the_ports_there_are() {
        for port in ["/dev/ttyUSB0", "emulated:", "emulator", ""] {
            let message = refusal(port);
            assert!(message.contains("expected emulated or emulated:PROGRAM"), "{message}");
            assert!(!message.contains('\n'));
        }
    }

    #[test]
    fn says_how_to_build_a_missing_program() {
        assert_eq!(
            refusal("emulated:/nowhere/emulated"),
            "link: /nowhere/emulated: no such program, build it with `cargo emulated`"
        );
    }
}
