//! The same job as one writes it down first: a plain loop in f64, stepped by the semi-implicit Euler method.
//!
//! Its controller computes what `shared` does (P, velocity feed-forward, PI with a limit that does not wind up), on a
//! circle from sine and cosine; there are no other laws, sensors, filters, compensations or blocks, and nothing is
//! watched. Its plant has two masses on a spring and `LuGre` friction of a constant level, explicit in everything:
//! velocities from the forces at the beginning of the step, then places from the new velocities.
#![expect(clippy::needless_range_loop, reason = "plain: every line is an equation of axis i")]

use model::machine::Machine;
use model::servo;
use plant::parameters::AxisParameters;

use super::{ACCELERATION_M_PER_S2, FEED_M_PER_S, RADIUS_M, START_M};

const AXES: usize = 2;

/// The loop, both axes with the constants of the first; each array holds one number an axis.
pub struct Plain {
    /// Constants of controller and plant.
    with: Constants,
    /// Commands so far.
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

/// All divisions are done here.
struct Constants {
    divider: u32,
    steps: u32,
    command_s: f64,
    ramp_m_per_s2: f64,
    tick_hz: f64,
    step_s: f64,
    kp: f64,
    /// Seconds that the position loop aims ahead, per command.
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
    relaxes_per_m: f64,
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
        let with = Constants {
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
            relaxes_per_m: friction.bristle_stiffness_n_per_m / friction.coulomb_n,
            per_motor_kg: 1.0 / parameters.motor_mass_kg,
            per_table_kg: 1.0 / parameters.table_mass_kg,
        };
        Self {
            with,
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

    /// One tick: position loops where they are due, velocity loops, and the steps of the plant.
    pub fn tick(&mut self) {
        if self.until_position_tick == 0 {
            self.until_position_tick = self.with.divider;
            self.position_loops();
        }
        self.until_position_tick -= 1;
        let force_n = self.velocity_loops();
        for _ in 0..self.with.steps {
            self.step(force_n);
        }
    }

    /// Where the tables, and so the tool, are, m.
    pub fn tool_m(&self) -> [f64; AXES] {
        self.table_m
    }

    fn position_loops(&mut self) {
        let with = &self.with;
        self.commands += 1.0;
        let command_m = on_circle(self.commands * with.command_s, with.ramp_m_per_s2);
        for i in 0..AXES {
            let lead_m = with.lead * (command_m[i] - self.command_m[i]);
            self.velocity_command[i] = with.kp * (command_m[i] - self.motor_m[i] + lead_m);
        }
        self.command_m = command_m;
    }

    fn velocity_loops(&mut self) -> [f64; AXES] {
        let with = &self.with;
        let mut force_n = [0.0; AXES];
        for i in 0..AXES {
            let velocity = with.tick_hz * (self.motor_m[i] - self.last_motor_m[i]);
            let error = self.velocity_command[i] - velocity;
            let integral_n = self.integral_n[i] + with.ki * error;
            let wanted_n = with.kv * error + integral_n;
            force_n[i] = wanted_n.clamp(-with.limit_n, with.limit_n);
            if wanted_n.abs() <= with.limit_n || (error > 0.0) != (wanted_n > 0.0) {
                self.integral_n[i] = integral_n;
            }
        }
        self.last_motor_m = self.motor_m;
        force_n
    }

    fn step(&mut self, force_n: [f64; AXES]) {
        let (with, h) = (&self.with, self.with.step_s);
        for i in 0..AXES {
            let (v, z) = (self.table_m_per_s[i], self.bristle_m[i]);
            let screw_n = with.stiffness * (self.motor_m[i] - self.table_m[i])
                + with.damping * (self.motor_m_per_s[i] - v);
            let bends = v - with.relaxes_per_m * v.abs() * z;
            let friction_n = with.bristle_stiffness * z + with.bristle_damping * bends + with.viscous * v;
            self.motor_m_per_s[i] += h * with.per_motor_kg * (force_n[i] - screw_n);
            self.table_m_per_s[i] += h * with.per_table_kg * (screw_n - friction_n);
            self.motor_m[i] += h * self.motor_m_per_s[i];
            self.table_m[i] += h * self.table_m_per_s[i];
            self.bristle_m[i] += h * bends;
        }
    }
}

/// Along the circle while it speeds up, as `shared` plans it: of the block's acceleration it spares a sixteenth on arcs,
/// and what points to the centre is taken from the rest.
fn ramp_m_per_s2() -> f64 {
    let to_centre = FEED_M_PER_S * FEED_M_PER_S / RADIUS_M;
    ((ACCELERATION_M_PER_S2 * 15.0 / 16.0).powi(2) - to_centre.powi(2)).sqrt()
}

/// The circle at a time, m: speeding up, then at its feed.
fn on_circle(time_s: f64, ramp_m_per_s2: f64) -> [f64; AXES] {
    let ramp_s = FEED_M_PER_S / ramp_m_per_s2;
    let way_m = if time_s < ramp_s {
        0.5 * ramp_m_per_s2 * time_s * time_s
    } else {
        FEED_M_PER_S * (time_s - 0.5 * ramp_s)
    };
    let (sine, cosine) = (way_m / RADIUS_M).sin_cos();
    [RADIUS_M * cosine, RADIUS_M * sine]
}
