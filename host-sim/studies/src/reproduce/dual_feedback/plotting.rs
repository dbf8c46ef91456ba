//! Lines and legends common to the pictures of the appendix.

use super::ideal_loop::TimeConstants;
use files::format::fixed;
use pages::plot::{Ink, Layer};

/// Inks of the three systems [`super::ideal_loop::ALPHAS`].
pub const INKS: [Ink; 3] = [Ink::Before, Ink::Third, Ink::Fourth];

/// A line.
pub fn line(ink: Ink, points: Vec<(f64, f64)>) -> Layer {
    Layer { ink, points, is_marked: false }
}

/// A single point marker.
pub fn marker(ink: Ink, point: (f64, f64)) -> Layer {
    Layer { ink, points: vec![point], is_marked: true }
}

/// Legend of the three systems and of the markers.
pub fn legend(systems: [TimeConstants; 3], markers: &str) -> Vec<(&'static str, String)> {
    let name = |times: TimeConstants| format!("T' = {} s", fixed(times.dual_s, 2));
    let [a, b, c] = systems.map(name);
    vec![("before", a), ("cw", b), ("ccw", c), ("after mark", markers.to_owned())]
}

/// Rounds to a number of decimals, for a printed bound.
pub fn rounded(value: f64, decimals: i32) -> f64 {
    let unit = 10f64.powi(decimals);
    (value * unit).round() / unit
}
