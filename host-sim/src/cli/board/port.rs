//! The arguments that commands for a servo board share: its port, and one of its axes.

use std::time::Duration;

use anyhow::Result;

use ::board::{BoardError, Client, Observer};
use files::error::InputError;
use shared::link::Welcome;

/// Maximum of `--timeout-s`.
const MAX_TIMEOUT_S: f64 = 3600.0;

/// The port of a board.
#[derive(clap::Args)]
pub struct PortArguments {
    /// `bench` (or `emulated`): the emulated servo board, which is started if it does not run (`cargo servo` builds it); otherwise a serial port
    /// (`board ports` lists them) or a socket.
    #[arg(long)]
    port: String,
    /// Timeout for a reply of the board, s.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, default_value_t = 2.0)]
    timeout_s: f64,
}

impl PortArguments {
    /// The port as it was given.
    pub fn name(&self) -> &str {
        &self.port
    }

    /// Opens a session with the board.
    ///
    /// # Errors
    /// An invalid argument, a port that cannot be opened, a board that does not answer.
    pub fn connect(&self) -> Result<Client> {
        connect(&self.port, self.timeout_s)
    }

    /// Opens the port for what needs no session, or a connection to the program that holds it.
    ///
    /// # Errors
    /// As [`PortArguments::connect`].
    pub fn observe(&self) -> Result<Observer> {
        let timeout = timeout(self.timeout_s)?;
        Observer::open(&self.port, timeout).map_err(of_port)
    }

    /// What the board at an observed port is.
    ///
    /// # Errors
    /// A board that does not answer, or an emulated one of other sources.
    pub fn identify(&self, observer: &mut Observer) -> Result<Welcome> {
        let welcome = observer.identify()?;
        check_sources(&self.port, &welcome)?;
        Ok(welcome)
    }
}

/// The timeout for a reply.
fn timeout(seconds: f64) -> Result<Duration, InputError> {
    if seconds > 0.0 && seconds <= MAX_TIMEOUT_S {
        return Ok(Duration::from_secs_f64(seconds));
    }
    let expected = format!("seconds above 0 and up to {MAX_TIMEOUT_S}");
    Err(InputError::expected("--timeout-s", expected, seconds))
}

/// A port that cannot be opened is an error of the argument.
fn of_port(error: BoardError) -> anyhow::Error {
    match error {
        BoardError::Port(problem) => InputError::new("--port", problem).into(),
        error => error.into(),
    }
}

/// The emulated board has to run the program of these sources.
fn check_sources(port: &str, welcome: &Welcome) -> Result<(), InputError> {
    if board::open::is_bench(port) && welcome.sources != shared::SOURCES {
        let problem = "the emulated board runs a program of other sources: end it (`board bench end`) and build it again \
                       (`cargo servo`)";
        return Err(InputError::new("--port", problem));
    }
    Ok(())
}

/// Opens a session with the board at a port.
///
/// # Errors
/// See [`PortArguments::connect`].
pub fn connect(port: &str, timeout_s: f64) -> Result<Client> {
    let timeout = timeout(timeout_s)?;
    let client = Client::connect(board::open(port).map_err(of_port)?, timeout)?;
    check_sources(port, client.welcome())?;
    Ok(client)
}

/// The port of a board, and one of its axes.
#[derive(clap::Args)]
pub struct AxisArguments {
    #[command(flatten)]
    pub port: PortArguments,
    /// Axis.
    #[arg(long)]
    pub axis: String,
}

impl AxisArguments {
    /// The number of the axis.
    ///
    /// # Errors
    /// If no board has such an axis.
    pub fn number(&self) -> Result<u8, InputError> {
        axis_number("--axis", &self.axis)
    }

    /// Opens a session with the board, which has to have the axis.
    ///
    /// # Errors
    /// As [`PortArguments::connect`]; a board without the axis.
    pub fn connect(&self) -> Result<Client> {
        let client = self.port.connect()?;
        check_axis(&client, "--axis", &self.axis)?;
        Ok(client)
    }
}

/// The board has to have the axis that an option names.
///
/// # Errors
/// If it has no such axis.
pub fn check_axis(client: &Client, option: &str, name: &str) -> Result<(), InputError> {
    let names = &board::refusal::AXIS_NAMES[..client.axes()];
    if names.contains(&name) {
        return Ok(());
    }
    let expected = format!("{} (the axes of the board)", names.join(" or "));
    Err(InputError::expected(option, expected, files::error::quoted(name)))
}

/// The number of the axis that an option names.
///
/// # Errors
/// If no board has such an axis.
pub fn axis_number(option: &str, name: &str) -> Result<u8, InputError> {
    let names = board::refusal::AXIS_NAMES;
    let number = names.iter().position(|known| *known == name).and_then(|number| u8::try_from(number).ok());
    number.ok_or_else(|| InputError::expected(option, names.join(" or "), files::error::quoted(name)))
}

/// Refuses the value of an option that is not valid, before the board is asked for anything.
///
/// # Errors
/// A value that is not valid.
pub fn check_value(option: &str, expected: &str, is_valid: bool, value: f64) -> Result<(), InputError> {
    // Not `Display`, which writes 1e300 with all its digits.
    if is_valid { Ok(()) } else { Err(InputError::expected(option, expected, format!("{value:?}"))) }
}
