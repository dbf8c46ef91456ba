//! The direction of a friction that yields before it slides (Dahl, 1968): dh/dx = (1 − h·sign(dx))/slip, −1 to 1.

/// The direction after a travel in one direction, m, in which friction reverses over the slip, m: exactly. With a slip of zero it is the
/// sign of the travel, which must not be zero then.
#[must_use]
pub fn after(direction: f64, travel_m: f64, slip_m: f64) -> f64 {
    let sign = if travel_m < 0.0 { -1.0 } else { 1.0 };
    sign + (direction - sign) * (-travel_m.abs() / slip_m).exp()
}
