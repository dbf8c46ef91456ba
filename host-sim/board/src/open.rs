//! Ports by their names.

use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

use files::error::quoted;
use serialport::{SerialPortInfo, SerialPortType};

use crate::bench::{self, Bench};
use crate::broker;
use crate::error::BoardError;
use crate::port::{self, Port};
use crate::port_lock::{self, PortLock};

/// Longest wait for a program that holds a port to listen.
const LISTEN_TIMEOUT: Duration = Duration::from_secs(1);

/// Time between two attempts.
const RETRY: Duration = Duration::from_millis(20);

/// Where a port is: the emulated board, or a path of a socket or a serial port.
enum Place<'a> {
    Bench(Bench),
    Path(&'a str),
}

/// Opens a port: `bench` or `emulated` for the emulated servo board, which is started if it does not run; the path of a
/// socket; otherwise the name of a serial port. It is held until it is dropped; other programs can meanwhile [`observe`] it.
///
/// # Errors
/// [`BoardError::Port`] in one line, [`BoardError::InUse`] with the program that uses it.
pub fn open(name: &str) -> Result<Port, BoardError> {
    let place = Place::of(name)?;
    let in_use = |holder| BoardError::InUse { port: quoted(name), holder };
    let lock = PortLock::take(&place.lock()).map_err(in_use)?;
    place.open(lock)
}

/// Opens a port, or a connection to the program that holds it, for what needs no session. Returns that program, in words.
///
/// # Errors
/// As [`open`]; [`BoardError::PassesNothingOn`] if the program that holds the port cannot be asked.
pub fn observe(name: &str) -> Result<(Port, Option<String>), BoardError> {
    let place = Place::of(name)?;
    let started = Instant::now();
    loop {
        let holder = match PortLock::take(&place.lock()) {
            Ok(lock) => return Ok((place.open(lock)?, None)),
            Err(holder) => holder,
        };
        if let Ok(port) = Port::socket(&broker::socket_of(&place.lock())) {
            return Ok((port, Some(holder)));
        }
        // It has just locked the port, or is about to end.
        if started.elapsed() > LISTEN_TIMEOUT {
            return Err(BoardError::PassesNothingOn { port: quoted(name), holder });
        }
        sleep(RETRY);
    }
}

impl<'a> Place<'a> {
    fn of(name: &'a str) -> Result<Self, BoardError> {
        Ok(if is_bench(name) { Self::Bench(Bench::start()?) } else { Self::Path(name) })
    }

    fn lock(&self) -> PathBuf {
        match self {
            Self::Bench(bench) => bench.link_lock(),
            Self::Path(name) => lock_of(Path::new(name)),
        }
    }

    fn open(&self, lock: Option<PortLock>) -> Result<Port, BoardError> {
        let name = match self {
            Self::Bench(bench) => return Ok(bench.link()?.held_by(lock)),
            Self::Path(name) => *name,
        };
        let failed = |problem: String| BoardError::Port(format!("{}: {problem}", quoted(name)));
        let path = Path::new(name);
        if port::is_socket(path) {
            let port = Port::socket(path).map_err(|error| failed(error.to_string()))?;
            return Ok(port.held_by(lock));
        }
        if let Some(holder) = port_lock::other_user_of(path) {
            return Err(BoardError::PassesNothingOn { port: quoted(name), holder });
        }
        let port = Port::serial(name)
            .map_err(|error| failed(format!("{error}; expected {}", expected(&serial_ports()))))?;
        Ok(port.held_by(lock))
    }
}

/// The file of the lock of a port, by its true name: links lead to the same port.
fn lock_of(port: &Path) -> PathBuf {
    let port = std::fs::canonicalize(port).unwrap_or_else(|_| port.to_owned());
    let name = port.to_string_lossy().replace(std::path::MAIN_SEPARATOR, "_");
    bench::folder().join(format!("port{name}.lock"))
}

/// Whether a name is that of the emulated servo board.
#[must_use]
pub fn is_bench(name: &str) -> bool {
    name == "bench" || name == "emulated"
}

/// The names of the serial ports of this computer.
fn serial_ports() -> Vec<String> {
    let ports = serialport::available_ports().unwrap_or_default();
    ports.into_iter().map(|port| port.port_name).collect()
}

/// What a port may be, on a computer with these serial ports.
fn expected(serial_ports: &[String]) -> String {
    if serial_ports.is_empty() {
        "emulated or bench, as this computer has no serial port".to_owned()
    } else {
        format!("emulated, bench, or one of: {}", serial_ports.join(", "))
    }
}

/// A line for the emulated board, and one for each serial port of this computer: its name, and of a USB port vendor, product and
/// their names.
#[must_use]
pub fn describe() -> Vec<String> {
    let ports = serialport::available_ports().unwrap_or_default();
    std::iter::once("bench".to_owned()).chain(ports.iter().map(line)).collect()
}

fn line(port: &SerialPortInfo) -> String {
    let SerialPortType::UsbPort(usb) = &port.port_type else { return port.port_name.clone() };
    let serial = usb.serial_number.as_ref().map(|serial| format!("serial number {serial}"));
    let names = [&usb.manufacturer, &usb.product, &serial].into_iter().flatten();
    // What a device tells of itself may be anything.
    let names: String = names.map(|name| format!(", {}", name.escape_default())).collect();
    format!("{}  USB {:04x}:{:04x}{names}", port.port_name, usb.vid, usb.pid)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serialport::UsbPortInfo;

    #[test]
    fn every_expected_port_is_listed_once() {
        let ports = |names: &[&str]| expected(&names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>());
        assert_eq!(ports(&[]), "emulated or bench, as this computer has no serial port");
        assert_eq!(ports(&["/dev/ttyACM0"]), "emulated, bench, or one of: /dev/ttyACM0");
        assert_eq!(
            ports(&["/dev/ttyS0", "/dev/ttyACM0"]),
            "emulated, bench, or one of: /dev/ttyS0, /dev/ttyACM0"
        );
    }

    #[test]
    fn a_usb_port_has_its_vendor_and_product() {
        let usb = |serial: Option<&str>, product: Option<&str>| {
            let text = |text: Option<&str>| text.map(str::to_owned);
            line(&SerialPortInfo {
                port_name: "/dev/ttyACM0".into(),
                port_type: SerialPortType::UsbPort(UsbPortInfo {
                    vid: 0x16c0,
                    pid: 0x7dd,
                    serial_number: text(serial),
                    manufacturer: text(Some("Lost Motion")),
                    product: text(product),
                }),
            })
        };
        let expected = "/dev/ttyACM0  USB 16c0:07dd, Lost Motion, two drives, serial number 0a1b";
        assert_eq!(usb(Some("0a1b"), Some("two drives")), expected);
        assert_eq!(usb(None, Some("a\nb")), "/dev/ttyACM0  USB 16c0:07dd, Lost Motion, a\\nb");
        let other = SerialPortInfo { port_name: "/dev/ttyS0".into(), port_type: SerialPortType::Unknown };
        assert_eq!(line(&other), "/dev/ttyS0");
    }
}
