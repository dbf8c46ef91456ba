//! Line charts: plotters draws them, the stylesheet gives them their colours and dashes.
//!
//! plotters knows colours only, and a page that is read in light, in dark and on paper needs names:
//! each [`Ink`] is drawn in a colour of its own that is replaced by a class afterwards. Coordinates
//! are whole numbers in plotters, so it draws [`FINE`] times as large as the page shows it.

use plotters::chart::ChartBuilder;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Polygon};
use plotters::prelude::{Cartesian2d, SVGBackend};
use plotters::style::{Color, IntoFont, RGBColor, TextStyle};

use super::markup;
use super::number::fixed;

/// Units of a drawing in a pixel of the page.
const FINE: u32 = 4;

/// What a line or surface stands for; the stylesheet has a class of each name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Labels.
    Label,
    /// Axes.
    Axis,
    /// Lines behind the curves.
    Grid,
    /// The residual of zero.
    Zero,
    /// What the sensors' noise makes of nothing.
    Noise,
    /// Before, as a line.
    Before,
    /// Before, as the surface between least and greatest.
    BeforeRange,
    /// After.
    After,
    /// A third line beside before and after.
    Third,
    /// A fourth.
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
}

/// One curve.
#[derive(Clone, Debug)]
pub struct Layer {
    /// How it is drawn.
    pub ink: Ink,
    /// Its corners; those of a surface go around it.
    pub points: Vec<(f64, f64)>,
    /// Whether a line's corners are marked.
    pub is_marked: bool,
}

/// A chart of residuals over something.
#[derive(Clone, Debug)]
pub struct Chart<'a> {
    /// Pixels of the page.
    pub size: (u32, u32),
    /// What it shows, for those who do not see it.
    pub title: &'a str,
    /// The same, at length.
    pub description: &'a str,
    /// What goes to the right, with its unit.
    pub x: &'a str,
    /// What goes up, with its unit.
    pub y: &'a str,
    /// Half height of the band that noise alone would fill; 0: none.
    pub noise: f64,
    /// From back to front.
    pub layers: Vec<Layer>,
}

impl Chart<'_> {
    /// The chart as markup.
    #[must_use]
    pub fn svg(&self) -> String {
        let size = (FINE * self.size.0, FINE * self.size.1);
        let mut drawn = String::new();
        let outcome = self.draw(&SVGBackend::with_string(&mut drawn, size).into_drawing_area());
        // Drawing into memory does not fail; if it did, the page would say so.
        if let Err(cause) = outcome {
            return markup::paragraph(&format!("not drawn: {cause}"));
        }
        // The element itself is written here, with a title and without the address of a namespace.
        let body = drawn.split_once('>').map_or("", |(_, rest)| rest.trim_start());
        let body = body.trim_end().strip_suffix("</svg>").unwrap_or(body);
        markup::svg(size, self.title, self.description, &named(body))
    }

    fn draw(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), Failure> {
        let ((left, right), (low, high)) = self.range();
        // plotters takes a font's height for its size.
        let size = f64::from(FINE) * 11.0 * 1.24;
        let colour = Ink::Label.colour();
        let words = TextStyle::from(("sans-serif", size).into_font()).color(&colour);
        let mut chart = ChartBuilder::on(area)
            .margin_top(2 * FINE)
            .margin_right(12 * FINE)
            .x_label_area_size(34 * FINE)
            .y_label_area_size(54 * FINE)
            .build_cartesian_2d(left..right, low..high)?;
        let (columns, rows) = (((self.size.0 / 60) as usize).max(3), 6);
        chart
            .configure_mesh()
            .light_line_style(plotters::style::TRANSPARENT)
            .bold_line_style(Ink::Grid.colour())
            .axis_style(Ink::Axis.colour())
            .disable_x_mesh()
            .set_all_tick_mark_size(4 * FINE)
            .label_style(words.clone())
            .axis_desc_style(words)
            .x_labels(columns)
            .y_labels(rows)
            .x_label_formatter(&|x| tick(*x, right - left, columns))
            .y_label_formatter(&|y| tick(*y, high - low, rows))
            .x_desc(self.x)
            .y_desc(self.y)
            .draw()?;
        let plane = chart.plotting_area();
        if self.noise > 0.0 {
            let corners =
                vec![(left, -self.noise), (left, self.noise), (right, self.noise), (right, -self.noise)];
            surface(plane, Ink::Noise, corners)?;
        }
        plane.draw(&PathElement::new(vec![(left, 0.0), (right, 0.0)], Ink::Zero.colour()))?;
        for layer in &self.layers {
            if layer.ink == Ink::BeforeRange {
                surface(plane, layer.ink, layer.points.clone())?;
            } else {
                plane.draw(&PathElement::new(layer.points.clone(), layer.ink.colour()))?;
            }
            for point in layer.points.iter().filter(|_| layer.is_marked) {
                plane.draw(&Circle::new(*point, 2 * FINE, layer.ink.colour()))?;
            }
        }
        area.present()
    }

    /// What the axes have to show: all points, zero, and the noise.
    fn range(&self) -> ((f64, f64), (f64, f64)) {
        let points = || self.layers.iter().flat_map(|layer| &layer.points);
        let (left, right) = bounds(points().map(|point| point.0));
        let (low, high) = bounds(points().map(|point| point.1).chain([-self.noise, self.noise]));
        let room = 0.06 * (high - low);
        ((left, right), (low - room, high + room))
    }
}

type Failure = DrawingAreaErrorKind<std::io::Error>;
type Plane<'a> = DrawingArea<SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

fn surface(plane: &Plane<'_>, ink: Ink, corners: Vec<(f64, f64)>) -> Result<(), Failure> {
    plane.draw(&Polygon::new(corners, ink.colour().filled()))
}

/// Least and greatest, which are never the same.
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

/// A label with the digits that its neighbours differ in.
fn tick(value: f64, range: f64, count: usize) -> String {
    // That many labels have one step less between them, and up to two beside them.
    let least = range / (count + 1) as f64;
    let power = 10_f64.powf(least.log10().floor());
    // Steps are 1, 2 or 5 times a power of ten.
    let step =
        [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| *step >= least).unwrap_or(power);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 9")]
    let decimals = (-(step * 1.001).log10().floor()).clamp(0.0, 9.0) as usize;
    fixed(value, decimals)
}

/// Colours replaced by the names that they stand for, and what the stylesheet says left out.
fn named(drawn: &str) -> String {
    let mut named = drawn.replace(" opacity=\"1\"", "").replace(" stroke-width=\"1\"", "");
    for (ink, class) in INKS {
        let RGBColor(r, g, b) = ink.colour();
        for attribute in ["fill", "stroke"] {
            named = named
                .replace(&format!("{attribute}=\"#{r:02X}{g:02X}{b:02X}\""), &format!("class=\"{class}\""));
        }
    }
    for needless in [" fill=\"none\"", " stroke=\"none\"", " font-family=\"sans-serif\""] {
        named = named.replace(needless, "");
    }
    named.replace(" \"/>", "\"/>")
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
            noise: 0.1,
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
            svg.starts_with("<svg viewBox=\"0 0 1600 800\" role=\"img\">\n<title>a &lt; b</title>"),
            "{svg}"
        );
        assert!(!svg.contains('#') && !svg.contains("http"), "{svg}");
        for (_, class) in INKS {
            assert!(svg.contains(&format!("class=\"{class}\"")), "{class} in {svg}");
        }
        assert_eq!(svg.matches("<svg").count(), svg.matches("</svg>").count());
        assert_eq!(svg, chart.svg());
    }

    #[test]
    fn labels_have_the_digits_they_need() {
        assert_eq!(tick(0.05, 0.31, 6), "0.05");
        assert_eq!(tick(0.1, 0.5, 6), "0.1");
        assert_eq!(tick(-0.02, 0.06, 6), "−0.02");
        assert_eq!(tick(1500.0, 6000.0, 6), "1500");
    }
}
