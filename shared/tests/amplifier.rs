//! What a power stage is told it can do, and what is said where it cannot be used.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use shared::drive::{Amplifier, DriveError};
use shared::scalar::Fixed;

/// The first and the last force that are taken, the next ones beyond them refused, and the message has both.
#[test]
fn a_full_scale_force_is_refused_with_its_range() {
    for (force_n, taken) in [(1e-3, true), (0.99e-3, false), (131_000.0, true), (131_001.0, false)] {
        let made = Amplifier::<Fixed>::new(force_n, 8400);
        assert_eq!(made.is_ok(), taken, "{force_n} N");
    }
    let said = Amplifier::<Fixed>::new(0.0, 8400).unwrap_err().to_string();
    let numbers: Vec<f64> = said.split(' ').filter_map(|word| word.parse().ok()).collect();
    assert_eq!(numbers, [1e-3, 131_000.0], "{said}");
    assert!(said.contains("force"), "{said}");
}

#[test]
fn a_power_stage_without_counts_is_refused() {
    let error = Amplifier::<Fixed>::new(100.0, 0).unwrap_err();
    assert_eq!(error, DriveError::NoPwm);
    assert!(error.to_string().contains("count"), "{error}");
}
