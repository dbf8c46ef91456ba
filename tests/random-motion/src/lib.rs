//! A random motion of the controller, through the protocol alone: the same for a session on the host, in any build, and for the
//! emulated core.
//!
//! Everything is drawn from a seed: settings, compensations, blocks, and in random ticks switches, changes of gains, faults, holds,
//! stops, disables, enables, scales that drop out, encoders that freeze or jump, and forces that push the axes to their force limit.
//! The axes are two masses that move by the forces of the answers: a single different bit grows.
#![allow(clippy::unwrap_used, clippy::missing_panics_doc, reason = "for tests, which fail by panicking")]

mod draws;
mod plant;
mod settings;

use shared::compensate::CompensationKind;
use shared::config::AxisSettings;
use shared::interpolate::Block;
use shared::lockstep::protocol::{
    AXES, Answer, FRAME, LONGEST_ORDER, Order, PART, Part, Setup, TickResult, decode, encode,
};
use shared::safety::{Fault, FaultKind, Power};
use shared::scalar::{Fixed, Format, Scalar};
use shared::units::Position;

use draws::Draws;
use plant::Plant;

/// The controller's end of the protocol: executes the order in a frame, and puts the answer there.
pub type Exchange<'a> = &'a mut dyn FnMut(&mut [u8; FRAME]);

/// Which motion.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Seed of everything random.
    pub seed: u64,
    /// Number format of the controller.
    pub format: Format,
    /// Number of ticks.
    pub ticks: usize,
    /// The velocity gain of both axes is multiplied by 1 + this; 0 except for a negative control.
    pub gain_error: f64,
}

/// What a motion has shown.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// A checksum of every answer up to and including each tick: forces, commands, states and refusals.
    pub digests: Vec<u64>,
    /// Ticks with the drives on.
    pub on: usize,
    /// Ticks with the drives on and a force at its limit.
    pub saturated: usize,
    /// Ticks with the drives on and without a reading of a scale.
    pub without_scale: usize,
    /// Faults that were injected while the drives were on, as numbers in [`faults`].
    pub injected: Vec<usize>,
    /// Faults that the controller has detected by itself, as their names.
    pub detected: Vec<String>,
    /// Orders by kind: switches of compensations, changes of gains, holds, resumes, stops, disables, enables, blocks accepted,
    /// overrides.
    pub orders: [usize; 9],
}

/// Every fault, on both axes.
#[must_use]
pub fn faults() -> Vec<Fault> {
    let on_axes = (0..2).flat_map(|axis| FaultKind::ALL.map(|kind| Fault::Axis { axis, kind }));
    on_axes.chain(Fault::OF_THE_MACHINE).collect()
}

/// A motion while it runs.
struct Run<'a> {
    end: Exchange<'a>,
    draws: Draws,
    outcome: Outcome,
    digest: u64,
    /// The present settings.
    axes: [AxisSettings; AXES],
    last_injected: Option<Fault>,
}

/// Runs a motion.
#[must_use]
pub fn run(motion: &Motion, end: Exchange<'_>) -> Outcome {
    let mut run = Run {
        end,
        draws: Draws::new(motion.seed),
        outcome: Outcome::default(),
        digest: 0xcbf2_9ce4_8422_2325,
        axes: [AxisSettings::default(); AXES],
        last_injected: None,
    };
    run.set_up(motion);
    let mut plant = Plant::new();
    let mut power = Power::Off;
    for tick in 0..motion.ticks {
        run.orders(tick, power, motion);
        plant.disturb(&mut run.draws);
        let Answer::Tick(result) = run.send(&Order::Tick(plant.readings())) else { panic!("no tick") };
        run.note(&result, power, &plant, motion.format);
        let forces_n = result.force_bits.map(|bits| force_n(bits, motion.format));
        plant.step(forces_n);
        power = result.power;
        run.outcome.digests.push(run.digest);
    }
    run.outcome
}

/// The force in an answer, N.
#[expect(clippy::cast_possible_truncation, reason = "the narrow formats fill the low bits")]
fn force_n(bits: u64, format: Format) -> f64 {
    match format {
        Format::Fixed => Scalar::value(Fixed::from_bits((bits as u32).cast_signed())),
        Format::F32 => Scalar::value(f32::from_bits(bits as u32)),
        Format::F64 => f64::from_bits(bits),
    }
}

impl Run<'_> {
    /// Sends an order, in parts if it is long. The answer enters the digest.
    fn send(&mut self, order: &Order) -> Answer {
        let mut frame = [0; FRAME];
        if encode(order, &mut frame).is_ok() {
            (self.end)(&mut frame);
        } else {
            let mut bytes = [0; LONGEST_ORDER];
            let bytes = postcard::to_slice(order, &mut bytes).unwrap();
            let count = bytes.len().div_ceil(PART);
            for (k, part) in bytes.chunks(PART).enumerate() {
                let bytes = heapless::Vec::from_slice(part).unwrap();
                encode(&Order::Part(Part { bytes, last: k + 1 == count }), &mut frame).unwrap();
                (self.end)(&mut frame);
            }
        }
        let mut answer = decode(&frame).unwrap();
        if let Answer::Tick(result) = &mut answer {
            // The only value that differs by intention.
            result.cost = 0;
            encode(&answer, &mut frame).unwrap();
        }
        // FNV-1a, 64 bits, in words.
        for word in frame.chunks_exact(8) {
            self.digest ^= u64::from_le_bytes(word.try_into().unwrap());
            self.digest = self.digest.wrapping_mul(0x0000_0100_0000_01b3);
        }
        answer
    }

    fn set_up(&mut self, motion: &Motion) {
        let rates = settings::rates(&mut self.draws);
        let axes = [0, 1].map(|_| settings::axis(&mut self.draws, motion.gain_error));
        self.axes = axes;
        let start = [Position(0); AXES];
        let set_up = self.send(&Order::Setup(Setup { format: motion.format, rates, axes, start }));
        assert_eq!(set_up, Answer::Ready, "{axes:?}");
        for number in [0, 1] {
            let compensation = settings::compensation(&mut self.draws, 1 - number);
            assert_eq!(self.send(&Order::Compensate(number, compensation)), Answer::Ready);
        }
        for _ in 0..4 {
            self.block();
        }
    }

    fn block(&mut self) {
        let block: Block<AXES> = settings::block(&mut self.draws);
        // Refused where it leads out of the travel, the queue is full or the path stops: by host and core alike.
        if self.send(&Order::Block(block)) == Answer::Ready {
            self.outcome.orders[7] += 1;
        }
    }

    /// The orders before a tick.
    fn orders(&mut self, tick: usize, power: Power, motion: &Motion) {
        if tick == 0 || !power.is_on() && self.draws.one_in(40) {
            // A fault has to be acknowledged before.
            if tick > 0 && self.draws.one_in(2) {
                self.count(5, &Order::Disable);
            }
            self.count(6, &Order::Enable);
        }
        if self.draws.one_in(60) {
            self.block();
        }
        if self.draws.one_in(25) {
            let kind = CompensationKind::ALL[self.draws.below(CompensationKind::ALL.len())];
            let (axis, on) = (self.draws.axis(), self.draws.one_in(2));
            self.count(0, &Order::Switch(axis, kind, on));
        }
        if self.draws.one_in(200) {
            let axis = self.draws.axis();
            let present = self.axes[usize::from(axis)];
            // Another filter behind the path is refused, another sensor with the drives on.
            let (smoothing, sensors) = (present.smoothing, present.sensors);
            let changed = settings::axis(&mut self.draws, motion.gain_error);
            let settings =
                if self.draws.one_in(8) { changed } else { AxisSettings { smoothing, sensors, ..changed } };
            if self.send(&Order::Change(axis, settings)) == Answer::Ready {
                self.outcome.orders[1] += 1;
                self.axes[usize::from(axis)] = settings;
            }
        }
        for (number, one_in) in [(2, 150), (3, 80), (4, 400), (5, 500), (8, 120)] {
            if self.draws.one_in(one_in) {
                let order = match number {
                    2 => Order::Hold,
                    3 => Order::Resume,
                    4 => Order::Stop,
                    8 => Order::Override(u8::try_from(self.draws.below(201)).unwrap_or(100)),
                    _ => Order::Disable,
                };
                self.count(number, &order);
            }
        }
        if self.draws.one_in(300) {
            let faults = faults();
            let number = self.draws.below(faults.len());
            if power.is_on() {
                self.outcome.injected.push(number);
            }
            self.last_injected = Some(faults[number]);
            assert_eq!(self.send(&Order::Fault(faults[number])), Answer::Ready);
        }
    }

    fn count(&mut self, number: usize, order: &Order) {
        assert_eq!(self.send(order), Answer::Ready, "{order:?}");
        self.outcome.orders[number] += 1;
    }

    /// What a tick has shown.
    fn note(&mut self, result: &TickResult, before: Power, plant: &Plant, format: Format) {
        if result.power.is_on() {
            self.outcome.on += 1;
            let limits = result.force_bits.iter().zip(self.axes.map(|axis| axis.force_limit_n));
            let at_limit = |(bits, limit): (&u64, f64)| force_n(*bits, format).abs() > 0.999 * limit;
            self.outcome.saturated += usize::from(limits.into_iter().any(at_limit));
            self.outcome.without_scale += usize::from(plant.is_without_scale());
        }
        if let (Power::On, Power::Stopping(fault) | Power::Faulted(fault)) = (before, result.power)
            && self.last_injected.take() != Some(fault)
        {
            let name = match fault {
                Fault::Axis { kind, .. } => format!("{kind:?}"),
                fault => format!("{fault:?}"),
            };
            if !self.outcome.detected.contains(&name) {
                self.outcome.detected.push(name);
            }
        }
    }
}
