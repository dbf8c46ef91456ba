//! The rounds as sentences, tables and JSON.

use serde_json::{Value, json};

use crate::round::Round;
use commissioning::compensate::prediction::total_rms_um;
use contour::ContourError;
use contour::comparison::{self, Comparison};
use files::format::significant;

/// Why no further round was executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The greatest number of rounds is reached.
    Rounds,
    /// The last round gained no more than chance.
    NothingGained,
    /// The compensation would take a loop below its margins.
    Margins,
    /// The model does not describe the logs of an axis.
    ModelDoesNotFit,
}

impl Stop {
    const fn words(self) -> &'static str {
        match self {
            Self::Rounds => "The greatest number of rounds is reached.",
            Self::NothingGained => {
                "The last round improved no motion by more than the noise, or made a motion worse; its compensation is not kept."
            }
            Self::ModelDoesNotFit => {
                "The model does not describe the logs of an axis; its compensation is not kept. Check the machine file."
            }
            Self::Margins => {
                "The next compensation would take a loop below its margins and was not executed."
            }
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Rounds => "rounds",
            Self::NothingGained => "nothing_gained",
            Self::Margins => "margins",
            Self::ModelDoesNotFit => "model_does_not_fit",
        }
    }
}

/// All rounds.
pub struct Improvement {
    /// Names of the motions whose contour error counts.
    pub motions: Vec<String>,
    /// Their contour errors before the first round, without the error of the probe as far as the last model that fits knows it.
    pub first: Vec<ContourError>,
    /// The rounds.
    pub rounds: Vec<Round>,
    /// Why there is no further one.
    pub stop: Stop,
}

impl Improvement {
    /// The last round whose compensation is kept.
    #[must_use]
    pub fn kept(&self) -> Option<&Round> {
        self.rounds.iter().rev().find(|round| round.is_kept())
    }

    /// Contour errors with the compensation that is kept.
    #[must_use]
    pub fn last(&self) -> &[ContourError] {
        self.kept().map_or(&self.first, |round| &round.after)
    }

    /// Before the first round, as predicted by the round that is kept, and with its compensation; each motion.
    #[must_use]
    pub fn comparisons(&self) -> Vec<(&str, [ContourError; 3])> {
        let Some(kept) = self.kept() else { return Vec::new() };
        let errors = self.first.iter().zip(&kept.predicted).zip(&kept.after);
        let errors = errors.map(|((before, predicted), after)| [before, predicted, after].map(Clone::clone));
        self.motions.iter().map(String::as_str).zip(errors).collect()
    }

    /// A sentence, the rounds, and the motions.
    #[must_use]
    pub fn text(&self) -> String {
        let mut lines = vec![
            self.sentence(),
            String::new(),
            format!(
                "{:>5}{:>12}{:>12}{:>12}{:>8}  found",
                "round", "before µm", "predicted", "after", "kept"
            ),
        ];
        lines.extend((1..).zip(&self.rounds).map(|(number, round)| {
            let [before, predicted, after] = round.totals_um();
            let kept = if round.is_kept() { "yes" } else { "no" };
            let found = round.found_words();
            format!("{number:>5}{before:>12.3}{predicted:>12.3}{after:>12.3}{kept:>8}  {found}")
        }));
        lines.extend([String::new(), self.stop.words().to_owned()]);
        let rows: Vec<Comparison> =
            self.comparisons().iter().map(|(name, errors)| Comparison::new(name, errors)).collect();
        if !rows.is_empty() {
            lines.extend([String::new(), comparison::text(&rows)]);
        }
        lines.join("\n")
    }

    /// How the contour error changed.
    #[must_use]
    pub fn sentence(&self) -> String {
        let [before, after] = [&self.first[..], self.last()].map(total_rms_um);
        let rounds = match self.rounds.iter().filter(|round| round.is_kept()).count() {
            0 => return format!("The contour error stays at {before:.2} µm rms: no compensation is kept."),
            1 => "1 round".to_owned(),
            count => format!("{count} rounds"),
        };
        format!("The contour error changed from {before:.2} to {after:.2} µm rms in {rounds}.")
    }

    /// How the contour error changed, one sentence for each round, and why there is no further one.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        let round = |(number, round): (u32, &Round)| {
            let [before, predicted, after] = round.totals_um().map(|um| significant(um, 3));
            let found = round.found_words();
            let kept = if round.is_kept() { "kept" } else { "not kept" };
            format!(
                "Round {number}: found {found}; {before} µm rms before, {predicted} µm predicted, {after} µm after \
                 ({kept})."
            )
        };
        let rounds = (1..).zip(&self.rounds).map(round);
        [self.sentence()].into_iter().chain(rounds).chain([self.stop.words().to_owned()]).collect()
    }

    /// The JSON of `improve`.
    #[must_use]
    pub fn json(&self) -> Value {
        let [before, after] = [&self.first[..], self.last()].map(total_rms_um);
        let rounds = (1..).zip(&self.rounds).map(|(number, round): (u32, _)| {
            let [before, predicted, after] = round.totals_um();
            json!({
                "round": number,
                "effects": trace::json::effects(&round.trace),
                "verdict": trace::verdict::of(&round.trace),
                "contour_error_um": {"before": before, "predicted": predicted, "after": after},
                "motions": self.motions_json(round),
                "kept": round.is_kept(),
            })
        });
        json!({
            "contour_error_um": {"before": before, "after": after},
            "rounds": rounds.collect::<Vec<_>>(),
            "stopped": self.stop.name(),
        })
    }

    fn motions_json(&self, round: &Round) -> Vec<Value> {
        let errors = round.before.iter().zip(&round.predicted).zip(&round.after);
        let one = |(name, ((before, predicted), after)): (
            &String,
            ((&ContourError, &ContourError), &ContourError),
        )| {
            Comparison::new(name, &[before.clone(), predicted.clone(), after.clone()]).json()
        };
        self.motions.iter().zip(errors).map(one).collect()
    }
}
