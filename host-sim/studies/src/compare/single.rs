//! The pipeline whose positions are f32 metres, which exists only here, to show what they lose.
//!
//! The control laws are those of `shared` in f32, and so is the look-ahead: how far each tick goes is what
//! the integer path goes. But the place along the path is a sum of these steps in f32, the point on
//! the path is computed from it in f32, and the readings are rounded to f32 before they are subtracted. Between
//! two neighbours of one sign and size a difference of f32 is exact, so the laws may subtract them as
//! integers.

use shared::axis::{AxisState, Reading};
use shared::config::{AxisConfig, AxisSettings, Rates};
use shared::interpolate::{Path, PathError};
use shared::machine::MachineError;
use shared::safety::{Event, Fault, Power};
use shared::scalar::Scalar;
use shared::units::Position;

use super::AXES;
use super::exact::{Point, apart_nm, length};
use link::controller::{AxisOutput, Controller, ControllerError, PathBlock, PathShape, Status};

/// The nearest f32 in metres.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "the loss is what is to be shown")]
pub fn metres(position: Position) -> f32 {
    position.to_m() as f32
}

/// An f32 in metres as a position, exact to its unit of 1e-6 nm.
#[must_use]
pub fn position(metres: f32) -> Position {
    Position::from_m(f64::from(metres)).unwrap_or_default()
}

/// A block travelled in f32.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    shape: Shape,
    /// From the start, or from the last passage of it on a circle, m.
    distance: f32,
    /// Passages of the start.
    turns: u32,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    Stand([f32; AXES]),
    Line { start: [f32; AXES], direction: [f32; AXES] },
    Circle { centre: [f32; AXES], radius: f32, angle: f32, sense: f32, circumference: f32 },
}

impl Way {
    /// The way of a block that starts at `start`; an arc turns from the first axis to the second.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "planned in f64, kept in f32")]
    pub fn of(block: &PathBlock, start: Point) -> Self {
        let from = start.map(Position::to_m);
        let shape = match &block.shape {
            PathShape::Dwell { .. } => Shape::Stand(start.map(metres)),
            PathShape::Line { to_m } => {
                let way: [f64; AXES] = std::array::from_fn(|i| to_m[i] - from[i]);
                let direction = way.map(|part| (part / length(way)) as f32);
                Shape::Line { start: start.map(metres), direction }
            }
            PathShape::Arc { centre_m, turns, .. } => circle(from, *centre_m, turns.signum()),
            PathShape::ArcTo { centre_m, positive, .. } => {
                circle(from, *centre_m, if *positive { 1.0 } else { -1.0 })
            }
        };
        Self { shape, distance: 0.0, turns: 0 }
    }

    /// How far along the path two exact points are apart, m.
    #[must_use]
    pub fn step_m(&self, from: Point, to: Point) -> f64 {
        let chord = 1e-9 * length(apart_nm(to, from));
        match self.shape {
            Shape::Circle { radius, .. } => {
                let diameter = 2.0 * f64::from(radius);
                let x = chord / diameter;
                // The arc sine: for the steps of a tick two terms are exact to 3/40·x⁴ < 1e-9, far below f32.
                if x < 1e-2 { chord * (1.0 + x * x / 6.0) } else { diameter * x.asin() }
            }
            _ => chord,
        }
    }

    /// How far it has come, in turns of a circle; not a number on anything else.
    #[must_use]
    pub fn turns(&self) -> f64 {
        match self.shape {
            Shape::Circle { circumference, .. } => {
                f64::from(self.turns) + f64::from(self.distance) / f64::from(circumference)
            }
            _ => f64::NAN,
        }
    }

    /// Goes on by a step, m, and gives the point.
    #[expect(clippy::cast_possible_truncation, reason = "a length in f32")]
    pub fn go(&mut self, step_m: f64) -> [f32; AXES] {
        self.distance += step_m as f32;
        match self.shape {
            Shape::Stand(place) => place,
            Shape::Line { start, direction } => {
                std::array::from_fn(|i| start[i] + self.distance * direction[i])
            }
            Shape::Circle { centre, radius, angle, sense, circumference } => {
                if self.distance >= circumference {
                    self.distance -= circumference;
                    self.turns = self.turns.wrapping_add(1);
                }
                let (sine, cosine) = (angle + sense * self.distance / radius).sin_cos();
                [centre[0] + radius * cosine, centre[1] + radius * sine]
            }
        }
    }
}

/// The circle about a centre through a point, m.
#[expect(clippy::cast_possible_truncation, reason = "planned in f64, kept in f32")]
fn circle(from: [f64; AXES], centre: [f64; AXES], sense: f64) -> Shape {
    let [x, y] = [from[0] - centre[0], from[1] - centre[1]];
    let radius = length([x, y]);
    Shape::Circle {
        centre: centre.map(|m| m as f32),
        radius: radius as f32,
        angle: y.atan2(x) as f32,
        sense: sense as f32,
        circumference: (std::f64::consts::TAU * radius) as f32,
    }
}

/// A controller of two axes whose positions are f32 metres.
pub struct Single {
    axes: Vec<(AxisConfig<f32>, AxisState<f32>)>,
    pace: Path<AXES>,
    way: Way,
    command: Point,
    divider: u32,
    until_position_tick: u32,
    enable_requested: bool,
    power: Power,
}

impl Single {
    /// A machine that stands at `start`, drives off.
    ///
    /// # Errors
    /// [`ControllerError::Refused`] as from `shared`.
    pub fn new(rates: Rates, settings: &[AxisSettings], start: Point) -> Result<Self, ControllerError> {
        let command = start.map(|place| position(metres(place)));
        let axis = |(axis, settings)| {
            let config = AxisConfig::new(settings, rates)
                .map_err(|error| ControllerError::Refused(MachineError::Config { axis, error }))?;
            let place = command[axis];
            Ok((config, AxisState::at_rest(place, Reading { motor: place, table: None })))
        };
        Ok(Self {
            axes: settings.iter().enumerate().map(axis).collect::<Result<_, ControllerError>>()?,
            pace: Path::new(start, rates.position_loop_hz()),
            way: Way { shape: Shape::Stand(start.map(metres)), distance: 0.0, turns: 0 },
            command,
            divider: rates.position_loop_divider,
            until_position_tick: 0,
            enable_requested: false,
            power: Power::Off,
        })
    }

    /// The next command: a step of the exact path's length, or its programmed end.
    fn advance(&mut self) {
        let from = self.pace.command();
        let to = self.pace.advance();
        let point = self.way.go(self.way.step_m(from, to));
        let point = if self.pace.is_done() { to.map(metres) } else { point };
        self.command = point.map(position);
    }
}

impl Controller for Single {
    /// One block at a time.
    fn push(&mut self, block: &PathBlock) -> Result<(), ControllerError> {
        let refused = |error| ControllerError::Refused(MachineError::Path(error));
        if !self.pace.is_done() {
            return Err(refused(PathError::QueueFull));
        }
        let exact = block.for_axes::<AXES>().ok_or(ControllerError::Axes(AXES))?;
        self.pace.push(&exact).map_err(refused)?;
        self.way = Way::of(block, self.pace.command());
        Ok(())
    }

    fn enable(&mut self) -> Result<(), ControllerError> {
        self.enable_requested = true;
        Ok(())
    }

    fn tick(&mut self, readings: &[Reading], outputs: &mut [AxisOutput]) -> Result<Status, ControllerError> {
        let single = |place: Position| position(metres(place));
        let readings: Vec<Reading> = readings
            .iter()
            .map(|reading| Reading { motor: single(reading.motor), table: reading.table.map(single) })
            .collect();
        if std::mem::take(&mut self.enable_requested) && self.power == Power::Off {
            for (((_, state), command), reading) in self.axes.iter_mut().zip(self.command).zip(&readings) {
                *state = AxisState::at_rest(command, *reading);
            }
            self.until_position_tick = 0;
            self.power = self.power.after(Event::Enable);
        }
        if self.power == Power::On && self.until_position_tick == 0 {
            self.until_position_tick = self.divider;
            self.advance();
            for (number, ((config, state), reading)) in (0u8..).zip(self.axes.iter_mut().zip(&readings)) {
                let command = self.command[usize::from(number)];
                for kind in state.position_tick(config, command, 0, *reading).iter() {
                    self.power = self.power.after(Event::Fault(Fault::Axis { axis: number, kind }));
                }
            }
        }
        self.until_position_tick = self.until_position_tick.saturating_sub(1);
        for ((((config, state), reading), command), output) in
            self.axes.iter_mut().zip(&readings).zip(self.command).zip(outputs)
        {
            let force = match self.power {
                Power::On => state.velocity_tick(config, *reading, 0.0).0,
                _ => 0.0,
            };
            *output = AxisOutput { force_n: force.value(), force_bits: force.bits(), command };
        }
        Ok(Status { power: self.power, warning: None, done: self.pace.is_done(), cost: None })
    }
}

#[cfg(test)]
mod tests {
    use shared::safety::FaultKind;

    use super::*;
    use crate::compare::motion::Motion;

    /// Distance (nm) that an f32 makes of a distance from 1 m.
    fn kept(nm: f64) -> f64 {
        let place = Position::from_m(1.0).unwrap() + Position::from_m(1e-9 * nm).unwrap().0;
        1e9 * (f64::from(metres(place)) - 1.0)
    }

    /// The spacing is 2⁻²³ m = 119.2 nm above 1 m and half of that below; to nearest, half a spacing is
    /// lost at the most.
    #[test]
    fn at_1_m_a_position_is_rounded_to_119_nm_above_and_60_below() {
        let (above, below) = (1e9 * 2f64.powi(-23), 1e9 * 2f64.powi(-24));
        for (nm, expected) in [(59.5, 0.0), (59.7, above), (178.7, above), (-29.7, 0.0), (-29.9, -below)] {
            assert!((kept(nm) - expected).abs() < 1e-6, "{nm}: {}", kept(nm));
        }
        // As a position it is again what it was.
        let metre = metres(Position::from_m(1.0 + 1e-6).unwrap());
        assert!(metres(position(metre)).to_bits() == metre.to_bits());
    }

    /// 100 steps of a hundredth of a turn come round to within 100 roundings of half a unit of 0.5 m (30 nm),
    /// and that many times farther on the way is not the start.
    #[test]
    fn a_way_goes_round() {
        let start = Motion::Circle.start_m().map(|m| Position::from_m(m).unwrap());
        let block = &Motion::Circle.blocks(1)[1];
        let mut way = Way::of(block, start);
        let step = std::f64::consts::TAU * 0.1 / 100.0;
        let points: Vec<[f32; AXES]> = (0..100).map(|_| way.go(step)).collect();
        let off = |[x, y]: [f32; AXES], [u, v]: [f64; AXES]| length([f64::from(x) - u, f64::from(y) - v]);
        assert!(off(points[24], [0.0, 0.1]) < 100.0 * 30e-9 && off(points[49], [-0.1, 0.0]) < 100.0 * 30e-9);
        assert!(off(points[99], [0.1, 0.0]) < 100.0 * 30e-9);
        assert!((way.turns() - 1.0).abs() < 5e-6);
    }

    /// Between two points of a circle the step is the arc, by its chord.
    #[test]
    fn a_step_is_the_arc() {
        let at = |angle: f64| [0.1 * angle.cos(), 0.1 * angle.sin()].map(|m| Position::from_m(m).unwrap());
        let way = Way::of(&Motion::Circle.blocks(1)[1], at(0.0));
        for angle in [4e-4, 0.01, 0.019, 0.5] {
            let step = way.step_m(at(0.3), at(0.3 + angle));
            // The radius in f32 is within 3e-8 of 0.1 m; it enters through the small difference of arc and chord.
            assert!((step / (0.1 * angle) - 1.0).abs() < 1e-8, "{angle}: {step}");
        }
    }

    /// A controller of the comparison's machine at the start of the circle, drives asked for.
    fn controller() -> Single {
        let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };
        let start = Motion::Circle.start_m().map(|m| Position::from_m(m).unwrap());
        let mut controller = Single::new(rates, &[AxisSettings::default(); AXES], start).unwrap();
        controller.enable().unwrap();
        controller
    }

    #[test]
    fn one_block_at_a_time() {
        let mut controller = controller();
        let block = &Motion::Circle.blocks(1)[1];
        controller.push(block).unwrap();
        assert_eq!(controller.push(block).unwrap_err().to_string(), PathError::QueueFull.to_string());
    }

    /// Limits are those of `shared`: beyond 50 mm of following error the drives go off in the same tick.
    #[test]
    fn a_following_error_switches_off() {
        let mut controller = controller();
        let mut outputs = [AxisOutput::default(); AXES];
        let mut tick = |x_m: f64| {
            let reading = |m: f64| Reading { motor: Position::from_m(m).unwrap(), table: None };
            let status = controller.tick(&[reading(x_m), reading(0.0)], &mut outputs).unwrap();
            (status.power, outputs[0].force_n)
        };
        assert_eq!(tick(0.1), (Power::On, 0.0));
        assert!((0..4).all(|_| tick(0.149).0 == Power::On));
        let (power, force_n) = tick(0.149);
        // 49 mm too far: pushed back.
        assert!(power == Power::On && force_n < -1.0, "{force_n}");
        let last = (0..5).map(|_| tick(0.151)).last().unwrap();
        assert_eq!(last, (Power::Faulted(Fault::Axis { axis: 0, kind: FaultKind::FollowingError }), 0.0));
    }
}
