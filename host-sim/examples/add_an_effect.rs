//! The declaration of an effect, for the example of `docs/adding-an-effect.md`: the second-order error of an encoder. The
//! effect is read from an entry of a machine file, described by its sentence, and applied to the simulated machine.
//!
//! `cargo run --release -p host-sim --example add_an_effect`

use model::effects::{Effect, EffectModel, EncoderEllipticity};
use model::examples::VMC_MACHINE;
use model::machine::Machine;
use plant::parameters::AxisParameters;

const ENTRY: &str = r#"
[[axis.x.effect]]
name = "encoder_ellipticity"
amplitude_um = 1.5
period_mm = 8.0
phase_rad = 0.0
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for parameter in EncoderEllipticity::PARAMETERS {
        println!("{:<14}{:?}, {}", parameter.key, parameter.unit, parameter.range.description());
    }
    let (effect, errors_um) = errors_um()?;
    println!("x: {}.", effect.sentence(&[], false));
    for (motor_mm, error_um) in errors_um {
        println!("motor at {motor_mm} mm: error of the reading {error_um:+.3} µm");
    }
    Ok(())
}

/// Motor position, mm, and error of its reading, µm.
type ReadingError = (f64, f64);

/// The effect of a machine file, and the error of the reading over one period.
fn errors_um() -> Result<(Effect, Vec<ReadingError>), Box<dyn std::error::Error>> {
    let machine = Machine::parse(&format!("{VMC_MACHINE}{ENTRY}"), "machine.toml")?;
    let axis = &machine.axis["x"];
    let parameters = AxisParameters::of(axis);
    let error_um = |motor_mm: f64| (motor_mm, 1e6 * parameters.resolver_error_m(1e-3 * motor_mm));
    Ok((axis.effect[0].clone(), [0.0, 2.0, 4.0, 6.0, 8.0].map(error_um).to_vec()))
}

#[test]
fn the_error_of_the_reading_is_the_amplitude_after_a_quarter_of_a_period()
-> Result<(), Box<dyn std::error::Error>> {
    let (effect, errors_um) = errors_um()?;
    assert_eq!(effect.name(), "encoder_ellipticity");
    for ((_, error_um), expected_um) in errors_um.into_iter().zip([0.0, 1.5, 0.0, -1.5, 0.0]) {
        assert!((error_um - expected_um).abs() < 1e-9, "{error_um} {expected_um}");
    }
    Ok(())
}
