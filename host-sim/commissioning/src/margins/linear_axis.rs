//! An axis from tick to tick: the equations of the controller without rounding and limits, and linear mechanics.
//!
//! In a tick the sensors are read first. In every n-th tick the position loop computes the velocity command, which is held for n
//! ticks; in every tick the velocity loop computes the force, which is held for one tick. The equations are those of
//! `shared`: `control/velocity.rs`, `control/observer.rs`, `control/filter.rs`, `control/hpc.rs`, `feedback/dual.rs`.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use shared::config::{AxisSettings, Law, Rates, Sensors, VelocitySource};
use shared::control::observer;

use super::mechanics::{Condition, Mechanics};
use super::sampled::Sampled;
use plant::instruments::Instruments;
use plant::parameters::AxisParameters;

/// Constants of one axis in one condition.
#[derive(Clone, Debug)]
pub struct LinearAxis {
    mechanics: Mechanics,
    a: DMatrix<f64>,
    b: DVector<f64>,
    tick_s: f64,
    /// Ticks of the velocity loop per tick of the position loop.
    divider: u32,
    velocity: VelocityLoop,
    /// Filters of the force in the order in which they act: notches, low-pass.
    filters: Vec<Filter>,
    motor_latency: Latency,
    table_latency: Latency,
    feedback: Sensors,
    position_gain_per_s: f64,
    law: Law,
}

/// Constants of the velocity loop.
#[derive(Clone, Copy, Debug)]
struct VelocityLoop {
    /// Kv, N·s/m.
    gain: f64,
    /// Kv·T/Ti, N·s/m.
    integral: f64,
    /// Factors of the present and of the last increment of the reading, 1/s.
    rates: [f64; 2],
    /// 1 − r of an observer; `None`: the velocity is the difference.
    observer: Option<f64>,
}

/// Constants of a filter of the force, as in `shared/src/control/filter.rs`.
#[derive(Clone, Copy, Debug)]
struct Filter {
    a1: f64,
    a2: f64,
    a3: f64,
    /// d·k of a notch; `None`: low-pass.
    notch: Option<f64>,
}

impl Filter {
    fn new(frequency_hz: f64, tick_s: f64, k: f64, notch: Option<f64>) -> Self {
        let g = libm::tan(PI * frequency_hz * tick_s);
        let a1 = 1.0 / (1.0 + g * (g + k));
        Self { a1, a2: g * a1, a3: g * g * a1, notch }
    }

    /// Output and next state.
    fn step(&self, [p, q]: [f64; 2], input: f64) -> (f64, [f64; 2]) {
        let u = input - q;
        let v = self.a1 * p + self.a2 * u;
        let w = q + self.a2 * p + self.a3 * u;
        (self.notch.map_or(w, |dk| input - dk * v), [2.0 * v - p, 2.0 * w - q])
    }
}

/// Latency of a reading: the cubic polynomial between two past ticks, as in the crate `plant`.
#[derive(Clone, Copy, Debug)]
struct Latency {
    /// Past ticks in the state.
    past: usize,
    fraction: f64,
}

impl Latency {
    fn new(latency_s: f64, tick_s: f64) -> Self {
        let ticks = (latency_s / tick_s).max(0.0);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "not negative, and saturates"
        )]
        let whole = ticks.floor() as usize;
        Self { past: if ticks > 0.0 { whole + 1 } else { 0 }, fraction: ticks.fract() }
    }

    fn states(self) -> usize {
        2 * self.past
    }

    /// The reading, and the next state, from the present position and velocity.
    fn step(self, past: &[f64], now: (f64, f64), tick_s: f64) -> (f64, Vec<f64>) {
        let mut all = vec![now.0, now.1];
        all.extend_from_slice(past);
        let last = all.len() - 2;
        let reading = if self.past == 0 {
            now.0
        } else {
            let (newer, newer_velocity) = (all[last - 2], all[last - 1]);
            let (older, older_velocity) = (all[last], all[last + 1]);
            let (t, h) = (self.fraction, tick_s);
            newer + (older - newer) * t * t * (3.0 - 2.0 * t) - h * newer_velocity * t * (1.0 - t) * (1.0 - t)
                + h * older_velocity * t * t * (1.0 - t)
        };
        all.truncate(self.states());
        (reading, all)
    }
}

/// The state of the velocity loop and the mechanics, in this order in a vector.
#[derive(Clone, Debug)]
struct State {
    mechanics: Vec<f64>,
    motor_past: Vec<f64>,
    table_past: Vec<f64>,
    last_reading: f64,
    last_increment: f64,
    integral: f64,
    /// Both stages of an observer, if there is one.
    observer: Vec<f64>,
    filters: Vec<[f64; 2]>,
}

/// 1 − r of an observer.
fn observer(source: VelocitySource, tick_s: f64) -> Option<f64> {
    match source {
        VelocitySource::Difference => None,
        VelocitySource::Observer { bandwidth_hz } => Some(observer::gain(bandwidth_hz * tick_s)),
    }
}

impl LinearAxis {
    /// The loops of an axis with these settings and parameters.
    #[must_use]
    pub fn new(
        settings: &AxisSettings,
        rates: Rates,
        axis: &AxisParameters,
        instruments: &Instruments,
        condition: Condition,
    ) -> Self {
        let tick_s = rates.velocity_loop_hz.recip();
        let lag_s = axis.servo.drive_time_constant_s(instruments.drive_time_constant_s);
        // A force that acts late closes the loop as late readings of both sensors do.
        let late_s = axis.servo.force_late_s(tick_s);
        let mechanics = Mechanics::new(axis, lag_s, condition);
        let (a, b) = mechanics.after(tick_s);
        let gain = settings.velocity_gain_n_s_per_m;
        let lag = settings.velocity_lag_s / tick_s;
        let notches = settings.notches.iter().map(|notch| {
            let k = notch.width_hz / notch.frequency_hz;
            Filter::new(notch.frequency_hz, tick_s, k, Some(notch.depth * k))
        });
        let low_pass =
            settings.low_pass.map(|l| Filter::new(l.frequency_hz, tick_s, 2.0 * l.damping_ratio, None));
        Self {
            mechanics,
            a,
            b,
            tick_s,
            divider: rates.position_loop_divider,
            velocity: VelocityLoop {
                gain,
                integral: settings.velocity_integral_time_s.map_or(0.0, |time_s| gain * tick_s / time_s),
                rates: [(1.0 - lag) / tick_s, lag / tick_s],
                observer: observer(settings.velocity_source, tick_s),
            },
            filters: notches.chain(low_pass).collect(),
            motor_latency: Latency::new(instruments.motor_latency_s + late_s, tick_s),
            table_latency: Latency::new(instruments.table_latency_s + late_s, tick_s),
            feedback: settings.sensors,
            position_gain_per_s: settings.position_gain_per_s,
            law: settings.law,
        }
    }

    /// Period of the velocity loop, s.
    #[must_use]
    pub fn tick_s(&self) -> f64 {
        self.tick_s
    }

    /// Period of the position loop, s.
    #[must_use]
    pub fn position_tick_s(&self) -> f64 {
        self.tick_s * f64::from(self.divider)
    }

    /// The velocity loop, cut at the force, with the position loop open.
    #[must_use]
    pub fn velocity_loop(&self) -> Sampled {
        Sampled::of(self.states(), |state, force_n| {
            let state = self.state(state);
            let (next, wanted_n) = self.tick(&state, 0.0, Some(force_n));
            (next.to_vec(), -wanted_n)
        })
    }

    /// The position loop, cut at the velocity command, with the velocity loop closed.
    #[must_use]
    pub fn position_loop(&self) -> Sampled {
        // After the state of the velocity loop: shift of dual feedback; output of the HPC filter and its derivative.
        let n = self.states();
        Sampled::of(n + 3, |vector, velocity| {
            let mut state = self.state(&vector[..n]);
            let (motor, table) = self.readings(&state);
            let (feedback, shift) = self.feedback(motor, table, vector[n]);
            let (filtered, law) = self.law(-feedback, [vector[n + 1], vector[n + 2]]);
            for _ in 0..self.divider {
                state = self.tick(&state, velocity, None).0;
            }
            let mut next = state.to_vec();
            next.push(shift);
            next.extend(law);
            (next, -self.position_gain_per_s * filtered)
        })
    }

    /// Feedback position and next shift (m) by `shared/src/feedback/dual.rs`.
    fn feedback(&self, motor: f64, table: f64, shift: f64) -> (f64, f64) {
        match self.feedback {
            Sensors::Motor { .. } => (motor, 0.0),
            Sensors::Table(_) => (table, 0.0),
            Sensors::Dual { time_constant_s, .. } => {
                let fraction = -libm::expm1(-self.position_tick_s() / time_constant_s);
                let shift = shift + fraction * (table - motor - shift);
                (motor + shift, shift)
            }
        }
    }

    /// The error before Kp, and the next state of the HPC filter, by `shared/src/control/hpc.rs`.
    fn law(&self, error: f64, [y, w]: [f64; 2]) -> (f64, [f64; 2]) {
        if matches!(self.law, Law::P) {
            return (error, [0.0; 2]);
        }
        let x = self.position_gain_per_s * self.position_tick_s();
        let (root7, decay) = (7f64.sqrt(), libm::exp(-3.0 * x));
        let (c, s) = (libm::cos(root7 * x), libm::sin(root7 * x) / root7);
        let off = y - error;
        let next = [
            y + (decay * (c + 3.0 * s) - 1.0) * off + decay * s * w,
            w - 16.0 * decay * s * off + (decay * (c - 3.0 * s) - 1.0) * w,
        ];
        (next[0], next)
    }

    fn readings(&self, state: &State) -> (f64, f64) {
        let motor = Mechanics::motor(&state.mechanics);
        let table = self.mechanics.table(&state.mechanics);
        let (motor, _) = self.motor_latency.step(&state.motor_past, motor, self.tick_s);
        let (table, _) = self.table_latency.step(&state.table_past, table, self.tick_s);
        (motor, table)
    }

    /// One tick with a velocity command: next state, and the force that the velocity loop commands. `force_n` acts instead of it,
    /// if given.
    fn tick(&self, state: &State, command: f64, force_n: Option<f64>) -> (State, f64) {
        let mut next = state.clone();
        let (motor, motor_past) =
            self.motor_latency.step(&state.motor_past, Mechanics::motor(&state.mechanics), self.tick_s);
        let table = self.mechanics.table(&state.mechanics);
        (next.motor_past, next.table_past) =
            (motor_past, self.table_latency.step(&state.table_past, table, self.tick_s).1);
        let increment = motor - state.last_reading;
        let [rate, last_rate] = self.velocity.rates;
        let mut velocity = rate * increment + last_rate * state.last_increment;
        if let Some(gain) = self.velocity.observer {
            for stage in &mut next.observer {
                *stage += gain * (velocity - *stage);
                velocity = *stage;
            }
        }
        let error = command - velocity;
        (next.last_reading, next.last_increment) = (motor, increment);
        // The integral has the unit of a velocity, so that all states are of similar magnitude.
        let has_integral = self.velocity.integral > 0.0;
        next.integral = if has_integral {
            state.integral + self.velocity.integral / self.velocity.gain * error
        } else {
            0.0
        };
        let mut wanted = error + next.integral;
        for (filter, state) in self.filters.iter().zip(&mut next.filters) {
            (wanted, *state) = filter.step(*state, wanted);
        }
        let wanted_n = self.velocity.gain * wanted;
        let moved =
            &self.a * DVector::from_column_slice(&state.mechanics) + &self.b * force_n.unwrap_or(wanted_n);
        next.mechanics = moved.as_slice().to_vec();
        (next, wanted_n)
    }

    fn observer_states(&self) -> usize {
        if self.velocity.observer.is_some() { 2 } else { 0 }
    }

    fn states(&self) -> usize {
        self.mechanics.states()
            + self.motor_latency.states()
            + self.table_latency.states()
            + 3
            + self.observer_states()
            + 2 * self.filters.len()
    }

    fn state(&self, vector: &[f64]) -> State {
        let (mechanics, rest) = vector.split_at(self.mechanics.states());
        let (motor_past, rest) = rest.split_at(self.motor_latency.states());
        let (table_past, rest) = rest.split_at(self.table_latency.states());
        let (observer, filters) = rest[3..].split_at(self.observer_states());
        State {
            mechanics: mechanics.to_vec(),
            motor_past: motor_past.to_vec(),
            table_past: table_past.to_vec(),
            last_reading: rest[0],
            last_increment: rest[1],
            integral: rest[2],
            observer: observer.to_vec(),
            filters: filters.as_chunks().0.to_vec(),
        }
    }
}

impl State {
    fn to_vec(&self) -> Vec<f64> {
        let mut vector = self.mechanics.clone();
        vector.extend(&self.motor_past);
        vector.extend(&self.table_past);
        vector.extend([self.last_reading, self.last_increment, self.integral]);
        vector.extend(&self.observer);
        vector.extend(self.filters.as_flattened());
        vector
    }
}
