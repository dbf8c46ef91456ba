//! What the machines of some kinds have beyond the textbook effects.

use std::f64::consts::TAU;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::draw::{Drawn, one_of};
use super::effect::sinusoid_um;
use super::joint;
use super::kind::Kind;
use super::machine::AXES;
use super::plant::{Mechanics, Sinusoid};
use super::sensors::Sensors;
use super::truth::Truth;
use super::warming::Warming;

/// Resolution of the encoder of the kind `coarse` in the control loops, m.
const ENCODER_STEP_M: f64 = 0.5e-6;
/// Lag of the drive of that kind, s.
const SLOW_DRIVE_S: f64 = 0.4e-3;
/// Half the travel over which the extent of a pitch shape is defined, mm.
const HALF_TRAVEL_MM: f64 = 80.0;
/// Period of the belt, mm.
const BELT_MM: f64 = 37.0;

/// Draws what a machine of this kind has beyond the effects of the catalogue and sets it in the true values. Faults of
/// the logs are drawn by [`super::fault`].
pub fn draw(kind: Kind, machine: &mut Drawn, random: &mut ChaCha8Rng) -> Vec<Truth> {
    let index = random.random_range(0..AXES.len());
    let lead_mm = machine.declared[index].lead_mm;
    if kind == Kind::Guide {
        if random.random_bool(0.5) {
            return vec![yaw(machine, index, random)];
        }
        let (waves, extent_um) = guide_shape(random);
        machine.axes[index].guide_waves = waves;
        return vec![extra("guide_shape", index, vec![("peak_to_peak_um", extent_um)])];
    }
    let mechanics = &mut machine.axes[index].mechanics;
    let (name, parameters) = match kind {
        Kind::Coarse => return slow_drives(machine),
        Kind::Joint => return joint::draw(machine, index, random),
        Kind::Shape => ("pitch_shape", pitch_shape(mechanics, random)),
        Kind::Friction => friction(mechanics, random),
        Kind::Foreign => foreign(mechanics, lead_mm, random),
        _ => return Vec::new(),
    };
    vec![extra(name, index, parameters)]
}

fn extra(name: &'static str, index: usize, parameters: Vec<(&'static str, f64)>) -> Truth {
    Truth { name, axis: AXES[index], parameters, reference: None, phase_rad: 0.0 }
}

/// Sensors and lag of the kind `coarse`, on both axes.
fn slow_drives(machine: &mut Drawn) -> Vec<Truth> {
    for axis in &mut machine.axes {
        axis.sensors = Sensors::coarse();
        axis.encoder_step_m = ENCODER_STEP_M;
        axis.servo.lag_s = SLOW_DRIVE_S;
    }
    [0, 1].map(|index| extra("slow_drive", index, vec![("ms", 1e3 * SLOW_DRIVE_S)])).to_vec()
}

/// Three long waves of incommensurate periods and a slope, scaled to a drawn extent.
fn pitch_shape(mechanics: &mut Mechanics, random: &mut ChaCha8Rng) -> Vec<(&'static str, f64)> {
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let waves =
        [(45.0, 75.0), (80.0, 130.0), (140.0, 230.0)].map(|periods_mm| long_wave(periods_mm, &mut between));
    let slope = 1e-6 * between(-600.0, 600.0);
    let height = height(|x_m| slope * x_m + waves.iter().map(|wave| wave.at(x_m)).sum::<f64>());
    let extent_um = between(5.0, 16.0);
    let factor = 1e-6 * extent_um / height;
    mechanics.pitch_slope = factor * slope;
    mechanics.screw_waves =
        waves.map(|wave| Sinusoid { amplitude: factor * wave.amplitude, ..wave }).to_vec();
    vec![("peak_to_peak_um", extent_um)]
}

/// A carriage that turns as it moves, with the other axis as its lever.
fn yaw(machine: &mut Drawn, index: usize, random: &mut ChaCha8Rng) -> Truth {
    let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
    let um_per_m2 = sign * random.random_range(200.0..800.0);
    machine.axes[index].yaw_per_m = 1e-6 * um_per_m2;
    let source = Some(("source", AXES[1 - index]));
    Truth { reference: source, ..extra("carriage_yaw", index, vec![("um_per_m2", um_per_m2)]) }
}

/// Two long waves of a guide, which is bent as it is screwed down, scaled to a drawn extent, µm peak to peak.
fn guide_shape(random: &mut ChaCha8Rng) -> (Vec<Sinusoid>, f64) {
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let waves = [(60.0, 110.0), (120.0, 240.0)].map(|periods_mm| long_wave(periods_mm, &mut between));
    let height = height(|y_m| waves.iter().map(|wave| wave.at(y_m)).sum::<f64>());
    let extent_um = between(3.0, 14.0);
    let scaled = |wave: Sinusoid| Sinusoid { amplitude: 1e-6 * extent_um / height * wave.amplitude, ..wave };
    (waves.map(scaled).to_vec(), extent_um)
}

/// A wave with a period of a range. Longer waves are higher, as a ground surface has less of the short ones.
fn long_wave((shortest_mm, longest_mm): (f64, f64), between: &mut impl FnMut(f64, f64) -> f64) -> Sinusoid {
    let period_mm = between(shortest_mm, longest_mm);
    sinusoid_um(between(0.5, 1.5) * period_mm, period_mm, between(0.0, TAU))
}

/// Peak-to-peak height of a shape over the travel.
fn height(shape: impl Fn(f64) -> f64) -> f64 {
    numerics::peak_to_peak((-100..=100).map(|step| shape(1e-3 * HALF_TRAVEL_MM * 0.01 * f64::from(step))))
}

/// A friction that the declared Coulomb and viscous friction do not contain.
fn friction(mechanics: &mut Mechanics, random: &mut ChaCha8Rng) -> (&'static str, Vec<(&'static str, f64)>) {
    let name =
        one_of(&["friction_position", "friction_warm_up", "motor_stribeck", "friction_temperature"], random);
    if name == "friction_temperature" {
        let warming = Warming::draw(random);
        mechanics.warming = Some(warming);
        let level_n_per_c = -warming.level_per_c * mechanics.coulomb_n;
        return (
            name,
            vec![
                ("level_n_per_c", level_n_per_c),
                ("viscous_percent_per_c", -100.0 * warming.viscosity_per_c),
            ],
        );
    }
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let parameters = match name {
        "friction_position" => {
            // Together at most 0.6 of the Coulomb friction, so that the friction opposes the motion everywhere.
            let peak_n = between(0.15, 0.4) * mechanics.coulomb_n;
            let [long, short] = [(90.0, 200.0), (40.0, 80.0)]
                .map(|(shortest, longest)| (between(shortest, longest), between(0.0, TAU)));
            let wave = |part: f64, (period_mm, phase): (f64, f64)| Sinusoid {
                amplitude: part * peak_n,
                period: 1e-3 * period_mm,
                phase,
            };
            mechanics.friction_waves = vec![wave(1.0, long), wave(0.5, short)];
            vec![("amplitude_n", peak_n)]
        }
        "friction_warm_up" => {
            mechanics.warm_up_n = between(0.2, 0.6) * mechanics.coulomb_n;
            mechanics.warm_up_s = between(20.0, 90.0);
            vec![("force_n", mechanics.warm_up_n), ("time_constant_s", mechanics.warm_up_s)]
        }
        _ => {
            let (excess, speed) = (between(20.0, 70.0), between(3.0, 12.0));
            mechanics.motor_stribeck_n = excess;
            mechanics.motor_stribeck_m_per_s = 1e-3 * speed;
            vec![("static_excess_n", excess), ("velocity_mm_s", speed)]
        }
    };
    (name, parameters)
}

/// A load or a position error that the textbook effects do not contain.
fn foreign(
    mechanics: &mut Mechanics,
    lead_mm: f64,
    random: &mut ChaCha8Rng,
) -> (&'static str, Vec<(&'static str, f64)>) {
    let name = one_of(&["cable_drag", "screw_second_harmonic", "belt_37mm", "backlash_varies"], random);
    let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let parameters = match name {
        "cable_drag" => {
            mechanics.load_n_per_m = sign * between(800.0, 3000.0);
            vec![("slope_n_per_m", mechanics.load_n_per_m)]
        }
        "backlash_varies" => {
            let (width_um, variation, period_mm) =
                (between(3.0, 12.0), between(0.4, 0.95), between(120.0, 260.0));
            mechanics.backlash_m = 1e-6 * width_um;
            mechanics.backlash_wave =
                Sinusoid { amplitude: variation, period: 1e-3 * period_mm, phase: between(0.0, TAU) };
            vec![("width_um", width_um), ("variation", variation), ("period_mm", period_mm)]
        }
        _ => {
            let period_mm = if name == "belt_37mm" { BELT_MM } else { 0.5 * lead_mm };
            let amplitude_um = between(1.0, 4.0);
            mechanics.screw_waves = vec![sinusoid_um(amplitude_um, period_mm, between(0.0, TAU))];
            vec![("amplitude_um", amplitude_um), ("period_mm", period_mm)]
        }
    };
    (name, parameters)
}
