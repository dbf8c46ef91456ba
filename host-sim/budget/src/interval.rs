//! What the uncertainty of a cause's values makes of its share.
//!
//! A displacement is proportional to the size of its cause: the width of a gap, the amplitude of a wave, the values of a map. Its share is
//! as uncertain as that, relatively. Where an effect has no such value, as a mode of the tool, all its values count. What a simulated
//! machine itself is wrong by is added.

use model::effects::{Effect, Unit};
use model::machine::Machine;

use crate::cause::Cause;

/// Relative error of a share by the simulation itself: the whole of the machines of another simulator is within it (tests `budget::`).
pub const OF_SIMULATION: f64 = 0.05;

/// Relative half width of the 95 % interval of a cause's share; `None`: unknown.
#[must_use]
pub fn of(cause: &Cause, machine: &Machine) -> Option<f64> {
    of_size(cause, machine).map(|relative| libm::hypot(relative, OF_SIMULATION))
}

fn of_size(cause: &Cause, machine: &Machine) -> Option<f64> {
    let tolerance = |axis: usize, key: &str| {
        let tolerance = machine.axis[axis].settings.tolerance(key);
        (tolerance > 0.0).then_some(tolerance)
    };
    match *cause {
        Cause::Effect(axis, effect) => {
            let half_widths = &cause.evidence(machine)?.half_widths;
            of_effect(&machine.axis[axis].effect[effect], half_widths)
        }
        Cause::Friction(axis) => tolerance(axis, "coulomb_n"),
        Cause::Stiffness(axis) => tolerance(axis, "stiffness_n_per_um"),
        Cause::FollowingLag
        | Cause::GainDifference
        | Cause::Unexplained(_)
        | Cause::Noise
        | Cause::Quantisation => None,
    }
}

fn of_effect(effect: &Effect, half_widths: &[f64]) -> Option<f64> {
    let values = effect.values();
    let parameters = effect.declared_parameters();
    let is_size = |unit: Unit| {
        !matches!(
            unit,
            Unit::Millimetre
                | Unit::MillimetrePerSecond
                | Unit::Second
                | Unit::Hertz
                | Unit::Radian
                | Unit::One
        )
    };
    let relative = |is_counted: &dyn Fn(Unit) -> bool| {
        let counted =
            || parameters.iter().zip(&values).zip(half_widths).filter(|((p, _), _)| is_counted(p.unit));
        let squares =
            |of: fn(f64, f64) -> f64| counted().map(|((_, v), half)| of(*v, *half).powi(2)).sum::<f64>();
        let (size, half) = (squares(|value, _| value), squares(|_, half| half));
        (size > 0.0 && half > 0.0).then(|| (half / size).sqrt())
    };
    relative(&is_size).or_else(|| relative(&|_| true))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn relative(effect: &str, half_widths: &[f64]) -> Option<f64> {
        let text = format!(
            "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\nlead_mm = 10.0\ntable_mass_kg = 10.0\n[[axis.x.effect]]\n{effect}"
        );
        let machine = Machine::parse(&text, "m.toml").unwrap();
        of_effect(&machine.axis["x"].effect[0], half_widths)
    }

    #[test]
    fn a_share_is_as_uncertain_as_the_size_of_its_cause() {
        let is = |value: Option<f64>, expected: f64| (value.unwrap() - expected).abs() < 1e-12;
        assert!(is(relative("name = 'backlash'\nwidth_um = 12.0", &[0.6]), 0.05));
        // Neither period nor phase change the size of a wave.
        let wave = "name = 'pitch_cyclic'\namplitude_um = 4.0\nperiod_mm = 10.0\nphase_rad = 1.0";
        assert!(is(relative(wave, &[0.4, 0.0, 0.5]), 0.1));
        // A map of knots ±3 and ±4 µm, each ± 0.5 µm: √(2·0.25)/√(9 + 16).
        let map = "name = 'pitch_map'\npositions_mm = [0.0, 10.0]\nerror_um = [3.0, -4.0]";
        assert!(is(relative(map, &[0.0, 0.0, 0.5, 0.5]), 0.5 * 2_f64.sqrt() / 5.0));
        assert_eq!(relative("name = 'backlash'\nwidth_um = 12.0", &[]), None);
    }
}
