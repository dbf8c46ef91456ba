//! Choices of other curves for a circle beside them, which the script of the page shows and acts on.

use maud::{Markup, html};

use super::markup::text;

/// The start of a group of choices, by which the page knows that it has one.
pub(super) const MARK: &str = "<fieldset class=\"choices\"";

/// The choices under their heading; the first is the picture as it is. Without scripts there is nothing to choose, so that it is hidden.
#[must_use]
pub fn one_of(heading: &str, own: &str, said_of_own: &str, choices: &[Markup]) -> Markup {
    html! {
        fieldset.choices hidden {
            legend { (text(heading)) }
            label { input type="radio" checked data-said=(text(said_of_own)); " " (text(own)) }
            @for choice in choices { (choice) }
            output { (text(said_of_own)) }
        }
    }
}

/// A choice: its words, what is said of it when it is chosen, and the figures of its curves (see [`super::polar::figures`]).
#[must_use]
pub fn choice(label: &str, said: &str, figures: &str) -> Markup {
    html! { label { input type="radio" data-said=(text(said)) data-figures=(figures); " " (text(label)) } }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_hidden_without_a_script_and_their_words_are_text() {
        let choices = one_of("a<", "all", "b<", &[choice("c<", "d<", "x, 1\ny\n0 0")]);
        assert!(choices.0.starts_with(&format!("{MARK} hidden><legend>a&lt;</legend>")), "{}", choices.0);
        assert!(
            choices.0.contains("data-said=\"d&lt;\" data-figures=\"x, 1\ny\n0 0\"> c&lt;</label>"),
            "{}",
            choices.0
        );
        assert_eq!(choices.0.matches(" checked ").count(), 1);
    }
}
