//! A mode in which the tool oscillates.

/// A second-order mode: ω²/(s² + 2ζωs + ω²) of the table's motion, less that motion, times the participation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// ω/2π.
    pub frequency_hz: f64,
    /// ζ.
    pub damping_ratio: f64,
    /// Displacement of the tool in the mode, relative to that of the mass which the table drives.
    pub participation: f64,
}
