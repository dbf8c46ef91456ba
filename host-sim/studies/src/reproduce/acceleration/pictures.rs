//! Figures 4, 5 and 9 of the paper: the plane fit, the ellipse, and the 20 mm movement.

use std::f64::consts::TAU;

use super::circles::CircleRecord;
use super::closed_loop::{Row, SAMPLE_S, X, Y, Z};
use super::experiment::Experiment;
use super::z_move::accelerations;
use crate::reproduce::study::Picture;
use model::bodies::talk::Talk;
use pages::plot::{Chart, Ink, Layer};
use pages::polar;

/// Bins over the acceleration.
const BINS: usize = 15;

/// Sectors of the circle.
const SECTORS: usize = 72;

/// Rows averaged per point of the movement: 2 ms.
const ROWS_PER_POINT: usize = 8;

/// All pictures.
pub fn all(experiment: &Experiment) -> Vec<Picture> {
    vec![
        plane(experiment),
        ellipse(experiment),
        movement(experiment),
        residual(experiment),
        profile(experiment),
    ]
}

fn line(ink: Ink, points: Vec<(f64, f64)>) -> Layer {
    Layer { ink, points, is_marked: false }
}

/// Legend of most pictures.
fn legend() -> Vec<(&'static str, String)> {
    vec![
        ("cw", "measured".to_owned()),
        ("before", "catalogue".to_owned()),
        ("after", "identified".to_owned()),
    ]
}

/// Deviation in x over the acceleration of z, on the circles in yz.
fn plane(experiment: &Experiment) -> Picture {
    let y_to_x = experiment.measured.talk_um_s2_per_m[(X, Y)];
    let circles = experiment.circles.iter().filter(|circle| circle.plane == [Y, Z]);
    // The cross-talk of y is subtracted, with the coefficient of the plane fit.
    let point = |(row, a): (&Row, &[f64; 2])| (a[1], 1e6 * row.error_m(X) - y_to_x * a[0]);
    let points: Vec<(f64, f64)> =
        circles.flat_map(|circle| circle.rows.iter().zip(&circle.acceleration).map(point)).collect();
    let max = experiment.measured.reached_m_per_s2;
    let bin_of = |bin: usize| -> (f64, f64, f64) {
        let width = 2.0 * max / BINS as f64;
        let middle = -max + (bin as f64 + 0.5) * width;
        let inside: Vec<f64> =
            points.iter().filter(|(a, _)| (a - middle).abs() <= 0.5 * width).map(|point| point.1).collect();
        let (mean, scatter) = numerics::mean_and_deviation(&inside);
        (middle, mean, scatter)
    };
    let bins: Vec<(f64, f64, f64)> = (0..BINS).map(bin_of).collect();
    let above = bins.iter().map(|(a, mean, scatter)| (*a, mean + scatter));
    let below = bins.iter().rev().map(|(a, mean, scatter)| (*a, mean - scatter));
    let line_of = |coefficient: f64| [-max, max].map(|a| (a, coefficient * a)).to_vec();
    let slope = |talk: &Talk| line_of(talk.tool_um_s2_per_m[(X, Z)]);
    let measured = bins.iter().map(|(a, mean, _)| (*a, *mean)).collect();
    let layers = vec![
        line(Ink::BeforeRange, above.chain(below).collect()),
        line(Ink::Before, slope(&experiment.before)),
        line(Ink::After, slope(&experiment.after)),
        Layer { ink: Ink::Third, points: measured, is_marked: true },
    ];
    let chart = Chart {
        size: (960, 260),
        title: "Deviation in x over the acceleration of z",
        description: "Circles in yz in both directions; the slope is the cross-talk.",
        x: "acceleration of z, m/s²",
        y: "deviation in x, µm",
        noise: Some(0.0),
        layers,
    };
    Picture {
        title: "Cross-talk by the plane fit".to_owned(),
        svg: chart.svg(),
        caption: "Circles of 2 mm in yz in both directions: external minus internal reading in x over the \
                  acceleration of z. Means of the measured points with a band of ± one standard deviation of their \
                  scatter, and the prediction of both models."
            .to_owned(),
        legend: [legend(), vec![("before-range", "scatter of the measurement".to_owned())]].concat(),
    }
}

/// Radial deviation on the circles in zx.
fn ellipse(experiment: &Experiment) -> Picture {
    let circles: Vec<&CircleRecord> =
        experiment.circles.iter().filter(|circle| circle.plane == [Z, X]).collect();
    let mut sums = vec![(0.0, 0.0); SECTORS];
    for (row, a) in circles.iter().flat_map(|circle| circle.rows.iter().zip(&circle.acceleration)) {
        // The acceleration points towards the centre.
        let (cos, sin) = (-a[0] / libm::hypot(a[0], a[1]), -a[1] / libm::hypot(a[0], a[1]));
        let turned = libm::atan2(sin, cos).rem_euclid(TAU) / TAU * SECTORS as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to SECTORS")]
        let sector = (turned.round() as usize) % SECTORS;
        sums[sector].0 += 1e6 * (row.error_m(Z) * cos + row.error_m(X) * sin);
        sums[sector].1 += 1.0;
    }
    let angle = |sector: usize| TAU * sector as f64 / SECTORS as f64;
    let measured: Vec<(f64, f64)> =
        (0..=SECTORS).map(|i| (angle(i), sums[i % SECTORS].0 / sums[i % SECTORS].1)).collect();
    let reached = experiment.measured.reached_m_per_s2;
    let modelled = |talk: &Talk| -> Vec<(f64, f64)> {
        let e = &talk.tool_um_s2_per_m;
        let radial = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            let z = e[(Z, Z)] * cos + e[(Z, X)] * sin;
            let x = e[(X, Z)] * cos + e[(X, X)] * sin;
            -reached * (z * cos + x * sin)
        };
        (0..=SECTORS).map(|i| (angle(i), radial(angle(i)))).collect()
    };
    let (before, after) = (modelled(&experiment.before), modelled(&experiment.after));
    let all = [&measured, &before, &after].into_iter().flatten();
    let max = numerics::max_abs(all.map(|point| point.1));
    let title = "Radial deviation on the circle in zx";
    let caption = "Circles of 2 mm in zx in both directions: external minus internal reading, radially outwards. \
                   In-talk turns the circle into an ellipse, cross-talk tilts the ellipse.";
    let lines: [(&str, &[(f64, f64)]); 3] = [("before", &before), ("after", &after), ("cw", &measured)];
    Picture {
        title: "In-talk and cross-talk as an ellipse".to_owned(),
        svg: polar::drawing(title, caption, &lines, polar::division_for(max), ["z", "x"]),
        caption: format!("{caption} One division is {} µm.", polar::division_for(max)),
        legend: legend(),
    }
}

/// Means of [`ROWS_PER_POINT`] rows over time, s.
fn over_time(values: impl IntoIterator<Item = f64>) -> Vec<(f64, f64)> {
    let values: Vec<f64> = values.into_iter().collect();
    let mean = |(i, rows): (usize, &[f64])| {
        let middle = (i * ROWS_PER_POINT) as f64 + 0.5 * rows.len() as f64;
        (middle * SAMPLE_S, numerics::mean(rows.iter().copied()))
    };
    values.chunks(ROWS_PER_POINT).enumerate().map(mean).collect()
}

/// Deviation in x on the 20 mm movement.
fn movement(experiment: &Experiment) -> Picture {
    let movement = &experiment.measured_move;
    let predicted = |talk: &Talk| {
        let coefficient = talk.tool_um_s2_per_m[(X, Z)];
        over_time(movement.acceleration.iter().map(|a| coefficient * a))
    };
    let layers = vec![
        line(Ink::Third, over_time(movement.error_um(X))),
        line(Ink::Before, predicted(&experiment.before)),
        line(Ink::After, predicted(&experiment.after)),
    ];
    let caption = "Deviation in x while the true machine moves 20 mm in z, and the deviation calculated from its \
                   acceleration with the coefficients of the circles. Means over 2 ms.";
    over_the_move("20 mm movement: deviation in x", "deviation in x, µm", caption, layers, legend())
}

/// Deviation in x on the movement after subtraction of each model.
fn residual(experiment: &Experiment) -> Picture {
    let movement = &experiment.measured_move;
    let residual = |talk: &Talk| {
        let coefficient = talk.tool_um_s2_per_m[(X, Z)];
        let errors = movement.error_um(X);
        over_time(errors.into_iter().zip(&movement.acceleration).map(|(error, a)| error - coefficient * a))
    };
    let layers =
        vec![line(Ink::Before, residual(&experiment.before)), line(Ink::After, residual(&experiment.after))];
    let legend = vec![
        ("before", "corrected with the catalogue's coefficient".to_owned()),
        ("after", "corrected with the identified coefficient".to_owned()),
    ];
    let caption = "The same deviation after correction with each model.";
    over_the_move("20 mm movement: before and after", "deviation in x, µm", caption, layers, legend)
}

/// Set and actual acceleration of z on the movement.
fn profile(experiment: &Experiment) -> Picture {
    let movement = &experiment.simulated_move;
    let command: Vec<f64> = movement.rows.iter().map(|row| row.command_m[Z]).collect();
    let set = accelerations(&command);
    let layers = vec![
        line(Ink::Before, over_time(set)),
        line(Ink::After, over_time(movement.acceleration.iter().copied())),
    ];
    let legend = vec![("before", "set".to_owned()), ("after", "actual".to_owned())];
    let caption = "With limited jerk the acceleration is triangular: the move of 20 mm ends before it reaches 10 \
                   m/s². The acceleration after the position loop is lower and later.";
    over_the_move("20 mm movement: acceleration", "acceleration of z, m/s²", caption, layers, legend)
}

/// A chart over the time of the movement.
fn over_the_move(
    title: &str,
    y: &str,
    caption: &str,
    layers: Vec<Layer>,
    legend: Vec<(&'static str, String)>,
) -> Picture {
    let chart =
        Chart { size: (960, 220), title, description: caption, x: "time, s", y, noise: Some(0.0), layers };
    Picture { title: title.to_owned(), svg: chart.svg(), caption: caption.to_owned(), legend }
}
