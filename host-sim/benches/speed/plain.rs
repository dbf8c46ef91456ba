//! The same job in the simplest form: a loop in f64 with the semi-implicit Euler method.
//!
//! Its controller has the laws of `shared` that the job needs (P, velocity feed-forward, PI with anti-windup), on a
//! circle by sine and cosine; it has no other laws, sensors, filters, compensation, blocks or monitoring. Its plant has
//! two masses on a spring and `LuGre` friction with a constant level: velocities from the forces at the beginning of
//! the step, then positions from the new velocities.
#![expect(clippy::needless_range_loop, reason = "every line is an equation of axis i")]

use model::machine::Machine;
use model::servo;
use plant::parameters::AxisParameters;

use super::{ACCELERATION_M_PER_S2, FEED_M_PER_S, RADIUS_M, START_M};

const AXES: usize = 2;

/// The loop. Arrays hold one number per axis; both axes have the constants of the first.
pub struct Plain {
    /// Constants of controller and plant.
    constants: Constants,
    /// Number of position ticks so far.
    commands: f64,
    until_position_tick: u32,
    command_m: [f64; AXES],
    velocity_command: [f64; AXES],
    last_motor_m: [f64; AXES],
    integral_n: [f64; AXES],
    motor_m: [f64; AXES],
    motor_m_per_s: [f64; AXES],
    table_m: [f64; AXES],
    table_m_per_s: [f64; AXES],
    bristle_m: [f64; AXES],
}

/// Constants, so that the loop has no divisions.
struct Constants {
    divider: u32,
    steps: u32,
    command_s: f64,
    ramp_m_per_s2: f64,
    tick_hz: f64,
    step_s: f64,
    kp: f64,
    /// Velocity feed-forward: lead of the command per change of the command in a position tick.
    lead: f64,
    kv: f64,
    /// Kv·T/Ti.
    ki: f64,
    limit_n: f64,
    stiffness: f64,
    damping: f64,
    bristle_stiffness: f64,
    bristle_damping: f64,
    viscous: f64,
    /// σ0/g, 1/m.
    relaxation_per_m: f64,
    per_motor_kg: f64,
    per_table_kg: f64,
}

impl Plain {
    /// At rest at the start of the circle, with a number of steps in each tick.
    pub fn new(machine: &Machine, steps: u32) -> Self {
        let axis = machine.axis.values().next().unwrap();
        let parameters = AxisParameters::of(axis);
        let settings = servo::settings(&axis.settings, &parameters.servo).unwrap();
        let rates = machine.rates();
        let (spring, friction) = (parameters.spring.unwrap(), &parameters.friction);
        let tick_hz = rates.velocity_loop_hz;
        let kv = settings.velocity_gain_n_s_per_m;
        let constants = Constants {
            divider: rates.position_loop_divider,
            steps,
            ramp_m_per_s2: ramp_m_per_s2(),
            command_s: 1.0 / rates.position_loop_hz(),
            tick_hz,
            step_s: 1.0 / (tick_hz * f64::from(steps)),
            kp: settings.position_gain_per_s,
            lead: 0.01 * settings.feedforward_percent * rates.position_loop_hz()
                / settings.position_gain_per_s,
            kv,
            ki: kv / (tick_hz * settings.velocity_integral_time_s.unwrap()),
            limit_n: settings.force_limit_n,
            stiffness: spring.stiffness_n_per_m,
            damping: spring.damping_n_s_per_m,
            bristle_stiffness: friction.bristle_stiffness_n_per_m,
            bristle_damping: friction.bristle_damping_n_s_per_m,
            viscous: friction.viscous_n_s_per_m,
            relaxation_per_m: friction.bristle_stiffness_n_per_m / friction.coulomb_n,
            per_motor_kg: 1.0 / parameters.motor_mass_kg,
            per_table_kg: 1.0 / parameters.table_mass_kg,
        };
        Self {
            constants,
            commands: 0.0,
            until_position_tick: 0,
            command_m: START_M,
            velocity_command: [0.0; AXES],
            last_motor_m: START_M,
            integral_n: [0.0; AXES],
            motor_m: START_M,
            motor_m_per_s: [0.0; AXES],
            table_m: START_M,
            table_m_per_s: [0.0; AXES],
            bristle_m: [0.0; AXES],
        }
    }

    /// One tick: position loops in every `divider`-th one, velocity loops, and the steps of the plant.
    pub fn tick(&mut self) {
        if self.until_position_tick == 0 {
            self.until_position_tick = self.constants.divider;
            self.position_loops();
        }
        self.until_position_tick -= 1;
        let force_n = self.velocity_loops();
        for _ in 0..self.constants.steps {
            self.step(force_n);
        }
    }

    /// Positions of the tables, which are those of the tool, m.
    pub fn tool_m(&self) -> [f64; AXES] {
        self.table_m
    }

    fn position_loops(&mut self) {
        let constants = &self.constants;
        self.commands += 1.0;
        let command_m = on_circle(self.commands * constants.command_s, constants.ramp_m_per_s2);
        for i in 0..AXES {
            let lead_m = constants.lead * (command_m[i] - self.command_m[i]);
            self.velocity_command[i] = constants.kp * (command_m[i] - self.motor_m[i] + lead_m);
        }
        self.command_m = command_m;
    }

    fn velocity_loops(&mut self) -> [f64; AXES] {
        let constants = &self.constants;
        let mut force_n = [0.0; AXES];
        for i in 0..AXES {
            let velocity = constants.tick_hz * (self.motor_m[i] - self.last_motor_m[i]);
            let error = self.velocity_command[i] - velocity;
            let integral_n = self.integral_n[i] + constants.ki * error;
            let wanted_n = constants.kv * error + integral_n;
            force_n[i] = wanted_n.clamp(-constants.limit_n, constants.limit_n);
            if wanted_n.abs() <= constants.limit_n || (error > 0.0) != (wanted_n > 0.0) {
                self.integral_n[i] = integral_n;
            }
        }
        self.last_motor_m = self.motor_m;
        force_n
    }

    fn step(&mut self, force_n: [f64; AXES]) {
        let (constants, h) = (&self.constants, self.constants.step_s);
        for i in 0..AXES {
            let (v, z) = (self.table_m_per_s[i], self.bristle_m[i]);
            let screw_n = constants.stiffness * (self.motor_m[i] - self.table_m[i])
                + constants.damping * (self.motor_m_per_s[i] - v);
            let bristle_m_per_s = v - constants.relaxation_per_m * v.abs() * z;
            let friction_n = constants.bristle_stiffness * z
                + constants.bristle_damping * bristle_m_per_s
                + constants.viscous * v;
            self.motor_m_per_s[i] += h * constants.per_motor_kg * (force_n[i] - screw_n);
            self.table_m_per_s[i] += h * constants.per_table_kg * (screw_n - friction_n);
            self.motor_m[i] += h * self.motor_m_per_s[i];
            self.table_m[i] += h * self.table_m_per_s[i];
            self.bristle_m[i] += h * bristle_m_per_s;
        }
    }
}

/// Acceleration along the circle as planned by `shared`: 15/16 of the block's acceleration, minus (as vectors) v²/R.
fn ramp_m_per_s2() -> f64 {
    let centripetal = FEED_M_PER_S * FEED_M_PER_S / RADIUS_M;
    ((ACCELERATION_M_PER_S2 * 15.0 / 16.0).powi(2) - centripetal.powi(2)).sqrt()
}

/// The point of the circle at a time, m: constant acceleration, then constant feed.
fn on_circle(time_s: f64, ramp_m_per_s2: f64) -> [f64; AXES] {
    let ramp_s = FEED_M_PER_S / ramp_m_per_s2;
    let travel_m = if time_s < ramp_s {
        0.5 * ramp_m_per_s2 * time_s * time_s
    } else {
        FEED_M_PER_S * (time_s - 0.5 * ramp_s)
    };
    let (sine, cosine) = (travel_m / RADIUS_M).sin_cos();
    [RADIUS_M * cosine, RADIUS_M * sine]
}
