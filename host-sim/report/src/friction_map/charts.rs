//! Charts of a friction map: runs and laws over speed, and the residuals of both laws.

use friction_map::law::Law;
use friction_map::map::FrictionMap;
use friction_map::selection::Selection;
use maud::{Markup, html};

use pages::markup::{figure, legend, line_entry, point_entry, surface_entry};
use pages::plot::{Chart, Ink, Layer};

/// The direction factors of the two sides of a map.
const SIDES: [f64; 2] = [-1.0, 1.0];

/// Both charts under their legend.
pub fn charts(map: &FrictionMap, selection: &Selection) -> Markup {
    let (before, after) = (&selection.declared.law, &selection.fitted.law);
    let entries = [
        point_entry("cw", "measured, mean of a run"),
        line_entry("before", "Coulomb and viscous friction"),
        line_entry("after", "with the terms found"),
        surface_entry("noise", "within ± 2 standard errors of a mean"),
    ];
    html! {
        (legend(&entries))
        (figure("wide", &friction(map, before, after), "Measured and modelled."))
        (figure("wide", &residuals(map, before, after), "Measured minus modelled, from fits to all runs."))
    }
}

fn friction(map: &FrictionMap, before: &Law, after: &Law) -> String {
    let run_layer =
        |velocity, force| Layer { ink: Ink::Third, points: vec![(velocity, force)], is_marked: true };
    let mut layers: Vec<Layer> = map.runs.iter().map(|run| run_layer(run.velocity, run.force)).collect();
    layers.extend(curves(map, before, Ink::Before));
    layers.extend(curves(map, after, Ink::After));
    let chart = Chart {
        size: (960, 260),
        title: "Friction over speed",
        description: "Measured runs, and the law before and after.",
        x: &format!("speed, {}", map.unit.speed()),
        y: &format!("{}, {}", map.unit.drive(), map.unit.force()),
        noise: Some(0.0),
        layers,
    };
    chart.svg()
}

fn residuals(map: &FrictionMap, before: &Law, after: &Law) -> String {
    let of_law = |ink: Ink, law: &Law| {
        let of_side = |side: f64| {
            let runs = map.runs.iter().filter(move |run| run.velocity * side > 0.0);
            let points = runs.map(|run| (run.velocity, run.force - law.force(run.velocity))).collect();
            Layer { ink, points, is_marked: true }
        };
        SIDES.map(of_side).into_iter().filter(|layer| !layer.points.is_empty())
    };
    let chart = Chart {
        size: (960, 220),
        title: "Residual over speed",
        description: "Measured minus law, before and after.",
        x: &format!("speed, {}", map.unit.speed()),
        y: &format!("residual, {}", map.unit.force()),
        noise: Some(2.0 * map.standard_error().unwrap_or(0.0)),
        layers: of_law(Ink::Before, before).chain(of_law(Ink::After, after)).collect(),
    };
    chart.svg()
}

/// A law over the speeds of the map, one curve in each direction.
fn curves(map: &FrictionMap, law: &Law, ink: Ink) -> Vec<Layer> {
    const POINTS: u32 = 120;
    let of_side = |side: f64| {
        let speeds = map.runs.iter().map(|run| side * run.velocity).filter(|speed| *speed > 0.0);
        let [min, max] = numerics::min_max(speeds);
        let at = |i: u32| {
            let velocity = side * (min + (max - min) * f64::from(i) / f64::from(POINTS));
            (velocity, law.force(velocity))
        };
        (max > min).then(|| Layer { ink, points: (0..=POINTS).map(at).collect(), is_marked: false })
    };
    SIDES.map(of_side).into_iter().flatten().collect()
}
