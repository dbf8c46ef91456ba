//! Masses, friction and stiffness, from the force, the motor and the table.
//!
//! 1. force = (all mass)·a + Coulomb friction·direction + viscous friction·v: the axis as one mass. The [`direction`] with the
//!    slip that leaves least.
//! 2. motor − table = (force that the screw transmits)/stiffness + half a backlash·sign(that force) + a time·v, with the division of
//!    mass and friction between motor and table that leaves least.

use numerics::resample::delayed_linear;
use trace::input::signals::AxisSignals;
use trace::input::smoothing::Smooth;

use crate::direction;
use crate::regression::{Regression, Solution, inner};

/// Slips that are tried, m: Coulomb friction over the stiffness before sliding. Most guideways yield by 1 to 20 µm.
const SLIPS_M: [f64; 10] = [0.0, 0.5e-6, 1e-6, 2e-6, 3e-6, 5e-6, 8e-6, 12e-6, 20e-6, 40e-6];

/// Part of the force's standard deviation that one mass with friction may leave. An axis that leaves more is moved by something else:
/// gravity on an arm, other axes.
pub const MOST_LEFT: f64 = 0.4;

/// A force is the mean over the interval that ends at its sample: half a sample old.
const FORCE_AGE: f64 = 0.5;

/// Noise of the acceleration as a part of its standard deviation, from which a wider filter is taken: it lowers the mass by its square.
const MOST_NOISE: f64 = 0.25;

/// Half widths of these filters, samples.
const WIDTHS: [usize; 6] = [5, 10, 20, 40, 80, 160];

/// Parts of the mass and of the Coulomb friction that may be the motor's, with the screw.
const MOTOR_MASSES: [f64; 12] = [0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.7];
const MOTOR_FRICTIONS: [f64; 3] = [0.05, 0.2, 0.35];

/// Part of the Coulomb friction below which the transmitted force may be crossing the backlash.
const CROSSING: f64 = 0.25;

/// Smallest backlash that is looked at, m; it must also be above what the regression leaves.
const LEAST_BACKLASH_M: f64 = 0.5e-6;

/// The axis as one mass.
#[derive(Clone, Copy, Debug)]
pub struct Rigid {
    /// Motor and table, kg.
    pub mass_kg: f64,
    /// Coulomb friction of both, N.
    pub coulomb_n: f64,
    /// Viscous friction, N·s/m.
    pub viscous_n_s_per_m: f64,
    /// Coulomb friction over the stiffness before sliding, m; 0: none is seen.
    pub slip_m: f64,
    /// Whether only a filter longer than that of a trace shows the mass.
    pub is_noisy: bool,
}

/// The drive train between motor and table.
#[derive(Clone, Copy, Debug)]
pub struct Elastic {
    /// Stiffness, N/m.
    pub stiffness_n_per_m: f64,
    /// Mass on the motor's side, kg.
    pub motor_mass_kg: f64,
    /// Coulomb friction of the motor, N.
    pub motor_coulomb_n: f64,
    /// Backlash between them, m; `None`: none is seen.
    pub backlash_m: Option<f64>,
}

/// The axis as one mass; `None` without logs of motor and force that show a mass.
#[must_use]
pub fn rigid(logs: &[&AxisSignals], sample_s: f64) -> Option<Rigid> {
    let smoothed: Vec<Smoothed> = logs.iter().filter_map(|log| Smoothed::of(log, sample_s)).collect();
    let with_slip = |slip_m: f64| Some((rigid_with(&smoothed, slip_m)?, slip_m));
    let (Solution { values: [mass_kg, coulomb_n, viscous], left, .. }, slip_m) =
        SLIPS_M.into_iter().filter_map(with_slip).min_by(|(a, _), (b, _)| a.rms.total_cmp(&b.rms))?;
    let has_reversal = coulomb_n != 0.0;
    let one_way = || numerics::mean(smoothed.iter().map(|log| log.one_way_n([mass_kg, viscous])));
    let coulomb_n = if has_reversal { coulomb_n } else { one_way() };
    let (coulomb_n, viscous_n_s_per_m) = (coulomb_n.max(0.0), viscous.max(0.0));
    let is_noisy = smoothed.iter().any(|log| log.is_noisy);
    let rigid = Rigid { mass_kg, coulomb_n, viscous_n_s_per_m, slip_m, is_noisy };
    (mass_kg > 0.0 && left < MOST_LEFT).then_some(rigid)
}

/// Motor and force of a log after the same filter: the narrowest that leaves little noise of the acceleration.
struct Smoothed {
    motor: Smooth,
    force: Smooth,
    /// Whether it is wider than that of a trace.
    is_noisy: bool,
}

impl Smoothed {
    fn of(log: &AxisSignals, sample_s: f64) -> Option<Self> {
        let (motor, force) = log.motor.as_ref().zip(log.force.as_ref())?;
        let is_quiet = |smooth: &Smooth| {
            let (_, deviation) = numerics::mean_and_deviation(&smooth.acceleration);
            smooth.acceleration_noise < MOST_NOISE * deviation
        };
        if is_quiet(motor) {
            return Some(Self { motor: motor.clone(), force: force.clone(), is_noisy: false });
        }
        let widths = WIDTHS.into_iter().map(|width| (width, Smooth::new(motor.raw.clone(), sample_s, width)));
        let (width, motor) = widths.into_iter().find(|(_, motor)| is_quiet(motor))?;
        Some(Self { motor, force: Smooth::new(force.raw.clone(), sample_s, width), is_noisy: true })
    }

    /// Mean force in the direction of a motion without a reversal, beside mass and viscous friction: Coulomb friction, or a load.
    fn one_way_n(&self, [mass_kg, viscous]: [f64; 2]) -> f64 {
        let Smooth { acceleration, velocity, .. } = &self.motor;
        let beside = self.force.value.iter().zip(acceleration).zip(velocity);
        let mean_n = numerics::mean(beside.map(|((force_n, a), v)| force_n - mass_kg * a - viscous * v));
        mean_n * numerics::mean(velocity.iter().copied()).signum()
    }
}

fn rigid_with(logs: &[Smoothed], slip_m: f64) -> Option<Solution<3>> {
    let mut regression = Regression::default();
    for Smoothed { motor, force, .. } in logs {
        let aged = |values: &[f64]| delayed_linear(values, FORCE_AGE);
        let (acceleration, velocity) = (aged(&motor.acceleration), aged(&motor.velocity));
        let direction = aged(&direction::of(&motor.value, slip_m));
        let rows = inner(force.value.len());
        regression.add_log(rows.map(|i| ([acceleration[i], direction[i], velocity[i]], force.value[i])));
    }
    regression.solve().or_else(|| without_reversal(&regression))
}

/// The coefficients without Coulomb friction, which a motion in one direction does not show.
fn without_reversal(regression: &Regression<3>) -> Option<Solution<3>> {
    let columns = nalgebra::SMatrix::<f64, 3, 2>::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    let Solution { values: [mass_kg, viscous], rms, left } = regression.combined(&columns).solve()?;
    Some(Solution { values: [mass_kg, 0.0, viscous], rms, left })
}

/// The drive train; `None` without logs of motor and table that show its stretch.
#[must_use]
pub fn elastic(logs: &[&AxisSignals], rigid: &Rigid) -> Option<Elastic> {
    let with_table: Vec<Stretch> = logs.iter().filter_map(|log| Stretch::of(log, rigid.slip_m)).collect();
    let divisions = MOTOR_MASSES.iter().flat_map(|mass| MOTOR_FRICTIONS.map(|friction| [*mass, friction]));
    let solved = divisions.filter_map(|parts| Some((stretched(&with_table, rigid, parts)?, parts)));
    let (Solution { values: [compliance, gap_m, _], rms, .. }, [mass_part, friction_part]) =
        solved.min_by(|(a, _), (b, _)| a.rms.total_cmp(&b.rms))?;
    let backlash_m = Some(2.0 * gap_m).filter(|width_m| *width_m > LEAST_BACKLASH_M.max(rms));
    (compliance > 0.0).then_some(Elastic {
        stiffness_n_per_m: 1.0 / compliance,
        motor_mass_kg: mass_part * rigid.mass_kg,
        motor_coulomb_n: friction_part * rigid.coulomb_n,
        backlash_m,
    })
}

/// Motor and table of a log, with the direction of the friction.
struct Stretch<'a> {
    motor: &'a Smooth,
    table: &'a Smooth,
    direction: Vec<f64>,
}

impl<'a> Stretch<'a> {
    fn of(log: &'a AxisSignals, slip_m: f64) -> Option<Self> {
        let (motor, table) = log.motor.as_ref().zip(log.table.as_ref())?;
        Some(Self { motor, table, direction: direction::of(&motor.value, slip_m) })
    }
}

/// motor − table = compliance·force + half the backlash·sign(force) + a time·velocity, with the force that the screw transmits if these
/// parts of mass and Coulomb friction are the motor's. Where it changes its sign the gap is being crossed: these samples are left out.
fn stretched(
    logs: &[Stretch<'_>],
    rigid: &Rigid,
    [mass_part, friction_part]: [f64; 2],
) -> Option<Solution<3>> {
    let mut regression = Regression::default();
    let least_n = CROSSING * rigid.coulomb_n;
    for Stretch { motor, table, direction } in logs {
        let force_n = |i: usize| {
            (1.0 - mass_part) * rigid.mass_kg * motor.acceleration[i]
                + (1.0 - friction_part) * rigid.coulomb_n * direction[i]
                + rigid.viscous_n_s_per_m * motor.velocity[i]
        };
        let rows =
            inner(motor.value.len()).map(|i| (i, force_n(i))).filter(|(_, force_n)| force_n.abs() > least_n);
        regression.add_log(rows.map(|(i, force_n)| {
            ([force_n, force_n.signum(), motor.velocity[i]], motor.value[i] - table.value[i])
        }));
    }
    regression.solve()
}
