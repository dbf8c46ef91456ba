//! The paper's figures 4, 5 and 9 again: the plane fit, the ellipse, and the 20 mm movement.

use std::f64::consts::TAU;

use super::bench::SAMPLE_S;
use super::circles::Lap;
use super::travel::Z;
use super::{Experiment, X};
use crate::reproduce::Picture;
use model::bodies::talk::Talk;
use report::plot::{Chart, Ink, Layer};
use report::polar;

/// Means in the picture over acceleration, and around the circle.
const BINS: usize = 15;
const SECTORS: usize = 72;

/// Rows that a point of the movement is the mean of: 2 ms.
const MEAN_OF: usize = 8;

/// y.
const Y: usize = 1;

/// All pictures.
pub fn all(experiment: &Experiment) -> Vec<Picture> {
    vec![plane(experiment), ellipse(experiment), movement(experiment), left(experiment), profile(experiment)]
}

fn line(ink: Ink, points: Vec<(f64, f64)>) -> Layer {
    Layer { ink, points, is_marked: false }
}

/// What the three lines of most pictures are.
fn keys() -> Vec<(&'static str, String)> {
    vec![
        ("cw", "measured".to_owned()),
        ("before", "catalogue".to_owned()),
        ("after", "identified".to_owned()),
    ]
}

/// Deviation in x over the acceleration of z, on the circles in yz.
fn plane(experiment: &Experiment) -> Picture {
    let tilt = experiment.measured.talk_um_s2_per_m[(X, Y)];
    let laps = experiment.laps.iter().filter(|lap| lap.plane == [Y, Z]);
    // What y does is taken out, as the plane fit has it.
    let point = |(row, a): (&super::bench::Row, &[f64; 2])| (a[1], 1e6 * row.error_m(X) - tilt * a[0]);
    let points: Vec<(f64, f64)> =
        laps.flat_map(|lap| lap.rows.iter().zip(&lap.acceleration).map(point)).collect();
    let most = experiment.measured.reached_m_per_s2;
    let of_bin = |bin: usize| -> (f64, f64, f64) {
        let width = 2.0 * most / BINS as f64;
        let middle = -most + (bin as f64 + 0.5) * width;
        let inside: Vec<f64> =
            points.iter().filter(|(a, _)| (a - middle).abs() <= 0.5 * width).map(|point| point.1).collect();
        let (mean, scatter) = numerics::mean_and_deviation(&inside);
        (middle, mean, scatter)
    };
    let bins: Vec<(f64, f64, f64)> = (0..BINS).map(of_bin).collect();
    let above = bins.iter().map(|(a, mean, scatter)| (*a, mean + scatter));
    let below = bins.iter().rev().map(|(a, mean, scatter)| (*a, mean - scatter));
    let through = |coefficient: f64| [-most, most].map(|a| (a, coefficient * a)).to_vec();
    let slope = |talk: &Talk| through(talk.tool_um_s2_per_m[(X, Z)]);
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
        description: "Circles in yz, both ways; the slope is the cross-talk.",
        x: "acceleration of z, m/s²",
        y: "deviation in x, µm",
        noise: 0.0,
        layers,
    };
    Picture {
        title: "Cross-talk by the plane fit".to_owned(),
        svg: chart.svg(),
        caption: "Circles of 2 mm in yz, both ways: external less internal reading in x over the acceleration of z, means \
                  of the measured points in a band of one standard deviation of their scatter, and what the two models say."
            .to_owned(),
        keys: [keys(), vec![("before-range", "scatter of the measured".to_owned())]].concat(),
    }
}

/// Radial deviation on the circles in zx.
fn ellipse(experiment: &Experiment) -> Picture {
    let laps: Vec<&Lap> = experiment.laps.iter().filter(|lap| lap.plane == [Z, X]).collect();
    let mut sums = vec![(0.0, 0.0); SECTORS];
    for (row, a) in laps.iter().flat_map(|lap| lap.rows.iter().zip(&lap.acceleration)) {
        // The acceleration points to the centre.
        let (cos, sin) = (-a[0] / a[0].hypot(a[1]), -a[1] / a[0].hypot(a[1]));
        let turned = sin.atan2(cos).rem_euclid(TAU) / TAU * SECTORS as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to the sectors")]
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
            let (sin, cos) = angle.sin_cos();
            let z = e[(Z, Z)] * cos + e[(Z, X)] * sin;
            let x = e[(X, Z)] * cos + e[(X, X)] * sin;
            -reached * (z * cos + x * sin)
        };
        (0..=SECTORS).map(|i| (angle(i), radial(angle(i)))).collect()
    };
    let (before, after) = (modelled(&experiment.before), modelled(&experiment.after));
    let all = [&measured, &before, &after].into_iter().flatten();
    let most = numerics::max_abs(all.map(|point| point.1));
    let title = "Radial deviation on the circle in zx";
    let caption = "Circles of 2 mm in zx, both ways: external less internal reading away from the centre. In-talk makes an \
                   ellipse of the circle, cross-talk tilts it.";
    let lines: [(&str, &[(f64, f64)]); 3] = [("before", &before), ("after", &after), ("cw", &measured)];
    Picture {
        title: "In-talk and cross-talk as an ellipse".to_owned(),
        svg: polar::drawing(title, caption, &lines, polar::division_for(most), ["z", "x"]),
        caption: format!("{caption} One division is {} µm.", polar::division_for(most)),
        keys: keys(),
    }
}

/// Means of a few rows over time.
fn over_time(values: impl IntoIterator<Item = f64>) -> Vec<(f64, f64)> {
    let values: Vec<f64> = values.into_iter().collect();
    let mean = |(i, rows): (usize, &[f64])| {
        let middle = (i * MEAN_OF) as f64 + 0.5 * rows.len() as f64;
        (middle * SAMPLE_S, numerics::mean(rows.iter().copied()))
    };
    values.chunks(MEAN_OF).enumerate().map(mean).collect()
}

/// Deviation in x on the 20 mm movement.
fn movement(experiment: &Experiment) -> Picture {
    let travel = &experiment.travelled;
    let predicted = |talk: &Talk| {
        let coefficient = talk.tool_um_s2_per_m[(X, Z)];
        over_time(travel.acceleration.iter().map(|a| coefficient * a))
    };
    let layers = vec![
        line(Ink::Third, over_time(travel.error_um(X))),
        line(Ink::Before, predicted(&experiment.before)),
        line(Ink::After, predicted(&experiment.after)),
    ];
    let caption = "The true machine moves 20 mm in z: deviation in x, and what the coefficients of the circles make of its \
                   acceleration. Means over 2 ms.";
    over_the_move("20 mm movement: deviation in x", "deviation in x, µm", caption, layers, keys())
}

/// What the models leave of it.
fn left(experiment: &Experiment) -> Picture {
    let travel = &experiment.travelled;
    let left = |talk: &Talk| {
        let coefficient = talk.tool_um_s2_per_m[(X, Z)];
        let errors = travel.error_um(X);
        over_time(errors.into_iter().zip(&travel.acceleration).map(|(error, a)| error - coefficient * a))
    };
    let layers = vec![line(Ink::Before, left(&experiment.before)), line(Ink::After, left(&experiment.after))];
    let keys = vec![
        ("before", "left by the catalogue's coefficient".to_owned()),
        ("after", "left by the identified one".to_owned()),
    ];
    let caption = "The same deviation less what each model says of it.";
    over_the_move("20 mm movement: before and after", "left in x, µm", caption, layers, keys)
}

/// Set and actual acceleration of it.
fn profile(experiment: &Experiment) -> Picture {
    let travel = &experiment.simulated;
    let command: Vec<f64> = travel.rows.iter().map(|row| row.command_m[Z]).collect();
    let set = super::travel::accelerations(&command);
    let layers = vec![
        line(Ink::Before, over_time(set)),
        line(Ink::After, over_time(travel.acceleration.iter().copied())),
    ];
    let keys = vec![("before", "set".to_owned()), ("after", "actual".to_owned())];
    let caption = "The jerk makes triangles of the acceleration: 20 mm end before it comes to 10 m/s². Behind the position \
                   loop it is less still, and later.";
    over_the_move("20 mm movement: acceleration", "acceleration of z, m/s²", caption, layers, keys)
}

fn over_the_move(
    title: &str,
    y: &str,
    caption: &str,
    layers: Vec<Layer>,
    keys: Vec<(&'static str, String)>,
) -> Picture {
    let chart = Chart { size: (960, 220), title, description: caption, x: "time, s", y, noise: 0.0, layers };
    Picture { title: title.to_owned(), svg: chart.svg(), caption: caption.to_owned(), keys }
}
