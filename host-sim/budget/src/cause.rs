//! The causes of a contour error, and a machine with some of them.

use model::axis::Settings;
use model::effects::Effect;
use model::machine::evidence::Evidence;
use model::machine::{Axis, Machine};
use plant::instruments::Instruments;
use plant::parameters::AxisParameters;
use plant::sensors::Sensor;

/// A cause of a contour error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cause {
    /// What a loop without friction and with rigid axes does to a motion: the command is followed late.
    FollowingLag,
    /// Position gains or feed-forwards that the axes do not have in common.
    GainDifference,
    /// Declared friction of an axis, by its number.
    Friction(usize),
    /// Declared stiffness of the drive train of an axis, by its number: it stretches under force.
    Stiffness(usize),
    /// An effect: numbers of the axis and of the effect in its list.
    Effect(usize, usize),
    /// Residuals that no effect describes, of an axis, by its number.
    Unexplained(usize),
    /// Noise of the sensors that the controller reads.
    Noise,
    /// Their resolution.
    Quantisation,
}

impl Cause {
    /// All causes of a machine.
    #[must_use]
    pub fn all(machine: &Machine) -> Vec<Self> {
        let mut causes = vec![Self::FollowingLag];
        causes.extend(has_gain_difference(machine).then_some(Self::GainDifference));
        for (index, axis) in machine.axis.values().enumerate() {
            causes.extend(has_friction(&axis.settings).then_some(Self::Friction(index)));
            causes.extend((!axis.settings.is_rigid()).then_some(Self::Stiffness(index)));
            causes.extend((0..axis.effect.len()).map(|effect| Self::Effect(index, effect)));
            causes.extend(axis.has_residuals().then_some(Self::Unexplained(index)));
        }
        if machine.instruments.is_some() {
            causes.extend([Self::Noise, Self::Quantisation]);
        }
        causes
    }

    /// Its name in files: that of an effect, or of a part of the declared model.
    #[must_use]
    pub fn name(&self, machine: &Machine) -> &'static str {
        match self {
            Self::FollowingLag => "following_lag",
            Self::GainDifference => "declared_gain_difference",
            Self::Friction(_) => "friction_reversal",
            Self::Stiffness(_) => "declared_stiffness",
            Self::Effect(axis, effect) => machine.axis[*axis].effect[*effect].name(),
            Self::Unexplained(_) => "unexplained",
            Self::Noise => "noise",
            Self::Quantisation => "quantisation",
        }
    }

    /// The name of its axis; `None`: it is of all axes together.
    #[must_use]
    pub fn axis<'a>(&self, machine: &'a Machine) -> Option<&'a str> {
        match self {
            Self::Friction(axis)
            | Self::Stiffness(axis)
            | Self::Effect(axis, _)
            | Self::Unexplained(axis) => machine.axis.get_index(*axis).map(|(name, _)| name.as_str()),
            Self::FollowingLag | Self::GainDifference | Self::Noise | Self::Quantisation => None,
        }
    }

    /// What a trace knows of the effect that it is; `None`: nothing, or it is no effect.
    #[must_use]
    pub fn evidence<'a>(&self, machine: &'a Machine) -> Option<&'a Evidence> {
        match self {
            Self::Effect(axis, effect) => machine.axis[*axis].evidence.get(*effect),
            _ => None,
        }
    }

    /// The effect that it is.
    #[must_use]
    pub fn effect<'a>(&self, machine: &'a Machine) -> Option<&'a Effect> {
        match self {
            Self::Effect(axis, effect) => Some(&machine.axis[*axis].effect[*effect]),
            _ => None,
        }
    }
}

/// The machine without effects that the controller of the simulation cannot have, and a sentence for each.
#[must_use]
pub fn simulated(machine: &Machine) -> (Machine, Vec<String>) {
    let (mut machine, mut notes) = (machine.clone(), Vec::new());
    for (name, axis) in &mut machine.axis {
        while let Some(refused) = AxisParameters::of(axis).servo.not_in_controller() {
            let is_it = |effect: &Effect| refused.split(' ').next() == Some(effect.name());
            let Some(index) = axis.effect.iter().position(is_it) else { break };
            axis.effect.remove(index);
            if index < axis.evidence.len() {
                axis.evidence.remove(index);
            }
            notes.push(format!(
                "{name}: {refused} is not in the budget, as the controller that is simulated cannot have it."
            ));
        }
        axis.nominal = None;
    }
    (machine, notes)
}

/// The machine with some of its causes. The lag of its loops always acts.
#[must_use]
pub fn with(machine: &Machine, causes: &[Cause]) -> Machine {
    let mut with = machine.clone();
    if !causes.contains(&Cause::GainDifference) {
        equalise_gains(&mut with);
    }
    for (index, axis) in with.axis.values_mut().enumerate() {
        let mut number = 0;
        axis.effect.retain(|_| {
            number += 1;
            causes.contains(&Cause::Effect(index, number - 1))
        });
        axis.evidence.clear();
        if !causes.contains(&Cause::Friction(index)) {
            remove_friction(axis);
        }
        if !causes.contains(&Cause::Stiffness(index)) {
            axis.settings.mechanics.stiffness_n_per_um = None;
            axis.settings.mechanics.damping_n_s_per_m = None;
        }
        if !causes.contains(&Cause::Unexplained(index)) {
            axis.empirical.clear();
            axis.residual_law.clear();
        }
    }
    with
}

/// The instruments with some causes. The probe reads the tool as it is.
#[must_use]
pub fn instruments(machine: &Machine, causes: &[Cause], seed: u64) -> Instruments {
    let of_machine = Instruments::of(machine, seed);
    let has = |cause: Cause| causes.contains(&cause);
    let read = |sensor: Sensor| Sensor {
        noise: if has(Cause::Noise) { sensor.noise } else { 0.0 },
        resolution: if has(Cause::Quantisation) { sensor.resolution } else { 0.0 },
    };
    let exact = Sensor::default();
    let (motor, table) = (read(of_machine.motor), read(of_machine.table));
    Instruments { motor, table, tool: exact, force: exact, ..of_machine }
}

/// Gain and feed-forward of the position loop.
const fn gains(settings: &Settings) -> [Option<f64>; 2] {
    [settings.controller.position_gain_per_s, settings.controller.feedforward_percent]
}

fn has_gain_difference(machine: &Machine) -> bool {
    let mut all = machine.axis.values().map(|axis| gains(&axis.settings));
    let first = all.next();
    all.any(|of_axis| Some(of_axis) != first && of_axis[0].is_some())
}

/// Gives all axes with a position gain the mean of these gains and feed-forwards.
fn equalise_gains(machine: &mut Machine) {
    let mean = |which: usize| {
        let values = machine.axis.values().filter(|axis| gains(&axis.settings)[0].is_some());
        let values: Vec<f64> = values.map(|axis| gains(&axis.settings)[which].unwrap_or(0.0)).collect();
        values.iter().sum::<f64>() / values.len().max(1) as f64
    };
    let [gain_per_s, percent] = [mean(0), mean(1)];
    for axis in machine.axis.values_mut() {
        let controller = &mut axis.settings.controller;
        if controller.position_gain_per_s.is_some() {
            controller.position_gain_per_s = Some(gain_per_s);
            controller.feedforward_percent = Some(percent);
        }
    }
}

fn has_friction(settings: &Settings) -> bool {
    let mechanics = &settings.mechanics;
    let values = [mechanics.coulomb_n, mechanics.viscous_n_s_per_m, mechanics.motor_coulomb_n];
    mechanics.friction_curve.is_some() || values.into_iter().flatten().any(|value| value > 0.0)
}

fn remove_friction(axis: &mut Axis) {
    let mechanics = &mut axis.settings.mechanics;
    mechanics.coulomb_n = mechanics.coulomb_n.map(|_| 0.0);
    mechanics.viscous_n_s_per_m = mechanics.viscous_n_s_per_m.map(|_| 0.0);
    mechanics.motor_coulomb_n = mechanics.motor_coulomb_n.map(|_| 0.0);
    mechanics.friction_curve = None;
    mechanics.presliding_stiffness_n_per_um = None;
    mechanics.presliding_damping_n_s_per_m = None;
    if let Some(offsets) = &mut axis.log_offsets {
        offsets.velocity_friction_m_per_s2 = None;
    }
}
