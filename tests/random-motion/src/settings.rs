//! Random settings, compensations and blocks that the controller accepts.

use shared::compensate::CompensationSettings;
use shared::compensate::settings::{
    Cycle, Factor, ForceModel, Pitch, PitchSource, Points, Product, Reversal, Straightness, Stribeck,
    TableFriction, Talk, TimePoints,
};
use shared::config::{
    AxisSettings, Brake, GainSchedule, Law, LowPass, Notch, Notches, Rates, SCHEDULE_POINTS, ScaleLimits,
    SchedulePoint, ScheduledOver, Sensors, VelocitySource,
};
use shared::interpolate::{Block, Ramps, Smoothing};

use super::draws::Draws;

pub fn rates(draws: &mut Draws) -> Rates {
    Rates { velocity_loop_hz: 20_000.0, position_loop_divider: [1, 2, 5][draws.below(3)] }
}

pub fn axis(draws: &mut Draws, gain_error: f64) -> AxisSettings {
    let sensors = match draws.below(3) {
        0 => Sensors::Motor {
            scale_disagreement_limit_m: draws.maybe(|draws| draws.between(0.5e-3, 2e-3)),
            frozen_encoder_limit_m: draws.maybe(|draws| draws.between(0.2e-3, 1e-3)),
        },
        1 => Sensors::Table(scale_limits(draws)),
        _ => Sensors::Dual { time_constant_s: draws.between(0.01, 0.1), limits: scale_limits(draws) },
    };
    let smoothing = match draws.below(4) {
        0 => Smoothing::None,
        1 => Smoothing::Trapezoid { time_s: draws.between(2e-3, 0.01) },
        2 => Smoothing::SCurve { time_s: draws.between(5e-3, 0.01), jerk_time_s: draws.between(1e-3, 5e-3) },
        _ => Smoothing::Exponential { time_constant_s: draws.between(2e-3, 0.01) },
    };
    AxisSettings {
        law: if draws.one_in(2) { Law::P } else { Law::Hpc },
        position_gain_per_s: draws.between(20.0, 60.0),
        feedforward_percent: draws.between(0.0, 100.0),
        feedforward_ahead_s: if draws.one_in(2) { 0.0 } else { draws.between(0.0, 2e-4) },
        velocity_gain_n_s_per_m: draws.between(8_000.0, 20_000.0) * (1.0 + gain_error),
        gain_schedule: draws.maybe(gain_schedule).flatten(),
        velocity_integral_time_s: draws.maybe(|draws| draws.between(0.01, 0.05)),
        velocity_lag_s: draws.between(0.0, 50e-6),
        notches: Notches(std::array::from_fn(|_| {
            draws.maybe(|draws| Notch {
                frequency_hz: draws.between(100.0, 800.0),
                width_hz: draws.between(20.0, 100.0),
                depth: draws.between(0.5, 1.0),
            })
        })),
        low_pass: draws
            .maybe(|draws| LowPass { frequency_hz: draws.between(400.0, 2000.0), damping_ratio: 0.7 }),
        force_limit_n: draws.between(200.0, 3000.0),
        sensors,
        smoothing,
        scale_fade_time_s: draws.between(0.01, 0.1),
        following_error_limit_m: draws.between(1e-3, 0.02),
        fastest_m_per_s: draws.maybe(|draws| draws.between(0.5, 2.0)),
        saturation_time_s: draws.between(2e-3, 0.02),
        travel_m: draws.maybe(|draws| [-draws.between(2e-3, 0.02), draws.between(2e-3, 0.02)]),
        stop_deceleration_m_per_s2: draws.between(1.0, 5.0),
        brake: draws
            .one_in(4)
            .then(|| Brake { release_s: draws.between(0.0, 2e-3), engage_s: draws.between(0.0, 2e-3) }),
        preload_n: draws.maybe(|draws| draws.between(-50.0, 50.0)),
        gantry: None,
        velocity_source: draws
            .maybe(|draws| draws.between(100.0, 2000.0))
            .map_or(VelocitySource::Difference, |bandwidth_hz| VelocitySource::Observer { bandwidth_hz }),
    }
}

/// Two to six points over the travel of the motions, or over their speeds.
fn gain_schedule(draws: &mut Draws) -> Option<GainSchedule> {
    let over = if draws.one_in(2) { ScheduledOver::Position } else { ScheduledOver::Speed };
    let mut at = if over == ScheduledOver::Position { -0.02 } else { 0.0 };
    let count = 2 + draws.below(SCHEDULE_POINTS - 1);
    GainSchedule::of(
        over,
        (0..count).map(|_| {
            at += draws.between(2e-3, 0.02);
            SchedulePoint { at, ratio: draws.between(0.5, 1.5) }
        }),
    )
}

fn scale_limits(draws: &mut Draws) -> ScaleLimits {
    ScaleLimits { disagreement_m: draws.between(0.5e-3, 2e-3), frozen_m: draws.between(0.2e-3, 0.5e-3) }
}

fn values(draws: &mut Draws, size: f64) -> heapless::Vec<f64, 64> {
    (0..2 + draws.below(20)).map(|_| draws.between(-size, size)).collect()
}

fn points(draws: &mut Draws, size: f64) -> Points {
    Points { start_m: -0.01, spacing_m: draws.between(0.5e-3, 2e-3), values: values(draws, size) }
}

fn cycles(draws: &mut Draws, size: f64) -> heapless::Vec<Cycle, 2> {
    (0..draws.below(3))
        .map(|_| Cycle::harmonic(size, draws.between(1e-3, 8e-3), draws.between(0.0, 6.0)))
        .collect()
}

/// Each compensation in half of the cases.
pub fn compensation(draws: &mut Draws, other: u8) -> CompensationSettings {
    let force = draws.maybe(force_model);
    let can_stretch = force.is_some();
    CompensationSettings {
        pitch: draws.maybe(|draws| Pitch {
            of: if draws.one_in(2) { PitchSource::Screw } else { PitchSource::Scale },
            forward: points(draws, 3e-6),
            backward: draws.maybe(|draws| points(draws, 3e-6)),
        }),
        backlash_width_m: draws.maybe(|draws| draws.between(1e-6, 20e-6)),
        screw: cycles(draws, 1e-6),
        dividing: cycles(draws, 1e-6),
        reversal: draws.maybe(|draws| Reversal {
            force_n: draws.between(5.0, 40.0),
            decay_s: draws.between(5e-3, 0.02),
            fade_m_per_s: draws.between(0.01, 0.1),
        }),
        intalk: draws.maybe(|draws| Talk::Over(points(draws, 1e-7))),
        crosstalk: draws.maybe(|draws| (other, Talk::Constant(draws.between(-4e-7, 4e-7)))),
        squareness: draws.maybe(|draws| (other, draws.between(-3e-5, 3e-5))),
        straightness: draws.maybe(|draws| (other, Straightness::Over(points(draws, 2e-6)))),
        ripple: cycles(draws, 4.0),
        force,
        stretch_m_per_n: draws.maybe(|_| 1e-8).filter(|_| can_stretch),
        drift: draws.maybe(|draws| TimePoints {
            start_s: -0.05,
            spacing_s: draws.between(0.05, 0.2),
            values: values(draws, 2e-6),
        }),
        products: (0..draws.below(4)).map(|_| product(draws, other)).collect(),
        ..CompensationSettings::default()
    }
}

/// One to three factors, of this axis and of the other one of two.
fn product(draws: &mut Draws, other: u8) -> Product {
    let factor = |draws: &mut Draws| {
        let axis = if draws.one_in(2) { other } else { 1 - other };
        match draws.below(5) {
            0 => Factor::Position { axis, full_scale_m: draws.between(5e-3, 0.05) },
            1 => Factor::Velocity { axis, full_scale_m_per_s: draws.between(0.05, 1.0) },
            2 => Factor::Speed { axis, full_scale_m_per_s: draws.between(0.05, 1.0) },
            3 => Factor::Acceleration { axis, full_scale_m_per_s2: draws.between(20.0, 100.0) },
            _ => Factor::Direction { axis },
        }
    };
    Product {
        amplitude_m: draws.between(-2e-6, 2e-6),
        factors: (0..=draws.below(3)).map(|_| factor(draws)).collect(),
    }
}

fn force_model(draws: &mut Draws) -> ForceModel {
    ForceModel {
        motor_mass_kg: draws.between(1.0, 20.0),
        table_mass_kg: draws.between(1.0, 20.0),
        motor_coulomb_n: draws.between(0.0, 10.0),
        friction: TableFriction {
            coulomb_n: draws.between(5.0, 40.0),
            viscous_n_s_per_m: draws.between(100.0, 600.0),
            presliding_stiffness_n_per_m: draws.maybe(|draws| draws.between(5e6, 40e6)),
            stribeck: draws
                .maybe(|draws| Stribeck { excess_n: 10.0, velocity_m_per_s: draws.between(4e-3, 0.02) }),
            map: draws.maybe(|draws| points(draws, 2.0)),
            ..TableFriction::default()
        },
        load: draws.maybe(|draws| points(draws, 5.0)),
        lag_s: draws.between(0.0, 1e-3),
        share: draws.between(0.5, 1.0),
        ..ForceModel::default()
    }
}

/// A line, an arc or a dwell near the origin.
pub fn block(draws: &mut Draws) -> Block<2> {
    let (feed, acceleration) = (draws.between(0.02, 0.3), draws.between(1.0, 10.0));
    let block = match draws.below(5) {
        0 => Block::arc(
            [0, 1],
            [draws.between(-5e-3, 5e-3), draws.between(-5e-3, 5e-3)],
            draws.between(-1.0, 1.0),
            feed,
            acceleration,
        ),
        1 => Block::dwell(draws.between(1e-3, 5e-3)),
        _ => Block::line([draws.between(-5e-3, 5e-3), draws.between(-5e-3, 5e-3)], feed, acceleration),
    };
    let ramps = match draws.below(4) {
        0 => Ramps::Trapezoid,
        1 => Ramps::SCurve { jerk_m_per_s3: draws.between(200.0, 2000.0) },
        2 => Ramps::Exponential,
        _ => Ramps::AfterInterpolation,
    };
    let block = block.with_ramps(ramps);
    if draws.one_in(2) { block.within(draws.between(5e-6, 50e-6)) } else { block }
}
