//! The direction of a friction that yields before it slides (Dahl, 1968): dh/dx = (1 − h·sign(dx))/slip, −1 to 1.

/// Slip of the friction of a drive whose velocity is commanded, m: that of rolling guides and seals is 1 to 50 µm.
pub const DRIVE_SLIP_M: f64 = 5e-6;

/// The direction after a travel in one direction, m, in which friction reverses over the slip, m: exactly. With a slip of zero it is the
/// sign of the travel, which must not be zero then.
#[must_use]
pub fn after(direction: f64, travel_m: f64, slip_m: f64) -> f64 {
    let sign = if travel_m < 0.0 { -1.0 } else { 1.0 };
    sign + (direction - sign) * libm::exp(-travel_m.abs() / slip_m)
}
