//! A motion of two axes, recorded once: the inputs of the parts.

use shared::axis::Reading;
use shared::compensate::CompensationSettings;
use shared::compensate::settings::{
    Cycle, Factor, ForceModel, FrictionWarmUp, Pitch, PitchSource, Points, Product, Reversal, Straightness,
    Stribeck, TableFriction, Talk, TimePoints,
};
use shared::config::{
    AxisSettings, Law, LowPass, Notch, Notches, Rates, ScaleLimits, Sensors, VelocitySource,
};
use shared::interpolate::{Block, Ramps, Smoothing};
use shared::machine::{Machine, Output};
use shared::scalar::Scalar;
use shared::units::Position;

/// Axes of the machine.
pub const AXES: usize = 2;

/// Ticks of the motion, 0.4 s: the blocks take 0.36 s of it.
pub const TICKS: usize = 8000;

/// Rates of most rows: every tick is a position tick.
pub const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };

/// Start of the motion.
pub const START: [Position; AXES] = [Position(0); AXES];

/// A line, an arc, a smaller arc in the other direction, a dwell and a line of two axes: ramps, full feed, and reversals of both
/// axes.
pub const PROGRAM: [Block<AXES>; 5] = [
    line([0.003, 0.0]),
    arc([-0.002, 0.0], 1.25),
    arc([-0.002, 0.004], -0.5),
    Block::dwell(0.005),
    line([-0.001, 0.002]),
];

/// Feed of each block, m/s.
pub const FEED_M_PER_S: f64 = 0.3;
/// Acceleration of each block, m/s².
pub const ACCELERATION_M_PER_S2: f64 = 20.0;
/// Ramps of each block.
pub const RAMPS: Ramps = Ramps::SCurve { jerk_m_per_s3: 4000.0 };

/// A line to a point.
#[must_use]
pub const fn line(to_m: [f64; AXES]) -> Block<AXES> {
    Block::line(to_m, FEED_M_PER_S, ACCELERATION_M_PER_S2).with_ramps(RAMPS)
}

/// An arc around a point.
#[must_use]
pub const fn arc(centre_m: [f64; 2], turns: f64) -> Block<AXES> {
    Block::arc([0, 1], centre_m, turns, FEED_M_PER_S, ACCELERATION_M_PER_S2).with_ramps(RAMPS)
}

/// An axis with every law of the controller switched on.
#[must_use]
pub fn full_axis() -> AxisSettings {
    AxisSettings {
        law: Law::Hpc,
        position_gain_per_s: 60.0,
        feedforward_percent: 80.0,
        feedforward_ahead_s: 1.25 / RATES.velocity_loop_hz,
        velocity_gain_n_s_per_m: 45_000.0,
        gain_schedule: None,
        velocity_integral_time_s: Some(0.013),
        velocity_lag_s: 0.5 / RATES.velocity_loop_hz,
        notches: Notches([
            Some(Notch { frequency_hz: 400.0, width_hz: 100.0, depth: 0.9 }),
            None,
            None,
            None,
        ]),
        low_pass: Some(LowPass { frequency_hz: 900.0, damping_ratio: 0.7 }),
        force_limit_n: 8000.0,
        sensors: Sensors::Dual {
            time_constant_s: 0.05,
            limits: ScaleLimits { disagreement_m: 0.001, ..ScaleLimits::DEFAULT },
        },
        smoothing: Smoothing::SCurve { time_s: 0.004, jerk_time_s: 0.002 },
        following_error_limit_m: 0.05,
        fastest_m_per_s: Some(1.0),
        saturation_time_s: 0.5,
        travel_m: Some([-0.1, 0.1]),
        stop_deceleration_m_per_s2: 2.0,
        ..AxisSettings::default()
    }
}

/// Both positions, and the speed times the other position.
fn products() -> [Product; 2] {
    let position = |axis| Factor::Position { axis, full_scale_m: 0.1 };
    let speed = Factor::Speed { axis: 0, full_scale_m_per_s: 0.5 };
    [[position(0), position(1)], [speed, position(1)]]
        .map(|factors| Product { amplitude_m: 1e-6, factors: factors.into_iter().collect() })
}

/// Every compensation but products, which have a row of their own.
#[must_use]
pub fn all_compensations(axis: usize) -> CompensationSettings {
    let other = u8::from(axis == 0);
    let points = |scale: f64| Points {
        start_m: -0.1,
        spacing_m: 0.01,
        values: (0..21).map(|k| scale * f64::from(k % 5)).collect(),
    };
    CompensationSettings {
        pitch: Some(Pitch { of: PitchSource::Screw, forward: points(1e-6), backward: Some(points(1.5e-6)) }),
        backlash_width_m: Some(3e-6),
        screw: cycles(2e-6, 5e-3).into_iter().collect(),
        dividing: cycles(1e-6, 2.5e-3).into_iter().collect(),
        reversal: Some(Reversal { force_n: 30.0, decay_s: 0.01, fade_m_per_s: 0.05 }),
        intalk: Some(Talk::Over(points(1e-7))),
        crosstalk: Some((other, Talk::Over(points(1e-7)))),
        squareness: Some((other, 2e-5)),
        straightness: Some((other, Straightness::Over(points(1e-6)))),
        ripple: cycles(5.0, 2.5e-3).into_iter().collect(),
        force: Some(force_model()),
        stretch_m_per_n: Some(5e-9),
        drift: Some(TimePoints { start_s: 0.0, spacing_s: 0.1, values: points(1e-6).values }),
        ..CompensationSettings::default()
    }
}

/// The nine compensations that there were when the aim of 1600 instructions was set, with one period each.
#[must_use]
pub fn nine_compensations(axis: usize) -> CompensationSettings {
    let all = all_compensations(axis);
    CompensationSettings {
        dividing: all.dividing.into_iter().take(1).collect(),
        ripple: all.ripple.into_iter().take(1).collect(),
        screw: Default::default(),
        force: None,
        stretch_m_per_n: None,
        drift: None,
        ..all
    }
}

/// Compensations of a single axis whose cost is a row of its own; the first one compensates nothing.
#[must_use]
pub fn single_compensations() -> [(&'static str, CompensationSettings); 7] {
    let all = || all_compensations(0);
    let none = CompensationSettings::default;
    let rigid = ForceModel {
        motor_stribeck: None,
        friction: TableFriction {
            coulomb_n: COULOMB_N,
            viscous_n_s_per_m: VISCOUS_N_S_PER_M,
            ..TableFriction::default()
        },
        load: None,
        ..force_model()
    };
    [
        ("compensation, empty", none()),
        ("  and screw, two periods", CompensationSettings { screw: all().screw, ..none() }),
        ("  and drift", CompensationSettings { drift: all().drift, ..none() }),
        ("  and two products", CompensationSettings { products: products().into_iter().collect(), ..none() }),
        ("  and force, sliding", CompensationSettings { force: Some(rigid), ..none() }),
        ("  and force, all parts", CompensationSettings { force: all().force, ..none() }),
        (
            "  and force and stretch",
            CompensationSettings { force: all().force, stretch_m_per_n: all().stretch_m_per_n, ..none() },
        ),
    ]
}

/// Two periods.
fn cycles(amplitude: f64, period_m: f64) -> [Cycle; 2] {
    [Cycle::harmonic(amplitude, period_m, 0.3), Cycle::harmonic(0.5 * amplitude, 1.7 * period_m, 0.1)]
}

/// The simulated axis as a model, with every part that the feed-forward has.
#[must_use]
pub fn force_model() -> ForceModel {
    let stribeck = Stribeck { excess_n: 60.0, velocity_m_per_s: 0.01 };
    let points = |scale: f64| Points {
        start_m: -0.1,
        spacing_m: 0.01,
        values: (0..21).map(|k| scale * f64::from(k % 5)).collect(),
    };
    ForceModel {
        motor_mass_kg: 0.5 * MASS_KG,
        table_mass_kg: 0.5 * MASS_KG,
        motor_coulomb_n: 40.0,
        motor_stribeck: Some(stribeck),
        friction: TableFriction {
            coulomb_n: COULOMB_N,
            viscous_n_s_per_m: VISCOUS_N_S_PER_M,
            half_difference_n_s_per_m: 50.0,
            presliding_stiffness_n_per_m: Some(60e6),
            stribeck: Some(stribeck),
            map: Some(points(5.0)),
            warm_up: Some(FrictionWarmUp { force_n: 30.0, time_constant_s: 10.0 }),
        },
        load: Some(points(10.0)),
        lag_s: 0.002,
        share: 0.9,
    }
}

/// A simulated axis: a mass on guides with friction, measured by encoders. Not counted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Axis {
    position_m: f64,
    velocity_m_per_s: f64,
}

const MASS_KG: f64 = 200.0;
const VISCOUS_N_S_PER_M: f64 = 1000.0;
const COULOMB_N: f64 = 300.0;
/// Speed v₀ at which half of the Coulomb friction F acts: F·v/(v₀ + |v|) is continuous at a reversal.
const COULOMB_SPEED_M_PER_S: f64 = 1e-3;
const STIFFNESS_N_PER_M: f64 = 150e6;
const ENCODER_M: f64 = 50e-9;

impl Axis {
    /// The readings after a tick under a force. The motor is ahead of the table by the wind-up of the screw.
    pub fn step(&mut self, force_n: f64) -> Reading {
        let speed = if self.velocity_m_per_s < 0.0 { -self.velocity_m_per_s } else { self.velocity_m_per_s };
        let coulomb = COULOMB_N * self.velocity_m_per_s / (COULOMB_SPEED_M_PER_S + speed);
        let tick = 1.0 / RATES.velocity_loop_hz;
        let accelerating = force_n - coulomb - VISCOUS_N_S_PER_M * self.velocity_m_per_s;
        self.velocity_m_per_s += accelerating / MASS_KG * tick;
        self.position_m += self.velocity_m_per_s * tick;
        let motor = quantised(self.position_m + force_n / STIFFNESS_N_PER_M);
        Reading { motor, table: Some(quantised(self.position_m)) }
    }
}

/// The reading of an encoder: whole steps.
fn quantised(m: f64) -> Position {
    let steps = m / ENCODER_M;
    #[expect(clippy::cast_possible_truncation, reason = "millimetres")]
    let steps = if steps < 0.0 { (steps - 0.5) as i64 } else { (steps + 0.5) as i64 };
    // One step is 52,428,800 position units exactly.
    Position(steps * 52_428_800)
}

/// A machine with the program queued and the enable requested. `None` if it rejects a setting or a block.
#[must_use]
pub fn machine<S: Scalar>(rates: Rates, program: &[Block<AXES>]) -> Option<Machine<S, AXES>> {
    compensated(rates, &full_axis(), all_compensations, program)
}

/// A machine as [`machine`], with what there was when the aim of 1600 instructions was set.
#[must_use]
pub fn nine_machine<S: Scalar>(rates: Rates, program: &[Block<AXES>]) -> Option<Machine<S, AXES>> {
    compensated(rates, &AxisSettings { feedforward_ahead_s: 0.0, ..full_axis() }, nine_compensations, program)
}

fn compensated<S: Scalar>(
    rates: Rates,
    axis: &AxisSettings,
    compensations: fn(usize) -> CompensationSettings,
    program: &[Block<AXES>],
) -> Option<Machine<S, AXES>> {
    let mut machine = Machine::new(rates, &[*axis; AXES], START).ok()?;
    for axis in 0..AXES {
        machine.compensate(axis, &compensations(axis)).ok()?;
    }
    ready(machine, program)
}

/// An axis as [`full_axis`], without filters.
fn plain_axis() -> AxisSettings {
    AxisSettings { notches: Notches::NONE, low_pass: None, smoothing: Smoothing::None, ..full_axis() }
}

/// An axis without filters, with an observer of its velocity.
#[must_use]
pub fn observed_axis() -> AxisSettings {
    AxisSettings { velocity_source: VelocitySource::Observer { bandwidth_hz: 300.0 }, ..plain_axis() }
}

/// A machine as [`machine`], with path, loops, dual feedback and monitoring only.
#[must_use]
pub fn plain_machine<S: Scalar>(program: &[Block<AXES>]) -> Option<Machine<S, AXES>> {
    ready(Machine::new(RATES, &[plain_axis(); AXES], START).ok()?, program)
}

/// A machine as [`plain_machine`], with an observer of each velocity.
#[must_use]
pub fn observed_machine<S: Scalar>(program: &[Block<AXES>]) -> Option<Machine<S, AXES>> {
    ready(Machine::new(RATES, &[observed_axis(); AXES], START).ok()?, program)
}

fn ready<S: Scalar>(mut machine: Machine<S, AXES>, program: &[Block<AXES>]) -> Option<Machine<S, AXES>> {
    for block in program {
        machine.push(block).ok()?;
    }
    machine.enable();
    Some(machine)
}

/// One tick of the recorded motion.
#[derive(Clone, Copy, Debug)]
pub struct Tick<S> {
    /// Sensor readings.
    pub readings: [Reading; AXES],
    /// Result of the tick.
    pub output: Output<S, AXES>,
}

/// Runs the program in closed loop. `None` if the machine rejects it or does not complete it.
#[must_use]
pub fn record<S: Scalar>(rates: Rates, ticks: &mut [Tick<S>; TICKS]) -> Option<()> {
    let mut machine = machine::<S>(rates, &PROGRAM)?;
    let mut axes = [Axis::default(); AXES];
    let mut forces = [S::default(); AXES];
    for tick in &mut *ticks {
        for ((axis, force), reading) in axes.iter_mut().zip(&forces).zip(&mut tick.readings) {
            *reading = axis.step(force.value());
        }
        tick.output = machine.tick(&tick.readings);
        forces = tick.output.forces;
    }
    let last = ticks.last()?.output;
    (last.enabled && last.done).then_some(())
}

impl<S: Scalar> Tick<S> {
    /// Not recorded yet.
    #[must_use]
    pub fn empty() -> Self {
        let output = Output {
            forces: [S::default(); AXES],
            commands: START,
            enabled: false,
            warning: None,
            done: false,
        };
        Self { readings: [Reading { motor: Position(0), table: None }; AXES], output }
    }

    /// Command − motor reading of the first axis, error units.
    #[must_use]
    pub fn error(&self) -> S {
        S::from_distance(self.output.commands[0] - self.readings[0].motor)
    }
}
