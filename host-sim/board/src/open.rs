//! Ports by their names.

use std::os::unix::fs::FileTypeExt;
use std::path::Path;

use files::error::quoted;

use crate::bench::Bench;
use crate::error::BoardError;
use crate::port::Port;

/// Opens a port: `bench` or `emulated` for the emulated servo board, which is started if it does not run; the path of a
/// socket; otherwise the name of a serial port.
///
/// # Errors
/// [`BoardError::Port`] in one line.
pub fn open(name: &str) -> Result<Port, BoardError> {
    if is_bench(name) {
        return Bench::start()?.link();
    }
    let failed = |problem: String| BoardError::Port(format!("{}: {problem}", quoted(name)));
    let is_socket = std::fs::metadata(name).is_ok_and(|file| file.file_type().is_socket());
    if is_socket {
        return Port::socket(Path::new(name)).map_err(|error| failed(error.to_string()));
    }
    Port::serial(name).map_err(|error| {
        failed(format!("{error}; expected emulated, bench, or one of: {}", list().join(", ")))
    })
}

/// Whether a name is that of the emulated servo board.
#[must_use]
pub fn is_bench(name: &str) -> bool {
    name == "bench" || name == "emulated"
}

/// The names of the serial ports of this computer, and of the emulated board.
#[must_use]
pub fn list() -> Vec<String> {
    let ports = serialport::available_ports().unwrap_or_default();
    std::iter::once("bench".to_owned()).chain(ports.into_iter().map(|port| port.port_name)).collect()
}
