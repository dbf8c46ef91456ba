//! The direction that friction takes from a motion: its sign, or where friction yields before it slides, a value between.
//!
//! Dahl's model, [`friction_direction`]. Over the distance `slip` after a reversal, z covers 1 − 2/e of the way from one
//! sign to the other. `LuGre` friction at low speed is the same with slip = Coulomb friction / σ0.

use plant::friction_direction;

/// z at each sample of a motion, −1 to 1. With a slip of zero it is the sign of the last motion, 0 before the first.
#[must_use]
pub fn of(position_m: &[f64], slip_m: f64) -> Vec<f64> {
    let mut direction = 0.0;
    let mut before = position_m.first().copied().unwrap_or(0.0);
    let step = |&position: &f64| {
        let moved = position - before;
        before = position;
        if moved != 0.0 {
            direction = friction_direction::after(direction, moved, slip_m);
        }
        direction
    };
    position_m.iter().map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_direction_follows_a_reversal_over_the_slip() {
        // 100 µm forward in steps of 1 µm, then back; a slip of 10 µm.
        let path: Vec<f64> = (0..200).map(|i| 1e-6 * f64::from(100 - (i - 100_i32).abs())).collect();
        let direction = of(&path, 10e-6);
        assert!((direction[100] - 1.0).abs() < 1e-4);
        // 10 µm after the reversal: 1 − 2·(1 − 1/e).
        assert!((direction[110] - (2.0 / std::f64::consts::E - 1.0)).abs() < 1e-3);
        assert!((direction[199] + 1.0).abs() < 1e-3);
        assert_eq!(of(&path, 0.0)[101].to_bits(), (-1.0_f64).to_bits());
    }
}
