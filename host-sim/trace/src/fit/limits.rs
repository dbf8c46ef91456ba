//! Parameters that ended at a limit of their search range.
//!
//! The best value is then outside the range, or the log shows another effect. As the limit is not a measured value, the
//! effect is not added.

use shared::config::Rates;

use model::effects::{Effect, Parameter};

/// An effect with a parameter at a limit of its search range.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterAtLimit {
    /// The fitted effect.
    pub effect: Effect,
    /// The parameter.
    pub parameter: &'static Parameter,
    /// Value in the unit of the parameter.
    pub value: f64,
    /// Limit in the unit of the parameter.
    pub limit: f64,
}

/// The first parameter of an effect that is at a limit of its range, on an axis with these loop rates.
#[must_use]
pub fn of(effect: &Effect, rates: Rates) -> Option<ParameterAtLimit> {
    let coordinates = effect.coordinates_at(rates);
    let at = coordinates.iter().enumerate().find_map(|(j, coordinate)| Some((j, coordinate.limit()?)));
    let (j, limit) = at?;
    // A coordinate may be a function of several parameters. The first parameter that changes with it is reported.
    let moved = |to: f64| {
        let mut values: Vec<f64> = coordinates.iter().map(|coordinate| coordinate.value).collect();
        values[j] = to;
        effect.at(&values).values()
    };
    let inside = coordinates[j].value - coordinates[j].step.copysign(limit);
    let [at_limit, at_inside] = [limit, inside].map(moved);
    let changes = |i: &usize| at_limit[*i].to_bits() != at_inside[*i].to_bits();
    let changed = (0..at_limit.len()).find(changes)?;
    let (parameter, value) = (effect.declared_parameters()[changed], effect.values()[changed]);
    Some(ParameterAtLimit { effect: effect.clone(), parameter, value, limit: at_limit[changed] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::{
        Backlash, Presliding, ResolverDividing, ServoMismatch, Stribeck, VelocityLag, Windup,
    };

    /// The period of the velocity loop is 0.25 ms.
    const RATES: Rates = Rates { velocity_loop_hz: 4000.0, position_loop_divider: 4 };

    fn reported(effect: &Effect) -> Option<(&'static str, f64)> {
        of(effect, RATES).map(|at| {
            assert_eq!(at.effect, *effect);
            (at.parameter.key, at.limit)
        })
    }

    #[test]
    fn a_parameter_at_either_end_of_its_range_is_reported() {
        let gain = |percent| reported(&Effect::ServoMismatch(ServoMismatch { percent }));
        assert_eq!(gain(300.0), Some(("percent", 300.0)));
        assert_eq!(gain(-79.95), Some(("percent", -80.0)));
        // Values within 0.1 % of the limit of 300 are at the limit; 299.6 is 0.13 % away.
        assert_eq!(gain(299.6), None);
        let stribeck = |static_excess_n, velocity_mm_s| {
            reported(&Effect::Stribeck(Stribeck { static_excess_n, velocity_mm_s }))
        };
        assert_eq!(stribeck(100.0, 300.0), Some(("velocity_mm_s", 300.0)));
        assert_eq!(stribeck(100.0, 0.1), Some(("velocity_mm_s", 0.1)));
        assert_eq!(stribeck(100.0, 8.0), None);
    }

    #[test]
    fn velocity_lag_is_limited_by_the_period_of_the_loop() {
        let lag = |ms| reported(&Effect::VelocityLag(VelocityLag { ms }));
        assert_eq!(lag(0.25), Some(("ms", 0.25)));
        assert_eq!(lag(0.2), None);
        // A slower loop has a longer period.
        let slower = Rates { velocity_loop_hz: 1000.0, position_loop_divider: 1 };
        assert_eq!(of(&Effect::VelocityLag(VelocityLag { ms: 0.25 }), slower), None);
    }

    /// The coordinate is a compliance, nm/N, of 1e-2 to 1e6: a stiffness of 1e5 to 1e-3 N/µm.
    #[test]
    fn a_limit_is_reported_in_the_unit_of_its_parameter() {
        let windup = |stiffness_n_per_um| reported(&Effect::Windup(Windup { stiffness_n_per_um }));
        let Some(("stiffness_n_per_um", limit)) = windup(1e5) else { panic!("a limit") };
        assert!((limit / 1e5 - 1.0).abs() < 1e-9, "{limit}");
        assert_eq!(windup(200.0), None);
    }

    #[test]
    fn a_size_of_zero_and_a_bound_of_one_step_are_not_limits() {
        assert_eq!(reported(&Effect::Backlash(Backlash { width_um: 0.0 })), None);
        let harmonic =
            ResolverDividing { amplitude_um: 0.0, period_mm: 5.0, phase_rad: 0.0, fitted_period_mm: None };
        assert_eq!(reported(&Effect::ResolverDividing(harmonic)), None);
        let presliding = Presliding { stiffness_n_per_um: 1e9, damping_n_s_per_m: 0.0 };
        assert_eq!(reported(&Effect::Presliding(presliding)), None);
    }
}
