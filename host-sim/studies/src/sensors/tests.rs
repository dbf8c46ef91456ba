//! The loops of the study beside each other, without the planned compensations.

use super::*;

fn machine(feedback: Feedback, law: Law) -> Machine {
    with_loop(&Machine::parse(MACHINE, "machine.toml").unwrap(), feedback, law)
}

/// [motor, table, dual] of a figure.
fn of_sensors(figure: impl Fn(Feedback) -> f64) -> [f64; 3] {
    [Feedback::Motor, Feedback::Table, Feedback::Dual].map(figure)
}

fn highest(feedback: Feedback, law: Law) -> f64 {
    let machine = machine(feedback, law);
    let axes = axis_margins::of_machine(&machine, &Instruments::of(&machine, SEED), MarginLimits::default())
        .unwrap();
    highest_gain(&axes).unwrap()
}

#[test]
fn the_feedforward_of_each_law_leaves_the_radius_of_a_circle() {
    let radius = |law: Law, w: f64| {
        let kf = feedforward_percent(law) / 100.0;
        match law {
            Law::P => 1f64.hypot(kf * w) / 1f64.hypot(w),
            // x³ + 6x² + 16x + 16 at x = jw.
            Law::Hpc => 16.0 * 1f64.hypot(kf * w) / (16.0 - 6.0 * w * w).hypot(16.0 * w - w * w * w),
        }
    };
    for law in [Law::P, Law::Hpc] {
        // What is left is of fourth order in w, with a factor below 1.
        assert!((radius(law, 0.1) - 1.0).abs() < 1e-4, "{law:?} {}", radius(law, 0.1));
    }
}

/// Above its crossover, 1/(30 ms)/2π = 5 Hz, dual feedback is the motor reading: the oscillation of the table against the motor at
/// 97 Hz enters its loop reduced by 5/97 and not, as that of the scale, whole. So its gain can be far above that of the
/// full-closed loop and is below that of the semi-closed one.
#[test]
fn the_resonance_limits_the_gain_of_the_full_closed_loop_most() {
    let [motor, table, dual] = of_sensors(|feedback| highest(feedback, Law::P));
    assert!((0.85 * motor..motor).contains(&dual), "{motor} {dual}");
    assert!(table < 0.5 * dual, "{table} {dual}");
    // The closed form of Kp·ω²/(s·(s² + 2ζωs + ω²)): with a gain margin of 6 dB, Kp = ζω = c/(2M) for a motor that is held. The
    // motor yields, which damps further: the limit is above that.
    let held = 3000.0 / (2.0 * 160.0);
    assert!(table > held, "{table} {held}");
}

/// Semi-closed, the table is wrong by half the backlash and the pitch errors: at the radius of 15 mm at least by half of 8 µm, at
/// some places. Full-closed control sees both.
#[test]
fn the_scale_takes_away_most_of_the_contour_error() {
    let text = MOTIONS[0].1;
    let test = TestMotion::parse(text, "circle.toml", 0.0).unwrap();
    let [motor, table, dual] = of_sensors(|feedback| {
        let machine = machine(feedback, Law::P);
        let instruments = Instruments::of(&machine, SEED);
        let none = CompensationFile::none(&machine);
        contour_errors(&machine, &none, std::slice::from_ref(&test), instruments).unwrap()[0].rms_um
    });
    // Half of 6 to 8 µm of backlash; and less than that with all pitch errors, 60 µm/m·15 mm + 2 µm, added in phase.
    assert!((2.5..6.9).contains(&motor), "{motor}");
    assert!(table < 0.7 * motor && table > 0.2, "{table}, noise 0.08 µm");
    // Dual feedback follows a reversal with its time constant of 30 ms: it is between both.
    assert!((table..motor).contains(&dual), "{table} {dual} {motor}");
}
