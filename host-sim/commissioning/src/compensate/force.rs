//! Force feed-forward from the identified masses, friction and loads.

use heapless::Vec;
use shared::compensate::settings::{
    CYCLES, Cycle, ForceModel, FrictionWarmUp, Points, Stribeck, TableFriction,
};

use crate::compensate::cycles::{self, Wave};
use crate::compensate::tables::points;
use model::axis::Settings;
use model::machine::Axis;
use plant::equivalent;
use plant::friction::SlidingState;
use plant::friction_direction::DRIVE_SLIP_M;
use plant::parameters::AxisParameters;

/// A velocity at which no friction is above its sliding level, m/s.
const FAST_M_PER_S: f64 = 10.0;

/// The force model of an axis; `None` if its masses are not known.
#[must_use]
pub fn model(
    parameters: &AxisParameters,
    settings: &Settings,
    travel_m: [f64; 2],
    start_s: f64,
) -> Option<ForceModel> {
    if !settings.has_mass() {
        return None;
    }
    let friction = &parameters.friction;
    let stribeck = |excess_n: f64, velocity_mm_s: f64| {
        (excess_n != 0.0).then_some(Stribeck { excess_n, velocity_m_per_s: 1e-3 * velocity_mm_s })
    };
    let motor = &parameters.motor_stribeck;
    Some(ForceModel {
        motor_mass_kg: parameters.motor_mass_kg,
        table_mass_kg: parameters.table_mass_kg,
        motor_coulomb_n: parameters.motor_coulomb_n,
        motor_stribeck: stribeck(motor.static_excess_n, motor.velocity_mm_s),
        friction: TableFriction {
            coulomb_n: friction.coulomb_n,
            viscous_n_s_per_m: friction.viscous_n_s_per_m,
            half_difference_n_s_per_m: friction.asymmetry.half_difference_n_s_per_m,
            presliding_stiffness_n_per_m: friction
                .has_bristles()
                .then_some(friction.bristle_stiffness_n_per_m),
            stribeck: stribeck(friction.stribeck.static_excess_n, friction.stribeck.velocity_mm_s),
            map: friction_map(parameters, travel_m),
            warm_up: warm_up(parameters, start_s),
        },
        load: load(parameters, travel_m),
        lag_s: lag_s(settings),
        share: 1.0,
    })
}

/// The friction of a drive whose velocity is commanded, as a trace has fitted it, as that of the mass with which it is simulated. `None`:
/// it has no friction, or masses of its own, which say nothing about the drive.
#[must_use]
pub fn of_velocity_drive(axis: &Axis) -> Option<ForceModel> {
    let friction_m_per_s2 = axis.fitted_velocity_drive().friction_m_per_s2;
    let is_known = friction_m_per_s2 > 0.0 && !axis.settings.has_mass();
    is_known.then(|| ForceModel {
        friction: TableFriction {
            coulomb_n: equivalent::MOTOR_KG * friction_m_per_s2,
            presliding_stiffness_n_per_m: Some(equivalent::MOTOR_KG * friction_m_per_s2 / DRIVE_SLIP_M),
            ..TableFriction::default()
        },
        lag_s: lag_s(&axis.settings),
        ..ForceModel::default()
    })
}

/// The friction that is not the same everywhere, less the Coulomb friction.
fn friction_map(parameters: &AxisParameters, travel_m: [f64; 2]) -> Option<Points> {
    let friction = &parameters.friction;
    let level_n = |position_m: f64| {
        let late_s = f64::MAX.sqrt();
        friction.level_n(
            FAST_M_PER_S,
            SlidingState { position_m, filtered_speed_m_per_s: FAST_M_PER_S, time_s: late_s },
        ) - friction.coulomb_n
    };
    let map = points(travel_m, level_n);
    let varies = map.values.iter().any(|n| n.abs() > 1e-9 * friction.coulomb_n.max(1.0));
    (varies && friction.curve.is_none()).then_some(map)
}

fn warm_up(parameters: &AxisParameters, start_s: f64) -> Option<FrictionWarmUp> {
    let warm_up = &parameters.friction.warm_up;
    warm_up.changes().then(|| FrictionWarmUp {
        force_n: warm_up.force_n * libm::exp(-start_s / warm_up.time_constant_s),
        time_constant_s: warm_up.time_constant_s,
    })
}

fn load(parameters: &AxisParameters, travel_m: [f64; 2]) -> Option<Points> {
    let load = &parameters.load;
    let has_load = load.constant.force_n != 0.0 || load.varies();
    has_load.then(|| points(travel_m, |x| load.force_n(x)))
}

/// How late the axis is behind its command at constant velocity, s: (1 − Kf)/Kp, as the loop has the velocity gain Kp with both
/// control laws.
fn lag_s(settings: &Settings) -> f64 {
    let controller = &settings.controller;
    let feedforward = 0.01 * controller.feedforward_percent.unwrap_or(0.0);
    controller.position_gain_per_s.map_or(0.0, |gain| ((1.0 - feedforward) / gain).max(0.0))
}

/// Tables of the motor's force ripple, and the number of ripples without a table.
#[must_use]
pub fn ripple(parameters: &AxisParameters) -> (Vec<Cycle, CYCLES>, usize) {
    let waves = parameters.ripple.iter().map(|ripple| Wave {
        period_m: 1e-3 * ripple.period_mm,
        amplitude: ripple.amplitude_n,
        value: Box::new(|position_m| ripple.force_n(position_m)),
    });
    cycles::tables(waves.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::machine::Machine;

    fn axis(keys: &str) -> Axis {
        let text = format!(
            "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ndrive = \"velocity\"\nposition_gain_per_s = 50.0\n\
             feedforward_percent = 60.0\n{keys}[axis.x.log_offsets]\nvelocity_friction_m_per_s2 = 0.9\n"
        );
        Machine::parse(&text, "m.toml").unwrap().axis["x"].clone()
    }

    /// 0.9 m/s² on the 1000 kg of the simulation; 40 % of the velocity without feed-forward over 50 1/s are 8 ms.
    #[test]
    fn the_friction_of_a_velocity_drive_is_that_of_the_simulated_mass() {
        let force = of_velocity_drive(&axis("")).unwrap();
        assert!((force.friction.coulomb_n - 900.0).abs() < 1e-9 && (force.lag_s - 8e-3).abs() < 1e-12);
        let stiffness_n_per_m = force.friction.presliding_stiffness_n_per_m.unwrap();
        assert!(
            (force.friction.coulomb_n / stiffness_n_per_m - 5e-6).abs() < 1e-12,
            "it turns over as traced"
        );
        assert!(force.table_mass_kg.abs() + force.motor_mass_kg.abs() < 1e-12, "the drive has its own");
        assert!(of_velocity_drive(&axis("table_mass_kg = 100.0\n")).is_none());
    }
}
