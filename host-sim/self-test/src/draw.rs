//! A machine and its session, drawn at random like those of the blind cases.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::bench::{AXES, Axis};
use super::motion::{Pace, Stretch};
use super::plant::Mechanics;
use super::servo::Settings;

/// How far the true mechanical values lie from the declared ones, at the most.
const DEVIATION: f64 = 0.06;
/// What the machine file says of that.
const TOLERANCE_PERCENT: f64 = 10.0;
/// σ0 (N/µm) and σ1 (N s/m), declared as they are.
const PRESLIDING: [f64; 2] = [40.0, 2000.0];
const FORCE_LIMIT_N: f64 = 20_000.0;

/// What a machine file says of an axis, in its units, and what a drawn machine has in common with its declaration.
#[derive(Clone, Debug, PartialEq)]
pub struct Declared {
    /// Travel in one turn of the screw.
    pub lead_mm: f64,
    /// Electrical periods of the resolver in one turn.
    pub pole_pairs: u32,
    /// Between motor and table.
    pub stiffness_n_per_um: f64,
    /// The axis's table of the machine file.
    pub text: String,
}

/// A machine without effects yet: each axis as it is, and as it is declared.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// As it is.
    pub axes: [Axis; 2],
    /// As it is declared.
    pub declared: [Declared; 2],
}

/// Draws a machine without effects.
pub fn machine(random: &mut ChaCha8Rng) -> Drawn {
    let hpc = random.random_bool(0.4);
    let dual = random.random_bool(0.6);
    let lead_mm = one_of(&[10.0, 16.0, 20.0], random);
    let pole_pairs = one_of(&[2, 4, 5], random);
    let mut axis = |name: &str| {
        let mut declared = |low, high| six(random.random_range(low..high));
        let [kp, kf] = [declared(32.0, 75.0), declared(42.0, 92.0)];
        let [kv, ti] = [declared(43e3, 83e3), declared(0.0125, 0.03)];
        let time_s = dual.then(|| declared(0.04, 0.1));
        let plant = [
            declared(70.0, 140.0),
            declared(90.0, 200.0),
            declared(120.0, 285.0),
            declared(8e3, 20e3),
            declared(88.0, 235.0),
            declared(540.0, 1490.0),
            declared(20.0, 60.0),
        ];
        let truth = plant.map(|value| value / (1.0 + random.random_range(-DEVIATION..DEVIATION)));
        let [motor_kg, table_kg, stiffness, damping, coulomb, viscous, motor_coulomb] = truth;
        let truth = Axis {
            servo: Settings {
                hpc,
                position_gain_per_s: kp,
                feedforward: 0.01 * kf,
                velocity_gain_n_s_per_m: kv,
                integral_s: ti,
                limit_n: FORCE_LIMIT_N,
                dual_s: time_s,
            },
            mechanics: Mechanics {
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
            },
            ..Axis::default()
        };
        let feedback = match time_s {
            None => "feedback = \"motor\"\n".to_owned(),
            Some(time_s) => format!("feedback = \"dual\"\ndual_feedback_time_constant_s = {time_s}\n"),
        };
        let [motor_kg, table_kg, stiffness, damping, coulomb, viscous, motor_coulomb] = plant;
        let text = format!(
            "[axis.{name}]\ncontroller = \"{}\"\nposition_gain_per_s = {kp}\nfeedforward_percent = {kf}\n\
             velocity_gain_n_s_per_m = {kv}\nvelocity_integral_time_s = {ti}\nforce_limit_n = {FORCE_LIMIT_N:.1}\n\
             motor_mass_kg = {motor_kg}\ntable_mass_kg = {table_kg}\nstiffness_n_per_um = {stiffness}\n\
             damping_n_s_per_m = {damping}\ncoulomb_n = {coulomb}\nviscous_n_s_per_m = {viscous}\n\
             motor_coulomb_n = {motor_coulomb}\npresliding_stiffness_n_per_um = {:.1}\n\
             presliding_damping_n_s_per_m = {:.1}\nplant_tolerance_percent = {TOLERANCE_PERCENT:.1}\n\
             lead_mm = {lead_mm}\nresolver_pole_pairs = {pole_pairs}\n{feedback}",
            if hpc { "hpc" } else { "p" },
            PRESLIDING[0],
            PRESLIDING[1],
        );
        (truth, Declared { lead_mm, pole_pairs, stiffness_n_per_um: stiffness, text })
    };
    let [(x, declared_x), (y, declared_y)] = AXES.map(&mut axis);
    Drawn { axes: [x, y], declared: [declared_x, declared_y] }
}

/// A motion of a session.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Name of its log.
    pub name: &'static str,
    /// Where it starts, mm.
    pub start: [f64; 2],
    /// Its path.
    pub stretches: Vec<Stretch>,
    /// Its speed.
    pub pace: Pace,
}

/// Draws the motions of a session: three to fit, two to validate.
pub fn session(random: &mut ChaCha8Rng) -> [Motion; 5] {
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let acceleration = between(1000.0, 3000.0);
    let centre = [between(-8.0, 8.0), between(-8.5, 8.5)];
    let mirrored = centre.map(|c| -c);
    let mut pace = |low, high| Pace { speed: between(low, high), acceleration };
    let paces = [pace(26.0, 65.0), pace(70.0, 150.0), pace(35.0, 64.0), pace(50.0, 100.0)];
    let [circle, reach, side, check] =
        [between(31.0, 50.0), between(60.0, 95.0), between(30.0, 58.0), between(29.0, 59.0)];
    let radial = between(3000.0, 4500.0);
    let small = Pace { speed: (radial * SMALL_MM).sqrt(), acceleration: radial };
    [
        Motion { name: "fit_circle", pace: paces[0], ..circles(centre, circle, 1.25, 0.25) },
        Motion { name: "fit_steps", pace: paces[1], ..steps(reach) },
        Motion { name: "fit_small", pace: small, ..circles(centre, SMALL_MM, 14.0, 0.3) },
        Motion { name: "validate_corner", pace: paces[2], ..corner(mirrored, side) },
        Motion { name: "validate_circle", pace: paces[3], ..circles(mirrored, check, 1.25, 0.25) },
    ]
}

/// Radius of the small circle.
const SMALL_MM: f64 = 2.0;
/// At both ends of a motion, s.
const REST: Stretch = Stretch::Dwell(0.25);
const NO_PACE: Pace = Pace { speed: 0.0, acceleration: 0.0 };

/// A circle forth and back.
fn circles(centre: [f64; 2], radius: f64, turns: f64, pause_s: f64) -> Motion {
    let stretches =
        vec![REST, Stretch::Arc(centre, turns), Stretch::Dwell(pause_s), Stretch::Arc(centre, -turns), REST];
    Motion { name: "", start: [centre[0] + radius, centre[1]], stretches, pace: NO_PACE }
}

/// To one end of a diagonal, then along it and back in eight steps each.
fn steps(reach: f64) -> Motion {
    const STEPS: i32 = 4;
    const SLOPE: f64 = 0.8;
    const PAUSE_S: f64 = 0.15;
    let forth = -STEPS..=STEPS;
    let back = (-STEPS..STEPS).rev();
    let places = forth.chain(back).map(|step| f64::from(step) / f64::from(STEPS) * reach);
    let mut stretches = vec![REST];
    for x in places {
        stretches.extend([Stretch::Line([x, SLOPE * x]), Stretch::Dwell(PAUSE_S)]);
    }
    stretches.pop();
    stretches.push(REST);
    Motion { name: "", start: [0.0; 2], stretches, pace: NO_PACE }
}

/// A square on its corner, half a diagonal long, stopping exactly at each corner.
fn corner(centre: [f64; 2], side: f64) -> Motion {
    let [left, middle] = [centre[0] - 40.0, centre[1]];
    let ends = [
        [left + side, middle + side],
        [left + 2.0 * side, middle],
        [left + side, middle - side],
        [left, middle],
    ];
    let stretches = [REST].into_iter().chain(ends.map(Stretch::Line)).chain([REST]).collect();
    Motion { name: "", start: [left, middle], stretches, pace: NO_PACE }
}

/// One of some.
pub fn one_of<T: Copy>(choice: &[T], random: &mut ChaCha8Rng) -> T {
    choice[random.random_range(0..choice.len())]
}

/// To six digits, as the machine file says it.
fn six(value: f64) -> f64 {
    let factor = 10_f64.powf(5.0 - value.abs().log10().floor());
    (value * factor).round() / factor
}
