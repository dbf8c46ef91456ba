//! The guideway under a table over one step: implicit friction, and load.

use wide::f64x2;

use super::axis_motion::AxisMotion;
use super::friction::{Friction, SlidingState};
use super::lane::Lane;
use super::parameters::AxisParameters;
use super::presliding::{Bristles, StepTime};

/// The guides of a register, with everything that is the same in every step.
#[derive(Clone, Copy, Debug)]
pub struct Guide<L> {
    /// `None`: friction without a presliding state.
    bristles: Option<Bristles<L>>,
    /// [`Bristles::relaxation_per_m`] where the sliding level is constant.
    relaxation_per_m: Option<L>,
    /// Constant load.
    load_n: L,
    /// Whether the load of any of the axes depends on its position.
    has_position_load: bool,
    /// Whether the friction of any of the axes depends on its filtered speed.
    has_memory: bool,
    /// Whether [`Friction::beyond_linear_n`] of any of the axes is not zero.
    is_beyond_linear: bool,
}

/// Motion of the tables over a step as it would be without guides, and their response to a force.
#[derive(Clone, Copy, Debug)]
pub struct FreeStep<L> {
    /// Mean velocity over the step, m/s.
    pub mean_m_per_s: L,
    /// Velocity at the end, m/s.
    pub end_m_per_s: L,
    /// Change of the mean velocity per constant force on the table, m/s/N.
    pub mobility: L,
    /// Constant force that changes the velocity at the end by 1 m/s, N·s/m.
    pub stopping_n_s_per_m: L,
}

impl Guide<f64> {
    /// The guide of one axis.
    #[must_use]
    pub fn new(parameters: &AxisParameters) -> Self {
        let friction = &parameters.friction;
        let bristles = friction.bristles();
        Self {
            bristles: friction.has_bristles().then_some(bristles),
            relaxation_per_m: friction.constant_level_n().map(|level_n| bristles.relaxation_per_m(level_n)),
            load_n: parameters.load.constant.force_n,
            has_position_load: parameters.load.varies(),
            has_memory: friction.memory.remembers(),
            is_beyond_linear: friction.is_beyond_linear(),
        }
    }
}

impl Guide<f64x2> {
    /// The guides of two axes in one register; `None` if only one of them has bristles.
    #[must_use]
    pub fn pair(guides: [Guide<f64>; 2]) -> Option<Self> {
        let bristles = match guides.map(|guide| guide.bristles) {
            [Some(a), Some(b)] => Some(Bristles {
                stiffness_n_per_m: f64x2::new([a.stiffness_n_per_m, b.stiffness_n_per_m]),
                damping_n_s_per_m: f64x2::new([a.damping_n_s_per_m, b.damping_n_s_per_m]),
            }),
            [None, None] => None,
            _ => return None,
        };
        let relaxation_per_m = match guides.map(|guide| guide.relaxation_per_m) {
            [Some(a), Some(b)] => Some(f64x2::new([a, b])),
            _ => None,
        };
        Some(Self {
            bristles,
            relaxation_per_m,
            has_memory: guides.iter().any(|guide| guide.has_memory),
            load_n: f64x2::new(guides.map(|guide| guide.load_n)),
            has_position_load: guides.iter().any(|guide| guide.has_position_load),
            is_beyond_linear: guides.iter().any(|guide| guide.is_beyond_linear),
        })
    }
}

impl<L: Lane> Guide<L> {
    /// Mean force of the guides on the tables over a step, N: friction without its viscous part, and load. Updates the
    /// bristles, the filtered speed, the time and `friction_n` of the motion.
    ///
    /// Friction and mean velocity of the step depend on each other; both relations are linear for a fixed sliding
    /// level, which is taken at the extrapolated velocity in the middle of the step.
    #[inline]
    pub fn force_n(
        &self,
        parameters: &[&AxisParameters],
        motion: &mut AxisMotion<L>,
        free: FreeStep<L>,
        step: StepTime,
    ) -> L {
        let about = motion.table_m_per_s + L::all(0.5) * motion.table_change;
        if self.has_memory {
            motion.filtered_speed_m_per_s = motion.filtered_speed_m_per_s
                + L::of(|axis| parameters[axis].friction.memory.share(step.seconds))
                    * (about.abs() - motion.filtered_speed_m_per_s);
        }
        motion.time_s = motion.time_s + L::all(step.seconds);
        let sliding = |axis: usize| SlidingState {
            position_m: motion.table_m.lane(axis),
            filtered_speed_m_per_s: motion.filtered_speed_m_per_s.lane(axis),
            time_s: motion.time_s.lane(axis),
        };
        let mut load_n = self.load_n;
        if self.is_beyond_linear {
            let beyond_linear_n = |axis: usize| {
                parameters[axis].friction.beyond_linear_n(about.lane(axis), motion.time_s.lane(axis))
            };
            load_n = load_n + L::of(beyond_linear_n);
        }
        if self.has_position_load {
            // In the middle of the step, by extrapolation.
            let middle_m = motion.table_m + L::all(0.5 * step.seconds) * about;
            let at_position = |axis: usize| parameters[axis].load.varying_n(middle_m.lane(axis));
            load_n = load_n + L::of(at_position);
        }
        if let Some(bristles) = &self.bristles {
            let of_level = |friction: &Friction, axis: usize| {
                friction.bristles().relaxation_per_m(friction.level_n(about.lane(axis), sliding(axis)))
            };
            let relaxation_per_m = self
                .relaxation_per_m
                .unwrap_or_else(|| L::of(|axis| of_level(&parameters[axis].friction, axis)));
            let relaxation = relaxation_per_m * about.abs() * L::all(step.seconds);
            let mean = bristles.mean_over_step(motion.bristle_m, relaxation, free.mobility, step);
            let velocity = free.mean_m_per_s - free.mobility * load_n;
            motion.friction_n = mean.force_n(velocity);
            motion.bristle_m = mean.bristle_m(velocity - free.mobility * motion.friction_n);
        } else {
            let holding_n = free.end_m_per_s * free.stopping_n_s_per_m - load_n;
            let dry_n = |axis: usize| {
                parameters[axis].friction.dry_n(about.lane(axis), sliding(axis), holding_n.lane(axis))
            };
            motion.friction_n = L::of(dry_n);
        }
        L::all(0.0) - (motion.friction_n + load_n)
    }
}
