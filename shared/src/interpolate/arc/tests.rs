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

proptest! {
    /// An arc to an end point that is off its circle by up to 2 µm, in both directions and with either order of the axes: its length is that of
    /// the angle between the points, it ends at the given point, and its direction is the derivative of its position. A chord of R/512
    /// deviates from that by (R/1024)²/6R² = 1.6e-7; a position that is off by 20 pm, the error of the sine for R = 1 m, by
    /// less than that; and the correction is up to 1/1024.
    #[test]
    fn an_arc_to_an_end_point_ends_there_and_has_the_direction_of_its_way(
        radius in 2e-3..1.0f64, from in 0.0..core::f64::consts::TAU, angle in 0.5..5.8f64, off_m in -1.9e-6..1.9e-6f64,
        positive: bool, exchanged: bool,
    ) {
        let to = if positive { from + angle } else { from - angle };
        let on = |radius: f64, angle: f64| [metres(radius * angle.cos()), metres(radius * angle.sin())];
        let order = |[x, y]: [Position; 2]| if exchanged { [y, x] } else { [x, y] };
        let (start, end) = (on(radius, from), on(radius + off_m, to));
        let plane = if exchanged { [1, 0] } else { [0, 1] };
        // Of the plane [1, 0] axis 1 is the first.
        let arc = Arc::plan_to(order(start), plane, [metres(0.0); 2], end, positive).unwrap();
        prop_assert_eq!(order(arc.end()), end);
        let length = arc.length();
        prop_assert!((length as f64 / (radius * angle * PER_M) - 1.0).abs() < 1e-9, "{length}");
        let last = order(at(&arc, length));
        prop_assert!((last[0] - end[0]).abs() < PER_NM / 5 && (last[1] - end[1]).abs() < PER_NM / 5);
        let half = arc.curvature_radius() / 1024;
        for part in 1..4 {
            let middle = length / 4 * part;
            let [before, after] = [middle - half, middle + half].map(|length| at(&arc, length));
            let direction = arc.direction(middle);
            for axis in 0..2 {
                let slope = (after[axis] - before[axis]) as f64 / (2 * half) as f64;
                let found = direction[axis] as f64 / f64::from(1 << 31).powi(2);
                prop_assert!((found - slope).abs() < 4e-7, "{axis}: {found}, {slope}");
            }
        }
    }

    /// The sine and cosine of the phase of a vector have its direction to the last bits of a sine (2⁻⁶²): a double alone leaves 2⁻⁵³ of a turn.
    #[test]
    fn the_phase_of_a_vector_has_its_direction(x in -(1i64 << 58)..1 << 58, y in -(1i64 << 58)..1 << 58) {
        prop_assume!(x.abs().max(y.abs()) > 1 << 50);
        let (sine, cosine) = sin_cos(phase_of([x, y]));
        let across = i128::from(y) * i128::from(cosine) - i128::from(x) * i128::from(sine);
        let along = i128::from(x) * i128::from(cosine) + i128::from(y) * i128::from(sine);
        prop_assert!(along > 0 && across.unsigned_abs() < along.unsigned_abs() >> 58, "{across}, {along}");
    }
}

/// 2 µm off the circle, and not a unit more, inwards and outwards.
#[test]
fn an_end_point_may_be_two_micrometres_off() {
    let (start, centre) = ([metres(0.01), metres(0.0)], [metres(0.0); 2]);
    let plan = |y: i64| Arc::plan_to(start, [0, 1], centre, [Position(0), Position(y)], true);
    let (radius, tolerance) = (10_000_000 * PER_NM, 2000 * PER_NM);
    for off in [tolerance, -tolerance] {
        assert!(plan(radius + off).is_ok_and(|arc| arc.end() == [Position(0), Position(radius + off)]));
    }
    for off in [tolerance + 1, -tolerance - 1, 2 * tolerance] {
        assert_eq!(plan(radius + off), Err(PathError::EndOffArc), "{off}");
    }
}

/// On a short arc the rounding of the end to a unit is more than 1/1024 of the way, and is no reason to refuse a point of the circle. A point
/// that is off the circle by 1/1000 of the way is refused.
#[test]
fn the_shortest_arcs_end_on_the_circle_or_are_refused() {
    let radius = 10_000_000 * PER_NM;
    let plan = |x: i64, y: i64| {
        Arc::plan_to(
            [Position(radius), Position(0)],
            [0, 1],
            [Position(0); 2],
            [Position(x), Position(y)],
            true,
        )
    };
    for y in 2..1000 {
        assert!(plan(radius, y).is_ok_and(|arc| arc.end() == [Position(radius), Position(y)]), "{y}");
    }
    assert_eq!(plan(radius + 1050, 1_000_000), Err(PathError::EndOffArc));
    assert!(plan(radius + 900, 1_000_000).is_ok());
}

/// A circle may touch the end of the range, 100 m, and have a radius of a micrometre or more.
#[test]
fn the_smallest_and_the_largest_circle() {
    let plan = |x: Position, centre: f64, turns| {
        Arc::plan([x, metres(0.0)], [0, 1], [metres(centre), metres(0.0)], turns)
    };
    assert!(plan(metres(100.0), 99.0, 1.0).is_ok());
    assert!(plan(metres(-100.0), -99.0, 1.0).is_ok());
    assert_eq!(plan(metres(97.999_999), 99.0, 1.0), Err(PathError::TooLarge(Field::Centre)));
    assert!(plan(Position(1000 * PER_NM), 0.0, 1.0).is_ok());
    assert_eq!(plan(Position(1000 * PER_NM - 1), 0.0, 1.0), Err(PathError::ZeroRadius));
    for turns in [1000.0, -1000.0] {
        assert!(plan(metres(0.1), 0.0, turns).is_ok());
        assert_eq!(plan(metres(0.1), 0.0, 1.001 * turns), Err(PathError::TooLarge(Field::Turns)));
    }
}

/// 2⁻³⁴ turns of a radius of 1 m are 0.366 nm, and are not lost beside whole turns.
#[test]
fn a_tiny_part_of_a_turn_has_its_end() {
    let turns = 2.0f64.powi(-34);
    let arc = Arc::plan([metres(1.0), metres(0.0)], [0, 1], [metres(0.0); 2], turns).unwrap();
    let exact = (core::f64::consts::TAU * turns * PER_M) as i64;
    assert!((arc.end()[1].0 - exact).abs() <= 2 && (arc.length() - exact).abs() <= 2, "{arc:?}");
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
