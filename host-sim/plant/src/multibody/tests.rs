//! The matrices against closed formulas, for structures that are small enough to have one.

use std::f64::consts::TAU;

use indexmap::IndexMap;
use model::bodies::*;

use super::*;

/// Stiff enough to count as rigid, N/µm or N·m/mrad.
const RIGID: f64 = 1e6;

fn body(mass_kg: f64) -> Body {
    Body { mass_kg, inertia_kg_m2: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0], centre_mm: [0.0; 3] }
}

fn joint(from: &str, to: &str, stiffness: [f64; 3], angular: [f64; 3]) -> Joint {
    Joint {
        kind: JointKind::Guideway,
        from: from.to_owned(),
        to: to.to_owned(),
        at_mm: vec![[0.0; 3]],
        stiffness_n_per_um: stiffness,
        damping_n_s_per_mm: [0.0; 3],
        angular_stiffness_nm_per_mrad: angular,
        angular_damping_nm_s_per_rad: [0.0; 3],
    }
}

fn point(body: &str, at_mm: [f64; 3]) -> Point {
    Point { body: body.to_owned(), at_mm }
}

/// A slide of 100 kg that z drives, on a guide that tilts about x and y with κ = 2 and 5 MN·m/rad. The tool is at
/// (0, 150, 300) mm, the screw at the given position; the inertia of the motor is negligible.
fn tilting(screw_mm: [f64; 3]) -> Structure {
    let z = Axis {
        from: GROUND.to_owned(),
        to: "slide".to_owned(),
        direction: [0.0, 0.0, 1.0],
        at_mm: screw_mm,
        scale_at_mm: [0.0; 3],
        motor_mass_kg: 1e-3,
        stiffness_n_per_um: 100.0,
        damping_n_s_per_mm: 0.0,
    };
    Structure {
        body: IndexMap::from([("slide".to_owned(), body(100.0))]),
        joint: vec![joint(GROUND, "slide", [RIGID, RIGID, 0.0], [2e3, 5e3, RIGID])],
        axis: IndexMap::from([("z".to_owned(), z)]),
        tool: point("slide", [0.0, 150.0, 300.0]),
        workpiece: point(GROUND, [0.0; 3]),
    }
}

/// m₁·x₁″ = −k₁x₁ + k₂(x₂ − x₁), m₂·x₂″ = −k₂(x₂ − x₁): m₁m₂ω⁴ − (m₂(k₁ + k₂) + m₁k₂)ω² + k₁k₂ = 0.
#[test]
fn two_bodies_have_the_frequencies_of_the_quadratic() {
    let (m1, m2, k1, k2) = (20.0, 5.0, 3e6, 2e6);
    let half: f64 = (m2 * (k1 + k2) + m1 * k2) / (2.0 * m1 * m2);
    let root = (half * half - k1 * k2 / (m1 * m2)).sqrt();
    let expected = [half - root, half + root].map(|square: f64| square.sqrt() / TAU);
    let structure = Structure {
        body: IndexMap::from([("a".to_owned(), body(m1)), ("b".to_owned(), body(m2))]),
        joint: vec![
            joint(GROUND, "a", [3.0, RIGID, RIGID], [RIGID; 3]),
            joint("a", "b", [2.0, RIGID, RIGID], [RIGID; 3]),
        ],
        axis: IndexMap::new(),
        tool: point("b", [0.0; 3]),
        workpiece: point(GROUND, [0.0; 3]),
    };
    let found = Assembly::of(&structure).unwrap().natural_frequencies_hz().unwrap();
    assert_eq!(found.len(), 12);
    for (found, expected) in found.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }
    // The next one belongs to the rigid directions.
    assert!(found[2] > 1e3, "{found:?}");
}

/// The moment m·a·h of a screw at the distance h from the centre of gravity tilts the slide by m·a·h/κ. A point at the
/// distance l along z then moves across by l times that angle, a point l above moves along z.
#[test]
fn talk_is_mass_times_both_levers_over_the_tilting_stiffness() {
    let (mass, up, ahead, about_x, about_y) = (100.0, 0.15, 0.3, 2e6, 5e6);
    // The screw 40 mm above: the slide tilts about x; at the tool z is ahead and y is lower.
    let above = Assembly::of(&tilting([0.0, 40.0, 0.0])).unwrap().talk_at_rest().unwrap();
    let turned = 1e6 * mass * 0.04 / about_x;
    let expected = [0.0, -turned * ahead, turned * up];
    for (found, expected) in above.tool_um_s2_per_m.iter().zip(expected) {
        // The directions that count as rigid yield by m/K: 1e-4 µm.
        assert!((found - expected).abs() < 2e-4, "{found} {expected}");
    }
    // The screw 40 mm aside: the slide tilts about y, with the opposite sign.
    let aside = Assembly::of(&tilting([40.0, 0.0, 0.0])).unwrap().talk_at_rest().unwrap();
    let expected = [-1e6 * mass * 0.04 / about_y * ahead, 0.0, 0.0];
    for (found, expected) in aside.tool_um_s2_per_m.iter().zip(expected) {
        assert!((found - expected).abs() < 2e-4, "{found} {expected}");
    }
    // The drive accelerates the slide and its own inertia.
    assert!((aside.force_kg[(0, 0)] - 100.001).abs() < 1e-6);
    // A force through the centre of gravity does not tilt the slide.
    let through = Assembly::of(&tilting([0.0; 3])).unwrap().talk_at_rest().unwrap();
    assert!(through.tool_um_s2_per_m.amax() < 1e-9);
}

/// One tilting mode: the coefficient is amplified by 1/(1 − (ω/ω₁)²) with ω₁² = κ/I.
#[test]
fn on_a_circle_talk_is_amplified_by_the_tilting_mode() {
    let assembly = Assembly::of(&tilting([40.0, 0.0, 0.0])).unwrap();
    let at_rest = assembly.talk_at_rest().unwrap().tool_um_s2_per_m[0];
    let mode = 5e6_f64.sqrt();
    for omega in [1.0, 50.0, 500.0] {
        let found = assembly.talk_at(omega).unwrap().tool_um_s2_per_m[0] / at_rest;
        let expected = 1.0 / (1.0 - (omega / mode).powi(2));
        assert!((found / expected - 1.0).abs() < 1e-3, "{omega}: {found} {expected}");
    }
}

/// Motor m₁ and slide m₂ on a screw k under a force F from rest: the screw stretches by F·μ/(m₁k)·(1 − cos ωt) with
/// μ = m₁m₂/(m₁ + m₂), ω² = k/μ, and the centre of gravity moves by F·t²/2(m₁ + m₂).
#[test]
fn a_step_is_exact_however_long() {
    let mut structure = tilting([0.0; 3]);
    structure.axis[0].motor_mass_kg = 50.0;
    let assembly = Assembly::of(&structure).unwrap();
    let (force, stiffness, reduced): (f64, f64, f64) = (300.0, 1e8, 50.0 * 100.0 / 150.0);
    let omega = (stiffness / reduced).sqrt();
    // Ten steps are a tenth of a period of the screw's oscillation, and five periods.
    for step_s in [0.01 * TAU / omega, 0.5 * TAU / omega + 1e-5] {
        let mut moving = Multibody::new(&assembly, step_s).unwrap();
        for number in 1..=10 {
            moving.set_forces(0, AxisForces { motor_n: force, ..AxisForces::default() });
            moving.step();
            let time = step_s * f64::from(number);
            let stretch = force * reduced / (50.0 * stiffness) * (1.0 - (omega * time).cos());
            let middle = force * time.powi(2) / (2.0 * 150.0);
            let (motor, slide) = (moving.motors_m()[0], moving.scales_m()[0]);
            assert!((motor - slide - stretch).abs() < 1e-9 * (middle + stretch) + 1e-15, "{number}");
            let centre = (50.0 * motor + 100.0 * slide) / 150.0;
            assert!((centre / middle - 1.0).abs() < 1e-6, "{number}: {centre} {middle}");
            // Driven through the centre of gravity, the tool moves with the scale.
            assert!((moving.tool_m()[2] - slide).abs() < 1e-9 * slide);
        }
    }
}

#[test]
fn each_part_is_scaled_separately() {
    let structure = tilting([40.0, 0.0, 0.0]);
    let talk = |part, factor| {
        let assembly = Assembly::of(&structure.scaled(part, factor)).unwrap();
        assembly.talk_at_rest().unwrap().tool_um_s2_per_m[0]
    };
    let plain = Assembly::of(&structure).unwrap().talk_at_rest().unwrap().tool_um_s2_per_m[0];
    assert!((talk(Part::Joints(JointKind::Guideway), 0.5) / plain - 2.0).abs() < 1e-9);
    assert!((talk(Part::Masses, 3.0) / plain - 3.0).abs() < 1e-9);
    for part in [Part::Screws, Part::Joints(JointKind::Foot)] {
        assert!((talk(part, 0.5) / plain - 1.0).abs() < 1e-9);
    }
}

#[test]
fn impossible_structures_are_refused_by_their_key() {
    let refused = |change: fn(&mut Structure)| {
        let mut structure = tilting([0.0; 3]);
        change(&mut structure);
        Assembly::of(&structure).unwrap_err().to_string()
    };
    assert_eq!(
        refused(|s| s.body[0].mass_kg = 0.0),
        "body.slide.mass_kg: expected a number above 0, at most 1e9, found 0"
    );
    assert_eq!(
        refused(|s| s.body[0].inertia_kg_m2 = [1.0, 1.0, 2.1, 0.0, 0.0, 0.0]),
        "body.slide.inertia_kg_m2: no body has these moments of inertia"
    );
    assert_eq!(
        refused(|s| s.joint[0].stiffness_n_per_um[1] = -1.0),
        "joint[0].stiffness_n_per_um: expected a number from 0 to 1e9, found -1"
    );
    assert_eq!(
        refused(|s| s.axis[0].at_mm[0] = f64::NAN),
        "axis.z.at_mm: expected a number within ±1e6, found NaN"
    );
    assert_eq!(refused(|s| "table".clone_into(&mut s.tool.body)), "tool.body: no body is called \"table\"");
    // Without its guide the slide is held by the screw alone, which may point in any direction.
    for direction in [[0.0, 0.0, 1.0], [1.0, 2.0, 3.0]] {
        let mut loose = tilting([10.0, 20.0, 0.0]);
        loose.joint.clear();
        loose.axis[0].direction = direction;
        assert_eq!(Assembly::of(&loose).unwrap_err(), StructureError::Loose);
    }
    assert_eq!(
        refused(|s| s.joint[0].stiffness_n_per_um[2] = 1.0),
        "an axis drives in a direction that a joint or another axis blocks"
    );
    // An axis perpendicular to the free direction does not drive the slide.
    let mut across = tilting([0.0; 3]);
    across.axis[0].direction = [1.0, 0.0, 0.0];
    assert_eq!(Assembly::of(&across).unwrap_err(), StructureError::Stuck);
    // The axis does not move the tool against a workpiece on the same body.
    let along = |s: &mut Structure| s.workpiece.body.clone_from(&s.tool.body);
    assert_eq!(refused(along), "axis.z: does not move the tool relative to the workpiece");
    assert_eq!(
        refused(|s| s.axis[0].from = s.axis[0].to.clone()),
        "axis.z.to: expected a body other than that of from"
    );
}
