//! The variable over which a residual is drawn.

/// What goes to the right in a picture of a residual. Where it was not measured, the picture is left out.
#[derive(Clone, Debug, PartialEq)]
pub enum Abscissa {
    /// The session's clock.
    Time,
    /// Position on the axis.
    Position,
    /// Position of the motor within a period, mm.
    WithinPeriod(f64),
    /// Of the axis.
    Velocity,
    /// Of the axis.
    Acceleration,
    /// Of the drive; where no force was logged, the acceleration of the axis, which follows it.
    Force,
    /// Position on another axis: of this name, or the first of the others.
    OtherPosition(Option<String>),
    /// Acceleration of another axis: of this name, or the first of the others.
    OtherAcceleration(Option<String>),
}
