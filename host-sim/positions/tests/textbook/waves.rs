//! Periodic errors at targets that resolve them, and at targets that do not.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::generator::{Axis, Wave, covered, effect};

/// 40 targets about every 3 mm, uneven by up to 0.9 mm.
fn dense(random: &mut ChaCha8Rng) -> Axis {
    let mut axis = Axis::quiet(0.3);
    axis.targets_mm = (0..40).map(|i| 3.0 * f64::from(i) + random.random_range(0.0..0.9)).collect();
    axis.curve_um = vec![0.0; 40];
    axis.gap_curve_um = vec![0.0; 40];
    axis
}

#[test]
fn a_wave_is_found_with_amplitude_period_and_phase() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let (mut hits, mut intervals) = (0, 0);
    for seed in 0..20 {
        let mut axis = dense(&mut random);
        let wave = Wave {
            amplitude_um: random.random_range(1.0..6.0),
            period_mm: random.random_range(8.0..40.0),
            phase_rad: random.random_range(-3.0..3.0),
        };
        axis.wave = Some(wave);
        axis.gap_um = 5.0;
        let analysis = axis.analysed(seed, false);
        let found = effect(&analysis, "pitch_cyclic")
            .unwrap_or_else(|| panic!("{seed}: {wave:?} {:?}", analysis.effects));
        assert!(effect(&analysis, "pitch_map").is_none(), "{seed}");
        assert!(found.aliases_mm.is_empty(), "{found:?}");
        for (key, truth) in [
            ("amplitude_um", wave.amplitude_um),
            ("period_mm", wave.period_mm),
            ("phase_rad", wave.phase_rad),
        ] {
            let (hit, count) = covered(found, key, &[truth]);
            hits += hit;
            intervals += count;
        }
    }
    assert!(intervals == 60 && hits >= 53, "{hits} of {intervals}");
}

/// At even targets every 3 mm, 12 mm looks like 4 mm and 2.4 mm.
#[test]
fn at_even_targets_a_wave_has_its_aliases() {
    let mut axis = dense(&mut ChaCha8Rng::seed_from_u64(1));
    axis.targets_mm = (0..40).map(|i| 3.0 * f64::from(i)).collect();
    axis.wave = Some(Wave { amplitude_um: 4.0, period_mm: 12.0, phase_rad: 0.4 });
    let analysis = axis.analysed(1, false);
    let found = effect(&analysis, "pitch_cyclic").unwrap();
    assert!(found.aliases_mm.iter().any(|mm| (mm - 4.0).abs() < 0.05), "{found:?}");
    assert!(found.rivals.contains(&"pitch_cyclic"));
    assert!(
        analysis.notes.iter().any(|note| note.starts_with("The targets are 3 mm apart")),
        "{:?}",
        analysis.notes
    );
}
