//! The parameters of a fitted law with their keys, units and intervals.

use super::fit::Fit;
use super::map::FrictionMap;
use super::term::{Term, viscous_key};

/// A parameter of a law.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Key in the JSON; it ends with the unit.
    pub key: String,
    /// Value in the unit of the key.
    pub value: f64,
    /// Half width of the 95 % interval; `None` if the parameter was not fitted.
    pub half_width: Option<f64>,
}

/// Coulomb and viscous friction of a law.
#[must_use]
pub fn declared(map: &FrictionMap, fit: &Fit) -> [Parameter; 2] {
    let half_widths = fit.half_widths();
    let (viscous, factor) = viscous_key("viscous", map.unit);
    let parameter = |key: String, i: usize, factor: f64| Parameter {
        key,
        value: factor * fit.law.sizes[i],
        half_width: Some(factor * half_widths[i]),
    };
    [parameter(format!("coulomb_{}", map.unit.force_key()), 0, 1.0), parameter(viscous, 1, factor)]
}

/// The parameters of one term of a law: its size, its shape if it has one, and the constants of its form.
///
/// # Panics
/// If there is no such term.
#[must_use]
pub fn of_term(map: &FrictionMap, fit: &Fit, index: usize) -> Vec<Parameter> {
    let (law, half_widths) = (&fit.law, fit.half_widths());
    let term = law.terms[index];
    let (key, factor) = term.size_key(map.unit);
    let half_width = Some(factor * half_widths[index + 2]);
    let mut all = vec![Parameter { key, value: factor * law.sizes[index + 2], half_width }];
    if let Some(key) = term.shape_key(map.unit) {
        let shapes_before = law.terms[..index].iter().filter(|term| term.parameter_count() == 2).count();
        let value = law.shapes[index];
        // As d(ln x) = dx/x, the half width of x is that of ln x times x.
        let half_width = half_widths.get(law.sizes.len() + shapes_before).map(|half| half * value);
        all.push(Parameter { key, value, half_width });
    }
    let constant = |key: &str, value: f64| Parameter { key: key.to_owned(), value, half_width: None };
    match term {
        Term::Stribeck => all.push(constant("exponent", 2.0)),
        Term::StribeckExponential | Term::StribeckAsymmetry => all.push(constant("exponent", 1.0)),
        Term::Power => all.push(constant(&format!("top_speed_{}", map.unit.speed_key()), law.top_speed)),
        _ => {}
    }
    all
}
