//! The section of the demo's page on motions before, as predicted, and after the compensation.

use maud::{Markup, html};

use super::verification_page::on_one_scale;
use contour::ContourError;
use files::format::fixed;
use pages::markup::{Column, note, number_cell, paragraph, table, text};

/// A motion before, as predicted, and after.
#[derive(Clone, Debug, PartialEq)]
pub struct RoundTripMotion {
    /// Name of the motion.
    pub name: String,
    /// Names of the axes.
    pub axes: Vec<String>,
    /// Contour errors before, as predicted, and after.
    pub errors: [ContourError; 3],
}

/// A table, and the circles beside each other on one scale; empty without a motion.
#[must_use]
pub fn body(motions: &[RoundTripMotion], lead: &str) -> Markup {
    const NUMBERS: [&str; 9] = [
        "rms before, µm",
        "predicted",
        "after",
        "greatest before, µm",
        "predicted",
        "after",
        "G before, µm",
        "predicted",
        "after",
    ];
    if motions.is_empty() {
        return Markup::default();
    }
    let columns: Vec<Column> =
        std::iter::once(Column::Words("motion")).chain(NUMBERS.map(Column::Numbers)).collect();
    let values = |motion: &RoundTripMotion| {
        let of = |value: fn(&ContourError) -> Option<f64>| motion.errors.each_ref().map(value);
        [of(|error| Some(error.rms_um)), of(|error| Some(error.max_um)), of(ContourError::circular_um)]
            .concat()
    };
    let rows = html! {
        @for motion in motions {
            tr {
                th scope="row" { (text(&motion.name)) }
                @for value in values(motion) {
                    (number_cell(&value.map_or("–".to_owned(), |um| fixed(um, 2))))
                }
            }
        }
    };
    html! {
        (paragraph(lead))
        (note("G: circular deviation, the larger of both directions (ISO 230-4)."))
        (table(&columns, &rows))
        @for motion in motions {
            @let [before, predicted, after] = &motion.errors;
            (paragraph(&motion.name))
            (on_one_scale(&[("Before", before), ("Predicted", predicted), ("After", after)], &motion.axes))
        }
    }
}
