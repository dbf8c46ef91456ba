//! The position sensors of both axes, by the table of the board.

use shared::axis::Reading;
use shared::feedback::ScaleSignal;
use shared::feedback::resolver::{Resolver, Sample};
use shared::figures::EncoderSignals;
use shared::units::Position;

use super::Conversions;
use super::counters::{
    Counters, FreeCounter, IndexedCounter, LongFreeCounter, LongQuadrature, Quadrature, Timers,
};
use crate::setup::{AXES, AxisTable, MotorSensor, SetupError};

/// The sensor of a motor. A resolver is started by its first samples, and has a sample from its first tick on.
enum Motor<Timer> {
    Encoder(Quadrature<Timer>),
    Resolver(Resolver, Option<Sample>),
}

impl<Timer: IndexedCounter<Count = u16>> Motor<Timer> {
    fn new(timer: Timer, sensor: &MotorSensor) -> Result<Self, SetupError> {
        match sensor {
            MotorSensor::Encoder { metres_per_count } => {
                Quadrature::new(timer, *metres_per_count).map(Self::Encoder)
            }
            MotorSensor::Resolver(settings) => {
                // Position zero is at phase zero of its cycle.
                let samples = settings.offset_counts.map(i16::unsigned_abs);
                let resolver = Resolver::new(settings, samples).ok_or(SetupError::Encoder)?;
                Ok(Self::Resolver(resolver, None))
            }
        }
    }

    fn read(&mut self, samples: [u16; 2]) -> Position {
        match self {
            Self::Encoder(encoder) => encoder.position(),
            Self::Resolver(resolver, last) => {
                let sample = resolver.read(samples);
                *last = Some(sample);
                sample.position
            }
        }
    }

    fn take_index(&mut self) -> Option<Position> {
        match self {
            Self::Encoder(encoder) => encoder.take_index(),
            // A resolver is absolute within its cycle; it has no pulse.
            Self::Resolver(..) => None,
        }
    }

    const fn is_good(&self) -> bool {
        match self {
            Self::Encoder(_) => true,
            Self::Resolver(_, Some(sample)) => sample.is_good,
            Self::Resolver(_, None) => false,
        }
    }

    const fn signals(&self) -> Option<EncoderSignals> {
        match self {
            Self::Resolver(_, Some(sample)) => Some(sample.signals),
            Self::Encoder(_) | Self::Resolver(_, None) => None,
        }
    }
}

/// What is at the input of the scale of x.
enum XScale<Timer> {
    Scale(LongQuadrature<Timer>),
    Counter(FreeCounter<Timer>),
}

/// What is at the input of the scale of y.
enum YScale<Timer> {
    Scale(Quadrature<Timer>),
    Counter(LongFreeCounter<Timer>),
}

/// The sensors of both axes, read once in a tick.
pub struct Sensors<C: Counters> {
    x: Motor<C::X>,
    y: Motor<C::Y>,
    x_scale: XScale<C::XScale>,
    y_scale: YScale<C::YScale>,
    /// The counters where there is no scale.
    counters: [Option<u32>; AXES],
    scale_signals: [ScaleSignal; AXES],
    readings: [Reading; AXES],
}

impl<C: Counters> Sensors<C> {
    /// Position zero is the present position.
    ///
    /// # Errors
    /// [`SetupError::Encoder`] for a count or a resolver of the table.
    pub fn new(table: &[AxisTable; AXES], timers: Timers<C>) -> Result<Self, SetupError> {
        let [x, y] = table;
        let x_scale = match x.scale_m_per_count {
            Some(metres) => XScale::Scale(LongQuadrature::new(timers.x_scale, metres)?),
            None => XScale::Counter(FreeCounter(timers.x_scale)),
        };
        let y_scale = match y.scale_m_per_count {
            Some(metres) => YScale::Scale(Quadrature::new(timers.y_scale, metres)?),
            None => YScale::Counter(LongFreeCounter::new(timers.y_scale)),
        };
        Ok(Self {
            x: Motor::new(timers.x, &x.motor)?,
            y: Motor::new(timers.y, &y.motor)?,
            x_scale,
            y_scale,
            counters: [None; AXES],
            scale_signals: [ScaleSignal::NEW; AXES],
            readings: [Reading { motor: Position(0), table: None }; AXES],
        })
    }

    /// Reads all sensors. A scale that has no signal, or had none meanwhile, has no reading.
    pub fn read(&mut self, conversions: &Conversions, have_signal: [bool; AXES]) {
        let [x, y] = conversions.resolvers;
        // Each is read in every tick: a counter of 16 bits must not wrap unseen.
        let (x_table, x_count) = match &self.x_scale {
            XScale::Scale(scale) => (Some(scale.position()), None),
            XScale::Counter(counter) => (None, Some(counter.count())),
        };
        let (y_table, y_count) = match &mut self.y_scale {
            YScale::Scale(scale) => (Some(scale.position()), None),
            YScale::Counter(counter) => (None, Some(counter.count())),
        };
        self.counters = [x_count, y_count];
        let mut tables = [x_table, y_table];
        for ((table, signal), present) in tables.iter_mut().zip(&mut self.scale_signals).zip(have_signal) {
            if !signal.update(present) {
                *table = None;
            }
        }
        let [x_table, y_table] = tables;
        self.readings = [
            Reading { motor: self.x.read(x), table: x_table },
            Reading { motor: self.y.read(y), table: y_table },
        ];
    }

    /// The readings of this tick.
    pub const fn readings(&self) -> [Reading; AXES] {
        self.readings
    }

    /// The motor reading at an index pulse since the last tick.
    pub fn motor_index(&mut self, axis: usize) -> Option<Position> {
        if axis == 0 { self.x.take_index() } else { self.y.take_index() }
    }

    /// The scale reading at an index pulse since the last tick.
    pub fn scale_index(&mut self, axis: usize) -> Option<Position> {
        match (axis, &self.x_scale, &mut self.y_scale) {
            (0, XScale::Scale(scale), _) => scale.take_index(),
            (1, _, YScale::Scale(scale)) => scale.take_index(),
            _ => None,
        }
    }

    /// The counter at the input of the scale, where there is none.
    pub fn counter(&self, axis: usize) -> Option<u32> {
        self.counters.get(axis).copied().flatten()
    }

    /// The signals of the motor's sensor, if it has some.
    pub const fn signals(&self, axis: usize) -> Option<EncoderSignals> {
        if axis == 0 { self.x.signals() } else { self.y.signals() }
    }

    /// Whether the signals of the motor's sensor are good.
    pub const fn is_good(&self, axis: usize) -> bool {
        if axis == 0 { self.x.is_good() } else { self.y.is_good() }
    }
}
