//! The table behind a motor whose motion is known: what the tracer drives with a measured motor.
//!
//! Unknown is only the deflection d = screw − table: m·d″ = m·a + friction + load − k·dz(d) − c·d′,
//! with the screw's acceleration a given and dz the dead zone. The step is implicit in d and in the
//! bristles: where motor and table are in quasi-static balance it is exact at any step, and it damps
//! the ringing of the table against a motor that is held in place. The real motor is not held, it
//! gives way; but its giving way, nanometres at the frequency of that ringing, is lost in the noise of
//! its encoder, and a step that does not damp would ring where the machine does not.

use super::friction::Slide;
use super::parameters::AxisParameters;
use super::screw::Spring;

/// Where the screw is, m, and how it moves, m/s and m/s².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Prescribed {
    /// Where the screw would carry an unloaded table.
    pub nominal_m: f64,
    /// Its velocity.
    pub velocity: f64,
    /// Its acceleration.
    pub acceleration: f64,
    /// How much of the velocity comes of the screw's errors: the damper lies between motor and table and does not
    /// see it.
    pub of_errors: f64,
}

/// The table's state, relative to the screw.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DrivenTable {
    deflection_m: f64,
    deflection_rate: f64,
    bristle_m: f64,
    lately_m_per_s: f64,
    /// Where a rigid screw left the table.
    table_m: f64,
    /// Force of the screw on the table, N.
    pub transmitted_n: f64,
}

impl DrivenTable {
    /// In balance behind a screw that moves steadily, or at rest without any force.
    #[must_use]
    pub fn settled(parameters: &AxisParameters, screw: Prescribed) -> Self {
        // Bristles are bent through within micrometres; slower than this they may still be upright.
        const MOVING_M_PER_S: f64 = 1e-3;
        let mut table = Self { table_m: screw.nominal_m, ..Self::default() };
        if screw.velocity.abs() < MOVING_M_PER_S {
            return table;
        }
        let friction = &parameters.friction;
        table.lately_m_per_s = screw.velocity.abs();
        let slide = table.slide(screw);
        let level = friction.level_n(screw.velocity, slide).copysign(screw.velocity);
        if friction.has_bristles() {
            table.bristle_m = level / friction.bristle_stiffness_n_per_m;
        }
        table.transmitted_n = parameters.table_mass_kg * screw.acceleration
            + level
            + friction.viscous_n(screw.velocity)
            + parameters.load.force_n;
        let gap_m = parameters.screw.backlash.half_m().copysign(table.transmitted_n);
        if let Some(spring) = &parameters.spring {
            table.deflection_m = table.transmitted_n / spring.stiffness_n_per_m + gap_m;
        } else {
            table.table_m -= gap_m;
        }
        table
    }

    /// Bend of the guide's bristles, m.
    #[must_use]
    pub fn bristle_m(&self) -> f64 {
        self.bristle_m
    }

    /// Speed that the guide's friction remembers, m/s.
    #[must_use]
    pub fn lately_m_per_s(&self) -> f64 {
        self.lately_m_per_s
    }

    fn slide(&self, screw: Prescribed) -> Slide {
        Slide { place_m: screw.nominal_m, lately_m_per_s: self.lately_m_per_s }
    }

    /// Table position, m.
    #[must_use]
    pub fn position_m(&self, parameters: &AxisParameters, screw: Prescribed) -> f64 {
        if parameters.spring.is_some() { screw.nominal_m - self.deflection_m } else { self.table_m }
    }

    /// One step that ends where `screw` says.
    #[inline]
    pub fn step(&mut self, step: &DrivenStep<'_>, screw: Prescribed) {
        let memory = &step.parameters.friction.memory;
        if memory.remembers() {
            self.lately_m_per_s += memory.share(step.step_s) * (screw.velocity.abs() - self.lately_m_per_s);
        }
        match step.parameters.spring {
            Some(_) => self.step_elastic(step, screw),
            None => self.step_rigid(step, screw),
        }
    }

    fn step_rigid(&mut self, step: &DrivenStep<'_>, screw: Prescribed) {
        let parameters = step.parameters;
        self.table_m = parameters.screw.carried_m(screw.nominal_m, self.table_m);
        let slide = self.slide(screw);
        let friction = parameters.friction.step(&mut self.bristle_m, screw.velocity, slide, step.step_s);
        self.transmitted_n =
            parameters.table_mass_kg * screw.acceleration + friction + parameters.load.force_n;
    }

    #[inline]
    fn step_elastic(&mut self, step: &DrivenStep<'_>, screw: Prescribed) {
        // The screw's mean velocity over the step, and the deflection's as it was.
        let sliding = screw.velocity - self.deflection_rate;
        let friction = step.friction(self.bristle_m, sliding, self.slide(screw));
        // Everything that does not act through the screw, as rest + inertia·d.
        let inertia = step.mass_per_h2 + friction.slope * step.per_h;
        let rest = step.mass * screw.acceleration
            + step.mass_per_h2 * self.deflection_m
            + step.mass_per_h * self.deflection_rate
            + friction.offset
            + friction.slope * (screw.velocity + self.deflection_m * step.per_h)
            + step.parameters.load.force_n;
        let in_gap = rest.abs() <= step.half_gap_m * inertia;
        let gap_m = step.half_gap_m.copysign(rest);
        let deflection = if in_gap {
            rest / inertia
        } else {
            (rest + step.stiffness * gap_m + step.drag * self.deflection_m + step.damping * screw.of_errors)
                / (inertia + step.stiffness + step.drag)
        };
        let rate = (deflection - self.deflection_m) * step.per_h;
        self.bristle_m = friction.bristle(self.bristle_m, screw.velocity - rate, step.step_s);
        self.transmitted_n = if in_gap {
            0.0
        } else {
            step.stiffness * (deflection - gap_m) + step.damping * (rate - screw.of_errors)
        };
        self.deflection_m = deflection;
        self.deflection_rate = rate;
    }
}

/// What is the same in all steps of one length.
#[derive(Clone, Debug)]
pub struct DrivenStep<'a> {
    parameters: &'a AxisParameters,
    step_s: f64,
    per_h: f64,
    mass: f64,
    mass_per_h: f64,
    mass_per_h2: f64,
    stiffness: f64,
    damping: f64,
    /// Damping over a step, N/m.
    drag: f64,
    half_gap_m: f64,
}

impl<'a> DrivenStep<'a> {
    /// Steps of `step_s` of an axis.
    #[must_use]
    pub fn new(parameters: &'a AxisParameters, step_s: f64) -> Self {
        let of_spring = |value: fn(&Spring) -> f64| parameters.spring.as_ref().map_or(0.0, value);
        let (mass, per_h) = (parameters.table_mass_kg, step_s.recip());
        let damping = of_spring(|spring| spring.damping_n_s_per_m);
        Self {
            parameters,
            step_s,
            per_h,
            mass,
            mass_per_h: mass * per_h,
            mass_per_h2: mass * per_h * per_h,
            stiffness: of_spring(|spring| spring.stiffness_n_per_m),
            damping,
            drag: damping * per_h,
            half_gap_m: parameters.screw.backlash.half_m(),
        }
    }

    /// Friction of the step about a velocity.
    #[inline]
    fn friction(&self, bristle_m: f64, about: f64, slide: Slide) -> Linear {
        let friction = &self.parameters.friction;
        let viscous = friction.viscous_n_s_per_m;
        let one_way = friction.asymmetry.force_n(about);
        if !friction.has_bristles() {
            let mut none = 0.0;
            let dry = friction.step(&mut none, about, slide, self.step_s) - friction.viscous_n(about);
            return Linear { offset: dry + one_way, slope: viscous, keeps: 0.0, takes: 0.0 };
        }
        let (stiffness, damping) = (friction.bristle_stiffness_n_per_m, friction.bristle_damping_n_s_per_m);
        let relaxation = friction.relaxes_per_m(friction.level_n(about, slide)) * about.abs() * self.step_s;
        let keeps = (-relaxation).exp();
        let takes = if relaxation > 1e-6 { (1.0 - keeps) / relaxation } else { 1.0 };
        Linear {
            offset: bristle_m * (stiffness * keeps + damping * (keeps - 1.0) * self.per_h) + one_way,
            slope: (stiffness * self.step_s + damping) * takes + viscous,
            keeps,
            takes,
        }
    }
}

/// Friction over one step as offset + slope·v, v the mean velocity of the step.
///
/// Bristles relax exactly for a velocity that stays: z′ = z·e⁻ʳ + v·h·(1 − e⁻ʳ)/r, r = σ0·|v|·h/g. A
/// reversal takes few steps, and a first-order rule would show there as a Stribeck effect.
struct Linear {
    offset: f64,
    slope: f64,
    keeps: f64,
    takes: f64,
}

impl Linear {
    #[inline]
    fn bristle(&self, bristle_m: f64, velocity: f64, step_s: f64) -> f64 {
        bristle_m * self.keeps + velocity * step_s * self.takes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::Friction;
    use model::effects::Backlash;

    fn axis() -> AxisParameters {
        AxisParameters {
            table_mass_kg: 200.0,
            spring: Some(Spring { stiffness_n_per_m: 200e6, damping_n_s_per_m: 1e4 }),
            friction: Friction {
                coulomb_n: 200.0,
                viscous_n_s_per_m: 1000.0,
                bristle_stiffness_n_per_m: 4e7,
                bristle_damping_n_s_per_m: 2000.0,
                ..Friction::default()
            },
            ..AxisParameters::default()
        }
    }

    /// Goes back and forth over ±1 mm at 20 mm/s and tells where the table lags behind, way out and way
    /// back, m.
    fn lag(parameters: &AxisParameters) -> (f64, f64) {
        let h = 5e-4;
        let mut table = DrivenTable::default();
        let mut screw = Prescribed::default();
        let step = DrivenStep::new(parameters, h);
        let mut lags = (0.0, 0.0);
        for (velocity, steps) in [(0.02, 100), (-0.02, 200), (0.02, 200)] {
            for _ in 0..steps {
                let nominal_m = screw.nominal_m + velocity * h;
                screw = Prescribed { nominal_m, velocity, ..Prescribed::default() };
                table.step(&step, screw);
            }
            let lag = screw.nominal_m - table.position_m(parameters, screw);
            if velocity > 0.0 { lags.0 = lag } else { lags.1 = lag }
        }
        lags
    }

    #[test]
    fn stretches_by_friction_over_stiffness() {
        // (200 N + 1000 N·s/m · 0.02 m/s)/200 N/µm = 1.1 µm either way.
        let (out, back) = lag(&axis());
        assert!((out - 1.1e-6).abs() < 1e-9 && (back + 1.1e-6).abs() < 1e-9, "{out:e} {back:e}");
    }

    #[test]
    fn loses_the_gap_at_reversal() {
        let mut with_gap = axis();
        with_gap.screw.backlash = Backlash { width_um: 10.0 };
        let (out, back) = lag(&with_gap);
        // Half the gap on either side, on top of the stretch.
        assert!((out - 6.1e-6).abs() < 1e-9 && (back + 6.1e-6).abs() < 1e-9, "{out:e} {back:e}");
    }
}
