//! The friction curve, the paper's third figure, and the circular tests as polar plots.

use super::contributors::Contributor;
use super::experiment::{Experiment, StickSlip};
use super::sentences::micrometres;
use super::table_model::{RADIUS_M, SPEEDS_RAD_PER_S, TABLES};
use crate::reproduce::study::Picture;
use contour::circular_test::Ballbar;
use files::format::significant;
use pages::plot::{Chart, Ink, Layer};
use pages::polar::{division_for, drawing};

/// All pictures.
pub fn all(experiment: &Experiment) -> Vec<Picture> {
    let runs = &experiment.stick_slip;
    let mut pictures = vec![friction(), deflections(runs)];
    pictures.push(circle("Stick-slip at 1.5 rad/s", &Contributor::StickSlip.description(), &runs[1].ballbar));
    pictures.extend(
        experiment
            .contributors
            .iter()
            .map(|(contributor, ballbar)| circle(contributor.name(), &contributor.description(), ballbar)),
    );
    pictures
}

/// The friction curve at the speeds of the circle.
fn friction() -> Picture {
    let friction = TABLES[0].friction();
    let max = SPEEDS_RAD_PER_S[1] * RADIUS_M;
    let point = |i: i32| {
        let v = max * f64::from(i) / 300.0;
        (1e3 * v, friction.coefficient(v))
    };
    let caption = "The printed coefficient of friction, over the speeds of the circle at 1.5 rad/s.";
    let chart = Chart {
        size: (960, 220),
        title: "Coefficient of friction over velocity",
        description: caption,
        x: "velocity, mm/s",
        y: "coefficient μ",
        noise: Some(0.0),
        layers: vec![Layer { ink: Ink::After, points: (-300..=300).map(point).collect(), is_marked: false }],
    };
    Picture {
        title: "Friction that falls and rises with speed".to_owned(),
        svg: chart.svg(),
        caption: caption.to_owned(),
        legend: Vec::new(),
    }
}

/// The paper's third figure: deflection of both tables over a lap at both speeds, over the angle for comparison.
fn deflections(runs: &[StickSlip; 2]) -> Picture {
    let inks = [[Ink::Before, Ink::After], [Ink::Third, Ink::Fourth]];
    let layer = |(run, ink, axis): (&StickSlip, Ink, usize)| {
        let degrees = |time_s: f64| 360.0 * time_s / run.lap.path.lap_s();
        let points = run.lap.points.iter().step_by(5).map(|(t, x)| (degrees(*t), 1e6 * x[axis])).collect();
        Layer { ink, points, is_marked: false }
    };
    let lines = runs.iter().zip(inks).flat_map(|(run, ink)| [(run, ink[0], 0), (run, ink[1], 1)]);
    let caption = "Deflection between each table and its drive over a lap that begins at +X.";
    let chart = Chart {
        size: (960, 260),
        title: "Deviation of both tables over a lap",
        description: caption,
        x: "angle, °",
        y: "deviation, µm",
        noise: Some(0.0),
        layers: lines.map(layer).collect(),
    };
    let legend = [
        ("before", "X, 0.5 rad/s"),
        ("after", "Y, 0.5 rad/s"),
        ("cw", "X, 1.5 rad/s"),
        ("ccw", "Y, 1.5 rad/s"),
    ];
    Picture {
        title: "Deviations of the tables (the paper's Figure 3)".to_owned(),
        svg: chart.svg(),
        caption: caption.to_owned(),
        legend: legend.map(|(class, meaning)| (class, meaning.to_owned())).to_vec(),
    }
}

/// A circular test as a polar plot.
fn circle(name: &str, description: &str, ballbar: &Ballbar) -> Picture {
    let (positive, negative) = (ballbar.positive.polar_points(), ballbar.negative.polar_points());
    let max = numerics::max_abs(positive.iter().chain(&negative).map(|point| point.1));
    let division_um = division_for(max);
    let [x, y] = ballbar.reversal_um();
    let caption = format!(
        "{name}, {description}: G {} µm, B {} µm on X and {} µm on Y, greatest difference between the directions H \
         {} µm. One division is {} µm.",
        significant(ballbar.circular_deviation_um(), 3),
        micrometres(x),
        micrometres(y),
        micrometres(ballbar.hysteresis_um()),
        significant(division_um, 1),
    );
    let title = format!("{name}: radial deviation over the angle");
    let lines = [("cw", &negative[..]), ("ccw", &positive[..])];
    Picture {
        title: name.to_owned(),
        svg: drawing(&title, &caption, &lines, division_um, ["X", "Y"]),
        caption,
        legend: vec![("cw", "clockwise".to_owned()), ("ccw", "counter-clockwise".to_owned())],
    }
}
