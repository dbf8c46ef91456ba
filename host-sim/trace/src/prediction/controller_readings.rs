//! What the loops of a controller use of command and readings: a late position, a filtered velocity.

use shared::axis::Reading;
use shared::units::Position;

use model::servo::ServoParameters;
use plant::axis_motion::AxisMotion;
use plant::delay::Delay;

/// The readings that the two loops use.
pub struct ControllerReadings {
    /// Delays of motor and scale on their way to the position loop; `None` without one.
    position: Option<[Delay; 2]>,
    velocity: Option<Filter>,
}

impl ControllerReadings {
    /// The readings of a controller with these parameters and this tick (s), on an axis in steady motion with its first reading.
    #[must_use]
    pub fn new(servo: &ServoParameters, tick_s: f64, first: Reading, motion: &AxisMotion) -> Self {
        let AxisMotion { motor_m_per_s, table_m_per_s, .. } = *motion;
        // The output of the position loop is late if both of its inputs are.
        let delay_s = servo.position_delay.seconds() + servo.loop_delay.seconds();
        let delay =
            |position: Position, velocity| Delay::in_motion(delay_s, tick_s, position.to_m(), velocity);
        let position =
            delay(first.motor, motor_m_per_s).zip(delay(first.table.unwrap_or_default(), table_m_per_s));
        let time_constant_s = servo.velocity_filter.time_constant_s();
        let filter = || Filter::new(time_constant_s, tick_s, first.motor.to_m(), motor_m_per_s);
        Self {
            position: position.map(|(motor, table)| [motor, table]),
            velocity: (time_constant_s > 0.0).then(filter),
        }
    }

    /// The readings for the position loop and for the velocity loop, at a tick with this reading and motion.
    pub fn at_tick(&mut self, reading: Reading, motion: &AxisMotion) -> [Reading; 2] {
        let of = |m: f64| Position::from_m(m).unwrap_or_default();
        let for_position = match &mut self.position {
            None => reading,
            Some([motor, table]) => Reading {
                motor: of(motor.read(reading.motor.to_m(), motion.motor_m_per_s)),
                table: reading.table.map(|m| of(table.read(m.to_m(), motion.table_m_per_s))),
            },
        };
        let for_velocity = match &mut self.velocity {
            None => reading,
            Some(filter) => Reading { motor: of(filter.filtered(reading.motor.to_m())), ..reading },
        };
        [for_position, for_velocity]
    }
}

/// First-order low-pass of a position, whose differences are those of the filtered velocity: y += (1 − e^(−T/τ))·(x − y).
struct Filter {
    left: f64,
    last_m: f64,
    /// y − x.
    behind_m: f64,
    /// y − x in the motion at the start, which is subtracted: the velocity loop begins with the reading itself.
    first_behind_m: f64,
}

impl Filter {
    fn new(time_constant_s: f64, tick_s: f64, start_m: f64, velocity: f64) -> Self {
        let left = libm::exp(-tick_s / time_constant_s);
        let behind_m = -left / (1.0 - left) * velocity * tick_s;
        Self { left, last_m: start_m - velocity * tick_s, behind_m, first_behind_m: behind_m }
    }

    fn filtered(&mut self, position_m: f64) -> f64 {
        self.behind_m = self.left * (self.behind_m - (position_m - self.last_m));
        self.last_m = position_m;
        position_m + self.behind_m - self.first_behind_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ramp is passed unchanged; after a stop, the remaining velocity falls by e^(−T/τ) a tick.
    #[test]
    fn the_velocity_follows_with_the_time_constant() {
        let (tick_s, velocity) = (1e-3, 0.2);
        let mut filter = Filter::new(5e-3, tick_s, 0.0, velocity);
        let mut last_m = -velocity * tick_s;
        for tick in 0..20 {
            let filtered_m = filter.filtered(f64::from(tick) * velocity * tick_s);
            assert!(((filtered_m - last_m) / tick_s - velocity).abs() < 1e-12);
            last_m = filtered_m;
        }
        let at_rest_m = 19.0 * velocity * tick_s;
        for tick in 1..20 {
            let filtered_m = filter.filtered(at_rest_m);
            let expected = velocity * (-f64::from(tick) * 0.2).exp();
            assert!(((filtered_m - last_m) / tick_s - expected).abs() < 1e-12, "{tick}");
            last_m = filtered_m;
        }
    }
}
