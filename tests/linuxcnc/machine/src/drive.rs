//! What an axis makes of its command: a force, or a force by loops of its own.

use model::axis::Settings;
use model::servo;
use plant::parameters::AxisParameters;
use shared::config::{AxisConfig, Rates};
use shared::control::velocity::{State, VelocityControl};
use shared::units::{Position, VELOCITY_M_PER_S};

/// What LinuxCNC commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// The force of the motor, N: a torque drive.
    Force,
    /// The velocity of the motor, m/s: a drive with the velocity loop of the machine file.
    Velocity,
    /// The position of the motor, m. The field of a stepper motor holds the rotor like a spring with a damper, of the stiffness Kp·Kv
    /// and the damping Kv of the machine file, without an integral part.
    Position,
}

impl Command {
    /// The command of a name of the component's parameter; `None`: there is no such command.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "force" => Some(Self::Force),
            "velocity" => Some(Self::Velocity),
            "position" => Some(Self::Position),
            _ => None,
        }
    }

    /// Metres, m/s or N in a unit of the component's pins: mm, mm/s or N.
    #[must_use]
    pub const fn unit(self) -> f64 {
        match self {
            Self::Force => 1.0,
            Self::Velocity | Self::Position => 1e-3,
        }
    }
}

/// The drive of an axis.
#[derive(Clone, Copy, Debug)]
pub struct Drive {
    command: Command,
    position_gain_per_s: f64,
    force_limit_n: f64,
    velocity: VelocityControl<f64>,
    state: State<f64>,
    /// Last command, SI.
    last: f64,
}

impl Drive {
    /// A drive at rest at a reading of its motor.
    ///
    /// # Errors
    /// The key that the machine file lacks, or whose value the loop does not take.
    pub fn at_rest(
        command: Command,
        settings: &Settings,
        parameters: &AxisParameters,
        rates: Rates,
        motor: Position,
    ) -> Result<Self, &'static str> {
        let settings = servo::settings(settings, &parameters.servo)?;
        let config = AxisConfig::<f64>::new(&settings, rates).map_err(|error| error.name())?;
        Ok(Self {
            command,
            position_gain_per_s: settings.position_gain_per_s,
            force_limit_n: settings.force_limit_n,
            velocity: config.velocity,
            state: State::at(motor),
            last: if command == Command::Position { motor.to_m() } else { 0.0 },
        })
    }

    /// The force over a tick, N. `share` of the servo period, 0 to 1, has passed at its start, when the motor was read.
    pub fn force_n(&mut self, command: f64, [share, period_s]: [f64; 2], motor: Position) -> f64 {
        let velocity_m_per_s = match self.command {
            Command::Force => return command.clamp(-self.force_limit_n, self.force_limit_n),
            Command::Velocity => command,
            // A pulse train runs from one command to the next at constant speed.
            Command::Position => {
                let change = command - self.last;
                self.position_gain_per_s * (self.last + share * change - motor.to_m()) + change / period_s
            }
        };
        self.velocity.force(&mut self.state, velocity_m_per_s / VELOCITY_M_PER_S, motor)
    }

    /// Ends a servo period with its command.
    pub const fn end_period(&mut self, command: f64) {
        self.last = command;
    }
}
