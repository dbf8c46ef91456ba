//! What a friction map told, in sentences and as a table.

use trace::friction_map::json::{Parameter, declared, parameters, reduction_percent, rivals};
use trace::friction_map::law::Term;
use trace::friction_map::search::{Errors, Explained};
use trace::friction_map::unexplained::Unexplained;
use trace::friction_map::{FrictionMap, Unit};

use crate::number::{percent, significant, with_spread};

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
            Unit::Rotary => "mN·m per rpm",
            Unit::Linear => "N·s/m",
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
        Unit::Rotary => "mN·m per rpm",
        Unit::Linear => "N·s/m",
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
            let unit = if map.unit == Unit::Rotary { "mN·m per rpm²" } else { "N·s²/m²" };
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
