//! The error of the tool on a grid over the measured volume, as CSV.

use super::analysis::Analysis;

/// Most points of a grid.
pub const MAX_POINTS: usize = 1_000_000;

/// The positions of an axis on a grid with steps of at most `step_mm`.
fn positions_mm([low_mm, high_mm]: [f64; 2], step_mm: f64) -> Vec<f64> {
    let steps = ((high_mm - low_mm) / step_mm).ceil().max(1.0);
    let positions =
        std::iter::successors(Some(0.0), |step| Some(step + 1.0)).take_while(|step| *step <= steps);
    let mut positions_mm: Vec<f64> =
        positions.map(|step| low_mm + (high_mm - low_mm) * step / steps).collect();
    // An axis that was not moved has one position.
    positions_mm.dedup();
    positions_mm
}

/// Number of points of a grid.
#[must_use]
pub fn points(analysis: &Analysis, step_mm: f64) -> f64 {
    analysis.measured_mm.iter().map(|[low_mm, high_mm]| ((high_mm - low_mm) / step_mm).ceil() + 1.0).product()
}

/// The table: positions, mm, and actual less commanded position of the tool, µm.
#[must_use]
pub fn csv(analysis: &Analysis, step_mm: f64) -> String {
    let [x, y, z] = analysis.measured_mm.map(|measured_mm| positions_mm(measured_mm, step_mm));
    let mut text = "x_mm,y_mm,z_mm,x_error_um,y_error_um,z_error_um\n".to_owned();
    for z_mm in &z {
        for y_mm in &y {
            for x_mm in &x {
                let [x_um, y_um, z_um] = analysis.error_um([*x_mm, *y_mm, *z_mm]);
                text += &format!("{x_mm:.4},{y_mm:.4},{z_mm:.4},{x_um:.3},{y_um:.3},{z_um:.3}\n");
            }
        }
    }
    text
}
