//! The detection curve as a picture: the fraction found over the size, and below it every case by effect.

use maud::{Markup, html};

use super::detection::SIZES;
use super::detection_curve::{Bin, Curve};
use pages::markup::{Attributes, svg, text};

/// Width of the names next to the rows, width and height of the curve, height above it and of a row below, in pixels of
/// the page.
const LEFT: u32 = 150;
const WIDTH: u32 = 780;
const HEIGHT: u32 = 240;
const TOP: u32 = 12;
const ROW: u32 = 20;
/// Space between the curve and the rows, for the labels of the sizes.
const GAP: u32 = 46;

/// Sizes with a label.
const LABELLED: [f64; 6] = [0.1, 0.3, 1.0, 3.0, 10.0, 30.0];
/// Ends of the scale: a little beyond the sizes that are aimed at.
const ENDS: [f64; 2] = [0.07, 45.0];

const TITLE: &str = "Detection of effects by their size";
const DESCRIPTION: &str = "Above, the fraction of effects found over their size in units of the noise, on a logarithmic \
                           scale, with its 95 % interval; below, a row for each effect with a point for each case.";

/// The SVG element; empty without a case.
pub fn picture(curve: &Curve) -> String {
    if curve.effects.is_empty() {
        return String::new();
    }
    let rows_top = TOP + HEIGHT + GAP;
    let bottom = rows_top + ROW * u32::try_from(curve.effects.len()).unwrap_or(0);
    let body = html! {
        (scales(bottom))
        (line(&curve.bins))
        @for bin in curve.bins.iter().filter(|bin| bin.found.trials > 0) { (point(bin)) }
        @for (top, effect) in (rows_top..).step_by(ROW as usize).zip(&curve.effects) {
            text.label font-size="12" text-anchor="end" x=(LEFT - 14) y=(top + ROW / 2 + 4) {
                (text(&effect.name.replace('_', " ")))
            }
            @for (size, is_found) in &effect.points {
                circle class=(if *is_found { "after" } else { "before" }) cx=(x(*size)) cy=(top + ROW / 2) r="3" {}
            }
        }
    };
    svg((LEFT + WIDTH + 50, bottom + 6), Attributes::default(), (TITLE, DESCRIPTION), &body)
}

/// Vertical lines at labelled sizes through both parts, horizontal lines of the curve.
fn scales(bottom: u32) -> Markup {
    html! {
        @for size in LABELLED {
            line.grid x1=(x(size)) y1=(TOP) x2=(x(size)) y2=(bottom) {}
            text.label font-size="11" text-anchor="middle" x=(x(size)) y=(TOP + HEIGHT + 16) { (size) }
        }
        text.label font-size="11" text-anchor="middle" x=(LEFT + WIDTH / 2) y=(TOP + HEIGHT + 34) { "size / noise" }
        @for (fraction, class) in [(0.0, "axis"), (0.25, "grid"), (0.5, "grid"), (0.75, "grid"), (0.95, "axis"), (1.0, "grid")] {
            line class=(class) x1=(LEFT) y1=(y(fraction)) x2=(LEFT + WIDTH) y2=(y(fraction)) {}
            // 95 and 100 % are too close for two labels.
            @if fraction < 1.0 {
                text.label font-size="11" text-anchor="end" x=(LEFT - 8) y=(y(fraction)) dy="4" {
                    (text(&format!("{:.0} %", 100.0 * fraction)))
                }
            }
        }
    }
}

/// The line through the sizes that occur.
fn line(bins: &[Bin]) -> Markup {
    let occurring = bins.iter().filter(|bin| bin.found.trials > 0);
    let points: Vec<String> =
        occurring.map(|bin| format!("{},{}", x(bin.size), y(bin.found.fraction()))).collect();
    html! { polyline.after points=(points.join(" ")) {} }
}

/// A size's fraction with its interval.
fn point(bin: &Bin) -> Markup {
    let [low, high] = bin.found.interval();
    html! {
        line.after x1=(x(bin.size)) y1=(y(low)) x2=(x(bin.size)) y2=(y(high)) {}
        circle.after cx=(x(bin.size)) cy=(y(bin.found.fraction())) r="3.5" {}
    }
}

/// Position of a size; one beyond the scale is drawn at its end.
fn x(size: f64) -> String {
    let [low, high] = ENDS.map(libm::log);
    let part = (libm::log(size.max(f64::MIN_POSITIVE)).clamp(low, high) - low) / (high - low);
    format!("{:.1}", f64::from(LEFT) + f64::from(WIDTH) * part)
}

/// Position of a fraction.
fn y(fraction: f64) -> String {
    format!("{:.1}", f64::from(TOP) + f64::from(HEIGHT) * (1.0 - fraction))
}

const _: () = assert!(ENDS[0] < SIZES[0] && ENDS[1] > SIZES[SIZES.len() - 1]);
