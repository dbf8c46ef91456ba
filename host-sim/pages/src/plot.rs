//! Line charts drawn by plotters, with colours and dashes from the stylesheet.
//!
//! plotters has no classes, only colours, and the colours of a page depend on its medium (light, dark,
//! paper). Each [`Ink`] is therefore drawn in a colour of its own, which is replaced by a class afterwards.
//! Coordinates are integers in plotters, so that a chart is drawn [`UNITS_PER_PIXEL`] times as large as on the
//! page.

use plotters::chart::ChartBuilder;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Polygon};
use plotters::prelude::{Cartesian2d, SVGBackend};
use plotters::style::{Color, IntoFont, RGBColor, TextStyle};

use maud::PreEscaped;

use super::data;
use super::markup::{self, Attributes};
use files::format::fixed;

/// Units of a drawing per pixel of the page.
const UNITS_PER_PIXEL: u32 = 4;

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
    const fn colour(self) -> RGBColor {
        RGBColor(1, 2, self as u8)
    }

    /// Its class in the stylesheet.
    fn class(self) -> &'static str {
        INKS.iter().find(|(ink, _)| *ink == self).map_or("", |(_, class)| class)
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
    /// The chart as an SVG element.
    #[must_use]
    pub fn svg(&self) -> String {
        let size = (UNITS_PER_PIXEL * self.size.0, UNITS_PER_PIXEL * self.size.1);
        let mut drawn = String::new();
        let outcome = self.draw(&SVGBackend::with_string(&mut drawn, size).into_drawing_area());
        // Drawing into memory does not fail; an error would be shown on the page.
        if let Err(cause) = outcome {
            return markup::paragraph(&format!("not drawn: {cause}")).into_string();
        }
        // The element of plotters has no title, and it has the address of a namespace, which a page does not need.
        let body = drawn.split_once('>').map_or("", |(_, body)| body.trim_start());
        let body = body.trim_end().strip_suffix("</svg>").unwrap_or(body);
        let curves: Vec<data::Curve<'_>> =
            self.layers.iter().map(|layer| (layer.ink.class(), &layer.points[..])).collect();
        let figures = data::packed([self.x, self.y], &curves);
        let attributes = Attributes { figures: Some(&figures), ..Attributes::default() };
        markup::svg(size, attributes, (self.title, self.description), &PreEscaped(with_classes(body)))
    }

    fn draw(&self, area: &Area<'_>) -> Result<(), Failure> {
        let ((left, right), (low, high)) = self.range();
        // plotters interprets the size of a font as its height.
        let size = f64::from(UNITS_PER_PIXEL) * 11.0 * 1.24;
        let colour = Ink::Label.colour();
        let words = TextStyle::from(("sans-serif", size).into_font()).color(&colour);
        let mut chart = ChartBuilder::on(area)
            .margin_top(2 * UNITS_PER_PIXEL)
            .margin_right(12 * UNITS_PER_PIXEL)
            .x_label_area_size(34 * UNITS_PER_PIXEL)
            .y_label_area_size(54 * UNITS_PER_PIXEL)
            .build_cartesian_2d(left..right, low..high)?;
        let (columns, rows) = (((self.size.0 / 60) as usize).max(3), 6);
        chart
            .configure_mesh()
            .light_line_style(plotters::style::TRANSPARENT)
            .bold_line_style(Ink::Grid.colour())
            .axis_style(Ink::Axis.colour())
            .disable_x_mesh()
            .set_all_tick_mark_size(4 * UNITS_PER_PIXEL)
            .label_style(words.clone())
            .axis_desc_style(words)
            .x_labels(columns)
            .y_labels(rows)
            .x_label_formatter(&|x| tick_label(*x, right - left, columns))
            .y_label_formatter(&|y| tick_label(*y, high - low, rows))
            .x_desc(self.x)
            .y_desc(self.y)
            .draw()?;
        self.draw_layers(chart.plotting_area(), (left, right))?;
        area.present()
    }

    /// The noise band, the line y = 0, and the layers over them.
    fn draw_layers(&self, plane: &Plane<'_>, (left, right): (f64, f64)) -> Result<(), Failure> {
        if let Some(noise) = self.noise {
            if noise > 0.0 {
                let corners = vec![(left, -noise), (left, noise), (right, noise), (right, -noise)];
                draw_surface(plane, Ink::Noise, corners)?;
            }
            plane.draw(&PathElement::new(vec![(left, 0.0), (right, 0.0)], Ink::Zero.colour()))?;
        }
        for layer in &self.layers {
            if matches!(layer.ink, Ink::BeforeRange | Ink::Noise) {
                draw_surface(plane, layer.ink, layer.points.clone())?;
            } else {
                plane.draw(&PathElement::new(layer.points.clone(), layer.ink.colour()))?;
            }
            for point in layer.points.iter().filter(|_| layer.is_marked) {
                plane.draw(&Circle::new(*point, 2 * UNITS_PER_PIXEL, layer.ink.colour()))?;
            }
        }
        Ok(())
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

type Failure = DrawingAreaErrorKind<std::io::Error>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Plane<'a> = DrawingArea<SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

fn draw_surface(plane: &Plane<'_>, ink: Ink, corners: Vec<(f64, f64)>) -> Result<(), Failure> {
    plane.draw(&Polygon::new(corners, ink.colour().filled()))
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

/// A label of an axis with as many decimals as neighbouring labels need to differ.
fn tick_label(value: f64, range: f64, count: usize) -> String {
    // Between `count` labels are `count` − 1 steps, and up to two more outside them.
    let min_step = range / (count + 1) as f64;
    let power = 10_f64.powf(min_step.log10().floor());
    // Steps are 1, 2 or 5 times a power of ten.
    let step =
        [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| *step >= min_step).unwrap_or(power);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 9")]
    let decimals = (-(step * 1.001).log10().floor()).clamp(0.0, 9.0) as usize;
    fixed(value, decimals)
}

/// Replaces colours by their classes and removes attributes that the stylesheet sets.
fn with_classes(drawn: &str) -> String {
    let mut classed = drawn.replace(" opacity=\"1\"", "").replace(" stroke-width=\"1\"", "");
    for (ink, class) in INKS {
        let RGBColor(r, g, b) = ink.colour();
        for attribute in ["fill", "stroke"] {
            classed = classed
                .replace(&format!("{attribute}=\"#{r:02X}{g:02X}{b:02X}\""), &format!("class=\"{class}\""));
        }
    }
    for attribute in [" fill=\"none\"", " stroke=\"none\"", " font-family=\"sans-serif\""] {
        classed = classed.replace(attribute, "");
    }
    classed.replace(" \"/>", "\"/>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_names_its_inks_and_holds_no_colour_of_its_own() {
        let line = |ink| Layer { ink, points: vec![(0.0, 1.0), (1.0, -2.0), (2.0, 0.5)], is_marked: false };
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
            ],
        };
        let svg = chart.svg();
        assert!(
            svg.starts_with("<svg viewBox=\"0 0 1600 800\" role=\"img\" data-figures=\"time, s\n"),
            "{svg}"
        );
        assert!(svg.contains("\nafter 0,1000 10000,-2000 10000,500\n"), "{svg}");
        assert!(svg.contains("><title>a &lt; b</title>"), "{svg}");
        assert!(!svg.contains('#') && !svg.contains("http"), "{svg}");
        for (_, class) in INKS {
            assert!(svg.contains(&format!("class=\"{class}\"")), "{class} in {svg}");
        }
        assert_eq!(svg.matches("<svg").count(), svg.matches("</svg>").count());
        assert_eq!(svg, chart.svg());
    }

    #[test]
    fn labels_have_the_digits_they_need() {
        assert_eq!(tick_label(0.05, 0.31, 6), "0.05");
        assert_eq!(tick_label(0.1, 0.5, 6), "0.1");
        assert_eq!(tick_label(-0.02, 0.06, 6), "−0.02");
        assert_eq!(tick_label(1500.0, 6000.0, 6), "1500");
    }
}
