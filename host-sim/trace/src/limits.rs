//! Parameters that a fit drove to the limit of their search.
//!
//! The value that fits best then lies beyond the range, or the effect is another one than the log's. Either way the limit
//! is none of the machine's figures: the effect is not taken.

use shared::config::Rates;

use super::axis_model::AxisModel;
use super::search::Round;
use model::effects::{Effect, Parameter};

/// An effect of which a parameter stands at a limit of its search.
#[derive(Clone, Debug, PartialEq)]
pub struct AtLimit {
    /// The effect as it was fitted.
    pub effect: Effect,
    /// The parameter.
    pub parameter: &'static Parameter,
    /// Its value, in its unit.
    pub value: f64,
    /// The limit, in the same unit.
    pub limit: f64,
}

/// The first parameter of an effect that stands at a limit, on an axis with these loops.
#[must_use]
pub fn of(effect: &Effect, rates: Rates) -> Option<AtLimit> {
    let coordinates = effect.coordinates_at(rates);
    let at = coordinates.iter().enumerate().find_map(|(j, coordinate)| Some((j, coordinate.limit()?)));
    let (j, limit) = at?;
    // A coordinate is not always a parameter: of those it shapes the first is told.
    let moved = |to: f64| {
        let mut values: Vec<f64> = coordinates.iter().map(|coordinate| coordinate.value).collect();
        values[j] = to;
        effect.at(&values).values()
    };
    let inside = coordinates[j].value - coordinates[j].step.copysign(limit);
    let [there, elsewhere] = [limit, inside].map(moved);
    let is_shaped = |i: &usize| there[*i].to_bits() != elsewhere[*i].to_bits();
    let shaped = (0..there.len()).find(is_shaped)?;
    let (parameter, value) = (&effect.declared_parameters()[shaped], effect.values()[shaped]);
    Some(AtLimit { effect: effect.clone(), parameter, value, limit: there[shaped] })
}

/// The effects that the last round of a search would have taken, were it not for a limit.
#[must_use]
pub fn refused(rounds: &[Round]) -> Vec<AtLimit> {
    let last = rounds.iter().filter(|round| round.added.is_none());
    let candidates = last.flat_map(|round| &round.candidates).filter(|candidate| candidate.stands_out());
    candidates.filter_map(|candidate| candidate.limit.clone()).collect()
}

/// The first found effect of a model that stands at a limit: its index and the limit.
#[must_use]
pub fn first(model: &AxisModel) -> Option<(usize, AtLimit)> {
    (0..model.found().len()).find_map(|index| Some((index, model.at_limit(index)?)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::{
        Backlash, Presliding, ResolverDividing, ServoMismatch, Stribeck, VelocityLag, Windup,
    };

    /// A velocity loop every quarter of a millisecond.
    const RATES: Rates = Rates { velocity_loop_hz: 4000.0, position_loop_divider: 4 };

    fn told(effect: &Effect) -> Option<(&'static str, f64)> {
        of(effect, RATES).map(|at| {
            assert_eq!(at.effect, *effect);
            (at.parameter.key, at.limit)
        })
    }

    #[test]
    fn a_parameter_at_either_end_of_its_search_is_named() {
        let gain = |percent| told(&Effect::ServoMismatch(ServoMismatch { percent }));
        assert_eq!(gain(80.0), Some(("percent", 80.0)));
        assert_eq!(gain(-79.95), Some(("percent", -80.0)));
        // Nearer than a per mille of 80 is a limit, farther is not.
        assert_eq!(gain(79.9), None);
        let stribeck = |static_excess_n, velocity_mm_s| {
            told(&Effect::Stribeck(Stribeck { static_excess_n, velocity_mm_s }))
        };
        assert_eq!(stribeck(100.0, 300.0), Some(("velocity_mm_s", 300.0)));
        assert_eq!(stribeck(100.0, 0.1), Some(("velocity_mm_s", 0.1)));
        assert_eq!(stribeck(100.0, 8.0), None);
    }

    #[test]
    fn the_age_of_a_speed_is_limited_by_the_loop() {
        let lag = |ms| told(&Effect::VelocityLag(VelocityLag { ms }));
        assert_eq!(lag(0.25), Some(("ms", 0.25)));
        assert_eq!(lag(0.2), None);
        // A slower loop may see an older speed.
        let slower = Rates { velocity_loop_hz: 1000.0, position_loop_divider: 1 };
        assert_eq!(of(&Effect::VelocityLag(VelocityLag { ms: 0.25 }), slower), None);
    }

    /// The coordinate is a compliance, nm/N, of 1e-2 to 1e6: a stiffness of 1e5 to 1e-3 N/µm.
    #[test]
    fn a_limit_is_told_in_the_unit_of_its_parameter() {
        let windup = |stiffness_n_per_um| told(&Effect::Windup(Windup { stiffness_n_per_um }));
        let Some(("stiffness_n_per_um", limit)) = windup(1e5) else { panic!("a limit") };
        assert!((limit / 1e5 - 1.0).abs() < 1e-9, "{limit}");
        assert_eq!(windup(200.0), None);
    }

    #[test]
    fn a_size_of_zero_and_a_bound_of_one_step_are_no_limits() {
        assert_eq!(told(&Effect::Backlash(Backlash { width_um: 0.0 })), None);
        let harmonic = ResolverDividing { amplitude_um: 0.0, period_mm: 5.0, phase_rad: 0.0 };
        assert_eq!(told(&Effect::ResolverDividing(harmonic)), None);
        let presliding = Presliding { stiffness_n_per_um: 1e9, damping_n_s_per_m: 0.0 };
        assert_eq!(told(&Effect::Presliding(presliding)), None);
    }
}
