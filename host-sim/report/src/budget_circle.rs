//! The circle of an error budget: its radial deviation with all causes, and at a choice without one of them.

use maud::{Markup, html};

use budget::radial::RadialDeviation;
use budget::{CauseShare, MotionBudget};
use files::format::significant;
use pages::choice::{choice, one_of};
use pages::markup::{figure, note};
use pages::polar::{class, directions, division_for, drawing, figures, magnification};

/// The picture and its choices; empty if the motion is no circle.
#[must_use]
pub fn of_motion(motion: &MotionBudget) -> Markup {
    let Some(whole) = &motion.circle else { return Markup::default() };
    let choices: Vec<Markup> =
        motion.shown().0.into_iter().filter_map(|cause| without(motion, cause)).collect();
    html! {
        (note("By the model: the radial deviation of the circle with all causes. Of each degree, the point that is farthest off is drawn."))
        div.choice {
            (picture(&motion.name, whole))
            @if !choices.is_empty() {
                (one_of("Without one cause", "all causes", &with_all(motion), &choices))
            }
        }
        (directions(whole.laps.iter().map(|lap| lap.is_clockwise)))
    }
}

fn picture(name: &str, whole: &RadialDeviation) -> Markup {
    let division_um = division_for(whole.greatest_um());
    let caption = format!(
        "One division is {} µm, magnified {} times.",
        significant(division_um, 1),
        significant(magnification(division_um, whole.radius_m), 2)
    );
    let [x, y] = &whole.axes;
    let title = format!("Error budget of {name}: radial deviation over the angle");
    figure("", &drawing(&title, &caption, &lines(whole), division_um, [x, y]), &caption)
}

/// A cause that can be taken out: its name, its share, and the curves and the circular deviation without it.
fn without(motion: &MotionBudget, cause: &CauseShare) -> Option<Markup> {
    let circle = cause.circle_without.as_ref()?;
    let title = cause.plain_title();
    let label = format!("{title}: {} µm rms", significant(cause.share.rms, 3));
    let said = match (cause.without.circular, motion.whole.circular) {
        (Some(without), Some(whole)) => {
            format!(
                "Without {title}: G = {} µm instead of {} µm.",
                significant(without, 3),
                significant(whole, 3)
            )
        }
        _ => format!("Without {title}: {} µm rms.", significant(cause.without.rms, 3)),
    };
    Some(choice(&label, &said, &figures(&lines(circle))))
}

fn with_all(motion: &MotionBudget) -> String {
    let circular =
        motion.whole.circular.map_or(String::new(), |um| format!(", G = {} µm", significant(um, 3)));
    format!("With all causes: {} µm rms{circular}.", significant(motion.whole.rms, 3))
}

fn lines(circle: &RadialDeviation) -> Vec<(&'static str, &[(f64, f64)])> {
    circle.laps.iter().map(|lap| (class(lap.is_clockwise), &lap.points[..])).collect()
}
