//! One axis of the second simulator: two masses, a spring with a dead zone, `LuGre` friction, in plain f64.
//!
//! It shares no code with the crate `plant`, the effects of `model` or the controller in `shared`, so that the tracer
//! is tested on data that its own model did not generate. The equations are those of docs/self-test.md, integrated by
//! semi-implicit Euler steps of [`STEP_S`].

use std::f64::consts::TAU;

use super::warming::Warming;

/// Step of the integration, s: short against the fastest mode of the drawn machines, about 400 Hz between the masses.
pub const STEP_S: f64 = 50e-6;

/// Speed scale v0 of the motor's Coulomb friction, tanh(v/v0), m/s.
const MOTOR_FRICTION_M_PER_S: f64 = 0.2e-3;

/// A sinusoidal error or force: amplitude·sin(2π·x/period + phase), SI units; 0 for amplitude 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sinusoid {
    /// Amplitude, in the unit of the value.
    pub amplitude: f64,
    /// Period, in the unit of x; above 0 unless the amplitude is 0.
    pub period: f64,
    /// Phase, rad.
    pub phase: f64,
}

impl Sinusoid {
    /// Value at x.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        if self.amplitude == 0.0 {
            return 0.0;
        }
        self.amplitude * libm::sin(TAU * x / self.period + self.phase)
    }
}

/// A local position error of Gaussian shape: height·exp(−((x − centre)/width)²/2), m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LocalDefect {
    /// Largest value.
    pub height_m: f64,
    /// Position of the largest value.
    pub centre_m: f64,
    /// Standard deviation of the Gaussian; above 0 unless the height is 0.
    pub width_m: f64,
}

impl LocalDefect {
    /// Value at x.
    #[must_use]
    pub fn at(&self, x_m: f64) -> f64 {
        if self.height_m == 0.0 {
            return 0.0;
        }
        let distance = (x_m - self.centre_m) / self.width_m;
        self.height_m * libm::exp(-0.5 * distance * distance)
    }
}

/// Number of elements of a hysteresis.
pub const SLIPPING: usize = 12;

/// An element that carries a force in proportion to the stretch, up to a limit at which it slips.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slipping {
    /// Stiffness while it sticks.
    pub stiffness_n_per_m: f64,
    /// Largest force; 0: there is none.
    pub limit_n: f64,
}

impl Slipping {
    /// Force after a change of the stretch, m.
    fn after(&self, force_n: f64, stretched_m: f64) -> f64 {
        (force_n + self.stiffness_n_per_m * stretched_m).clamp(-self.limit_n, self.limit_n)
    }
}

/// True mechanical values of one axis, SI units. An error of value 0 is absent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mechanics {
    /// Mass of motor and screw, reflected to the table.
    pub motor_kg: f64,
    /// Mass of the table.
    pub table_kg: f64,
    /// Stiffness between screw and table.
    pub stiffness_n_per_m: f64,
    /// Relative variation of the stiffness over the motor's position, 1 over m; amplitude below 1.
    pub stiffness_wave: Sinusoid,
    /// Elements beside the stiffness, each of which sticks up to a force and slips at it: the hysteresis of a gear.
    pub slipping: [Slipping; SLIPPING],
    /// Damping between screw and table, while they are in contact.
    pub damping_n_s_per_m: f64,
    /// Coulomb friction of the table.
    pub coulomb_n: f64,
    /// Viscous friction of the table.
    pub viscous_n_s_per_m: f64,
    /// Coulomb friction of the motor.
    pub motor_coulomb_n: f64,
    /// σ0 of the `LuGre` model.
    pub presliding_n_per_m: f64,
    /// σ1 of the `LuGre` model.
    pub presliding_n_s_per_m: f64,
    /// Total width of the gap between screw and table.
    pub backlash_m: f64,
    /// Relative error of the lead: the screw moves the table by (1 + slope) times the motor.
    pub pitch_slope: f64,
    /// Cyclic error of the screw over the motor's position, m over m.
    pub pitch: Sinusoid,
    /// Local defect of the screw.
    pub screw_defect: LocalDefect,
    /// Further errors of the screw over the motor's position, m over m: long waves, other orders, a belt.
    pub screw_waves: Vec<Sinusoid>,
    /// Relative variation of the gap over the motor's position, 1 over m; amplitude below 1.
    pub backlash_wave: Sinusoid,
    /// Ripple force on the motor over its position, N over m.
    pub ripple: Sinusoid,
    /// Additional friction of the table at standstill.
    pub stribeck_n: f64,
    /// Speed at which the additional friction has decreased to 1/e.
    pub stribeck_m_per_s: f64,
    /// Half of the difference of viscous friction between forward and backward motion.
    pub asymmetry_n_s_per_m: f64,
    /// Constant load, positive if it opposes forward motion.
    pub load_n: f64,
    /// Increase of the load along the travel of the table; 0 at position 0.
    pub load_n_per_m: f64,
    /// Load over the table's position, N over m, positive if it opposes forward motion: gravity on a joint.
    pub load_wave: Sinusoid,
    /// Variation of the Coulomb friction over the table's position, N over m; in sum smaller than the Coulomb friction.
    pub friction_waves: Vec<Sinusoid>,
    /// Additional Coulomb friction of the table at time 0 of the session.
    pub warm_up_n: f64,
    /// Time constant with which that friction decays, s; above 0 unless it is 0.
    pub warm_up_s: f64,
    /// A guide whose friction depends on its temperature.
    pub warming: Option<Warming>,
    /// Additional friction of the motor near standstill.
    pub motor_stribeck_n: f64,
    /// Speed at which the additional friction of the motor has decreased to 1/e; above 0 unless it is 0.
    pub motor_stribeck_m_per_s: f64,
}

/// Positions and speeds of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Position of the motor.
    pub motor_m: f64,
    /// Speed of the motor.
    pub motor_m_per_s: f64,
    /// Position of the table.
    pub table_m: f64,
    /// Speed of the table.
    pub table_m_per_s: f64,
    /// Acceleration of the table at this position.
    pub table_m_per_s2: f64,
    /// Deflection of the bristles of the table's friction.
    pub bristle_m: f64,
    /// Forces of the slipping elements.
    pub slipping_n: [f64; SLIPPING],
    /// Time on the clock of the session, s.
    pub time_s: f64,
}

impl State {
    /// At rest; the spring is unstrained if the screw has no error.
    #[must_use]
    pub fn resting(at_m: f64) -> Self {
        Self { motor_m: at_m, table_m: at_m, ..Self::default() }
    }
}

impl Mechanics {
    /// At rest. The spring of a gear starts unstrained, as its elements would keep a strain from the error of its transmission.
    #[must_use]
    pub fn resting(&self, at_m: f64) -> State {
        let has_gear = self.slipping.iter().any(|element| element.limit_n > 0.0);
        State { table_m: if has_gear { self.screw_m(at_m) } else { at_m }, ..State::resting(at_m) }
    }

    /// One step under a force on the motor.
    pub fn step(&self, state: &mut State, force_n: f64) {
        let [motor, table] = [state.motor_m_per_s, state.table_m_per_s];
        let spring_n = self.spring_n(state);
        let friction_n = self.friction_n(state);
        let motor_friction_n = self.motor_friction_n(motor);
        let ripple_n = self.ripple.at(state.motor_m);
        let motor_n = force_n + ripple_n - spring_n - motor_friction_n;
        let table_n = spring_n - friction_n - self.load_n(state);
        state.motor_m_per_s = motor + STEP_S * motor_n / self.motor_kg;
        state.table_m_per_s = table + STEP_S * table_n / self.table_kg;
        let strain_m = |state: &State| self.screw_m(state.motor_m) - state.table_m;
        let before_m = strain_m(state);
        state.motor_m += STEP_S * state.motor_m_per_s;
        state.table_m += STEP_S * state.table_m_per_s;
        let stretched_m = strain_m(state) - before_m;
        for (force_n, element) in state.slipping_n.iter_mut().zip(&self.slipping) {
            *force_n = element.after(*force_n, stretched_m);
        }
        state.time_s += STEP_S;
        // The next step changes the bristles of the state itself.
        let table_n = self.spring_n(state) - self.friction_n(&mut { *state }) - self.load_n(state);
        state.table_m_per_s2 = table_n / self.table_kg;
    }

    /// Load of the table, positive if it opposes forward motion.
    fn load_n(&self, state: &State) -> f64 {
        self.load_n + self.load_n_per_m * state.table_m + self.load_wave.at(state.table_m)
    }

    /// (C + S·exp(−(v/vs)²))·tanh(v/v0).
    fn motor_friction_n(&self, v: f64) -> f64 {
        let stribeck_n = decaying(self.motor_stribeck_n, v / self.motor_stribeck_m_per_s);
        (self.motor_coulomb_n + stribeck_n) * libm::tanh(v / MOTOR_FRICTION_M_PER_S)
    }

    /// Position of the table that the screw sets, without strain.
    fn screw_m(&self, motor_m: f64) -> f64 {
        let local_m =
            (1.0 + self.pitch_slope) * motor_m + self.pitch.at(motor_m) + self.screw_defect.at(motor_m);
        self.screw_waves.iter().fold(local_m, |sum, wave| sum + wave.at(motor_m))
    }

    /// Force of the screw on the table; 0 inside the gap.
    fn spring_n(&self, state: &State) -> f64 {
        let half_gap_m = 0.5 * self.backlash_m * (1.0 + self.backlash_wave.at(state.motor_m));
        let strain_m = self.screw_m(state.motor_m) - state.table_m;
        let stretch_m = if strain_m > half_gap_m {
            strain_m - half_gap_m
        } else if strain_m < -half_gap_m {
            strain_m + half_gap_m
        } else {
            return 0.0;
        };
        let speed = state.motor_m_per_s - state.table_m_per_s;
        let stiffness_n_per_m = self.stiffness_n_per_m * (1.0 + self.stiffness_wave.at(state.motor_m));
        let slipping_n: f64 = state.slipping_n.iter().sum();
        stiffness_n_per_m * stretch_m + slipping_n + self.damping_n_s_per_m * speed
    }

    /// Viscous and Coulomb friction at the temperature of the guide, relative to the nominal ones.
    fn at_temperature(&self, state: &State) -> [f64; 2] {
        self.warming.map_or([1.0; 2], |warming| warming.factors(state.time_s))
    }

    /// Friction level at which the bristles slide: C·(1 − γ·(T − T0)) + S·exp(−(v/vs)²) + C'(x) + W·exp(−t/τ).
    fn sliding_n(&self, state: &State) -> f64 {
        let [_, coulomb] = self.at_temperature(state);
        let level_n =
            coulomb * self.coulomb_n + decaying(self.stribeck_n, state.table_m_per_s / self.stribeck_m_per_s);
        let level_n = self.friction_waves.iter().fold(level_n, |sum, wave| sum + wave.at(state.table_m));
        if self.warm_up_n == 0.0 {
            level_n
        } else {
            level_n + self.warm_up_n * libm::exp(-state.time_s / self.warm_up_s)
        }
    }

    /// `LuGre`: F = σ0·z + σ1·ż + b·v with ż = v − σ0·|v|·z/g(v). The step of z is implicit, because σ0·|v|/g reaches
    /// 1/[`STEP_S`].
    fn friction_n(&self, state: &mut State) -> f64 {
        let v = state.table_m_per_s;
        let level_n = self.sliding_n(state);
        let before_m = state.bristle_m;
        state.bristle_m =
            (before_m + STEP_S * v) / (1.0 + STEP_S * self.presliding_n_per_m * v.abs() / level_n);
        let deflection_rate = (state.bristle_m - before_m) / STEP_S;
        let viscous =
            self.at_temperature(state)[0] * self.viscous_n_s_per_m + self.asymmetry_n_s_per_m * v.signum();
        self.presliding_n_per_m * state.bristle_m + self.presliding_n_s_per_m * deflection_rate + viscous * v
    }
}

/// excess·exp(−ratio²); 0 for an excess of 0, where the ratio may be undefined.
fn decaying(excess: f64, ratio: f64) -> f64 {
    if excess == 0.0 { 0.0 } else { excess * libm::exp(-ratio.powi(2)) }
}
