//! Unit: the reading is in another unit than its column says, or wrong by another factor.

use std::borrow::Cow;

use super::channels::{SENSORS, stretches};
use super::fault::{FaultHandling, FaultKind};
use super::findings::{ChannelLocation, Findings};
use crate::input::smoothing::Smooth;
use crate::options::{SampleOptions, TraceOptions};
use files::log::{AxisLog, Channel, Log};
use model::machine::{Axis, Machine};

/// Factors of readings of positions that are those of a unit: inches in a column of mm or mm in one of inches, µm, m, degrees
/// in one of radians and the reverse. Another factor may be any other wrong setting.
const UNITS: [f64; 6] =
    [1.0 / 25.4, 25.4, 1e3, 1e-3, 180.0 / std::f64::consts::PI, std::f64::consts::PI / 180.0];

/// Largest relative deviation of a factor from that of a unit.
const UNIT_TOLERANCE: f64 = 0.005;

/// Largest relative deviation of the factor of a command, which contains the following error.
const COMMAND_TOLERANCE: f64 = 0.35;

/// Force in N per logged force: kN and mN.
const FORCE_UNITS: [f64; 2] = [1e-3, 1e3];

/// Largest ratio, and inverse of the smallest, of the declared to the true force per acceleration and friction.
const FORCE_TOLERANCE: f64 = 2.0;

/// Reports a position channel that moves by a factor of the others. It is converted if the factor is that of a unit.
/// Returns whether it can be used.
pub fn correct(
    values: &mut [f64],
    factor: f64,
    place: &ChannelLocation<'_>,
    findings: &mut Findings,
) -> bool {
    let tolerance = if place.channel == Channel::Command { COMMAND_TOLERANCE } else { UNIT_TOLERANCE };
    let unit = UNITS.into_iter().find(|unit| (factor / unit - 1.0).abs() < tolerance);
    let treatment = if unit.is_some() { FaultHandling::Corrected } else { FaultHandling::Removed };
    findings.faults.push(place.fault(FaultKind::Unit, Some(unit.unwrap_or(factor)), treatment));
    let Some(unit) = unit else { return false };
    for value in values {
        *value /= unit;
    }
    true
}

/// Reports and converts forces in kN or mN, and forces with the wrong sign.
pub fn correct_forces(
    machine: &Machine,
    log: &mut Cow<'_, Log>,
    options: &TraceOptions,
    findings: &mut Findings,
) {
    for axis in 0..log.axes.len() {
        let Some(declared) = machine.axis.get(&log.axes[axis].name) else { continue };
        let Some(factor) = force_factor(declared, &log.axes[axis], log.sample_time_s, &options.samples)
        else {
            continue;
        };
        let fits = |unit: &f64| (1.0 / FORCE_TOLERANCE..FORCE_TOLERANCE).contains(&(factor.abs() / unit));
        let unit = FORCE_UNITS.into_iter().find(fits);
        let place = ChannelLocation { log, axis, channel: Channel::Force };
        let is_reversed = factor < 0.0;
        if is_reversed {
            findings.faults.push(place.fault(FaultKind::Sign, None, FaultHandling::Corrected));
        }
        if let Some(unit) = unit {
            findings.faults.push(place.fault(FaultKind::Unit, Some(unit), FaultHandling::Corrected));
        }
        if is_reversed || unit.is_some() {
            let divisor = unit.unwrap_or(1.0).copysign(factor);
            log.to_mut().axes[axis].force.iter_mut().flatten().for_each(|force| *force /= divisor);
        }
    }
}

/// Ratio of the logged force to that which the declared masses and friction require for the measured motion; `None` if they
/// do not correlate, or if there is nothing to compare.
fn force_factor(declared: &Axis, axis: &AxisLog, sample_s: f64, options: &SampleOptions) -> Option<f64> {
    /// Smallest squared correlation: declared values may be wrong, and friction is simplified.
    const MIN_CORRELATION: f64 = 0.5;
    let mechanics = &declared.settings.mechanics;
    let mass = mechanics.motor_mass_kg.unwrap_or(0.0) + mechanics.table_mass_kg.unwrap_or(0.0);
    let force = axis.force.as_ref()?;
    let positions = SENSORS.into_iter().find_map(|channel| axis.channel(channel))?;
    if mass <= 0.0 {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
    let half = ((options.smoothing_s / sample_s).round() as usize).clamp(2, 50);
    let friction = |velocity: f64| {
        let coulomb =
            mechanics.coulomb_n.unwrap_or(0.0) * (velocity / options.max_standstill_m_per_s).clamp(-1.0, 1.0);
        coulomb + mechanics.viscous_n_s_per_m.unwrap_or(0.0) * velocity
    };
    let (mut logged, mut required, mut velocity) = (Vec::new(), Vec::new(), Vec::new());
    for range in stretches(force.len()) {
        let metres = positions[range.clone()].iter().map(|mm| 1e-3 * mm).collect();
        let motion = Smooth::new(metres, sample_s, half);
        let of_motion = motion.velocity.iter().zip(&motion.acceleration);
        required.extend(of_motion.map(|(v, a)| mass * a + friction(*v)));
        velocity.extend(motion.velocity);
        logged.extend_from_slice(&force[range]);
    }
    let [logged, required, velocity] = [&logged, &required, &velocity].map(|values| {
        let mean = numerics::mean(values.iter().copied());
        values.iter().map(|value| value - mean).collect::<Vec<f64>>()
    });
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (cross, own) = (product(&logged, &required), product(&required, &required));
    let correlation = cross * cross / (own * product(&logged, &logged));
    // Over a motion the drive supplies the work of friction; a spring alone takes as much as it gives.
    let has_sign_of_work = cross * product(&logged, &velocity) > 0.0;
    (correlation > MIN_CORRELATION && (cross > 0.0 || has_sign_of_work)).then(|| cross / own)
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::Unit;

    /// 3 s of an axis of 100 kg with 20 N of friction, its force in N times a factor.
    fn corrected(factor: f64) -> (Findings, Vec<f64>) {
        let text =
            "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ntable_mass_kg = 100.0\ncoulomb_n = 20.0\n";
        let machine = Machine::parse(text, "m.toml").unwrap();
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        let angle = |i: u32| 6e-3 * f64::from(i);
        axis.motor = Some((0..3000).map(|i| 20.0 * angle(i).sin()).collect());
        let newton = |i: u32| 20.0 * angle(i).cos().signum() - 100.0 * 0.02 * 36.0 * angle(i).sin();
        axis.force = Some((0..3000).map(|i| factor * newton(i)).collect());
        let log = Log::new("l", 0.0, 1e-3, [axis]);
        let mut log = Cow::Owned(log);
        let mut findings = Findings::default();
        correct_forces(&machine, &mut log, &TraceOptions::default(), &mut findings);
        (findings, log.into_owned().axes.remove(0).force.unwrap())
    }

    #[test]
    fn kilonewtons_are_converted_and_wrong_masses_are_not() {
        let newtons = corrected(1.0).1;
        for factor in [1.0, 1.8, 3.0, 0.3, 9.81] {
            assert!(corrected(factor).0.faults.is_empty(), "{factor}");
        }
        let (findings, forces) = corrected(1e-3);
        assert_eq!(findings.faults[0].size, Some(1e-3));
        assert!(forces.iter().zip(&newtons).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    /// The force of the drive accelerates the masses in its own direction.
    #[test]
    fn a_force_against_the_acceleration_is_reversed() {
        let newtons = corrected(1.0).1;
        let (findings, forces) = corrected(-1.0);
        assert_eq!(findings.faults.iter().map(|fault| fault.kind).collect::<Vec<_>>(), [FaultKind::Sign]);
        assert!(forces.iter().zip(&newtons).all(|(a, b)| (a - b).abs() < 1e-9));
        let (findings, forces) = corrected(-1e-3);
        assert_eq!(findings.faults.len(), 2);
        assert!(forces.iter().zip(&newtons).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}
