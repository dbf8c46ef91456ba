//! The error budget against machines of the second simulator, which shares no code with the plant: what is taken out of its machine goes
//! away as the budget of the model says.

mod second_simulator;

use budget::motions::{Travel, standard};
use budget::{Budget, MotionBudget};
use compensate::prediction::TestMotion;
use model::machine::Machine;

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
