#![expect(clippy::cast_possible_truncation, reason = "lengths below 2⁵³ as f64 and back")]

use proptest::prelude::*;

use super::*;

fn at(arc: &Arc<2>, length: i64) -> [Position; 2] {
    let mut point = [Position(0); 2];
    arc.set_to(&mut point, length);
    point
}

fn metres(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

proptest! {
    /// Radius 1 mm to 1 m, centre within ±2 m: every point is within 0.1 nm of the circle (the error of the sine, 20 pm,
    /// and the rounding of the radius), and a whole number of turns closes exactly.
    #[test]
    fn stays_on_the_circle(
        centre in -2.0..2.0f64, radius in 1e-3..1.0f64, angle in 0.0..core::f64::consts::TAU, fraction in 0.0..1.0f64,
        turns in -3i32..=3,
    ) {
        prop_assume!(turns != 0);
        let start = [metres(centre + radius * angle.cos()), metres(-centre + radius * angle.sin())];
        let about = [metres(centre), metres(-centre)];
        let arc = Arc::plan(start, [0, 1], about, f64::from(turns)).unwrap();
        prop_assert_eq!(arc.end(), start);
        let r = |p: [Position; 2]| {
            let square = |d: i64| i128::from(d) * i128::from(d);
            (square(p[0] - about[0]) + square(p[1] - about[1])).unsigned_abs().isqrt()
        };
        let distance = (arc.length() as f64 * fraction) as i64;
        let off = r(at(&arc, distance)).abs_diff(r(start));
        prop_assert!(off < u128::from(PER_NM.unsigned_abs()) / 10, "{off} units off");
        // The point at the full length agrees with the end point: the phase is accurate to 0.1 nm.
        let last = at(&arc, arc.length());
        prop_assert!((last[0] - start[0]).abs() < PER_NM / 5);
        prop_assert!((last[1] - start[1]).abs() < PER_NM / 5);
    }
}

proptest! {
    /// Up to a radius of 1 m the error of the sine is a quarter of a unit, that of the product half a unit, and those of radius and
    /// start phase together less than a quarter.
    #[test]
    fn starts_within_a_unit_of_its_start(
        centre in -2.0..2.0f64, radius in 1e-6..1.0f64, angle in 0.0..core::f64::consts::TAU, turns in -3.0..3.0f64,
    ) {
        prop_assume!(turns != 0.0);
        let start = [metres(centre + radius * angle.cos()), metres(-centre + radius * angle.sin())];
        let arc = Arc::plan(start, [0, 1], [metres(centre), metres(-centre)], turns).unwrap();
        let [x, y] = at(&arc, 0);
        prop_assert!((x - start[0]).abs() <= 1 && (y - start[1]).abs() <= 1, "{} {}", x - start[0], y - start[1]);
    }

    /// An arc with the axes of its plane exchanged, seen from the other side: the same points but for the rounding of the
    /// sine.
    #[test]
    fn the_axes_of_a_plane_can_be_exchanged(
        radius in 1e-3..1.0f64, angle in 0.0..core::f64::consts::TAU, turns in -3.0..3.0f64, fraction in 0.0..1.0f64,
    ) {
        prop_assume!(turns.abs() > 1e-6);
        let start = [metres(radius * angle.cos()), metres(radius * angle.sin())];
        let arc = Arc::plan(start, [0, 1], [metres(0.0); 2], turns).unwrap();
        let exchanged = Arc::plan([start[1], start[0]], [1, 0], [metres(0.0); 2], turns).unwrap();
        let length = (arc.length() as f64 * fraction) as i64;
        let ([x, y], [exchanged_x, exchanged_y]) = (at(&arc, length), at(&exchanged, length));
        prop_assert!((exchanged_y - x).abs() <= 2 && (exchanged_x - y).abs() <= 2);
    }
}

proptest! {
    /// Every point lies within the bounds, and the bounds are tight: one of 4096 points lies within half a step,
    /// 2πR·turns/8192, of an extreme, at a distance of R·(1 − cos) = step²/2R.
    #[test]
    fn reaches_its_bounds_and_no_further(
        radius in 1e-3..1.0f64, angle in 0.0..core::f64::consts::TAU, turns in -1.5..1.5f64,
    ) {
        prop_assume!(turns.abs() > 1e-3);
        let start = [metres(radius * angle.cos()), metres(radius * angle.sin())];
        let arc = Arc::plan(start, [0, 1], [metres(0.0); 2], turns).unwrap();
        let [mut min, mut max] = [start; 2];
        for k in 0..=4096 {
            let point = at(&arc, (i128::from(arc.length()) * k / 4096) as i64);
            min = core::array::from_fn(|i| min[i].min(point[i]));
            max = core::array::from_fn(|i| max[i].max(point[i]));
        }
        let half_step = arc.length() as f64 / 8192.0;
        let shortfall = (half_step * half_step / 2.0 / arc.curvature_radius() as f64) as i64 + PER_NM;
        for (i, [low, high]) in arc.bounds().into_iter().enumerate() {
            prop_assert!((-PER_NM..=shortfall).contains(&(min[i] - low)), "{i}: {}", min[i] - low);
            prop_assert!((-PER_NM..=shortfall).contains(&(high - max[i])), "{i}: {}", high - max[i]);
        }
    }
}

#[test]
fn a_quarter_turn_ends_at_the_exact_point() {
    let arc = Arc::plan([metres(0.05), metres(0.0)], [0, 1], [metres(0.0); 2], 0.25).unwrap();
    assert_eq!(arc.end(), [metres(0.0), metres(0.05)]);
    // 2π·50 mm/4 = 78.539816339744831 mm.
    let exact = (0.05 * core::f64::consts::FRAC_PI_2 * PER_M) as i64;
    assert!((arc.length() - exact).abs() < 200, "{}", arc.length() - exact);
}

#[test]
fn invalid_arcs_are_rejected() {
    let at = [metres(0.0); 2];
    let plan = |plane, centre, turns| Arc::plan(at, plane, centre, turns).unwrap_err();
    assert_eq!(plan([0, 0], [metres(1.0); 2], 1.0), PathError::BadPlane);
    assert_eq!(plan([0, 2], [metres(1.0); 2], 1.0), PathError::BadPlane);
    assert_eq!(plan([0, 1], at, 1.0), PathError::ZeroRadius);
    assert_eq!(plan([0, 1], [metres(1.0); 2], 0.0), PathError::ZeroLength);
    assert_eq!(plan([0, 1], [metres(1.0); 2], f64::NAN), PathError::NotFinite(Field::Turns));
    assert_eq!(plan([0, 1], [metres(1.0); 2], 1e9), PathError::TooLarge(Field::Turns));
}
