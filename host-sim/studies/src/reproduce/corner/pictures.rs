//! Contours at the corner, and overshoot over the gain.

use super::experiment::{Experiment, FEEDFORWARD_PERCENT, LawAtGain};
use super::machine::{Track, Tuning, corner_m};
use crate::reproduce::study::{Picture, ReproduceError};
use model::axis::Law;
use pages::plot::{Chart, Ink, Layer};

/// Width of a contour picture, pixels.
const WIDTH: f64 = 620.0;

/// Space that a chart uses for labels next to and below its plane, pixels.
const LABELS: (f64, f64) = (66.0, 40.0);

/// Margin that a chart leaves above and below the data, fraction of the data's height each.
const MARGIN: f64 = 0.06;

/// All pictures.
///
/// # Errors
/// If a prediction fails.
pub fn all(experiment: &Experiment) -> Result<Vec<Picture>, ReproduceError> {
    let predicted = (0..experiment.hpc.len()).map(|gain| prediction(experiment, gain));
    let laws = experiment.hpc.iter().zip(&experiment.p).map(|(hpc, p)| both_laws(hpc, p));
    Ok(predicted.chain(laws).chain([over_gain(experiment)?]).collect())
}

/// Plant and prediction at one gain, by its index.
fn prediction(experiment: &Experiment, gain: usize) -> Picture {
    const HALF_UM: f64 = 300.0;
    let (run, prediction) = (&experiment.hpc[gain], &experiment.predictions[gain]);
    let corner = &run.printed;
    let tool = &corner.motion.tool;
    let tracks = [
        (Ink::Axis, &corner.motion.command),
        (Ink::Third, &prediction.motor),
        (Ink::After, tool),
        (Ink::Before, &prediction.tool),
    ];
    Picture {
        title: format!("The corner at Kp = {} 1/s, plant and prediction", run.gain_per_s),
        svg: contours("Tool and motors at the corner", HALF_UM, &tracks),
        caption: format!(
            "HPC, Kf = {FEEDFORWARD_PERCENT} %, {HALF_UM} µm on either side of the corner, passed from left to \
             right. The simulated tool and the tool predicted from the command differ by at most {:.1} µm; the \
             overshoot is {:.0} µm.",
            corner.difference_um(tool, &prediction.tool),
            corner.overshoot_um(),
        ),
        legend: vec![
            ("axis", "command".to_owned()),
            ("cw", "motors, predicted".to_owned()),
            ("after", "tool, plant".to_owned()),
            ("before", "tool, predicted".to_owned()),
        ],
    }
}

/// P and HPC on the plant at one gain.
fn both_laws(hpc: &LawAtGain, p: &LawAtGain) -> Picture {
    const HALF_UM: f64 = 900.0;
    let tracks = [
        (Ink::Axis, &hpc.printed.motion.command),
        (Ink::Before, &p.printed.motion.tool),
        (Ink::After, &hpc.printed.motion.tool),
        (Ink::Fourth, &p.radius_kept.motion.tool),
    ];
    Picture {
        title: format!("P and HPC at Kp = {} 1/s", hpc.gain_per_s),
        svg: contours("The tool at the corner under both laws", HALF_UM, &tracks),
        caption: format!(
            "Kf = {FEEDFORWARD_PERCENT} % keeps a circle's radius under HPC; with this value, P rounds the corner \
             by {:.0} µm. With the {:.0} % that keep the radius under P, P overshoots by {:.0} µm.",
            p.printed.rounding_um(),
            p.feedforward.tool_percent,
            p.radius_kept.overshoot_um(),
        ),
        legend: vec![
            ("axis", "command".to_owned()),
            ("after", format!("HPC, Kf = {FEEDFORWARD_PERCENT} %")),
            ("before", format!("P, Kf = {FEEDFORWARD_PERCENT} %")),
            ("ccw", format!("P, Kf = {:.0} %", p.feedforward.tool_percent)),
        ],
    }
}

/// Overshoot over Kp: predictions as lines, the plant as markers.
fn over_gain(experiment: &Experiment) -> Result<Picture, ReproduceError> {
    let cases = [
        (Ink::After, Law::Hpc, FEEDFORWARD_PERCENT),
        (Ink::Third, Law::Hpc, 0.0),
        (Ink::Before, Law::P, FEEDFORWARD_PERCENT),
    ];
    let mut layers = Vec::new();
    for (ink, law, feedforward_percent) in cases {
        let line = (0..=14).map(|k| {
            let gain_per_s = 24.0 + 4.0 * f64::from(k);
            let overshoot =
                experiment.predicted_overshoot_um(Tuning { law, gain_per_s, feedforward_percent })?;
            Ok((gain_per_s, overshoot))
        });
        layers.push(Layer { ink, points: line.collect::<Result<_, ReproduceError>>()?, is_marked: false });
        let plant = if law == Law::Hpc { &experiment.hpc } else { &experiment.p };
        for run in plant {
            let corner = if feedforward_percent > 0.0 { &run.printed } else { &run.without };
            let points = vec![(run.gain_per_s, corner.overshoot_um())];
            layers.push(Layer { ink, points, is_marked: true });
        }
    }
    let chart = Chart {
        size: (960, 260),
        title: "Overshoot over the position gain",
        description: "Lines: predicted from the command; circles: the plant.",
        x: "Kp, 1/s",
        y: "overshoot, µm",
        noise: Some(0.0),
        layers,
    };
    Ok(Picture {
        title: "Overshoot over the position gain".to_owned(),
        svg: chart.svg(),
        caption: "Overshoot of the tool beyond the second line. Lines: predicted, with the mechanics identified at \
                  Kp = 33; circles: the plant."
            .to_owned(),
        legend: vec![
            ("after", format!("HPC, Kf = {FEEDFORWARD_PERCENT} %")),
            ("cw", "HPC, Kf = 0".to_owned()),
            ("before", format!("P, Kf = {FEEDFORWARD_PERCENT} %")),
        ],
    })
}

/// Contours around the corner, µm, with the same scale on both axes.
fn contours(title: &str, half_um: f64, tracks: &[(Ink, &Track)]) -> String {
    let layers: Vec<Layer> = tracks
        .iter()
        .map(|&(ink, track)| Layer { ink, points: near(track, half_um), is_marked: false })
        .collect();
    let points = || layers.iter().flat_map(|layer| &layer.points);
    // The plane of a chart spans the data and zero, with a margin above and below.
    let span = |values: &mut dyn Iterator<Item = f64>, start: f64| {
        let (min, max) = values.fold((start, start), |(min, max), v| (min.min(v), max.max(v)));
        max - min
    };
    let width = span(&mut points().map(|point| point.0), -half_um);
    let data_height = span(&mut points().map(|point| point.1), 0.0) * (1.0 + 2.0 * MARGIN);
    let height = LABELS.1 + (WIDTH - LABELS.0) * data_height / width;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few hundred pixels")]
    let size = (WIDTH as u32, height.round() as u32);
    Chart {
        size,
        title,
        description: "Plan view; the corner of the command is at 0, 0.",
        x: "X − corner, µm",
        y: "Y − corner, µm",
        noise: Some(0.0),
        layers,
    }
    .plan_svg()
}

/// Points of a track within ±`half_um` of the corner in X and Y, µm.
fn near(track: &Track, half_um: f64) -> Vec<(f64, f64)> {
    let [cx, cy] = corner_m();
    track
        .points()
        .map(|[x, y]| (1e6 * (x - cx), 1e6 * (y - cy)))
        .filter(|(x, y)| x.abs() <= half_um && y.abs() <= half_um)
        .collect()
}
