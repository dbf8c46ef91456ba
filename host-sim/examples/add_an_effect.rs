//! The declaration of an effect, for the example of `docs/adding-an-effect.md`: a drag that grows with the square of the velocity. The
//! effect is read from an entry of a machine file, described by its sentence, and applied to the simulated machine.
//!
//! `cargo run --release -p host-sim --example add_an_effect`

use model::effects::{Effect, EffectModel, QuadraticDrag};
use model::examples::VMC_MACHINE;
use model::machine::Machine;
use plant::parameters::AxisParameters;

const ENTRY: &str = r#"
[[axis.x.effect]]
name = "quadratic_drag"
force_n = 80.0
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for parameter in QuadraticDrag::PARAMETERS {
        println!("{:<14}{:?}, {}", parameter.key, parameter.unit, parameter.range.description());
    }
    let (effect, forces_n) = forces_n()?;
    println!("x: {}.", effect.sentence(&[], false));
    for (m_per_s, force_n) in forces_n {
        println!("at {m_per_s} m/s: {force_n:+.1} N against the motion");
    }
    Ok(())
}

/// Velocity, m/s, and force, N.
type ForceAt = (f64, f64);

/// The effect of a machine file, and its force at some velocities.
fn forces_n() -> Result<(Effect, Vec<ForceAt>), Box<dyn std::error::Error>> {
    let machine = Machine::parse(&format!("{VMC_MACHINE}{ENTRY}"), "machine.toml")?;
    let axis = &machine.axis["x"];
    let friction = AxisParameters::of(axis).friction;
    let force_n = |m_per_s: f64| (m_per_s, friction.beyond_linear_n(m_per_s));
    Ok((axis.effect[0].clone(), [-1.0, -0.5, 0.0, 0.5, 1.0].map(force_n).to_vec()))
}

#[test]
fn the_force_is_a_quarter_at_half_the_velocity() -> Result<(), Box<dyn std::error::Error>> {
    let (effect, forces_n) = forces_n()?;
    assert_eq!(effect.name(), "quadratic_drag");
    for ((_, force_n), expected_n) in forces_n.into_iter().zip([-80.0, -20.0, 0.0, 20.0, 80.0]) {
        assert!((force_n - expected_n).abs() < 1e-9, "{force_n} {expected_n}");
    }
    Ok(())
}
