//! The controller on a chip in step with a simulated machine: the chip waits for each tick ([`shared::lockstep`]).
//!
//! - [`remote`]: the controller at the other end of a connection
//! - [`emulator`]: the connection to a core emulated by QEMU

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod emulator;
pub mod remote;

use std::path::PathBuf;
use std::time::Duration;

use emulator::Emulator;
use files::error::quoted;
use plant::controller::ControllerError;

/// Opens a port. [`remote::Remote::set_up`] then configures its controller.
///
/// `port` is `emulated` for the program built by `cargo emulated`, or `emulated:PATH` for another build of it. `timeout` is
/// the maximum time for an answer.
///
/// # Errors
/// [`ControllerError::Port`] if there is no such port; [`ControllerError::Link`] if the program or the emulator is missing,
/// does not start, or has another version than this program.
pub fn open(port: &str, timeout: Duration) -> Result<Emulator, ControllerError> {
    let program = match port.split_once(':') {
        None if port == "emulated" => emulator::default_program(),
        Some(("emulated", path)) if !path.is_empty() => PathBuf::from(path),
        _ => {
            return Err(ControllerError::Port(format!(
                "expected emulated or emulated:PROGRAM, found {}",
                quoted(port)
            )));
        }
    };
    let mut emulator = Emulator::start(&program, timeout).map_err(ControllerError::Link)?;
    remote::identify(&mut emulator)?;
    Ok(emulator)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(port: &str) -> String {
        open(port, emulator::DEFAULT_TIMEOUT).expect_err("there is no such port").to_string()
    }

    #[test]
    fn the_error_for_an_unknown_port_lists_the_known_ports() {
        for port in ["/dev/ttyUSB0", "emulated:", "emulator", ""] {
            assert_eq!(error(port), format!("port: expected emulated or emulated:PROGRAM, found \"{port}\""));
        }
    }

    #[test]
    fn the_error_for_a_missing_program_contains_the_command_to_build_it() {
        assert_eq!(
            error("emulated:/nowhere/emulated"),
            "link: /nowhere/emulated: no such program, build it with `cargo emulated`"
        );
    }
}
