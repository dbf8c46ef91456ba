//! The result of a friction map in sentences, and its errors as a table.

use friction_map::explain::{Errors, Explanation};
use friction_map::map::{FrictionMap, Unit};
use friction_map::parameters::{Parameter, declared, of_term};
use friction_map::residual_analysis::Residual;
use friction_map::term::Term;

use files::format::{percent, significant, with_spread};

/// One sentence for each selected term, or one sentence that there is none, then one on Coulomb and viscous friction.
#[must_use]
pub fn sentences(map: &FrictionMap, explanation: &Explanation) -> Vec<String> {
    let fitted = &explanation.selection.fitted;
    let terms = fitted.law.terms.iter().enumerate();
    let mut sentences: Vec<String> =
        terms.map(|(i, &term)| of_selected(map, explanation, term, &of_term(map, fitted, i))).collect();
    if sentences.is_empty() {
        sentences.push(
            "No term found in addition to Coulomb and viscous friction, equal in both directions.".to_owned(),
        );
    }
    let [coulomb, viscous] = declared(map, fitted);
    sentences.push(format!(
        "Coulomb friction is then {} {} and viscous friction {} {}.",
        value(&coulomb),
        map.unit.force(),
        value(&viscous),
        map.unit.viscous()
    ));
    sentences
}

fn of_selected(map: &FrictionMap, explanation: &Explanation, term: Term, parameters: &[Parameter]) -> String {
    let of_term = if term.is_directional() {
        directional(map.unit, term, parameters)
    } else {
        symmetric(map.unit, term, parameters)
    };
    let gain = percent(explanation.reduction_percent(term));
    let sentence = format!("{of_term}; reduces the error of left-out runs by {gain}.");
    let others: Vec<&str> = explanation.equally_good(term).into_iter().map(Term::description).collect();
    if others.is_empty() {
        return sentence;
    }
    format!("{sentence} The runs do not distinguish it from: {}.", others.join("; "))
}

/// A value with its interval, without its unit.
fn value(parameter: &Parameter) -> String {
    with_spread(parameter.value, parameter.half_width.unwrap_or(0.0))
}

/// Value with unit of the parameter at an index; empty if there is none.
fn value_at(parameters: &[Parameter], index: usize) -> String {
    parameters.get(index).map_or_else(String::new, value)
}

/// A term of either sign, with its magnitude and the direction in which friction is higher.
fn directional(unit: Unit, term: Term, parameters: &[Parameter]) -> String {
    let force = unit.force();
    let size = parameters
        .first()
        .map_or_else(String::new, |p| value(&Parameter { value: p.value.abs(), ..p.clone() }));
    let is_negative = parameters.first().is_some_and(|p| p.value < 0.0);
    let [more, less] = if is_negative { ["−", "+"] } else { ["+", "−"] };
    match term {
        Term::FrictionAsymmetry => format!(
            "Viscous friction is {size} {} higher in the {more} direction, and lower by the same amount in the \
             {less} direction",
            unit.viscous()
        ),
        Term::StribeckAsymmetry => format!(
            "The rise towards standstill is {size} {force} higher in the {more} direction, and lower by the same \
             amount in the {less} direction, below {} {}",
            value_at(parameters, 1),
            unit.speed()
        ),
        _ => format!(
            "A constant load of {size} {force} against motion in the {more} direction (equivalent to Coulomb \
             friction that is higher by this amount in the {more} direction and lower by it in the {less} \
             direction)"
        ),
    }
}

/// A term that is the same in both directions.
fn symmetric(unit: Unit, term: Term, parameters: &[Parameter]) -> String {
    let (force, speed) = (unit.force(), unit.speed());
    let [size, shape] = [0, 1].map(|index| value_at(parameters, index));
    match term {
        Term::Quadratic => {
            let unit = if unit == Unit::Rotary { "mN·m per rpm²" } else { "N·s²/m²" };
            format!("Friction grows with the square of speed, by {size} {unit}")
        }
        Term::Power => format!(
            "Friction grows with speed to the power {shape}, to {size} {force} at {} {speed}",
            parameters.get(2).map_or_else(String::new, |p| significant(p.value, 4))
        ),
        Term::Saturating => format!(
            "Friction rises by {size} {force} and saturates, as tanh(|v|/vs) with vs = {shape} {speed}"
        ),
        Term::Logarithmic => {
            format!("Friction rises as {size} {force} · ln(1 + |v|/vs) with vs = {shape} {speed}")
        }
        _ => {
            let form = if term == Term::Stribeck { "exp(−(v/vs)²)" } else { "exp(−|v|/vs)" };
            format!(
                "Stribeck friction: it rises by {size} {force} towards standstill, as {form} with vs = {shape} {speed}"
            )
        }
    }
}

/// What remains unexplained, what could not be tested, and what was dropped.
#[must_use]
pub fn unexplained(map: &FrictionMap, explanation: &Explanation, residual: Option<&Residual>) -> Vec<String> {
    let force = map.unit.force();
    let standard_error = map.standard_error().map(|error| significant(error, 3));
    let mut sentences = Vec::new();
    match (residual, standard_error) {
        (Some(residual), error) => sentences.push(of_residual(force, residual, error)),
        (None, Some(error)) => {
            sentences.push(format!(
                "The remaining residual is at the level of the standard error of the runs' means \
                                    ({error} {force})."
            ));
        }
        (None, None) => {}
    }
    if let Some(deviation) = map.deviation_within_runs() {
        sentences.push(format!(
            "Within a run the {} varies by {} {force} rms, ripple and noise together; a mean does not show on what \
             this variation depends.",
            map.unit.drive(),
            significant(deviation, 3)
        ));
    }
    if map.standstill_runs > 0 {
        let runs = match map.standstill_runs {
            1 => "1 run at speed 0 was".to_owned(),
            count => format!("{count} runs at speed 0 were"),
        };
        sentences.push(format!("{runs} left out: at standstill the friction equals the drive force."));
    }
    for (term, needs) in &explanation.not_testable {
        sentences.push(format!("{}: could not be tested; required: {needs}.", term.description()));
    }
    for term in &explanation.selection.dropped {
        let term = term.description();
        sentences
            .push(format!("{term}: added at first, then dropped because later terms made it unnecessary."));
    }
    sentences
}

fn of_residual(force: &str, residual: &Residual, standard_error: Option<String>) -> String {
    let slow = percent(residual.slow_percent);
    let variable = match residual.variable {
        "velocity" => format!("{slow} of its power varies slowly with the velocity"),
        "time" => format!("{slow} of its power varies slowly with the order of the runs"),
        _ => "no significant correlation between runs at neighbouring speeds".to_owned(),
    };
    let noise = standard_error.map_or_else(
        || "the file does not contain the standard errors of the means".to_owned(),
        |error| format!("the standard error of a run's mean is {error} {force}"),
    );
    format!("Remaining residual {} {force} rms; {noise}; {variable}.", significant(residual.rms, 3))
}

/// The rms errors of both laws as a table of fixed width, one line an element.
#[must_use]
pub fn error_table(map: &FrictionMap, explanation: &Explanation) -> Vec<String> {
    let row = |name: &str, e: &Errors| {
        let cell =
            |value: f64| if value.is_nan() { format!("{:>16}", "–") } else { format!("{value:>16.4}") };
        format!("{name:<32}{}{}{}", cell(e.fit), cell(e.left_out), cell(e.ranges_left_out))
    };
    let heading = format!("error, {} rms", map.unit.force());
    let standard_error = map.standard_error().map_or_else(|| "–".to_owned(), |error| format!("{error:.4}"));
    vec![
        format!("{heading:<32}{:>16}{:>16}{:>16}", "runs fitted", "runs left out", "ranges left out"),
        row("Coulomb and viscous friction", &explanation.before),
        row("with what was found", &explanation.after),
        format!("{:<32}{standard_error:>16}", "standard error of a mean"),
    ]
}
