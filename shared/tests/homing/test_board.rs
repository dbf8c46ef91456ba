//! A simulated axis of 120 mm with a home switch, limit switches, an encoder with an index pulse every 5 mm, and a scale.

use crate::slide::Slide;
use shared::config::{AxisSettings, Rates, ScaleLimits, Sensors, VelocitySource};
use shared::drive::{Amplifier, AxisInputs, Board, DriveSystem, Duty, EnableSwitch, Inputs, StatusLight};
use shared::feedback::Reading;
use shared::homing::{AtLimit, Direction, HomingSettings, HomingStatus, Mark};
use shared::machine::Machine;
use shared::scalar::Fixed;
use shared::units::Position;

pub const TICK_HZ: f64 = 20_000.0;
const TABLE: Slide = Slide { mass_kg: 15.0, viscous_n_s_per_m: 0.0, coulomb_n: 10.0 };
const FULL_COUNTS: u16 = 8400;
const FULL_N: f64 = 400.0;
/// Encoder and scale, m per count.
const COUNT_M: f64 = 0.25e-6;

pub const SETTINGS: AxisSettings = AxisSettings {
    position_gain_per_s: 25.0,
    feedforward_percent: 100.0,
    velocity_gain_n_s_per_m: 3000.0,
    force_limit_n: 200.0,
    sensors: Sensors::Dual { time_constant_s: 0.02, limits: ScaleLimits::DEFAULT },
    following_error_limit_m: 1e-3,
    travel_m: Some([-0.005, 0.09]),
    stop_deceleration_m_per_s2: 1.0,
    ..default_settings()
};

const fn default_settings() -> AxisSettings {
    AxisSettings {
        law: shared::config::Law::P,
        position_gain_per_s: 25.0,
        feedforward_percent: 100.0,
        feedforward_ahead_s: 0.0,
        velocity_gain_n_s_per_m: 3000.0,
        gain_schedule: None,
        velocity_integral_time_s: Some(0.02),
        velocity_source: VelocitySource::Difference,
        velocity_lag_s: 0.0,
        notches: shared::config::Notches::NONE,
        low_pass: None,
        force_limit_n: 200.0,
        sensors: Sensors::MOTOR,
        smoothing: shared::interpolate::Smoothing::None,
        scale_fade_time_s: 0.1,
        following_error_limit_m: 1e-3,
        fastest_m_per_s: None,
        saturation_time_s: 1.0,
        travel_m: None,
        stop_deceleration_m_per_s2: 1.0,
        brake: None,
        preload_n: None,
        gantry: None,
    }
}

/// Towards the negative end, the switch is at 20 to 26 mm of the board, the index at 24.1 mm.
pub const fn homing() -> HomingSettings {
    HomingSettings {
        direction: Direction::Negative,
        mark: Mark::MotorIndex { spacing_m: 0.005 },
        mark_position_m: 0.001,
        search_speed_m_per_s: 0.02,
        approach_speed_m_per_s: 0.002,
        acceleration_m_per_s2: 1.0,
        search_distance_m: 0.12,
        back_off_distance_m: 0.01,
        at_limit: AtLimit::TurnRound,
        timeout_s: 30.0,
    }
}

pub struct TestBoard {
    /// Position of the simulated axis, m.
    pub at_m: f64,
    pub velocity: f64,
    pub closed: bool,
    pub index_m: f64,
    /// The single index pulse of the scale.
    pub scale_index_m: f64,
    /// Place at power-up, where both counters are zero.
    start_m: f64,
    previous_m: f64,
    /// Every so many samples of the home switch one reads the opposite; 0: none does.
    pub spike_every: u32,
    samples: u32,
    duty: Duty,
    enabled: bool,
}

impl TestBoard {
    pub fn at(at_m: f64) -> Self {
        Self {
            at_m,
            velocity: 0.0,
            closed: false,
            index_m: 0.0241,
            scale_index_m: 0.0217,
            start_m: at_m,
            previous_m: at_m,
            spike_every: 0,
            samples: 0,
            duty: Duty::default(),
            enabled: false,
        }
    }

    /// The system of an axis that does not know its position.
    pub fn system() -> DriveSystem<'static, Fixed, 1> {
        let rates = Rates { velocity_loop_hz: TICK_HZ, position_loop_divider: 5 };
        let machine = Box::leak(Box::new(Machine::new(rates, &[SETTINGS], [Position(0)]).unwrap()));
        machine.lose_reference(0);
        let amplifiers = [Amplifier::new(FULL_N, FULL_COUNTS).unwrap()];
        DriveSystem::new(machine, amplifiers, EnableSwitch::new(10), StatusLight::new(5000))
    }

    pub fn enable(&mut self, system: &mut DriveSystem<'static, Fixed, 1>) {
        self.closed = false;
        self.run(system, 20);
        self.closed = true;
        self.run(system, 20);
        assert!(self.enabled);
    }

    pub fn run(&mut self, system: &mut DriveSystem<'static, Fixed, 1>, ticks: u32) {
        for _ in 0..ticks {
            system.tick(self);
            self.previous_m = self.at_m;
            let magnitude = FULL_N * f64::from(self.duty.counts) / f64::from(FULL_COUNTS);
            let force = if self.duty.reverse { -magnitude } else { magnitude };
            TABLE.step(&mut self.at_m, &mut self.velocity, force, 1.0 / TICK_HZ);
            assert!((0.0..0.12).contains(&self.at_m), "over the end of the plant: {}", self.at_m);
        }
    }

    fn count(&self, m: f64) -> Position {
        Position::from_m(((m - self.start_m) / COUNT_M).floor() * COUNT_M).unwrap()
    }
}

impl Board<1> for TestBoard {
    fn inputs(&mut self) -> Inputs<1> {
        let cell = |m: f64| ((m - self.index_m) / 0.005).floor();
        let (from, to) = (self.previous_m.min(self.at_m), self.previous_m.max(self.at_m));
        let index = (cell(from) < cell(to)).then(|| self.count(self.index_m + 0.005 * cell(to)));
        self.samples += 1;
        let is_spike = self.spike_every > 0 && self.samples.is_multiple_of(self.spike_every);
        let axis = AxisInputs {
            limits: [self.at_m < 0.005, self.at_m > 0.115],
            home: (0.020..=0.026).contains(&self.at_m) != is_spike,
            motor_index: index,
            scale_index: (from..to).contains(&self.scale_index_m).then(|| self.count(self.scale_index_m)),
            ..AxisInputs::NONE
        };
        Inputs { axes: [axis], ..Inputs::NONE }
    }

    fn readings(&mut self) -> [Reading; 1] {
        [Reading { motor: self.count(self.at_m), table: Some(self.count(self.at_m)) }]
    }

    fn enable_switch_closed(&mut self) -> bool {
        self.closed
    }

    fn hardware_stop_active(&mut self) -> bool {
        false
    }

    fn set_signals(&mut self, [duty]: [Duty; 1]) {
        self.duty = duty;
    }

    fn set_enabled(&mut self, enabled: bool) {
        self.enabled = enabled;
    }

    fn set_light(&mut self, _: bool) {}

    fn next_tick_due(&mut self) -> bool {
        false
    }
}

/// Runs a homing to its end.
pub fn run_homing(
    board: &mut TestBoard,
    system: &mut DriveSystem<'static, Fixed, 1>,
    settings: &HomingSettings,
) -> HomingStatus {
    system.home(0, settings).unwrap();
    for _ in 0..40 * 20_000 {
        board.run(system, 1);
        system.plan_leg();
        match system.homing_status().unwrap() {
            (_, HomingStatus::Running) => {}
            (_, ended) => {
                // To rest.
                board.run(system, 4000);
                return ended;
            }
        }
    }
    panic!("the homing does not end")
}
