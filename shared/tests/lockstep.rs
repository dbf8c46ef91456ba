//! The board side of the protocol: each order calls the machine, and the answer contains the output of the machine.

use shared::compensate::settings::{Pitch, PitchSource, Points};
use shared::compensate::{CompensationKind, CompensationSettings};
use shared::config::{AxisSettings, Rates};
use shared::interpolate::Block;
use shared::lockstep::protocol::{
    AXES, Answer, FRAME, LONGEST_ORDER, Order, PART, Part, Setup, TickResult, encode,
};
use shared::lockstep::session::{Meter, NoMeter, Session};
use shared::machine::{Machine, Reading};
use shared::safety::{Fault, FaultKind, Power};
use shared::scalar::{Fixed, Format, Scalar};
use shared::units::Position;

const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };
const FORMATS: [Format; 3] = [Format::Fixed, Format::F32, Format::F64];

/// A session and the host that sends orders to it.
struct Host {
    session: Session,
}

impl Host {
    fn new(format: Format) -> Self {
        let mut host = Self { session: Session::default() };
        let axes = [AxisSettings::default(); AXES];
        let start = [Position(0); AXES];
        assert_eq!(host.answer_to(&Order::Setup(Setup { format, rates: RATES, axes, start })), Answer::Ready);
        host
    }

    fn answer_to(&mut self, order: &Order) -> Answer {
        let mut frame = [0; FRAME];
        if encode(order, &mut frame).is_ok() {
            return self.session.answer(&frame, &mut NoMeter).unwrap();
        }
        let mut bytes = [0; LONGEST_ORDER];
        let bytes = postcard::to_slice(order, &mut bytes).unwrap();
        let count = bytes.len().div_ceil(PART);
        let mut answers = bytes.chunks(PART).enumerate().map(|(k, piece)| {
            let part = Part { bytes: heapless::Vec::from_slice(piece).unwrap(), last: k + 1 == count };
            encode(&Order::Part(part), &mut frame).unwrap();
            self.session.answer(&frame, &mut NoMeter).unwrap()
        });
        assert!(answers.by_ref().take(count - 1).all(|answer| answer == Answer::Ready));
        answers.next().unwrap()
    }

    /// A tick with both motor readings at `at_m`.
    fn tick(&mut self, at_m: f64) -> TickResult {
        let motor = Position::from_m(at_m).unwrap();
        match self.answer_to(&Order::Tick([Reading { motor, table: None }; AXES])) {
            Answer::Tick(result) => result,
            other => panic!("{other:?}"),
        }
    }
}

const NO_FORCE: [u64; AXES] = [0; AXES];

#[test]
fn disable_puts_the_drives_off() {
    for format in FORMATS {
        let mut host = Host::new(format);
        assert_eq!(host.answer_to(&Order::Enable), Answer::Ready);
        host.tick(0.0);
        let result = host.tick(1e-4);
        assert_eq!(result.power, Power::On);
        assert!(result.force_bits.iter().all(|bits| *bits != 0), "{format:?}: {result:?}");
        assert_eq!(host.answer_to(&Order::Disable), Answer::Ready);
        for _ in 0..10 {
            let result = host.tick(1e-4);
            assert_eq!((result.power, result.force_bits), (Power::Off, NO_FORCE), "{format:?}");
        }
        assert_eq!(host.answer_to(&Order::Enable), Answer::Ready);
        assert_eq!(host.tick(1e-4).power, Power::On);
    }
}

#[test]
fn disable_acknowledges_a_fault() {
    for format in FORMATS {
        let mut host = Host::new(format);
        host.answer_to(&Order::Enable);
        host.tick(0.0);
        // 60 mm exceed the limit of 50 mm; it is checked in position ticks only.
        let fault = Power::Faulted(Fault::Axis { axis: 0, kind: FaultKind::FollowingError });
        assert!((0..RATES.position_loop_divider).any(|_| host.tick(0.06).power == fault));
        host.answer_to(&Order::Enable);
        assert_eq!(host.tick(0.06).power, fault);
        host.answer_to(&Order::Disable);
        assert_eq!(host.tick(0.06).power, Power::Off);
        host.answer_to(&Order::Enable);
        assert_eq!(host.tick(0.06).power, Power::On);
    }
}

/// Orders through a session and directly to a machine, which computes ahead as a board does: forces, commands and state of each tick are identical, bit
/// for bit.
fn matches_the_machine<S: Scalar>(format: Format) {
    let mut host = Host::new(format);
    let axes = [AxisSettings::default(); AXES];
    let mut machine = Machine::<S, AXES>::new(RATES, &axes, [Position(0); AXES]).unwrap();
    let stiffer = AxisSettings { position_gain_per_s: 50.0, ..AxisSettings::default() };
    let pitch = Points { start_m: -0.1, spacing_m: 0.1, values: [1e-4; 3].into_iter().collect() };
    let compensation = CompensationSettings {
        pitch: Some(Pitch { of: PitchSource::Screw, forward: pitch, backward: None }),
        ..CompensationSettings::default()
    };
    let block = Block::line([0.1, 0.05], 0.1, 1.0);
    let mut at = [Position(0); AXES];
    let mut differ = 0;
    for tick in 0..4000 {
        let order = match tick {
            0 => Some(Order::Block(block)),
            1 => Some(Order::Enable),
            500 => Some(Order::Change(1, stiffer)),
            1000 => Some(Order::Compensate(0, compensation.clone())),
            1500 => Some(Order::Hold),
            2500 => Some(Order::Switch(0, CompensationKind::Pitch, false)),
            2700 => Some(Order::Resume),
            3500 => Some(Order::Stop),
            _ => None,
        };
        if let Some(order) = order {
            assert_eq!(host.answer_to(&order), Answer::Ready);
            match order {
                Order::Block(block) => machine.push(&block).unwrap(),
                Order::Enable => machine.enable(),
                Order::Hold => machine.hold(),
                Order::Resume => machine.resume(),
                Order::Stop => machine.discard_path(),
                Order::Change(axis, settings) => machine.change(axis.into(), &settings).unwrap(),
                Order::Compensate(axis, settings) => machine.compensate(axis.into(), &settings).unwrap(),
                Order::Switch(axis, item, on) => machine.switch(axis.into(), item, on).unwrap(),
                other => panic!("{other:?}"),
            }
        }
        let readings = at.map(|motor| Reading { motor, table: None });
        let Answer::Tick(result) = host.answer_to(&Order::Tick(readings)) else { panic!() };
        let output = machine.tick(&readings);
        machine.prepare();
        assert_eq!(result.force_bits, output.forces.map(Scalar::bits), "{format:?}, tick {tick}");
        assert_eq!((result.commands, result.done), (output.commands, output.done));
        assert_eq!((result.power, result.warning), (machine.power(), output.warning));
        // The motors follow their commands, a tick later.
        at = output.commands;
        differ += u32::from(output.forces[0] != output.forces[1]);
    }
    // The axes were in motion with different forces, so the comparison was not one of zeros.
    assert!(at[0] > at[1] && at[1] > Position(0) && differ > 3000, "{at:?}, {differ}");
}

#[test]
fn every_order_has_the_same_effect_as_a_call_of_the_machine() {
    matches_the_machine::<Fixed>(Format::Fixed);
    matches_the_machine::<f32>(Format::F32);
    matches_the_machine::<f64>(Format::F64);
}

/// A meter that counts its starts and stops, and returns 1000 times the number of stops.
#[derive(Default)]
struct Counter {
    started: u32,
    stopped: u32,
}

impl Meter for Counter {
    fn start(&mut self) {
        assert_eq!(self.started, self.stopped);
        self.started += 1;
    }

    fn stop(&mut self) -> u32 {
        self.stopped += 1;
        assert_eq!(self.started, self.stopped);
        1000 * self.stopped
    }
}

/// The meter runs during ticks only, and the answer of a tick contains its result.
#[test]
fn the_cost_of_a_tick_is_that_of_the_meter() {
    for format in FORMATS {
        let mut host = Host::new(format);
        assert_eq!(host.tick(0.0).cost, 0);
        let mut meter = Counter::default();
        let mut frame = [0; FRAME];
        for ticks in 1..=3 {
            for order in [Order::Disable, Order::Enable] {
                encode(&order, &mut frame).unwrap();
                assert_eq!(host.session.answer(&frame, &mut meter), Some(Answer::Ready));
            }
            let reading = Reading { motor: Position(0), table: None };
            encode(&Order::Tick([reading; AXES]), &mut frame).unwrap();
            let Some(Answer::Tick(result)) = host.session.answer(&frame, &mut meter) else { panic!() };
            assert_eq!((result.cost, meter.started, meter.stopped), (1000 * ticks, ticks, ticks));
        }
    }
}
