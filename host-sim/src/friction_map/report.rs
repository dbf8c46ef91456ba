//! What a map told, for programs and in words.

use serde_json::{Map, Value, json};

use super::FrictionMap;
use super::fit::Fitted;
use super::law::{Term, viscous_key};
use super::search::{AS_GOOD, Errors, Explained, half_widths};
use super::unexplained::Unexplained;
use crate::report::number::{percent, significant, with_spread};

/// A number of a law with its name and the half width of its 95 % interval; without one it was not fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Key in the JSON.
    pub key: String,
    /// Value in the unit that the key says.
    pub value: f64,
    /// Half width.
    pub half_width: Option<f64>,
}

/// Coulomb and viscous friction of a law.
#[must_use]
pub fn declared(map: &FrictionMap, fitted: &Fitted) -> [Parameter; 2] {
    let half = half_widths(fitted);
    let (viscous, factor) = viscous_key("viscous", map.unit);
    let of = |key: String, i: usize, factor: f64| Parameter {
        key,
        value: factor * fitted.law.sizes[i],
        half_width: Some(factor * half[i]),
    };
    [of(format!("coulomb_{}", map.unit.force_key()), 0, 1.0), of(viscous, 1, factor)]
}

/// The numbers of a term of a law.
#[must_use]
pub fn parameters(map: &FrictionMap, fitted: &Fitted, index: usize) -> Vec<Parameter> {
    let (law, half) = (&fitted.law, half_widths(fitted));
    let term = law.terms[index];
    let ((size_key, factor), shape_key) = term.keys(map.unit);
    let size = Parameter {
        key: size_key,
        value: factor * law.sizes[index + 2],
        half_width: Some(factor * half[index + 2]),
    };
    let mut all = vec![size];
    if let Some(key) = shape_key {
        let shaped = law.terms[..index].iter().filter(|term| term.width() == 2).count();
        let shape = law.shapes[index];
        // The interval of a logarithm, taken as one of the number.
        let half_width = half.get(law.sizes.len() + shaped).map(|half| half * shape);
        all.push(Parameter { key, value: shape, half_width });
    }
    let fixed = |key: &str, value: f64| Parameter { key: key.to_owned(), value, half_width: None };
    match term {
        Term::Stribeck => all.push(fixed("exponent", 2.0)),
        Term::StribeckExponential | Term::StribeckAsymmetry => all.push(fixed("exponent", 1.0)),
        Term::Power => all.push(fixed(&format!("top_speed_{}", map.unit.speed_key()), law.top)),
        _ => {}
    }
    all
}

/// How much a found term lowered the error of left-out runs when it was added, percent of their rms.
#[must_use]
pub fn reduction_percent(explained: &Explained, term: Term) -> f64 {
    let rounds = explained.searched.rounds.iter();
    let added = rounds.filter_map(|round| round.added.map(|index| &round.candidates[index]));
    let share = added.into_iter().find(|candidate| candidate.term == term).map_or(0.0, |c| c.reduction);
    100.0 * (1.0 - (1.0 - share).max(0.0).sqrt())
}

/// Terms that left-out runs supported nearly as well as the one that was added: the map does not tell them apart.
/// What the law holds besides is none of them.
#[must_use]
pub fn rivals(explained: &Explained, term: Term) -> Vec<Term> {
    for round in &explained.searched.rounds {
        let Some(added) = round.added.map(|index| &round.candidates[index]) else { continue };
        if added.term != term {
            continue;
        }
        let count = round.candidates.len();
        let near = |c: &&super::search::Candidate| {
            let is_held = explained.searched.fitted.law.terms.iter().any(|held| held.name() == c.term.name());
            !is_held && c.is_supported(count) && 1.0 - c.reduction < AS_GOOD * (1.0 - added.reduction)
        };
        return round.candidates.iter().filter(near).map(|c| c.term).collect();
    }
    Vec::new()
}

/// The JSON of `trace --friction-map`: the shape of `trace --json`, `validate` being the runs left out.
#[must_use]
pub fn json(map: &FrictionMap, explained: &Explained, rest: Option<&Unexplained>) -> Value {
    let unit = map.unit.force_key();
    let keyed = |entries: Vec<(String, Value)>| Value::Object(entries.into_iter().collect());
    let errors = |e: &Errors| json!({"fit": e.fit, "validate": e.left_out, "ranges": e.ranges_left_out});
    let values = |all: &[Parameter]| -> Value {
        let one = |p: &Parameter| {
            let mut entry = Map::new();
            entry.insert("value".to_owned(), json!(p.value));
            if let Some(half) = p.half_width {
                entry.insert("ci95".to_owned(), json!([p.value - half, p.value + half]));
            }
            (p.key.clone(), Value::Object(entry))
        };
        keyed(all.iter().map(one).collect())
    };
    let fitted = &explained.searched.fitted;
    let effects: Vec<Value> = fitted
        .law
        .terms
        .iter()
        .enumerate()
        .map(|(i, &term)| {
            json!({
                "name": term.name(),
                "axis": AXIS,
                "channel": "force",
                "parameters": values(&parameters(map, fitted, i)),
                "validate_reduction_percent": reduction_percent(explained, term),
                "as_good": rivals(explained, term).into_iter().map(Term::name).collect::<Vec<_>>(),
            })
        })
        .collect();
    let residual = keyed(vec![
        ("channel".to_owned(), json!("force")),
        ("axis".to_owned(), json!(AXIS)),
        ("unit".to_owned(), json!(unit)),
        (format!("before_{unit}"), errors(&explained.before)),
        (format!("after_{unit}"), errors(&explained.after)),
        (format!("noise_{unit}"), json!(map.noise())),
        (format!("within_run_{unit}"), json!(map.ripple())),
    ]);
    let unexplained = rest.map(|rest| {
        keyed(vec![
            ("channel".to_owned(), json!("force")),
            ("axis".to_owned(), json!(AXIS)),
            (format!("rms_{unit}"), json!(rest.rms)),
            ("share_percent".to_owned(), json!(rest.share_percent)),
            ("variable".to_owned(), json!(rest.variable)),
        ])
    });
    let not_testable: Vec<Value> = explained
        .not_testable
        .iter()
        .map(|(term, needs)| json!({"channel": "force", "axis": AXIS, "effect": term.name(), "needs": needs}))
        .collect();
    json!({
        "residual": [residual],
        "declared": values(&declared(map, &explained.searched.declared)),
        "fitted": values(&declared(map, fitted)),
        "effects": effects,
        "unexplained": unexplained.into_iter().collect::<Vec<_>>(),
        "not_testable": not_testable,
        "runs": map.runs.len(),
        "runs_at_standstill": map.standing,
    })
}

/// A map has no machine and so no name of an axis.
const AXIS: &str = "map";

/// One sentence for each term found, or one that says that there is none; then what became of the declared law.
#[must_use]
pub fn sentences(map: &FrictionMap, explained: &Explained) -> Vec<String> {
    let fitted = &explained.searched.fitted;
    let mut said: Vec<String> = Vec::new();
    for (i, &term) in fitted.law.terms.iter().enumerate() {
        let numbers = words(map, term, &parameters(map, fitted, i));
        let gain = percent(reduction_percent(explained, term));
        let mut sentence = format!("{numbers}; takes away {gain} of the error of runs left out.");
        let rivals = rivals(explained, term);
        if !rivals.is_empty() {
            let names: Vec<&str> = rivals.iter().map(|term| term.meaning()).collect();
            sentence += &format!(" The runs do not tell it from: {}.", names.join("; "));
        }
        said.push(sentence);
    }
    if said.is_empty() {
        said.push("Nothing found beside Coulomb and viscous friction, the same both ways.".to_owned());
    }
    let [coulomb, viscous] = declared(map, fitted);
    let spread = |p: &Parameter| with_spread(p.value, p.half_width.unwrap_or(0.0));
    said.push(format!(
        "With that, Coulomb friction is {} {} and viscous friction {} {}.",
        spread(&coulomb),
        map.unit.force(),
        spread(&viscous),
        match map.unit {
            super::Unit::Rotary => "mN·m per rpm",
            super::Unit::Linear => "N·s/m",
        }
    ));
    said
}

/// What a term is, with its numbers.
fn words(map: &FrictionMap, term: Term, numbers: &[Parameter]) -> String {
    let (force, speed) = (map.unit.force(), map.unit.speed());
    let spread = |i: usize| {
        let number = numbers.get(i);
        number.map_or_else(String::new, |p| with_spread(p.value, p.half_width.unwrap_or(0.0)))
    };
    let size = || {
        let number = numbers.first();
        number.map_or_else(String::new, |p| with_spread(p.value.abs(), p.half_width.unwrap_or(0.0)))
    };
    let [more, less] =
        if numbers.first().is_some_and(|p| p.value < 0.0) { ["−", "+"] } else { ["+", "−"] };
    let viscous = match map.unit {
        super::Unit::Rotary => "mN·m per rpm",
        super::Unit::Linear => "N·s/m",
    };
    match term {
        Term::ConstantLoad => format!(
            "A constant load of {} {force} against motion in {more} direction (Coulomb friction that is so much higher \
             in {more} than in {less} direction would be the same)",
            size()
        ),
        Term::FrictionAsymmetry => format!(
            "Viscous friction is {} {viscous} higher in {more} direction and as much lower in {less} direction",
            size()
        ),
        Term::Stribeck | Term::StribeckExponential => {
            let form = if term == Term::Stribeck { "exp(−(v/vs)²)" } else { "exp(−|v|/vs)" };
            format!(
                "Stribeck friction: it rises by {} {force} towards standstill, as {form} with vs = {} {speed}",
                spread(0),
                spread(1)
            )
        }
        Term::StribeckAsymmetry => format!(
            "The rise towards standstill is {} {force} higher in {more} direction and as much lower in {less} \
             direction, below {} {speed}",
            size(),
            spread(1)
        ),
        Term::Quadratic => {
            let unit = if map.unit == super::Unit::Rotary { "mN·m per rpm²" } else { "N·s²/m²" };
            format!("Friction grows with the square of speed, by {} {unit}", spread(0))
        }
        Term::Power => format!(
            "Friction grows with speed to the power {}, to {} {force} at {} {speed}",
            spread(1),
            spread(0),
            numbers.get(2).map_or_else(String::new, |p| significant(p.value, 4))
        ),
        Term::Saturating => format!(
            "Friction rises by {} {force} and saturates, as tanh(|v|/vs) with vs = {} {speed}",
            spread(0),
            spread(1)
        ),
        Term::Logarithmic => format!(
            "Friction rises as {} {force} · ln(1 + |v|/vs) with vs = {} {speed}",
            spread(0),
            spread(1)
        ),
    }
}

/// What stays, and what could not be looked for.
#[must_use]
pub fn remainder(map: &FrictionMap, explained: &Explained, rest: Option<&Unexplained>) -> Vec<String> {
    let force = map.unit.force();
    let mut said = Vec::new();
    let noise = map.noise().map(|noise| significant(noise, 3));
    if let Some(rest) = rest {
        let share = percent(rest.share_percent);
        let follows = match rest.variable {
            "velocity" => format!("{share} of its power goes slowly with the velocity"),
            "time" => format!("{share} of its power goes slowly with the order of the runs"),
            _ => "runs at neighbouring speeds share none of it beyond chance".to_owned(),
        };
        let beside = noise.map_or_else(
            || "the file does not say how certain its means are".to_owned(),
            |noise| format!("the standard error of a run's mean is {noise} {force}"),
        );
        said.push(format!("{} {force} rms stay, where {beside}; {follows}.", significant(rest.rms, 3)));
    } else if let Some(noise) = noise {
        said.push(format!("What stays is the standard error of the runs' means ({noise} {force})."));
    }
    if let Some(ripple) = map.ripple() {
        said.push(format!(
            "Within a run the {} swings by {} {force} rms, ripple and noise together; a mean does not show what it \
             follows.",
            map.unit.drive(),
            significant(ripple, 3)
        ));
    }
    if map.standing > 0 {
        let what = if map.standing == 1 {
            "1 run at speed 0 was"
        } else {
            &format!("{} runs at speed 0 were", map.standing)
        };
        said.push(format!("{what} left out: at standstill friction is whatever the drive asks of it."));
    }
    for (term, needs) in &explained.not_testable {
        said.push(format!("{}: could not be tested; it needs {needs}.", term.meaning()));
    }
    for term in &explained.searched.dropped {
        said.push(format!("{}: added at first, no longer needed with what came later.", term.meaning()));
    }
    said
}

/// The errors as a table.
#[must_use]
pub fn table(map: &FrictionMap, explained: &Explained) -> Vec<String> {
    let row = |name: &str, e: &Errors| {
        let cell =
            |value: f64| if value.is_nan() { format!("{:>16}", "–") } else { format!("{value:>16.4}") };
        format!("{name:<32}{}{}{}", cell(e.fit), cell(e.left_out), cell(e.ranges_left_out))
    };
    let unit = map.unit.force();
    let noise = map.noise().map_or_else(|| "–".to_owned(), |noise| format!("{noise:.4}"));
    vec![
        format!(
            "{:<32}{:>16}{:>16}{:>16}",
            format!("error, {unit} rms"),
            "runs fitted",
            "runs left out",
            "ranges left out"
        ),
        row("Coulomb and viscous friction", &explained.before),
        row("with what was found", &explained.after),
        format!("{:<32}{noise:>16}", "standard error of a mean"),
    ]
}
