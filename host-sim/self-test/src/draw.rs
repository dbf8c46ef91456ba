//! A machine and its session, drawn at random like those of the blind cases.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::machine::{AXES, Axis};
use super::motion::{Pace, Segment};
use super::plant::Mechanics;
use super::recording::Recorder;
use super::servo::Settings;

/// Largest relative differences between declared and true values, in the order of [`MechanicalValues`].
pub type Deviations = [f64; 7];
/// Within the tolerance of the machine file.
pub const WITHIN_TOLERANCE: Deviations = [0.06; 7];
/// Masses, stiffness and friction of the table outside it.
pub const BEYOND_TOLERANCE: Deviations = [0.25, 0.25, 0.25, 0.06, 0.25, 0.25, 0.06];
/// The declared values are the true ones, to the digits of the file.
pub const TRUE: Deviations = [1e-12; 7];
/// Tolerance of these values in the machine file.
const TOLERANCE_PERCENT: f64 = 10.0;
/// σ0 (N/µm) and σ1 (N s/m); the declared values are the true ones.
const PRESLIDING: [f64; 2] = [40.0, 2000.0];
const FORCE_LIMIT_N: f64 = 20_000.0;

/// Declared values of an axis, in the units of the machine file.
#[derive(Clone, Debug, PartialEq)]
pub struct Declared {
    /// Travel per turn of the screw; the true value, too.
    pub lead_mm: f64,
    /// Electrical periods of the resolver per turn; the true value, too.
    pub pole_pairs: u32,
    /// Stiffness between motor and table.
    pub stiffness_n_per_um: f64,
    /// The axis's table of the machine file.
    pub text: String,
}

/// A machine without undeclared effects: each axis with its true and its declared values.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// True values.
    pub axes: [Axis; 2],
    /// Declared values.
    pub declared: [Declared; 2],
    /// Errors of the recorder.
    pub recorder: Recorder,
}

/// What both axes of a machine have in common.
struct Design {
    hpc: bool,
    dual_feedback: bool,
    lead_mm: f64,
    pole_pairs: u32,
}

/// Mechanical values in the units of the machine file: masses of motor and table (kg), stiffness (N/µm), damping
/// (N s/m), Coulomb (N) and viscous (N s/m) friction of the table, Coulomb friction of the motor (N).
type MechanicalValues = [f64; 7];

/// Settings of a drive in the units of the machine file.
struct DriveValues {
    position_gain_per_s: f64,
    feedforward_percent: f64,
    velocity_gain_n_s_per_m: f64,
    velocity_integral_time_s: f64,
    dual_feedback_time_s: Option<f64>,
}

/// Draws a machine without undeclared effects, whose true values differ from the declared ones by at most `deviations`.
pub fn machine(deviations: &Deviations, random: &mut ChaCha8Rng) -> Drawn {
    let design = Design {
        hpc: random.random_bool(0.4),
        dual_feedback: random.random_bool(0.6),
        lead_mm: one_of(&[10.0, 16.0, 20.0], random),
        pole_pairs: one_of(&[2, 4, 5], random),
    };
    let [(x, declared_x), (y, declared_y)] = AXES.map(|name| axis(name, &design, deviations, random));
    Drawn { axes: [x, y], declared: [declared_x, declared_y], recorder: Recorder::default() }
}

/// Draws the true and the declared values of an axis. The order of the draws determines the result of a seed.
fn axis(name: &str, design: &Design, deviations: &Deviations, random: &mut ChaCha8Rng) -> (Axis, Declared) {
    let mut declared = |low, high| six_digits(random.random_range(low..high));
    let drive = DriveValues {
        position_gain_per_s: declared(32.0, 75.0),
        feedforward_percent: declared(42.0, 92.0),
        velocity_gain_n_s_per_m: declared(43e3, 83e3),
        velocity_integral_time_s: declared(0.0125, 0.03),
        dual_feedback_time_s: design.dual_feedback.then(|| declared(0.04, 0.1)),
    };
    let mechanics: MechanicalValues = [
        declared(70.0, 140.0),
        declared(90.0, 200.0),
        declared(120.0, 285.0),
        declared(8e3, 20e3),
        declared(88.0, 235.0),
        declared(540.0, 1490.0),
        declared(20.0, 60.0),
    ];
    let mut truth = mechanics;
    for (value, deviation) in truth.iter_mut().zip(deviations) {
        *value /= 1.0 + random.random_range(-deviation..*deviation);
    }
    let axis = Axis { servo: settings(&drive, design), mechanics: true_mechanics(truth), ..Axis::default() };
    let declared = Declared {
        lead_mm: design.lead_mm,
        pole_pairs: design.pole_pairs,
        stiffness_n_per_um: mechanics[2],
        text: file_text(name, design, &drive, mechanics),
    };
    (axis, declared)
}

fn settings(drive: &DriveValues, design: &Design) -> Settings {
    Settings {
        hpc: design.hpc,
        position_gain_per_s: drive.position_gain_per_s,
        feedforward: 0.01 * drive.feedforward_percent,
        velocity_gain_n_s_per_m: drive.velocity_gain_n_s_per_m,
        integral_s: drive.velocity_integral_time_s,
        limit_n: FORCE_LIMIT_N,
        dual_s: drive.dual_feedback_time_s,
        ..Settings::default()
    }
}

fn true_mechanics(values: MechanicalValues) -> Mechanics {
    let [motor_kg, table_kg, stiffness, damping, coulomb, viscous, motor_coulomb] = values;
    Mechanics {
        motor_kg,
        table_kg,
        stiffness_n_per_m: 1e6 * stiffness,
        damping_n_s_per_m: damping,
        coulomb_n: coulomb,
        viscous_n_s_per_m: viscous,
        motor_coulomb_n: motor_coulomb,
        presliding_n_per_m: 1e6 * PRESLIDING[0],
        presliding_n_s_per_m: PRESLIDING[1],
        ..Mechanics::default()
    }
}

/// The axis's table of the machine file.
fn file_text(name: &str, design: &Design, drive: &DriveValues, mechanics: MechanicalValues) -> String {
    let controller = if design.hpc { "hpc" } else { "p" };
    let Design { lead_mm, pole_pairs, .. } = design;
    let DriveValues { position_gain_per_s: kp, feedforward_percent: kf, .. } = drive;
    let DriveValues { velocity_gain_n_s_per_m: kv, velocity_integral_time_s: ti, .. } = drive;
    let feedback = match drive.dual_feedback_time_s {
        None => "feedback = \"motor\"\n".to_owned(),
        Some(time_s) => format!("feedback = \"dual\"\ndual_feedback_time_constant_s = {time_s}\n"),
    };
    let [motor_kg, table_kg, stiffness, damping, coulomb, viscous, motor_coulomb] = mechanics;
    format!(
        "[axis.{name}]\ncontroller = \"{controller}\"\nposition_gain_per_s = {kp}\nfeedforward_percent = {kf}\n\
         velocity_gain_n_s_per_m = {kv}\nvelocity_integral_time_s = {ti}\nforce_limit_n = {FORCE_LIMIT_N:.1}\n\
         motor_mass_kg = {motor_kg}\ntable_mass_kg = {table_kg}\nstiffness_n_per_um = {stiffness}\n\
         damping_n_s_per_m = {damping}\ncoulomb_n = {coulomb}\nviscous_n_s_per_m = {viscous}\n\
         motor_coulomb_n = {motor_coulomb}\npresliding_stiffness_n_per_um = {:.1}\n\
         presliding_damping_n_s_per_m = {:.1}\nplant_tolerance_percent = {TOLERANCE_PERCENT:.1}\n\
         lead_mm = {lead_mm}\nresolver_pole_pairs = {pole_pairs}\n{feedback}",
        PRESLIDING[0], PRESLIDING[1],
    )
}

/// A motion of a session.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Name of its log.
    pub name: &'static str,
    /// Start of its path, mm.
    pub start: [f64; 2],
    /// Its path.
    pub segments: Vec<Segment>,
    /// Its speed and acceleration.
    pub pace: Pace,
}

/// Names of the motions of a session.
pub const MOTIONS: [&str; 5] = ["fit_circle", "fit_steps", "fit_small", "validate_corner", "validate_circle"];

/// Draws the motions of a session: three to fit, two to validate.
pub fn session(random: &mut ChaCha8Rng) -> [Motion; 5] {
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let acceleration = between(1000.0, 3000.0);
    let centre = [between(-8.0, 8.0), between(-8.5, 8.5)];
    let mirrored = centre.map(|c| -c);
    let mut pace = |low, high| Pace { speed: between(low, high), acceleration, averaged_samples: 0 };
    let paces = [pace(26.0, 65.0), pace(70.0, 150.0), pace(35.0, 64.0), pace(50.0, 100.0)];
    let [radius, reach, half_diagonal, validate_radius] =
        [between(31.0, 50.0), between(60.0, 95.0), between(30.0, 58.0), between(29.0, 59.0)];
    let radial_acceleration = between(3000.0, 4500.0);
    let speed = (radial_acceleration * SMALL_MM).sqrt();
    let small = Pace { speed, acceleration: radial_acceleration, averaged_samples: 0 };
    [
        Motion { name: MOTIONS[0], pace: paces[0], ..circles(centre, radius, 1.25, 0.25) },
        Motion { name: MOTIONS[1], pace: paces[1], ..steps(reach) },
        Motion { name: MOTIONS[2], pace: small, ..circles(centre, SMALL_MM, 14.0, 0.3) },
        Motion { name: MOTIONS[3], pace: paces[2], ..corner(mirrored, half_diagonal) },
        Motion { name: MOTIONS[4], pace: paces[3], ..circles(mirrored, validate_radius, 1.25, 0.25) },
    ]
}

/// Radius of the small circle.
const SMALL_MM: f64 = 2.0;
/// Standstill at both ends of a motion.
const REST: Segment = Segment::Dwell(0.25);
const NO_PACE: Pace = Pace { speed: 0.0, acceleration: 0.0, averaged_samples: 0 };

/// A circle counter-clockwise, then clockwise.
fn circles(centre: [f64; 2], radius: f64, turns: f64, pause_s: f64) -> Motion {
    let segments =
        vec![REST, Segment::Arc(centre, turns), Segment::Dwell(pause_s), Segment::Arc(centre, -turns), REST];
    Motion { name: "", start: [centre[0] + radius, centre[1]], segments, pace: NO_PACE }
}

/// To one end of a diagonal, then along it and back in eight steps each.
fn steps(reach: f64) -> Motion {
    const STEPS: i32 = 4;
    const SLOPE: f64 = 0.8;
    const PAUSE_S: f64 = 0.15;
    let forwards = -STEPS..=STEPS;
    let back = (-STEPS..STEPS).rev();
    let positions = forwards.chain(back).map(|step| f64::from(step) / f64::from(STEPS) * reach);
    let mut segments = vec![REST];
    for x in positions {
        segments.extend([Segment::Line([x, SLOPE * x]), Segment::Dwell(PAUSE_S)]);
    }
    segments.pop();
    segments.push(REST);
    Motion { name: "", start: [0.0; 2], segments, pace: NO_PACE }
}

/// A square standing on its corner, given by half its diagonal, with an exact stop at each corner.
fn corner(centre: [f64; 2], half_diagonal: f64) -> Motion {
    let [left, middle] = [centre[0] - 40.0, centre[1]];
    let ends = [
        [left + half_diagonal, middle + half_diagonal],
        [left + 2.0 * half_diagonal, middle],
        [left + half_diagonal, middle - half_diagonal],
        [left, middle],
    ];
    let segments = [REST].into_iter().chain(ends.map(Segment::Line)).chain([REST]).collect();
    Motion { name: "", start: [left, middle], segments, pace: NO_PACE }
}

/// The name of a case whose number determines it; numbers count from 1.
#[must_use]
pub fn in_turn(names: &[&'static str], number: u64) -> &'static str {
    let count = names.len() as u64;
    names
        .iter()
        .zip(0..)
        .find(|(_, index)| *index == (number + count - 1) % count)
        .map_or("", |(name, _)| *name)
}

/// One of several values, each with the same probability.
pub fn one_of<T: Copy>(choice: &[T], random: &mut ChaCha8Rng) -> T {
    choice[random.random_range(0..choice.len())]
}

/// Rounded to six significant digits, as it is written to the machine file.
fn six_digits(value: f64) -> f64 {
    let factor = libm::pow(10_f64, 5.0 - libm::log10(value.abs()).floor());
    (value * factor).round() / factor
}
