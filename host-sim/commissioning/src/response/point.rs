//! Plant and loops at one frequency.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;
use shared::config::{AxisSettings, Law, Rates, Sensors, VelocitySource};
use shared::control::observer;

use super::spectrum::Line;

/// Which loop a response is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loop {
    /// Both loops, cut at the force.
    Force,
    /// The velocity loop, cut at the force, with the position loop open.
    Velocity,
    /// The position loop, cut at the velocity command.
    Position,
}

impl Loop {
    /// All loops.
    pub const ALL: [Self; 3] = [Self::Force, Self::Velocity, Self::Position];

    /// Name in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Force => "at the force",
            Self::Velocity => "velocity",
            Self::Position => "position",
        }
    }
}

/// The measured response at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// See [`Line::coherence`].
    pub coherence: f64,
    /// Velocity of the motor per force, m/s per N, of the mechanics and the drive, without the hold of the force over a tick.
    pub plant_m_per_s_per_n: Complex<f64>,
    /// Open loop, cut at the force.
    pub open_loop: Complex<f64>,
    /// Open velocity and position loop; `None`: the controller is not one whose loops can be told apart.
    pub loops: Option<[Complex<f64>; 2]>,
}

impl Point {
    /// The point of a line. `settings` are those of the controller of the axis, `rates` those of its loops.
    #[must_use]
    pub fn of(line: &Line, settings: &AxisSettings, rates: Rates) -> Self {
        let omega = TAU * line.frequency_hz;
        let half = 0.5 * omega / rates.velocity_loop_hz;
        // A force that was recorded in a tick has been held over the tick before.
        let held = line.force_n * Complex::from_polar(libm::sin(half) / half, half);
        let open_loop = (Complex::from(line.excitation_n) - line.force_n) / line.force_n;
        Self {
            frequency_hz: line.frequency_hz,
            coherence: line.coherence,
            plant_m_per_s_per_n: Complex::new(0.0, omega) * line.motor_m / held,
            open_loop,
            loops: ratio(line, settings, rates).map(|ratio| {
                let velocity = open_loop / (1.0 + ratio);
                [velocity, ratio * velocity / (1.0 + velocity)]
            }),
        }
    }

    /// The closed loop L/(1 + L), from the excitation to the force of the controller.
    #[must_use]
    pub fn closed_loop(&self) -> Complex<f64> {
        self.open_loop / (1.0 + self.open_loop)
    }

    /// The response of an open loop; `None`: see [`Point::loops`].
    #[must_use]
    pub fn of_loop(&self, which: Loop) -> Option<Complex<f64>> {
        match which {
            Loop::Force => Some(self.open_loop),
            Loop::Velocity => self.loops.map(|[velocity, _]| velocity),
            Loop::Position => self.loops.map(|[_, position]| position),
        }
    }
}

/// The velocity command of the position loop over the velocity that the velocity loop gets, for a motor that moves. The command is that of
/// the last position tick: the mean of the ticks of its hold. The motor's velocity is the difference of two ticks, or that of an observer.
fn ratio(line: &Line, settings: &AxisSettings, rates: Rates) -> Option<Complex<f64>> {
    if settings.law != Law::P || settings.velocity_lag_s.abs() > 0.0 {
        return None;
    }
    let position = match settings.sensors {
        Sensors::Motor { .. } => Complex::from(1.0),
        Sensors::Table(_) => line.table_m? / line.motor_m,
        Sensors::Dual { .. } => return None,
    };
    let tick_s = 1.0 / rates.velocity_loop_hz;
    let angle = TAU * line.frequency_hz * tick_s;
    if angle >= PI {
        return None;
    }
    let difference = (Complex::from(1.0) - Complex::from_polar(1.0, -angle)) / tick_s;
    let velocity = difference * observed(settings.velocity_source, angle, tick_s);
    let divider = rates.position_loop_divider.max(1);
    let held: Complex<f64> =
        (0..divider).map(|tick| Complex::from_polar(1.0, -angle * f64::from(tick))).sum();
    Some(position * settings.position_gain_per_s * held / f64::from(divider) / velocity)
}

/// The velocity that an observer gives over that of the difference, at an angle per tick: ((1 − r)/(1 − r/z))², as in
/// `shared/src/control/observer.rs`.
fn observed(source: VelocitySource, angle: f64, tick_s: f64) -> Complex<f64> {
    match source {
        VelocitySource::Difference => Complex::from(1.0),
        VelocitySource::Observer { bandwidth_hz } => {
            let gain = observer::gain(bandwidth_hz * tick_s);
            let stage = gain / (Complex::from(1.0) - Complex::from_polar(1.0 - gain, -angle));
            stage * stage
        }
    }
}
