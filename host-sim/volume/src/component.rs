//! The geometric errors of three linear axes, with the names of ISO 230-1.

use serde::Serialize;

/// A linear axis, or a direction of space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// X.
    X,
    /// Y.
    Y,
    /// Z.
    Z,
}

impl Axis {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// Its name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        ["x", "y", "z"][self as usize]
    }

    /// The axis of a name.
    #[must_use]
    pub fn of(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|axis| axis.name() == name)
    }
}

/// An error of a carriage along a direction, µm, or about it, µrad (right-handed).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Along a direction.
    Along(Axis),
    /// About a direction.
    About(Axis),
}

/// An error of a carriage as a function of its own position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Component {
    /// The axis that moves.
    pub moved: Axis,
    /// The direction of the error.
    pub kind: Kind,
}

impl Component {
    /// All eighteen.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let of = |moved: Axis| {
            let along = Axis::ALL.map(|axis| Self { moved, kind: Kind::Along(axis) });
            along.into_iter().chain(Axis::ALL.map(|axis| Self { moved, kind: Kind::About(axis) }))
        };
        Axis::ALL.into_iter().flat_map(of).collect()
    }

    /// The name of ISO 230-1, such as `EYX`: error along y (`ECX`: about z) of the axis x.
    #[must_use]
    pub fn name(self) -> String {
        let direction = match self.kind {
            Kind::Along(axis) => ["X", "Y", "Z"][axis as usize],
            Kind::About(axis) => ["A", "B", "C"][axis as usize],
        };
        format!("E{direction}{}", ["X", "Y", "Z"][self.moved as usize])
    }

    /// In words.
    #[must_use]
    pub fn words(self) -> String {
        let moved = self.moved.name();
        match self.kind {
            Kind::Along(axis) if axis == self.moved => format!("positioning of {moved}"),
            Kind::Along(axis) => format!("straightness of {moved} in {}", axis.name()),
            Kind::About(axis) if axis == self.moved => format!("roll of {moved}"),
            Kind::About(axis) => format!("tilt of {moved} about {}", axis.name()),
        }
    }

    /// Its unit.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self.kind {
            Kind::Along(_) => "µm",
            Kind::About(_) => "µrad",
        }
    }

    /// Whether it is a positioning error.
    #[must_use]
    pub fn is_positioning(self) -> bool {
        self.kind == Kind::Along(self.moved)
    }

    /// Whether it is a tilt or a roll.
    #[must_use]
    pub const fn is_rotation(self) -> bool {
        matches!(self.kind, Kind::About(_))
    }

    /// Whether its slope is an error of squareness. The directions of x and of the plane xy are the reference: the slopes of the other
    /// straightness errors turn the whole machine, which is no error.
    #[must_use]
    pub fn has_squareness(self) -> bool {
        match self.kind {
            Kind::Along(axis) => axis < self.moved,
            Kind::About(_) => false,
        }
    }

    /// What shows it: the measurement that is to be added. `None`: nothing, as it does not move the tool.
    #[must_use]
    pub fn shown_by(self, chain: [Axis; 3]) -> Option<String> {
        let moved = self.moved.name();
        Some(match self.kind {
            Kind::Along(axis) if axis == self.moved => format!("a positioning test of {moved}"),
            Kind::Along(axis) => {
                format!("circles in the plane of {moved} and {} at several places", axis.name())
            }
            Kind::About(about) => {
                let beyond = |axis: &&Axis| **axis != about;
                let carried = carried(chain, self.moved);
                let lever = carried.iter().find(beyond)?;
                // A rotation about one axis with a lever along another moves the tool along the third.
                let seen = Axis::ALL.into_iter().find(|axis| *axis != about && axis != lever);
                let seen = seen.map_or("", Axis::name);
                let lever = lever.name();
                if seen == moved {
                    format!("positioning tests of {moved} at two positions of {lever}")
                } else {
                    format!("circles in the plane of {moved} and {seen} at two positions of {lever}")
                }
            }
        })
    }
}

/// The axes between the carriage of an axis and the tool, in the order of a chain from workpiece to tool.
#[must_use]
pub fn carried(chain: [Axis; 3], moved: Axis) -> Vec<Axis> {
    chain.into_iter().skip_while(|axis| *axis != moved).skip(1).collect()
}

/// A course of a component over the position of its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// A Legendre polynomial over the span in which the component was measured: of degree 1 the slope, from −1 to 1; 2 and 3 a bend.
    Legendre(u8),
    /// A knot of a polyline, by its index.
    Knot(usize),
    /// A cubic bend of one axis of a plane less that of the other, where the readings do not tell which: it takes part in the fit, so that
    /// it is not taken for another error, and is in no result.
    EitherCubic,
}

/// The positions of an axis that were measured, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// Lowest.
    pub low_mm: f64,
    /// Highest.
    pub high_mm: f64,
    /// Where its positioning error is zero.
    pub zero_mm: f64,
    /// From where the levers of its tilts count, for each direction of the error that they make: positions of x, y and z in the first
    /// measurement of the axis in this direction, which so shows its error along it whatever its tilts are.
    pub lever_from_mm: [[f64; 3]; 3],
    /// Where its rotations about x, y and z are zero: at the first circle in the plane of the other two directions, whose squareness so is
    /// that of this circle. `None`: there is no such circle.
    pub unturned_mm: [Option<f64>; 3],
    /// Knots of its positioning error, ascending; empty without a positioning test.
    pub knots_mm: Vec<f64>,
}

impl Range {
    /// Whether the axis moved at all.
    #[must_use]
    pub fn is_moved(&self) -> bool {
        self.high_mm > self.low_mm
    }

    /// The courses of a component of the axis.
    #[must_use]
    pub fn courses(&self, component: Component) -> Vec<Course> {
        match component.kind {
            _ if !self.is_moved() => Vec::new(),
            Kind::Along(_) if component.is_positioning() && !self.knots_mm.is_empty() => self.knots(),
            Kind::Along(_) if component.is_positioning() || component.has_squareness() => {
                [1, 2, 3].map(Course::Legendre).to_vec()
            }
            Kind::Along(_) => [2, 3].map(Course::Legendre).to_vec(),
            // A roll is seen on circles alone, which are a part of the travel.
            Kind::About(axis) if axis == component.moved => [1, 2].map(Course::Legendre).to_vec(),
            Kind::About(_) => [1, 2, 3].map(Course::Legendre).to_vec(),
        }
    }

    /// All knots but the one nearest to where the error is zero.
    fn knots(&self) -> Vec<Course> {
        let distance = |index: &usize| (self.knots_mm[*index] - self.zero_mm).abs();
        let zero = (0..self.knots_mm.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        (0..self.knots_mm.len()).filter(|index| Some(*index) != zero).map(Course::Knot).collect()
    }
}

/// The value of a Legendre polynomial over a span, mm. Beyond it, where nothing was measured, it stays as it is at its end; a slope that
/// is a squareness goes on.
#[must_use]
pub fn legendre(degree: u8, goes_on: bool, [low_mm, high_mm]: [f64; 2], at_mm: f64) -> f64 {
    let u = (2.0 * at_mm - low_mm - high_mm) / (high_mm - low_mm);
    let within = u.clamp(-1.0, 1.0);
    match degree {
        1 if goes_on => u,
        1 => within,
        2 => 0.5 * (3.0 * within * within - 1.0),
        _ => 0.5 * within * (5.0 * within * within - 3.0),
    }
}

/// One at a knot, zero at the others, straight between them.
#[must_use]
pub fn hat(knots_mm: &[f64], index: usize, at_mm: f64) -> f64 {
    let at_mm = at_mm.clamp(knots_mm[0], knots_mm[knots_mm.len() - 1]);
    let here = knots_mm[index];
    let neighbour = if at_mm < here { index.checked_sub(1) } else { Some(index + 1) };
    match neighbour.and_then(|other| knots_mm.get(other)) {
        Some(other) => (1.0 - (at_mm - here) / (other - here)).max(0.0),
        // Beyond the ends, at which positions are held.
        None => 1.0,
    }
}
