//! Line charts, with colours and dashes from the stylesheet.
//!
//! A chart is as wide as its figure, and its words keep their size: ticks, labels and lines across stand at percentages of the plane, and the
//! plane with the curves is an SVG element of its own, which is stretched. Its units are those of the figures (see `data`), so that the
//! curves are the figures, and a part of the plane is magnified by its `viewBox` alone.

use maud::{Markup, html};

use super::data::{Curve, Decimals};
use super::markup::text;
use super::ticks::{self, Tick};

/// The start of a chart, by which the page knows that it has one.
pub(super) const MARK: &str = "<svg class=\"chart";

/// Pixels that a label of the horizontal axis takes, and labels for which a narrow page has room.
const LABEL_WIDTH: u32 = 60;
const FEW: u32 = 6;

/// Steps of the vertical axis.
const ROWS: u32 = 6;

/// The meaning of a line or surface; the stylesheet has a class for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Labels.
    Label,
    /// Axes.
    Axis,
    /// Grid lines behind the curves.
    Grid,
    /// The line y = 0.
    Zero,
    /// The band of the sensors' noise, as a surface.
    Noise,
    /// The declared model, as a line.
    Before,
    /// The declared model, as the surface between minimum and maximum.
    BeforeRange,
    /// The model with the effects found.
    After,
    /// A third line in addition to [`Ink::Before`] and [`Ink::After`].
    Third,
    /// A fourth line.
    Fourth,
}

const INKS: [(Ink, &str); 10] = [
    (Ink::Label, "label"),
    (Ink::Axis, "axis"),
    (Ink::Grid, "grid"),
    (Ink::Zero, "zero"),
    (Ink::Noise, "noise"),
    (Ink::Before, "before"),
    (Ink::BeforeRange, "before-range"),
    (Ink::After, "after"),
    (Ink::Third, "cw"),
    (Ink::Fourth, "ccw"),
];

impl Ink {
    /// Its class in the stylesheet.
    fn class(self) -> &'static str {
        INKS.iter().find(|(ink, _)| *ink == self).map_or("", |(_, class)| class)
    }

    fn is_surface(self) -> bool {
        matches!(self, Self::BeforeRange | Self::Noise)
    }
}

/// One curve.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Colour and dashes.
    pub ink: Ink,
    /// Its corners; those of a surface in the order of its outline.
    pub points: Vec<(f64, f64)>,
    /// Whether the corners are drawn as points.
    pub is_marked: bool,
}

/// A line chart.
#[derive(Clone, Debug)]
pub struct Chart<'a> {
    /// Width and height, pixels of the page.
    pub size: (u32, u32),
    /// Title for screen readers.
    pub title: &'a str,
    /// Description for screen readers.
    pub description: &'a str,
    /// Label of the horizontal axis, with its unit.
    pub x: &'a str,
    /// Label of the vertical axis, with its unit.
    pub y: &'a str,
    /// Half height of the noise band about zero, in the unit of y; 0: only the line y = 0. `None`: values that are not about zero, which need
    /// not be shown.
    pub noise: Option<f64>,
    /// Curves and surfaces, from back to front.
    pub layers: Vec<Layer>,
}

impl Chart<'_> {
    /// The chart as an SVG element, as wide as its figure.
    #[must_use]
    pub fn svg(&self) -> String {
        self.drawn(false)
    }

    /// The chart as a plan: an SVG element that keeps the proportions of its size at every width.
    #[must_use]
    pub fn plan_svg(&self) -> String {
        self.drawn(true)
    }

    fn drawn(&self, is_plan: bool) -> String {
        let (width, height) = self.size;
        let curves: Vec<Curve<'_>> =
            self.layers.iter().map(|layer| (layer.ink.class(), &layer.points[..])).collect();
        let decimals = Decimals::of(&curves);
        let ((left, right), (low, high)) = self.range();
        let columns = ticks::within([left, right], (width / LABEL_WIDTH).max(3), FEW, self.least_step());
        let rows = ticks::within([low, high], ROWS, ROWS, 0.0);
        let element = html! {
            svg.chart.plan[is_plan] style=(format_args!("--width:{width};--height:{height}")) role="img"
                data-figures=(decimals.heading([self.x, self.y]))
            {
                title { (text(self.title)) }
                desc { (text(self.description)) }
                (vertical_axis(&rows, self.y))
                (horizontal_axis(&columns, self.x))
                (self.plane(decimals))
            }
        };
        element.into_string()
    }

    /// The noise band, the line y = 0, and the layers over them. Values are upwards, as `scale` makes it.
    fn plane(&self, decimals: Decimals) -> Markup {
        let ((left, right), (low, high)) = self.range();
        let (x, top) = decimals.units((left, -high));
        let (width, height) = decimals.units((right - left, high - low));
        let [x, top, width, height] = [x, top, width, height].map(short);
        let half = self.noise.map(|noise| decimals.units((0.0, noise)).1);
        html! {
            svg.plane viewBox=(format_args!("{x} {top} {width} {height}")) preserveAspectRatio="none" width="100%" height="100%"
                aria-hidden="true"
            {
                g transform="scale(1 -1)" {
                    @if let Some(half) = half {
                        @if half > 0.0 { path.noise d=(format_args!("M{x} {}h{width}v{}h-{width}z", short(half), short(-2.0 * half))) {} }
                        path.zero d=(format_args!("M{x} 0h{width}")) {}
                    }
                    @for layer in self.layers.iter().filter(|layer| !layer.points.is_empty()) { (layer.drawn(decimals)) }
                }
            }
        }
    }

    /// Smallest step of the horizontal axis: 1 if it counts, such as runs. Then there is no unit, all abscissas are whole, and nothing is
    /// between two of them.
    fn least_step(&self) -> f64 {
        let mut abscissas = self.layers.iter().flat_map(|layer| &layer.points).map(|point| point.0);
        let counts = !self.x.contains(", ") && abscissas.all(|x| libm::trunc(x).to_bits() == x.to_bits());
        if counts { 1.0 } else { 0.0 }
    }

    /// Ends of both axes: they include all points and the noise band, vertically with a margin.
    fn range(&self) -> ((f64, f64), (f64, f64)) {
        let noise = self.noise.into_iter().flat_map(|noise| [-noise, noise]);
        let points = || self.layers.iter().flat_map(|layer| &layer.points);
        let (left, right) = bounds(points().map(|point| point.0));
        let (low, high) = bounds(points().map(|point| point.1).chain(noise));
        let margin = 0.06 * (high - low);
        ((left, right), (low - margin, high + margin))
    }
}

impl Layer {
    /// A line or surface, and its corners as dots.
    fn drawn(&self, decimals: Decimals) -> Markup {
        let end = if self.ink.is_surface() { "z" } else { "" };
        // The first step is from 0, 0.
        let line = decimals.steps(&self.points, " ");
        html! {
            g class=(self.ink.class()) {
                path d=(format_args!("m{line}{end}")) {}
                @if self.is_marked {
                    @let dots = decimals.steps(&self.points, "h0m");
                    path.dots d=(format_args!("{}h0", dots.trim_start_matches("h0"))) {}
                }
            }
        }
    }
}

/// The lines across, labels and name of the vertical axis.
fn vertical_axis(ticks: &[Tick], name: &str) -> Markup {
    html! {
        @for tick in ticks {
            @let y = percent(1.0 - tick.place);
            line.grid x2="100%" y1=(y) y2=(y) {}
            line.axis x1="-4" y1=(y) y2=(y) {}
            text.label x="-7" y=(y) dy=".35em" text-anchor="end" { (tick.label) }
        }
        line.axis y2="100%" {}
        // A percentage cannot be turned: it is the place of an element of its own.
        svg y="50%" aria-hidden="true" { text.label transform="rotate(-90)" y="-42" text-anchor="middle" { (text(name)) } }
    }
}

/// The ticks and labels of the horizontal axis, which the script replaces, and its name.
fn horizontal_axis(ticks: &[Tick], name: &str) -> Markup {
    html! {
        svg y="100%" aria-hidden="true" {
            g.ticks {
                @for tick in ticks {
                    @let x = percent(tick.place);
                    line.axis x1=(x) x2=(x) y2="4" {}
                    text.label.fine[!tick.is_coarse] x=(x) y="17" text-anchor="middle" { (tick.label) }
                }
            }
            line.axis x2="100%" {}
            text.label x="50%" y="31" text-anchor="middle" { (text(name)) }
        }
    }
}

/// A length in units of the plane, of which a thousandth is not seen.
fn short(units: f64) -> String {
    let text = format!("{units:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A part as a percentage with two decimals.
fn percent(part: f64) -> String {
    format!("{:.2}%", 100.0 * part)
}

/// Minimum and maximum, moved apart if they are equal; 0 and 1 without values.
fn bounds(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let [low, high] = numerics::min_max(values);
    if low < high {
        (low, high)
    } else if low.is_finite() {
        (low - 0.5, high + 0.5)
    } else {
        (0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_names_its_inks_and_holds_no_colour_of_its_own() {
        let line = |ink| Layer {
            ink,
            points: vec![(0.0, 1.0), (1.0, -2.0), (2.0, 0.5)],
            is_marked: ink == Ink::Third,
        };
        let chart = Chart {
            size: (400, 200),
            title: "a < b",
            description: "two lines",
            x: "time, s",
            y: "residual, µm",
            noise: Some(0.1),
            layers: vec![
                line(Ink::BeforeRange),
                line(Ink::Before),
                line(Ink::After),
                line(Ink::Third),
                line(Ink::Fourth),
                line(Ink::Label),
            ],
        };
        let svg = chart.svg();
        assert!(
            svg.starts_with("<svg class=\"chart\" style=\"--width:400;--height:200\" role=\"img\""),
            "{svg}"
        );
        assert!(svg.contains("data-figures=\"time, s\nresidual, µm\n4 3\"><title>a &lt; b</title>"), "{svg}");
        // Figures are the path: 0, 1; then 1, −2; then 2, 0.5.
        assert!(
            svg.contains("<g class=\"after\"><path d=\"m 0,1000 10000,-3000 10000,2500\"></path></g>"),
            "{svg}"
        );
        assert!(svg.contains("<g class=\"cw\"><path d=\"m 0,1000 10000,-3000 10000,2500\"></path><path class=\"dots\" d=\"m0,1000h0m10000,-3000h0m10000,2500h0\"></path></g>"), "{svg}");
        // The plane: 0 to 2, and −2 to 1 with a margin of 6 %.
        assert!(svg.contains("viewBox=\"0 -1180 20000 3360\""), "{svg}");
        assert!(!svg.contains('#') && !svg.contains("http"), "{svg}");
        for (_, class) in INKS {
            assert!(svg.contains(&format!("class=\"{class}")), "{class} in {svg}");
        }
        assert_eq!(svg.matches("<svg").count(), svg.matches("</svg>").count());
        assert_eq!(svg, chart.svg());
    }

    #[test]
    fn runs_are_counted_in_whole_numbers() {
        let labels = |x: &str, last: f64| {
            let layers = vec![Layer {
                ink: Ink::Third,
                points: vec![(1.0, 0.0), (2.0, 1.0), (last, 0.5)],
                is_marked: true,
            }];
            let size = (960, 220);
            let chart = Chart { size, title: "", description: "", x, y: "", noise: None, layers };
            let svg = chart.svg();
            svg.split_once("class=\"ticks\"")
                .unwrap()
                .1
                .split_once("</g>")
                .unwrap()
                .0
                .matches("<text")
                .count()
        };
        assert_eq!(labels("run", 3.0), 3);
        assert!(labels("run", 3.5) > 5 && labels("time, s", 3.0) > 5);
    }

    #[test]
    fn a_plan_keeps_its_proportions() {
        let size = (620, 350);
        let chart = Chart { size, title: "", description: "", x: "", y: "", noise: None, layers: Vec::new() };
        assert!(chart.plan_svg().starts_with("<svg class=\"chart plan\" style=\"--width:620;--height:350\""));
        assert!(chart.svg().starts_with("<svg class=\"chart\""));
    }
}
