//! The page of `budget`, and its section on the page of a trace: for each motion a sentence, the causes as bars in µm, and
//! of a circle the picture.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use super::budget_circle;
use budget::text::sentence;
use budget::{Budget, CauseShare, MotionBudget};
use files::format::significant;
use files::output::OutputError;
use pages::markup::{Column, list, note, number_cell, paragraph, section, table, text, words_cell};

/// Length of the longest bar, units of the drawing.
const LONGEST: f64 = 100.0;

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(folder: &Path, budget: &Budget) -> Result<PathBuf, OutputError> {
    pages::write(folder, &html(budget))
}

/// The page. The same result gives the same bytes.
#[must_use]
pub fn html(budget: &Budget) -> String {
    let lead =
        paragraph("What makes each motion wrong at the tool, by how many µm, and what to do about it.");
    pages::render(&format!("Error budget of {}", budget.machine), &lead, &sections(budget))
}

/// A section for each motion, then what is assumed and left out.
#[must_use]
pub fn sections(budget: &Budget) -> Markup {
    let said: Vec<String> =
        budget.assumed.iter().map(plant::equivalent::Assumed::sentence).chain(budget.notes.clone()).collect();
    html! {
        @if let Some((first, others)) = budget.motions.split_first() {
            (section(&heading(first), &of_motion(first)))
            @for motion in others {
                details { summary { (text(&sentence(motion))) } (bars(motion)) (budget_circle::of_motion(motion)) }
            }
        }
        @if !said.is_empty() { (section("Assumed and left out", &list(&said))) }
        (note(
            "The squares of the µm rms, with their signs, add up to that of the whole. Below zero: the cause makes others smaller. \
             A share is half of the mean square that its cause makes alone and that goes away without it. Compensated: the share where the \
             controller compensates everything that it can."
        ))
    }
}

fn heading(motion: &MotionBudget) -> String {
    format!("Error budget: {}", motion.name)
}

fn of_motion(motion: &MotionBudget) -> Markup {
    html! { (paragraph(&sentence(motion))) (bars(motion)) (budget_circle::of_motion(motion)) }
}

/// The table of the causes with their bars.
fn bars(motion: &MotionBudget) -> Markup {
    let (shown, others) = motion.shown();
    let longest_um = motion.causes.iter().map(|cause| cause.share.rms.abs()).fold(1e-12, f64::max);
    let columns = [
        Column::Words("cause"),
        Column::Words(""),
        Column::Numbers("µm rms"),
        Column::Numbers("95 % interval"),
        Column::Numbers("at most"),
        Column::Numbers("G"),
        Column::Numbers("compensated"),
        Column::Words("certainty"),
        Column::Words("what to do"),
    ];
    let rows = html! {
        @for cause in shown { (row(cause, longest_um)) }
    };
    html! {
        (table(&format!("Error budget of the motion {}", motion.name), &columns, &rows))
        @if let Some(others) = &others { (note(others)) }
    }
}

fn row(cause: &CauseShare, longest_um: f64) -> Markup {
    let um = |um: f64| significant(um, 3);
    let interval =
        cause.interval_um.map_or("–".to_owned(), |[from, to]| format!("{} to {}", um(from), um(to)));
    html! {
        tr {
            th scope="row" { (text(&cause.title())) }
            td.share { (bar(cause, longest_um)) }
            (number_cell(&um(cause.share.rms)))
            (number_cell(&interval))
            (number_cell(&um(cause.share.max)))
            (number_cell(&cause.share.circular.map_or("–".to_owned(), um)))
            (number_cell(&cause.compensated.map_or("–".to_owned(), |sizes| um(sizes.rms))))
            td { (cause.certainty.word()) }
            (words_cell(&cause.remedy))
        }
    }
}

/// A bar as long as the share; hollow if it makes others smaller.
fn bar(cause: &CauseShare, longest_um: f64) -> Markup {
    let width = format!("{:.2}", LONGEST * cause.share.rms.abs() / longest_um);
    let class = if cause.share.rms < 0.0 { "left" } else { "taken" };
    html! {
        svg.bar viewBox="0 0 100 10" preserveAspectRatio="none" aria-hidden="true" {
            rect class=(class) x="0" y="1" width=(width) height="8" {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use commissioning::compensate::motions_within::{Travel, standard};
    use model::machine::Machine;

    #[test]
    fn the_page_shows_each_cause_with_its_bar_and_remedy() {
        let text = format!(
            "{}\n[[axis.x.effect]]\nname = 'backlash'\nwidth_um = 12.0\n",
            model::examples::DEMO_MACHINE
        );
        let machine = Machine::parse(&text, "m.toml").unwrap();
        let tests = standard(&Travel::of(&machine));
        let budget = Budget::of(&machine, &tests[..1], 1).unwrap();
        let page = html(&budget);
        assert!(page.contains("backlash of x") && page.contains("compensate: half of the width"), "{page}");
        // One bar for each cause that is shown; the longest is as long as the drawing.
        let shown = budget.motions[0].shown().0.len();
        assert!(shown > 4, "{shown}");
        assert_eq!(page.matches("class=\"bar\"").count(), shown);
        assert_eq!(page.matches("width=\"100.00\"").count(), 1);
        // The circle with all causes, and a choice for each cause that is shown.
        assert_eq!(page.matches("data-division=\"").count(), 1);
        assert_eq!(page.matches("type=\"radio\"").count(), 1 + shown);
        assert!(page.contains("Without backlash of x: G ="), "{page}");
    }
}
