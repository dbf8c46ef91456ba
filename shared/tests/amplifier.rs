//! Rejected data of a power stage, and their error messages.

use shared::drive::{Amplifier, DriveError};
use shared::scalar::Fixed;

/// Both ends of the range are accepted, the values just beyond are rejected, and the message states the range.
#[test]
fn a_full_scale_force_out_of_range_is_rejected_with_the_range() {
    for (force_n, accepted) in [(1e-3, true), (0.99e-3, false), (131_000.0, true), (131_001.0, false)] {
        let amplifier = Amplifier::<Fixed>::new(force_n, 8400);
        assert_eq!(amplifier.is_ok(), accepted, "{force_n} N");
    }
    let message = Amplifier::<Fixed>::new(0.0, 8400).unwrap_err().to_string();
    let numbers: Vec<f64> = message.split(' ').filter_map(|word| word.parse().ok()).collect();
    assert_eq!(numbers, [1e-3, 131_000.0], "{message}");
    assert!(message.contains("force"), "{message}");
}

#[test]
fn a_power_stage_without_pwm_counts_is_rejected() {
    let error = Amplifier::<Fixed>::new(100.0, 0).unwrap_err();
    assert_eq!(error, DriveError::NoPwm);
    assert!(error.to_string().contains("count"), "{error}");
}
