//! Declared effects that a fit leaves as they are.
//!
//! Time and memory of a fit grow with the number n of its parameters: derivatives of each over all samples, and n² products for
//! each block of a log. A calibration table of a screw has hundreds of points, each a parameter that no log of seconds
//! determines. The parameters of the declared effects of an axis are therefore fitted up to a fixed number.

use model::effects::Effect;

/// Largest number of parameters of the declared effects of an axis that are fitted. A file that a trace writes has fewer: a pitch
/// map of 25 knots each way has 47, a friction map 24, the other effects together rarely 20.
pub const MAX_FITTED: usize = 96;

/// Whether each declared effect is held at its declared values: those, in the order of the file, with which the parameters would
/// be more than [`MAX_FITTED`].
#[must_use]
pub fn held(declared: &[Effect]) -> Vec<bool> {
    let mut fitted = 0;
    let is_held = |effect: &Effect| {
        let count = effect.coordinates().len();
        let is_held = fitted + count > MAX_FITTED;
        fitted += if is_held { 0 } else { count };
        is_held
    };
    declared.iter().map(is_held).collect()
}

/// A sentence for each effect of an axis that is held.
pub fn notes<'a>(axis: &'a str, declared: &'a [Effect]) -> impl Iterator<Item = String> + 'a {
    let all = declared.iter().zip(held(declared)).filter(|(_, is_held)| *is_held);
    all.map(move |(effect, _)| {
        let count = effect.coordinates().len();
        format!("{axis}: the declared {} has {count} parameters and is not fitted.", effect.name())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::{ConstantLoad, PitchMap};

    fn map(knots: u32) -> Effect {
        let positions_mm: Vec<f64> = (0..knots).map(f64::from).collect();
        Effect::PitchMap(PitchMap {
            error_um: vec![0.0; positions_mm.len()],
            positions_mm,
            error_negative_um: None,
        })
    }

    /// A map of n knots has n − 2 parameters, as mean and slope are not fitted.
    #[test]
    fn as_many_parameters_are_fitted_as_the_limit_allows() {
        let load = || Effect::ConstantLoad(ConstantLoad { force_n: 1.0 });
        assert_eq!(held(&[map(98)]), [false]);
        assert_eq!(held(&[map(99), load()]), [true, false]);
        assert_eq!(held(&[load(), map(98)]), [false, true]);
        assert_eq!(held(&[map(50), map(50), load()]), [false, false, true]);
        assert_eq!(held(&[]), [] as [bool; 0]);
    }

    #[test]
    fn a_held_effect_is_said() {
        let declared = [map(25), map(300)];
        let notes: Vec<String> = notes("x", &declared).collect();
        assert_eq!(notes, ["x: the declared pitch_map has 298 parameters and is not fitted."]);
    }
}
