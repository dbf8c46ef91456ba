//! Effects on a machine of rigid bodies: forces on an axis, and between table and tool.

use files::log::Channel;

use crate::effects::runs::{ROUNDING_N, assert_all, assert_near, circle, lines, run};

/// The machine of rigid bodies, without effects.
const BODIES: &str = include_str!("../../../../host-sim/machines/bodies.toml");

fn with(effect: &str) -> String {
    format!("{BODIES}\n[[axis.x.effect]]\n{effect}\n")
}

/// A load adds its force in both directions, an asymmetry h·|v|.
#[test]
fn forces() {
    let motion = lines(&[(80.0, 50.0), (0.0, 50.0)]);
    let plain = run(BODIES, &motion);
    let cases = [
        ("name = \"constant_load\"\nforce_n = 300.0", 300.0),
        ("name = \"friction_asymmetry\"\nhalf_difference_n_s_per_m = 400.0", 400.0 * 0.05),
    ];
    for (effect, expected_n) in cases {
        let effect_run = run(&with(effect), &motion);
        let change_n = effect_run.change(Channel::Force, &plain);
        for mm_s in [50.0, -50.0] {
            assert_all(&change_n, &effect_run.steady(mm_s), expected_n, ROUNDING_N, effect);
        }
    }
}

/// The tool is displaced by the squareness times y, in addition to the tilt of the bodies; nothing else changes.
#[test]
fn squareness() {
    let motion = circle(50.0, 100.0, 1.0);
    let (plain, effect_run) =
        (run(BODIES, &motion), run(&with("name = \"squareness\"\num_per_m = 30.0"), &motion));
    effect_run.assert_same(&plain, &[Channel::Tool]);
    let y_mm = effect_run.channel("y", Channel::Table);
    for (change_um, &y_mm) in effect_run.change(Channel::Tool, &plain).iter().zip(y_mm) {
        assert_near(*change_um, 30.0 * 1e-3 * y_mm, 1e-9, "tool");
    }
    // The bodies tilt without any effect.
    let offset_um = plain.difference_um(Channel::Tool, Channel::Table);
    assert!(offset_um.iter().any(|um| um.abs() > 0.01), "the bodies do not tilt");
}
