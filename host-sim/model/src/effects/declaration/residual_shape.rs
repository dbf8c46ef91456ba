//! How a residual depends on the position: resolutions and periods with which a fit starts.

/// What a residual that is left shows over the position, in a scope with table or force stage. By default nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ResidualShape {
    /// Number of knots over the travel that describe the table residual best; `None`: it does not depend on the position,
    /// or less than on a line.
    pub pitch_knots: Option<u32>,
    /// Number of knots that describe the table residual best with a curve for each direction.
    pub pitch_knots_each_way: Option<u32>,
    /// Number of knots that describe the force residual against the motion best.
    pub friction_knots: Option<u32>,
    /// Number of knots that describe best by what factor of the modelled stretch between motor and table the table residual changes.
    pub stiffness_knots: Option<u32>,
    /// Of each other axis over which the tool residual depends more than on a line, how.
    pub tool_over_others: Vec<ResidualOverOther>,
    /// Periodic parts.
    pub waves: Vec<ResidualWave>,
}

#[cfg(test)]
impl ResidualShape {
    /// A residual for which every map is tried: over the position of the axis, and over 0 to 100 mm of another one.
    #[must_use]
    pub fn over(source: &str) -> Self {
        let over = ResidualOverOther { source: source.to_owned(), travel_mm: [0.0, 100.0], knots: 4 };
        Self {
            pitch_knots: Some(6),
            pitch_knots_each_way: Some(4),
            friction_knots: Some(5),
            stiffness_knots: Some(4),
            tool_over_others: vec![over],
            waves: Vec::new(),
        }
    }
}

/// How the tool residual of an axis depends on the position of another one.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualOverOther {
    /// Name of the other axis.
    pub source: String,
    /// Its lowest and highest position, mm.
    pub travel_mm: [f64; 2],
    /// Number of knots over this travel that describe the residual best.
    pub knots: u32,
}

/// A periodic part amplitude·sin(2π·x/period + phase) of a residual over the motor position x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResidualWave {
    /// The residual.
    pub of: WaveOf,
    /// Period, mm.
    pub period_mm: f64,
    /// µm or N.
    pub amplitude: f64,
    /// rad.
    pub phase_rad: f64,
}

/// The residual in which a wave was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaveOf {
    /// Table, µm.
    Table,
    /// Force, N.
    Force,
    /// Force times the direction of motion, N.
    Friction,
}
