//! First values of an axis: what the user knows, and for the rest what linear regressions find.

use std::collections::BTreeMap;

use crate::control_loop::{self, Known, LoopSettings};
use crate::mechanics::{self, Elastic, Rigid};
use crate::velocity_loop;
use model::axis::{Drive, Feedback, Settings, TOLERATED, Tolerated};
use model::effects::{Backlash, Effect};
use model::machine::Axis;
use trace::input::signals::AxisSignals;

/// Damping of the drive train and of the presliding, as parts of the critical one: usual values of ball screws.
const USUAL_DAMPING: f64 = 0.04;
const USUAL_PRESLIDING_DAMPING: f64 = 0.02;

/// Time constant of dual feedback with which its fit starts, s: the regression hardly shows it.
const USUAL_DUAL_S: f64 = 0.06;

/// Where a value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The user declared it.
    Known,
    /// The logs show it.
    Logs,
    /// The logs show it to a regression over a filter that is longer than that of a trace, whose fit it would mislead.
    Regression,
    /// It is a usual value: the logs hardly show it.
    Usual,
}

/// First values of an axis.
#[derive(Clone, Debug)]
pub struct Rough {
    /// All values.
    pub settings: Settings,
    /// Where each value with a tolerance comes from, by its key.
    pub origins: BTreeMap<&'static str, Origin>,
    /// Effects that are fitted beside the values, which would otherwise imitate them. They are no part of the file.
    pub beside: Vec<Effect>,
}

/// First values of an axis for each form of its loops that suits the logs, the best first; one if the loops are known or not shown.
/// `divider` is the number of ticks of the velocity loop per sample, if it is declared.
#[must_use]
pub fn of(declared: &Axis, logs: &[&AxisSignals], sample_s: f64, divider: Option<u32>) -> Vec<Rough> {
    let known = &declared.settings;
    let beside = declared.effect.clone();
    let mut rough = Rough { settings: known.clone(), origins: BTreeMap::new(), beside };
    for key in TOLERATED.iter().filter(|key| (key.get)(known).is_some()) {
        rough.origins.insert(key.key, Origin::Known);
    }
    rough.settings.controller.drive = drive(known, logs);
    if rough.settings.controller.drive != Drive::Torque {
        rough.add_velocity_loop(logs, sample_s);
        return vec![rough];
    }
    rough.add_mechanics(logs, sample_s);
    let Settings { controller, sensors, .. } = known;
    let is_known =
        [controller.position_gain_per_s, controller.velocity_gain_n_s_per_m].iter().all(Option::is_some);
    if is_known || !rough.settings.has_mass() {
        return vec![rough];
    }
    let feedback = (sensors.feedback != Feedback::Motor).then_some(sensors.feedback);
    let known = Known { law: controller.law, feedback, divider };
    let loops = control_loop::candidates(logs, sample_s, known);
    let all: Vec<Rough> = loops.iter().map(|settings| rough.with_loop(settings)).collect();
    if all.is_empty() { vec![rough] } else { all }
}

/// The kind of drive: as declared, or by the channels of the logs. A force shows a drive that is commanded one; without a reading of
/// the motor there is nothing that closes a loop.
fn drive(known: &Settings, logs: &[&AxisSignals]) -> Drive {
    let has_force = logs.iter().any(|log| log.force.is_some());
    let has_motor = logs.iter().any(|log| log.motor.is_some());
    match known.controller.drive {
        Drive::Torque if has_force || known.has_mass() => Drive::Torque,
        Drive::Torque if has_motor => Drive::Velocity,
        Drive::Torque => Drive::Stepper,
        declared => declared,
    }
}

impl Rough {
    /// Sets a value that the user did not declare.
    fn set(&mut self, key: &str, value: Option<f64>, origin: Origin) {
        let declared = Tolerated::with_key(key);
        let (Some(tolerated), Some(value)) = (declared, value.filter(|value| *value > 0.0)) else { return };
        if self.origins.get(tolerated.key) != Some(&Origin::Known) {
            let value = crate::rounded_as_written(tolerated.key, value, self.settings.names);
            (tolerated.set)(&mut self.settings, value);
            self.origins.insert(tolerated.key, origin);
        }
    }

    fn add_velocity_loop(&mut self, logs: &[&AxisSignals], sample_s: f64) {
        if self.settings.controller.drive != Drive::Velocity {
            return;
        }
        if let Some(found) = velocity_loop::settings(logs, sample_s) {
            self.set("position_gain_per_s", Some(found.position_gain_per_s), Origin::Logs);
            self.set("feedforward_percent", Some(found.feedforward_percent), Origin::Logs);
        }
    }

    fn add_mechanics(&mut self, logs: &[&AxisSignals], sample_s: f64) {
        let Some(rigid) = mechanics::rigid(logs, sample_s) else { return };
        if rigid.is_noisy {
            self.set("table_mass_kg", Some(rigid.mass_kg), Origin::Regression);
            self.set("viscous_n_s_per_m", Some(rigid.viscous_n_s_per_m), Origin::Regression);
            self.set("coulomb_n", Some(rigid.coulomb_n), Origin::Regression);
            return;
        }
        self.set("viscous_n_s_per_m", Some(rigid.viscous_n_s_per_m), Origin::Logs);
        if let Some(elastic) = mechanics::elastic(logs, &rigid) {
            self.add_elastic(&rigid, &elastic);
        } else if self.settings.mechanics.stiffness_n_per_um.is_none() {
            self.set("table_mass_kg", Some(rigid.mass_kg), Origin::Logs);
            self.set("coulomb_n", Some(rigid.coulomb_n), Origin::Logs);
        }
        let slip_um = Some(1e6 * rigid.slip_m).filter(|slip| *slip > 0.0);
        let coulomb_n = self.settings.mechanics.coulomb_n;
        if let (Some(slip_um), Some(coulomb_n)) = (slip_um, coulomb_n.filter(|force_n| *force_n > 0.0)) {
            let stiffness = coulomb_n / slip_um;
            self.set("presliding_stiffness_n_per_um", Some(stiffness), Origin::Logs);
            let damping = 2.0 * USUAL_PRESLIDING_DAMPING * (1e6 * stiffness * rigid.mass_kg).sqrt();
            self.set("presliding_damping_n_s_per_m", Some(damping), Origin::Usual);
        }
    }

    fn add_elastic(&mut self, rigid: &Rigid, elastic: &Elastic) {
        let Elastic { stiffness_n_per_m, motor_mass_kg, motor_coulomb_n, backlash_m } = *elastic;
        let table_mass_kg = rigid.mass_kg - motor_mass_kg;
        self.set("motor_mass_kg", Some(motor_mass_kg), Origin::Logs);
        self.set("table_mass_kg", Some(table_mass_kg), Origin::Logs);
        self.set("stiffness_n_per_um", Some(1e-6 * stiffness_n_per_m), Origin::Logs);
        let critical = 2.0 * (stiffness_n_per_m * motor_mass_kg * table_mass_kg / rigid.mass_kg).sqrt();
        self.set("damping_n_s_per_m", Some(USUAL_DAMPING * critical), Origin::Usual);
        self.set("motor_coulomb_n", Some(motor_coulomb_n), Origin::Logs);
        self.set("coulomb_n", Some(rigid.coulomb_n - motor_coulomb_n), Origin::Logs);
        let width = backlash_m.map(|width_m| Effect::Backlash(Backlash { width_um: 1e6 * width_m }));
        self.beside.extend(width);
    }

    fn with_loop(&self, found: &LoopSettings) -> Self {
        let mut rough = self.clone();
        rough.settings.controller.law.get_or_insert(found.law);
        rough.settings.sensors.feedback = found.feedback;
        rough.set("position_gain_per_s", Some(found.position_gain_per_s), Origin::Logs);
        rough.set("feedforward_percent", Some(found.feedforward_percent), Origin::Logs);
        rough.set("velocity_gain_n_s_per_m", Some(found.velocity_gain_n_s_per_m), Origin::Logs);
        rough.set("velocity_integral_time_s", found.integral_time_s, Origin::Logs);
        rough.set("dual_feedback_time_constant_s", found.dual_s.map(|_| USUAL_DUAL_S), Origin::Logs);
        rough
    }

    /// Leaves a value unknown that the user did not declare.
    fn forget(&mut self, key: &Tolerated) {
        if self.origins.get(key.key).is_some_and(|origin| *origin != Origin::Known) {
            (key.clear)(&mut self.settings);
            self.origins.remove(key.key);
        }
    }

    /// Leaves the loops unknown, as far as the user did not declare them.
    pub fn forget_loops(&mut self, declared: &Settings) {
        TOLERATED.iter().filter(|key| key.is_of_controller).for_each(|key| self.forget(key));
        self.settings.controller.law = declared.controller.law;
        self.settings.sensors.feedback = declared.sensors.feedback;
    }

    /// Leaves masses, stiffness and friction unknown, and with them the loops.
    pub fn forget_mechanics(&mut self, declared: &Settings) {
        TOLERATED.iter().filter(|key| !key.is_of_controller).for_each(|key| self.forget(key));
        self.forget_loops(declared);
    }

    /// One mass in place of two with a stiffness between them.
    pub fn make_rigid(&mut self) {
        let mechanics = &self.settings.mechanics;
        let sum = |a: Option<f64>, b: Option<f64>| Some(a.unwrap_or(0.0) + b.unwrap_or(0.0));
        let mass_kg = sum(mechanics.motor_mass_kg, mechanics.table_mass_kg);
        let coulomb_n = sum(mechanics.motor_coulomb_n, mechanics.coulomb_n);
        self.set("table_mass_kg", mass_kg, Origin::Logs);
        self.set("coulomb_n", coulomb_n, Origin::Logs);
        let divided = ["motor_mass_kg", "motor_coulomb_n", "stiffness_n_per_um", "damping_n_s_per_m"];
        TOLERATED.iter().filter(|key| divided.contains(&key.key)).for_each(|key| self.forget(key));
    }

    /// Leaves a value unknown by its key, if the user did not declare it.
    pub fn forget_value(&mut self, key: &str) {
        if let Some(tolerated) = Tolerated::with_key(key) {
            self.forget(tolerated);
        }
    }

    /// The axis with tolerances of all values that the user did not declare, percent, and with the effects beside them.
    #[must_use]
    pub fn free(&self, percent: f64) -> Axis {
        let mut settings = self.settings.clone();
        let known: Vec<f64> = TOLERATED.iter().map(|key| 100.0 * key.tolerance(&settings)).collect();
        let tolerances = settings.mechanics.tolerance_percent.get_or_insert_default();
        for (key, known) in TOLERATED.iter().zip(known) {
            match self.origins.get(key.key) {
                Some(Origin::Known) => (key.set_tolerance_percent)(tolerances, known),
                Some(Origin::Regression) => (key.set_tolerance_percent)(tolerances, 0.0),
                Some(_) => (key.set_tolerance_percent)(tolerances, percent),
                None => {}
            }
        }
        // That of the effects.
        settings.mechanics.plant_tolerance_percent = Some(percent);
        Axis { settings, effect: self.beside.clone(), ..Axis::default() }
    }
}
