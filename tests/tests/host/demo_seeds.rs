//! The demo finds its undeclared effect for every seed.

/// Ten seeds with ten different effects.
const SEEDS: [u64; 10] = [2, 3, 4, 6, 8, 9, 10, 16, 19, 22];

#[test]
fn the_undeclared_effects_of_ten_seeds_are_found() {
    let mut kinds = std::collections::BTreeSet::new();
    for seed in SEEDS {
        let demo = demo::traced(seed, &|_| {}).unwrap();
        assert!(demo.is_named(), "seed {seed}: {} {:?}", demo.drawn.axis, demo.drawn.effect);
        kinds.insert(demo.drawn.effect.name());

        // The residual is well above the noise before, and most of it is explained after.
        let h = demo.headline().unwrap();
        assert!(h.before > 2.0 * h.noise, "seed {seed}: {h:?}");
        assert!(h.after < 0.5 * h.before, "seed {seed}: {h:?}");

        // Every parameter is that of the drawn effect, within 5 % and its confidence interval.
        let axis = demo.axis().unwrap();
        let found = &axis.found[0];
        let pairs = found.effect.parameters().into_iter().zip(demo.drawn.effect.parameters());
        for (((name, value), (_, truth)), half) in pairs.zip(&found.half_widths) {
            if name != "phase_rad" {
                let error = (value - truth).abs();
                assert!(
                    error < 0.05 * truth.abs() + half,
                    "seed {seed}: {name} {value} ± {half}, truth {truth}"
                );
            }
        }
    }
    assert_eq!(kinds.len(), 10, "{kinds:?}");
}
