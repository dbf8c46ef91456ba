//! A simulated axis that is richer than the model of the estimator: Stribeck friction, a load that changes along the travel, coloured noise,
//! an encoder with steps, loops that give way.

use std::f64::consts::TAU;

use crate::anticogging::passes::Sample;
use crate::anticogging::plan::{ACCELERATION_M_PER_S2, Plan, Wanted};
use crate::anticogging::{Declared, Learned, passes};

/// Time of a step, s, and steps per sample: 4 kHz.
const STEP_S: f64 = 50e-6;
const STEPS_PER_SAMPLE: usize = 5;
pub const SAMPLE_S: f64 = STEP_S * STEPS_PER_SAMPLE as f64;

/// A count of the encoder, m, and a step of the recorded force, N.
const COUNT_M: f64 = 50e-9;
pub const FORCE_STEP_N: f64 = 1.0 / 32.0;

/// The declared values of the axis of the emulated board.
pub const DECLARED: Declared = Declared {
    mass_kg: 15.0,
    velocity_gain_n_s_per_m: 3000.0,
    velocity_integral_time_s: 0.02,
    position_gain_per_s: 25.0,
    lead_mm: Some(5.0),
    travel_mm: Some([-100.0, 100.0]),
    force_limit_n: Some(200.0),
};

/// The true machine.
#[derive(Clone, Debug)]
pub struct Rig {
    /// Period mm, amplitude N, phase rad.
    pub waves: Vec<[f64; 3]>,
    pub load_n: f64,
    pub load_n_per_m: f64,
    pub coulomb_n: f64,
    /// Rise of the friction towards standstill, N, over 3 mm/s.
    pub static_excess_n: f64,
    /// Friction that follows the position, N, with a period of 3.1 mm: against the motion, so that it is no cogging.
    pub friction_ripple_n: f64,
    /// Standard deviation of a force that wanders with a time constant of 20 ms, N.
    pub noise_n: f64,
    /// Standard deviation of a load that wanders along the travel, the same in each pass, N.
    pub rough_n: f64,
    pub seed: u64,
}

impl Rig {
    /// Friction of 20 N, without waves.
    pub fn quiet(seed: u64) -> Self {
        Self {
            waves: Vec::new(),
            load_n: 12.0,
            load_n_per_m: 60.0,
            coulomb_n: 20.0,
            static_excess_n: 6.0,
            friction_ripple_n: 1.0,
            noise_n: 0.5,
            rough_n: 0.0,
            seed,
        }
    }

    pub fn with_waves(waves: &[[f64; 3]], seed: u64) -> Self {
        Self { waves: waves.to_vec(), ..Self::quiet(seed) }
    }

    /// Force on the motor at a position, N: cogging less load.
    fn force_n(&self, at_m: f64) -> f64 {
        let cogging: f64 =
            self.waves.iter().map(|[mm, n, rad]| n * (TAU * 1e3 * at_m / mm + rad).sin()).sum();
        // Waves whose periods are no whole fractions of anything, with amplitudes that fall towards short ones.
        let mut random = Random(self.seed ^ 0x5eed);
        let rough: f64 = (1..=40)
            .map(|line| {
                let (rad, weight) = (TAU * random.uniform(), 1.0 / (1.0 + 0.1 * f64::from(line)));
                weight * (TAU * f64::from(line) * 1e3 * at_m / 31.7 + rad).sin()
            })
            .sum();
        cogging - self.load_n - self.load_n_per_m * at_m + 0.3 * self.rough_n * rough
    }

    /// The recording of passes.
    pub fn run(&self, plan: &Plan, pairs: usize) -> Vec<Sample> {
        let [from_m, to_m] = plan.travel_mm.map(|mm| 1e-3 * mm);
        let mut random = Random(self.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        let (mut position, mut velocity, mut integral, mut wander) = (from_m, 0.0, 0.0, 0.0);
        let mut samples = Vec::new();
        let commands = commands([from_m, to_m], 1e-3 * plan.speed_mm_per_s, pairs);
        let rate = STEP_S / 0.02f64;
        for (step, pair) in commands.windows(2).enumerate() {
            let (command, speed) = (pair[1], (pair[1] - pair[0]) / STEP_S);
            let read = (position / COUNT_M).floor() * COUNT_M;
            let error = DECLARED.position_gain_per_s * (command - read) + speed - velocity;
            integral += error * STEP_S / DECLARED.velocity_integral_time_s;
            let drive_n = DECLARED.velocity_gain_n_s_per_m * (error + integral);
            wander += -rate * wander + (2.0 * rate).sqrt() * self.noise_n * random.normal();
            let free = velocity + STEP_S / DECLARED.mass_kg * (drive_n + self.force_n(position) + wander);
            let stribeck = self.static_excess_n * (-(velocity / 3e-3f64).powi(2)).exp();
            let along = self.friction_ripple_n * (TAU * 1e3 * position / 3.1).sin();
            let slowed = STEP_S / DECLARED.mass_kg * (self.coulomb_n + stribeck + along);
            velocity = free - free.clamp(-slowed, slowed);
            position += STEP_S * velocity;
            if step % STEPS_PER_SAMPLE == 0 {
                let force_n = (drive_n / FORCE_STEP_N).round() * FORCE_STEP_N;
                samples.push(Sample { command_m: command, motor_m: read, force_n });
            }
        }
        samples
    }

    /// What is learned from four pairs of passes over 20 mm.
    pub fn learned(&self) -> (Plan, Learned) {
        let plan = Plan::new(&wanted(), &DECLARED).unwrap();
        let pairs = passes::pairs(&self.run(&plan, 4), &plan, 4, (SAMPLE_S, DECLARED.force_limit_n)).unwrap();
        let learned = Learned::of(&pairs, &plan, &DECLARED, FORCE_STEP_N);
        (plan, learned)
    }
}

pub fn wanted() -> Wanted {
    Wanted {
        periods_mm: vec![5.0],
        harmonics: 8,
        from_mm: Some(-11.5),
        to_mm: Some(11.5),
        speed_mm_per_s: None,
        at_mm: 0.0,
        sample_s: SAMPLE_S,
    }
}

/// Commands at every step: passes with trapezoidal speed, between standstills of 0.1 s.
fn commands([from_m, to_m]: [f64; 2], m_per_s: f64, pairs: usize) -> Vec<f64> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "thousands of steps")]
    let steps = |seconds: f64| (seconds / STEP_S) as usize;
    let stands = steps(0.1);
    let ramp_s = m_per_s / ACCELERATION_M_PER_S2;
    let whole_s = (to_m - from_m) / m_per_s + ramp_s;
    let mut commands = vec![from_m; stands];
    for pass in 0..2 * pairs {
        let (start_m, sign) = if pass % 2 == 0 { (from_m, 1.0) } else { (to_m, -1.0) };
        for step in 1..=steps(whole_s) {
            let time_s = step as f64 * STEP_S;
            let ramp = |s: f64| 0.5 * ACCELERATION_M_PER_S2 * s * s;
            let way_m = if time_s < ramp_s {
                ramp(time_s)
            } else if time_s < whole_s - ramp_s {
                m_per_s * (time_s - 0.5 * ramp_s)
            } else {
                to_m - from_m - ramp(whole_s - time_s)
            };
            commands.push(start_m + sign * way_m);
        }
        let end_m = if pass % 2 == 0 { to_m } else { from_m };
        commands.extend(std::iter::repeat_n(end_m, stands));
    }
    commands
}

/// Random numbers (xorshift).
pub struct Random(pub u64);

impl Random {
    pub fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Sum of twelve, less its mean: variance 1.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}
