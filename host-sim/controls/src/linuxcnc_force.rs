//! What LinuxCNC can do about friction and masses: lines of the INI file for HAL components that `docs/linuxcnc.md` wires.
//!
//! Of a torque drive, `FORCE_FF1` and `FORCE_FF2` are the viscous friction and the mass, those of a `pid` without feedback. Sliding
//! friction turns over with the travel after a reversal: the output of an `integ` over the planned velocity that ends at ±1 and rises by
//! `FRICTION_PER_MM`, times `FRICTION`. Of a drive whose velocity is commanded, friction takes a velocity until its integral part has made
//! up for it: `FRICTION` is that velocity, of which a `lowpass` with the gain `FRICTION_DECAY` takes the past.

use std::fmt::Write;

use model::axis::Drive;
use plant::equivalent;
use shared::compensate::settings::ForceModel;

use crate::errors::AxisErrors;

/// What the lines need.
pub const WIRING: &str = "FORCE_FF1, FORCE_FF2 and FRICTION do something only where the HAL file has the components that read them: docs/linuxcnc.md, \"Friction\".";

/// Share of the friction that turns over in a millimetre where no presliding is known, 1/mm: as in the trace of a velocity drive, 5 µm.
const TURNOVER_PER_MM: f64 = 200.0;

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
    let ForceModel { motor_mass_kg, table_mass_kg, motor_coulomb_n, ref friction, share, .. } = *force;
    let per_mm = friction
        .presliding_stiffness_n_per_m
        .filter(|_| friction.coulomb_n > 0.0)
        .map_or(TURNOVER_PER_MM, |stiffness| 1e-3 * stiffness / friction.coulomb_n);
    let mut lines = String::new();
    let values = [
        ("FORCE_FF1", 1e-3 * share * friction.viscous_n_s_per_m),
        ("FORCE_FF2", 1e-3 * share * (motor_mass_kg + table_mass_kg)),
        ("FRICTION", share * (friction.coulomb_n + motor_coulomb_n)),
        ("FRICTION_PER_MM", per_mm),
    ];
    for (key, value) in values {
        let _ = writeln!(lines, "{key} = {value:.6}");
    }
    lines
}

/// The velocity, mm/s, that the gain of the drive's loop turns into the force of the friction: F/m·τ.
fn of_velocity_drive(force: &ForceModel, axis: &AxisErrors<'_>) -> String {
    let friction_m_per_s2 = force.share * force.motor_coulomb_n / equivalent::MOTOR_KG;
    let velocity_mm_s = 1e3 * friction_m_per_s2 * axis.fitted.time_constant_s;
    let decay = 1.0 - (-axis.fitted.integral_per_s.max(0.0) * axis.period_s).exp();
    format!(
        "FRICTION = {velocity_mm_s:.6}\nFRICTION_PER_MM = {TURNOVER_PER_MM:.6}\nFRICTION_DECAY = {decay:.6}\n"
    )
}

/// An axis with the stretch of its drive under friction in the backlash: the table is behind by it in the direction of motion.
#[must_use]
pub fn with_stretch<'a>(axis: &AxisErrors<'a>) -> AxisErrors<'a> {
    let settings = &axis.compensation.compensation;
    let coulomb_n = settings.force.as_ref().map_or(0.0, |force| force.friction.coulomb_n);
    let width_um = 2e6 * coulomb_n * settings.stretch_m_per_n.unwrap_or(0.0);
    AxisErrors { backlash_um: axis.backlash_um + width_um, ..axis.clone() }
}
