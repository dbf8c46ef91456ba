//! The parts of a tick in the order of the signal, one statement each.

use core::array::from_fn;
use core::hint::black_box;

use shared::axis::AxisState;
use shared::capture::{CaptureMemory, ChannelSteps, Quantisers, Trigger};
use shared::compensate::{AxisCompensation, AxisOf, Compensation, CompensationSettings, Correction};
use shared::config::{AxisConfig, AxisSettings, Law};
use shared::control::{feedforward, filter, position, velocity};
use shared::feedback::dual;
use shared::feedback::phase::Phase;
use shared::interpolate::sincos::sin_cos;
use shared::interpolate::{Block, Path, Smoothing};
use shared::machine::{Machine, Output};
use shared::scalar::{Fixed, Scalar};

use super::count::Counter;
use super::motion::{self, AXES, PROGRAM, RATES, START, TICKS, Tick, arc, full_axis, line};
use crate::setup;

/// The parts in integer arithmetic, independent of the number format: path and phase. `None` if a block is rejected.
#[inline(never)]
pub fn of_the_path(counter: &mut Counter) -> Option<()> {
    // An odd stride covers the whole turn and every offset from the tabulated angles.
    let phases: [u64; 1000] = from_fn(|k| (k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    counter.part("sine and cosine", "all", &phases, |&phase| sin_cos(phase));

    let there_and_back: [_; 16] = from_fn(|k| line([if k % 2 == 0 { 2e-6 } else { 0.0 }, 0.0]));
    let none = Smoothing::None;
    path(counter, "path, a line", &[line([0.02, 0.01])], (none, 100))?;
    path(counter, "path, an arc", &[arc([-0.01, 0.0], 0.3)], (none, 100))?;
    path(counter, "path, an arc at 150 %", &[arc([-0.01, 0.0], 0.3)], (none, 150))?;
    path(
        counter,
        "path, an arc, S-curve behind it",
        &[arc([-0.01, 0.0], 0.3)],
        (full_axis().smoothing, 100),
    )?;
    path(counter, "path, blocks of 12 ticks", &there_and_back, (none, 100))?;
    let samples: [(i32, i32); 1000] = from_fn(|k| {
        let (sine, cosine) = sin_cos((k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        ((sine >> 46) as i32, (cosine >> 46) as i32)
    });
    counter.part("phase of a resolver", "all", &samples, |&(sine, cosine)| {
        Phase::from_samples(sine, cosine, 1000)
    });
    Some(())
}

/// Every compensation, on both axes.
fn compensation<S: Scalar>() -> Option<Compensation<S, AXES>> {
    let mut all = Compensation::none(START);
    for axis in 0..AXES {
        all.replace(
            axis,
            &AxisCompensation::new(&motion::all_compensations(axis), RATES, AxisOf { axis, axes: AXES })
                .ok()?,
        );
    }
    Some(all)
}

/// One compensation on the first axis.
fn alone<S: Scalar>(settings: &CompensationSettings) -> Option<Compensation<S, AXES>> {
    let mut all = Compensation::none(START);
    all.replace(0, &AxisCompensation::new(settings, RATES, AxisOf { axis: 0, axes: AXES }).ok()?);
    Some(all)
}

/// Counts every tick of a path of these blocks at a feed override, with a filter behind it.
fn path(
    counter: &mut Counter,
    name: &str,
    blocks: &[Block<AXES>],
    (smoothing, percent): (Smoothing, u8),
) -> Option<()> {
    let mut path = Path::new(START, RATES.position_loop_hz());
    path.smooth(&[smoothing; AXES]).ok()?;
    path.set_override(percent, 1);
    for block in blocks {
        path.push(block).ok()?;
    }
    let (mut trial, mut ticks) = (path.clone(), 0);
    while !trial.is_done() && ticks < TICKS {
        trial.advance();
        ticks += 1;
    }
    let path = black_box(&mut path);
    counter.part(name, "all", [(); TICKS].get(..ticks)?, |()| path.advance());
    Some(())
}

/// The laws and the whole tick in the format `S`. `None` if the settings or the motion are rejected.
#[inline(never)]
pub fn of_the_tick<S: Scalar>(counter: &mut Counter) -> Option<()> {
    let mut ticks: [Tick<S>; TICKS] = from_fn(|_| Tick::empty());
    motion::record(RATES, &mut ticks)?;
    let (first, others) = ticks.split_first()?;
    let config = |law| AxisConfig::<S>::new(&AxisSettings { law, ..full_axis() }, RATES).ok();
    let (p, all) = &black_box((config(Law::P)?, config(Law::Hpc)?));

    // The signals between the parts of the first axis.
    let errors: [S; TICKS] = from_fn(|k| ticks.get(k).map_or(S::default(), Tick::error));
    let mut filter = position::State::default();
    let speeds = errors.map(|error| all.position.velocity(&mut filter, error));
    let motors = from_fn::<_, TICKS, _>(|k| (speeds[k], ticks[k].readings[0].motor));

    let (command, reading) = (first.output.commands[0], first.readings[0]);
    let mut part = Parts { counter, format: S::NAME };
    part.of("dual feedback", others, dual::State::settled(reading.motor, reading.table), |state, tick| {
        all.feedback.position(state, tick.readings[0].motor, tick.readings[0].table)
    });
    part.of("feed-forward", others, feedforward::State::at(command), |state, tick| {
        all.feedforward.lead(state, tick.output.commands[0])
    });
    part.of("P", &errors, position::State::default(), |state, &error| p.position.velocity(state, error));
    part.of("HPC", &errors, position::State::default(), |state, &error| all.position.velocity(state, error));
    part.of("PI", &motors, velocity::State::at(reading.motor), |state, &(speed, motor)| {
        let pi = all.velocity.pi_by_difference(state, speed, motor);
        all.velocity.limit(state, &pi, pi.force).0
    });
    let observed = AxisConfig::<S>::new(&motion::observed_axis(), RATES).ok()?;
    part.of("PI with an observer", &motors, velocity::State::at(reading.motor), |state, &(speed, motor)| {
        let pi = observed.velocity.pi_output(state, speed, motor);
        observed.velocity.limit(state, &pi, pi.force).0
    });
    part.of("position loop of an axis", others, AxisState::at_rest(command, reading), |state, tick| {
        state.position_tick(all, tick.output.commands[0], Correction::NONE, tick.readings[0])
    });
    part.of(
        "tick, drives coming on",
        &ticks[..1],
        motion::machine::<S>(RATES, &PROGRAM)?,
        |machine, tick| machine.tick(&tick.readings),
    );
    let compensation = compensation::<S>()?;
    part.of("compensation of two axes", others, compensation, |all, tick| {
        let readings = all.readings(&tick.readings);
        (all.commands(&tick.output.commands), all.forces(&readings))
    });
    for (name, settings) in motion::single_compensations() {
        let alone = alone::<S>(&settings)?;
        part.of(name, others, alone, |all, tick| {
            let readings = all.readings(&tick.readings);
            (all.commands(&tick.output.commands), all.forces(&readings))
        });
    }
    let (notch, low_pass) = (all.notches[0].as_ref()?, all.low_pass.as_ref()?);
    part.of("notch", &errors, filter::State::default(), |state, &x| notch.step(state, x));
    part.of("low-pass", &errors, filter::State::default(), |state, &x| low_pass.step(state, x));
    recording(&mut part, others);
    whole_ticks(&mut part, first, others)
}

/// Whole ticks of two axes.
fn whole_ticks<S: Scalar>(part: &mut Parts<'_>, first: &Tick<S>, others: &[Tick<S>]) -> Option<()> {
    let mut plain = motion::plain_machine::<S>(&PROGRAM)?;
    plain.tick(&first.readings);
    part.of("tick of two axes, path and loops", others, plain, |machine, tick| machine.tick(&tick.readings));
    let mut observed = motion::observed_machine::<S>(&PROGRAM)?;
    observed.tick(&first.readings);
    part.of("tick of two axes, with observers", others, observed, |machine, tick| {
        machine.tick(&tick.readings)
    });
    let mut nine = motion::nine_machine::<S>(RATES, &PROGRAM)?;
    nine.tick(&first.readings);
    part.of("tick, nine compensations", others, nine, |machine, tick| machine.tick(&tick.readings));
    let mut moving = motion::machine::<S>(RATES, &PROGRAM)?;
    moving.tick(&first.readings);
    part.of("tick of two axes, all on", others, moving, |machine, tick| machine.tick(&tick.readings));
    Some(())
}

/// The tick with the rates of the board, in fixed point: of all ticks, and of those with position loops.
#[inline(never)]
pub fn of_the_tick_of_the_board(counter: &mut Counter) -> Option<()> {
    let mut ticks: [Tick<Fixed>; TICKS] = from_fn(|_| Tick::empty());
    motion::record(setup::RATES, &mut ticks)?;
    let (first, others) = ticks.split_first()?;
    let format = Fixed::NAME;
    let stride = setup::RATES.position_loop_divider as usize;
    let started = |mut machine: Machine<Fixed, AXES>| {
        machine.tick(&first.readings);
        machine
    };
    let nine = started(motion::nine_machine(setup::RATES, &PROGRAM)?);
    let all = started(motion::machine(setup::RATES, &PROGRAM)?);
    for (names, machine) in [
        (["board, nine compensations", "board, nine, position tick"], nine),
        (["board, all on", "board, all, position tick"], all),
    ] {
        let [every, position] = names;
        counter.part(every, format, others, ticked(&mut black_box(machine.clone())));
        counter.last_of_each((position, format), (others, stride), ticked(&mut black_box(machine)));
    }
    Some(())
}

/// The tick of a machine on the board.
fn ticked(machine: &mut Machine<Fixed, AXES>) -> impl FnMut(&Tick<Fixed>) -> Output<Fixed, AXES> {
    move |tick| {
        let output = machine.tick(&tick.readings);
        machine.prepare();
        output
    }
}

/// Recording of all channels: counts of 0.25 µm and 50 nm, and a memory for all ticks.
fn recording<S: Scalar>(part: &mut Parts<'_>, ticks: &[Tick<S>]) {
    let steps = ChannelSteps::of_counts([0.25e-6; AXES], [50e-9; AXES], 5);
    let mut bytes = [0; 32 * TICKS];
    let mut memory = CaptureMemory::new(&mut bytes);
    memory.arm(Trigger::Now, u32::MAX, RATES.position_loop_divider);
    memory.takes(0, true, true);
    part.of(
        "recording of two axes",
        ticks,
        (Quantisers::new(&steps), memory),
        |(quantisers, memory), tick| {
            memory.append(&quantisers.sample(&tick.output.commands, &tick.readings, &tick.output.forces));
        },
    );
}

/// The parts in one number format.
struct Parts<'a> {
    counter: &'a mut Counter,
    format: &'static str,
}

impl Parts<'_> {
    /// Counts a part with its state.
    fn of<T, St, R>(
        &mut self,
        name: &str,
        inputs: &[T],
        mut state: St,
        mut part: impl FnMut(&mut St, &T) -> R,
    ) {
        let state = black_box(&mut state);
        self.counter.part(name, self.format, inputs, |input| part(state, input));
    }
}
