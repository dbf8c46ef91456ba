//! Effects on a machine of rigid bodies: what pushes an axis and what lies behind the tables acts there, too.

use files::log::Channel;

use crate::bench::{ROUNDING_N, assert_all, assert_near, circle, lines, run};

/// The machine of bodies, without any effect.
const BODIES: &str = include_str!("../../../host-sim/machines/bodies.toml");

fn with(effect: &str) -> String {
    format!("{BODIES}\n[[axis.x.effect]]\n{effect}\n")
}

/// A load is a force more in both directions, an asymmetry h·|v|.
#[test]
fn forces() {
    let motion = lines(&[(80.0, 50.0), (0.0, 50.0)]);
    let plain = run(BODIES, &motion);
    let cases = [
        ("name = \"constant_load\"\nforce_n = 300.0", 300.0),
        ("name = \"friction_asymmetry\"\nhalf_difference_n_s_per_m = 400.0", 400.0 * 0.05),
    ];
    for (effect, expected_n) in cases {
        let seen = run(&with(effect), &motion);
        let moved_n = seen.moved(Channel::Force, &plain);
        for mm_s in [50.0, -50.0] {
            assert_all(&moved_n, &seen.steady(mm_s), expected_n, ROUNDING_N, effect);
        }
    }
}

/// On top of what the bodies lean, the tool is off by the square angle times y; nothing else changes.
#[test]
fn squareness() {
    let motion = circle(50.0, 100.0, 1.0);
    let (plain, seen) = (run(BODIES, &motion), run(&with("name = \"squareness\"\num_per_m = 30.0"), &motion));
    seen.assert_same(&plain, &[Channel::Tool]);
    let y_mm = seen.channel("y", Channel::Table);
    for (moved_um, &y_mm) in seen.moved(Channel::Tool, &plain).iter().zip(y_mm) {
        assert_near(*moved_um, 30.0 * 1e-3 * y_mm, 1e-9, "tool");
    }
    // What the bodies lean by is there without any effect: the circle is not the tables' alone.
    let leaning_um = plain.beyond_um(Channel::Tool, Channel::Table);
    assert!(leaning_um.iter().any(|um| um.abs() > 0.01), "the bodies do not lean");
}
