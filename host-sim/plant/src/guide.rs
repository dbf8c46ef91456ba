//! What a table slides on: friction over a step, implicit, and load.

use wide::f64x2;

use super::friction::{Bristles, Slide, StepTime};
use super::lane::Lane;
use super::motion::Motion;
use super::parameters::AxisParameters;

/// The guides of a register.
#[derive(Clone, Copy, Debug)]
pub struct Guide<L> {
    /// `None`: friction without a presliding state.
    bristles: Option<Bristles<L>>,
    /// [`super::friction::Friction::relaxes_per_m`] where it is the same at every velocity.
    relaxes_per_m: Option<L>,
    load_n: L,
    /// Whether friction of any of them hangs on the speed of before.
    remembers: bool,
    asymmetry_n_s_per_m: L,
}

/// How tables would move over a step without guides, and how hard they are to stop.
#[derive(Clone, Copy, Debug)]
pub struct Free<L> {
    /// Mean velocity.
    pub mean_m_per_s: L,
    /// Velocity at the end.
    pub end_m_per_s: L,
    /// By how much a newton that stays changes the mean velocity, m/s.
    pub mobility: L,
    /// Newtons that have to stay to change the velocity at the end by 1 m/s.
    pub stops_n_s_per_m: L,
}

impl Guide<f64> {
    /// Of one axis.
    #[must_use]
    pub fn new(parameters: &AxisParameters) -> Self {
        let friction = &parameters.friction;
        Self {
            bristles: friction.has_bristles().then(|| friction.bristles()),
            relaxes_per_m: friction.even_level_n().map(|level_n| friction.relaxes_per_m(level_n)),
            load_n: parameters.load.force_n,
            remembers: friction.memory.remembers(),
            asymmetry_n_s_per_m: friction.asymmetry.half_difference_n_s_per_m,
        }
    }
}

impl Guide<f64x2> {
    /// Two beside each other; `None` where one has bristles and the other has not.
    #[must_use]
    pub fn beside(guides: [Guide<f64>; 2]) -> Option<Self> {
        let bristles = match guides.map(|guide| guide.bristles) {
            [Some(a), Some(b)] => Some(Bristles {
                stiffness_n_per_m: f64x2::new([a.stiffness_n_per_m, b.stiffness_n_per_m]),
                damping_n_s_per_m: f64x2::new([a.damping_n_s_per_m, b.damping_n_s_per_m]),
            }),
            [None, None] => None,
            _ => return None,
        };
        let relaxes_per_m = match guides.map(|guide| guide.relaxes_per_m) {
            [Some(a), Some(b)] => Some(f64x2::new([a, b])),
            _ => None,
        };
        Some(Self {
            bristles,
            relaxes_per_m,
            remembers: guides.iter().any(|guide| guide.remembers),
            load_n: f64x2::new(guides.map(|guide| guide.load_n)),
            asymmetry_n_s_per_m: f64x2::new(guides.map(|guide| guide.asymmetry_n_s_per_m)),
        })
    }
}

impl<L: Lane> Guide<L> {
    /// Mean push on the tables over a step, N: friction without its viscous part, and load. Bends the bristles.
    #[inline]
    pub fn push_n(
        &self,
        parameters: &[&AxisParameters],
        motion: &mut Motion<L>,
        free: Free<L>,
        step: StepTime,
    ) -> L {
        let about = motion.table_m_per_s + L::all(0.5) * motion.table_change;
        if self.remembers {
            motion.lately_m_per_s = motion.lately_m_per_s
                + L::of(|axis| parameters[axis].friction.memory.share(step.seconds))
                    * (about.abs() - motion.lately_m_per_s);
        }
        let slide = |axis: usize| Slide {
            place_m: motion.table_m.lane(axis),
            lately_m_per_s: motion.lately_m_per_s.lane(axis),
        };
        let load_n = self.load_n + self.asymmetry_n_s_per_m * about.abs();
        if let Some(bristles) = &self.bristles {
            let relaxes_per_m = self.relaxes_per_m.unwrap_or_else(|| {
                let friction = |axis: usize| &parameters[axis].friction;
                L::of(|axis| {
                    friction(axis).relaxes_per_m(friction(axis).level_n(about.lane(axis), slide(axis)))
                })
            });
            let relaxation = relaxes_per_m * about.abs() * L::all(step.seconds);
            let mean = bristles.over(motion.bristle_m, relaxation, free.mobility, step);
            let velocity = free.mean_m_per_s - free.mobility * load_n;
            motion.friction_n = mean.force_n(velocity);
            motion.bristle_m = mean.bristle_m(velocity - free.mobility * motion.friction_n);
        } else {
            let holds_n = free.end_m_per_s * free.stops_n_s_per_m - load_n;
            let dry_n = |axis: usize| {
                parameters[axis].friction.dry_n(about.lane(axis), slide(axis), holds_n.lane(axis))
            };
            motion.friction_n = L::of(dry_n);
        }
        L::all(0.0) - (motion.friction_n + load_n)
    }
}
