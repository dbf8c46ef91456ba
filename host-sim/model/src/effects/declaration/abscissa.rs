//! The variable over which a residual is plotted.

/// Horizontal axis of a plot of a residual. If the variable was not measured, the plot is omitted.
#[derive(Clone, Debug, PartialEq)]
pub enum Abscissa {
    /// Time on the session clock.
    Time,
    /// Position on the axis.
    Position,
    /// Position of the motor modulo this period, mm.
    WithinPeriod(f64),
    /// Velocity of the axis.
    Velocity,
    /// Acceleration of the axis.
    Acceleration,
    /// Force of the drive. If no force was logged: acceleration of the axis, to which the force is nearly proportional.
    Force,
    /// Position of the named axis, or of the first other axis.
    OtherPosition(Option<String>),
    /// Acceleration of the named axis, or of the first other axis.
    OtherAcceleration(Option<String>),
}
