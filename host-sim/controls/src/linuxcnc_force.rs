//! What LinuxCNC can do about friction and masses: lines of the INI file for HAL components that `docs/linuxcnc.md` wires.
//!
//! Of a torque drive, `FORCE_FF1` and `FORCE_FF2` are the viscous friction and the mass, those of a `pid` without feedback. Sliding
//! friction of the table turns over with the travel after a reversal: the output of an `integ` over the planned velocity that ends at ±1
//! and rises by `FRICTION_PER_MM`, times `FRICTION`. That of the motor has the sign of the velocity: the FF1 of another `pid`,
//! `MOTOR_FRICTION_FF1`, with the limit `MOTOR_FRICTION`. Of a drive whose velocity is commanded, friction takes a velocity until its integral part has made
//! up for it: `FRICTION` is that velocity, of which a `lowpass` with the gain `FRICTION_DECAY` takes the past.

use model::axis::Drive;
use plant::equivalent;
use plant::friction_direction::DRIVE_SLIP_M;
use shared::compensate::settings::{ForceModel, Stribeck, TableFriction};

use crate::errors::AxisErrors;

/// Velocity below which friction that has the sign of the velocity is less, mm/s.
const SIGN_WIDTH_MM_S: f64 = 0.2;

/// What the lines need.
pub const WIRING: &str = "the lines of FORCE_ and FRICTION do something only where the HAL file has the components that read them: docs/linuxcnc.md, \"Friction\"";

/// Share of the friction of a velocity drive that turns over in a millimetre, 1/mm: the slip of its trace.
const TURNOVER_PER_MM: f64 = 1e-3 / DRIVE_SLIP_M;

/// The lines of an axis.
#[must_use]
pub fn lines(axis: &AxisErrors<'_>) -> String {
    let Some(force) = axis.compensation.compensation.force.as_ref().filter(|force| force.share > 0.0) else {
        return String::new();
    };
    match axis.declared.controller.drive {
        Drive::Torque => of_torque_drive(force),
        Drive::Velocity => of_velocity_drive(force, axis),
        Drive::Stepper => String::new(),
    }
}

/// In N, mm and s.
fn of_torque_drive(force: &ForceModel) -> String {
    let ForceModel { motor_mass_kg, table_mass_kg, ref friction, share, .. } = *force;
    let (table_n, motor_n) = (table_friction_n(force), force.motor_coulomb_n + rise_n(force.motor_stribeck));
    let stiffness = friction.presliding_stiffness_n_per_m.filter(|_| table_n > 0.0);
    // Without a known presliding all of it has the sign of the velocity.
    let (turning_n, signed_n) =
        if stiffness.is_some() { (table_n, motor_n) } else { (0.0, table_n + motor_n) };
    let per_mm = stiffness.map_or(0.0, |stiffness| 1e-3 * stiffness / table_n);
    let values = [
        ("FORCE_FF1", 1e-3 * share * friction.viscous_n_s_per_m),
        ("FORCE_FF2", 1e-3 * share * (motor_mass_kg + table_mass_kg)),
        ("FRICTION", share * turning_n),
        ("FRICTION_PER_MM", per_mm),
        ("MOTOR_FRICTION", share * signed_n),
        ("MOTOR_FRICTION_FF1", share * signed_n / SIGN_WIDTH_MM_S),
    ];
    values.iter().map(|(key, value)| format!("{key} = {value:.6}\n")).collect()
}

/// Friction of the table at a reversal, which is what `FRICTION` is for, N.
fn table_friction_n(force: &ForceModel) -> f64 {
    let TableFriction { coulomb_n, stribeck, warm_up, .. } = &force.friction;
    coulomb_n + rise_n(*stribeck) + warm_up.as_ref().map_or(0.0, |cold| cold.force_n)
}

fn rise_n(stribeck: Option<Stribeck>) -> f64 {
    stribeck.map_or(0.0, |rise| rise.excess_n)
}

/// The velocity, mm/s, that the gain of the drive's loop turns into the force of the friction: F/m·τ.
fn of_velocity_drive(force: &ForceModel, axis: &AxisErrors<'_>) -> String {
    let friction_m_per_s2 = force.share * force.friction.coulomb_n / equivalent::MOTOR_KG;
    let velocity_mm_s = 1e3 * friction_m_per_s2 * axis.fitted.time_constant_s;
    let decay = 1.0 - libm::exp(-axis.fitted.integral_per_s.max(0.0) * axis.period_s);
    format!(
        "FRICTION = {velocity_mm_s:.6}\nFRICTION_PER_MM = {TURNOVER_PER_MM:.6}\nFRICTION_DECAY = {decay:.6}\n"
    )
}

/// What a loop that is closed on the scale needs.
pub const ON_SCALE: &str = "its loop is closed on the scale: COMP_FILE and BACKLASH may reach only the feed-forward of its pid: docs/linuxcnc.md, \"On a scale\"";

/// An axis with the stretch of its drive under friction in the backlash: the table is behind by it in the direction of motion.
#[must_use]
pub fn with_stretch<'a>(axis: &AxisErrors<'a>) -> AxisErrors<'a> {
    let settings = &axis.compensation.compensation;
    let friction_n = settings.force.as_ref().map_or(0.0, table_friction_n);
    let width_um = 2e6 * friction_n * settings.stretch_m_per_n.unwrap_or(0.0);
    AxisErrors { backlash_um: axis.backlash_um + width_um, ..axis.clone() }
}
