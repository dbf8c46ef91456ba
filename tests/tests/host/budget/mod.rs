//! The error budget against machines of the second simulator, which shares no code with the plant: what is taken out of its machine goes
//! away as the budget of the model says.

mod second_simulator;

use budget::{Budget, MotionBudget};
use commissioning::compensate::motions_within::{Travel, standard};
use commissioning::compensate::planning::Planning;
use commissioning::compensate::prediction::TestMotion;
use model::machine::Machine;
use plant::instruments::Instruments;

/// The standard circle within ±40 mm: radius 30 mm at 50 mm/s, both directions.
fn circle(machine: &Machine) -> TestMotion {
    let mut travels = Travel::of(machine);
    for travel in &mut travels {
        travel.ends_mm = [-40.0, 40.0];
    }
    let mut motions = standard(&travels);
    assert_eq!(motions[0].motion.name, "circle");
    motions.swap_remove(0)
}

/// A machine file with a gap of 12 µm in x.
fn with_backlash(declared: &str) -> Machine {
    let effect = "[[axis.x.effect]]\nname = 'backlash'\nwidth_um = 12.0\n";
    Machine::parse(&format!("{declared}\n{effect}"), "m.toml").unwrap()
}

/// The budget of a model on the standard circle.
fn on_circle(machine: &Machine) -> MotionBudget {
    let mut budget = Budget::of(machine, &[circle(machine)], 1).unwrap();
    budget.motions.swap_remove(0)
}

/// The shares are the whole, on every standard motion, whatever the machine has.
#[test]
fn the_shares_are_the_whole() {
    let text = format!(
        "{}\n[[axis.x.effect]]\nname = 'backlash'\nwidth_um = 12.0\n[[axis.y.effect]]\nname = 'pitch_cyclic'\namplitude_um = 3.0\n\
         period_mm = 10.0\nphase_rad = 0.5\n[[axis.y.effect]]\nname = 'intalk'\num_s2_per_m = 2.0\n",
        model::examples::DEMO_MACHINE
    );
    let machine = Machine::parse(&text, "m.toml").unwrap();
    let budget = Budget::of(&machine, &standard(&Travel::of(&machine)), 1).unwrap();
    assert_eq!(budget.motions.len(), 4);
    for motion in &budget.motions {
        let whole_um = motion.whole.rms;
        assert!((motion.sum_um() - whole_um).abs() < 1e-9 * whole_um, "{}: {}", motion.name, motion.sum_um());
        let names: Vec<&str> = motion.causes.iter().map(|cause| cause.name).collect();
        for name in ["backlash", "pitch_cyclic", "intalk", "friction_reversal", "following_lag"] {
            assert!(names.contains(&name), "{}: {names:?}", motion.name);
        }
        // Largest first.
        assert!(motion.causes.is_sorted_by(|a, b| a.share.rms.abs() >= b.share.rms.abs()));
    }
}

/// With everything compensated, the shares are the whole, too. `compensate` predicts the same, but searches for what helps: at most 2 % more (that search
/// keeps a part that costs less than 0.2 %, of at most ten), and at least two thirds.
#[test]
fn what_is_left_with_a_compensation_is_what_compensate_predicts() {
    let machine = with_backlash(model::examples::DEMO_MACHINE);
    let motion = on_circle(&machine);
    let left_um = motion.compensated.unwrap().rms;
    let squares = motion.causes.iter().map(|cause| cause.compensated.unwrap().rms).map(|um| um * um.abs());
    assert!((squares.sum::<f64>().sqrt() - left_um).abs() < 1e-9 * left_um);

    let tests = [circle(&machine)];
    let instruments = Instruments::of(&machine, 1);
    let planning = Planning {
        model: &machine,
        model_file: "m.toml",
        tests: &tests,
        watched: &[],
        instruments,
        set_at_s: 0.0,
    };
    let plan = planning.plan().unwrap();
    let predicted_um = plan.file.predicted[0].after_um;
    assert!((0.66..1.02).contains(&(predicted_um / left_um)), "{predicted_um} {left_um}");

    // Half of the width is added within a millisecond; the loop follows in some more, of the 3.8 s of a turn.
    let gap = motion.causes.iter().find(|cause| cause.name == "backlash").unwrap();
    let (before_um, after_um) = (gap.share.rms, gap.compensated.unwrap().rms);
    assert!(after_um.abs() < 0.25 * before_um, "{before_um} {after_um}");
}

/// Of a machine with masses and a spring, but without gains, a loop is assumed that is stable. With the gap alone it follows its command: the contour
/// error of a gap of w on a circle is ±w/2 times the cosine of the angle to its axis, w/√8 rms.
#[test]
fn a_machine_without_gains_has_the_budget_of_its_gap() {
    let has_gain =
        |line: &&str| line.contains("gain") || line.starts_with("feedforward") || line.contains("integral");
    let declared: Vec<&str> = model::examples::DEMO_MACHINE.lines().filter(|line| !has_gain(line)).collect();
    let motion = on_circle(&with_backlash(&declared.join("\n")));
    let gap = motion.causes.iter().find(|cause| cause.name == "backlash").unwrap();
    let expected_um = 12.0 / 8f64.sqrt();
    assert!((gap.alone.rms / expected_um - 1.0).abs() < 0.02, "{:?}", gap.alone);
}

/// The curve of the circle belongs to its figures: the tool is at least as far from the path as the circle deviates. G is a range about the
/// fitted centre, whose offset e is the first harmonic of the deviation: with the greatest deviation m, e ≤ (4/π)·m and G ≤ 2·m + 2·e, so
/// that m ≥ 0.22·G.
#[test]
fn the_curve_of_a_circle_belongs_to_its_figures() {
    let machine = with_backlash(model::examples::DEMO_MACHINE);
    let motion = on_circle(&machine);
    let causes = motion.causes.iter().map(|cause| (&cause.circle_without, cause.without));
    let all = std::iter::once((&motion.circle, motion.whole)).chain(causes);
    let mut greatest_um = Vec::new();
    for (circle, sizes) in all {
        let circle = circle.as_ref().unwrap();
        assert_eq!(circle.axes, ["x", "y"]);
        assert!((circle.radius_m - 0.03).abs() < 1e-9);
        assert_eq!(circle.laps.iter().map(|lap| lap.is_clockwise).collect::<Vec<_>>(), [false, true]);
        assert!(circle.laps.iter().all(|lap| (350..=360).contains(&lap.points.len())));
        let um = circle.greatest_um();
        assert!(um <= sizes.max + 1e-6 && um >= 0.22 * sizes.circular.unwrap(), "{um} {sizes:?}");
        greatest_um.push(um);
    }
    // Only a motion along arcs has a curve, though the part has a full circle, too.
    let budget = Budget::of(&machine, &standard(&Travel::of(&machine)), 1).unwrap();
    let has: Vec<bool> = budget.motions.iter().map(|motion| motion.circle.is_some()).collect();
    assert_eq!(has, [true, false, false, false]);
    // Taking out the largest cause changes the curve.
    assert!((greatest_um[0] - greatest_um[1]).abs() > 0.01 * greatest_um[0], "{greatest_um:?}");
}
