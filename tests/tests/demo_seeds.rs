//! The demo names what it was not told, seed after seed.

use studies::demo;

/// Ten seeds whose machines have ten different effects.
const SEEDS: [u64; 10] = [2, 3, 4, 6, 8, 9, 10, 16, 19, 22];

#[test]
fn ten_seeds_each_name_their_undeclared_effect() {
    let mut kinds = std::collections::BTreeSet::new();
    for seed in SEEDS {
        let demo = demo::run(seed, &|_| {}).unwrap();
        assert!(demo.is_named(), "seed {seed}: {} {:?}", demo.drawn.axis, demo.drawn.effect);
        kinds.insert(demo.drawn.effect.name());

        // A residual that was found must be found in a signal: well above the noise before, and most of
        // what stood above it gone.
        let h = demo.headline().unwrap();
        assert!(h.before > 2.0 * h.noise, "seed {seed}: {h:?}");
        assert!(h.after < 0.5 * h.before, "seed {seed}: {h:?}");

        // The parameter is the one that was drawn, to 5 % or to its own confidence interval.
        let axis = demo.axis().unwrap();
        let found = &axis.found[0];
        let pairs = found.effect.parameters().into_iter().zip(demo.drawn.effect.parameters());
        for (((name, value), (_, truth)), half) in pairs.zip(&found.half_widths) {
            if name != "phase_rad" {
                let off = (value - truth).abs();
                assert!(
                    off < 0.05 * truth.abs() + half,
                    "seed {seed}: {name} {value} ± {half}, truth {truth}"
                );
            }
        }
    }
    assert_eq!(kinds.len(), 10, "{kinds:?}");
}
