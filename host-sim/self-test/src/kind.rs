//! The kinds of cases.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use super::{chain, gap};

/// What a case has beyond a machine with undeclared effects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// Effects of the catalogue, of sizes that exceed the noise by far.
    #[default]
    Textbook,
    /// Encoder steps of 0.5 µm in the loops, a lag of the drive, noisy sensors.
    Coarse,
    /// Four or five effects at once.
    Many,
    /// Effects down to a thirtieth of the textbook sizes.
    Small,
    /// Commands with limited jerk.
    Jerk,
    /// Declared masses, stiffness and friction off by up to 25 %, with a tolerance of 10 %.
    Offspec,
    /// A smooth pitch error over the travel.
    Shape,
    /// Friction that depends on position or time, or on the speed of the motor.
    Friction,
    /// Cable drag, a second harmonic of the screw, a belt, or a backlash that varies.
    Foreign,
    /// A scale that slips or sticks, or a probe with the wrong sign.
    Slip,
    /// A setting of the controller, or a lag of the drive, that is not as declared.
    Controller,
    /// Errors of the measuring chain and of the loop: see [`super::chain`].
    Sensors,
    /// A machine file or logs that lack something: see [`super::gap`].
    Sparse,
    /// A guide that is not straight, or a carriage that turns as it moves.
    Guide,
    /// Rotary axes, one with a gear or a weight: see [`super::joint`].
    Joint,
}

impl Kind {
    /// All kinds; the position of a kind determines its random numbers.
    pub const ALL: [Self; 15] = [
        Self::Textbook,
        Self::Coarse,
        Self::Many,
        Self::Small,
        Self::Jerk,
        Self::Offspec,
        Self::Shape,
        Self::Friction,
        Self::Foreign,
        Self::Slip,
        Self::Controller,
        Self::Sensors,
        Self::Sparse,
        Self::Guide,
        Self::Joint,
    ];

    /// Its name on the command line and in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Textbook => "textbook",
            Self::Coarse => "coarse",
            Self::Many => "many",
            Self::Small => "small",
            Self::Jerk => "jerk",
            Self::Offspec => "offspec",
            Self::Shape => "shape",
            Self::Friction => "friction",
            Self::Foreign => "foreign",
            Self::Slip => "slip",
            Self::Controller => "controller",
            Self::Sensors => "sensors",
            Self::Sparse => "sparse",
            Self::Guide => "guide",
            Self::Joint => "joint",
        }
    }

    /// Name of a case: `case-3` for the textbook kind, otherwise `KIND-3`.
    #[must_use]
    pub fn case_name(self, number: u64) -> String {
        let word = if self == Self::Textbook { "case" } else { self.name() };
        format!("{word}-{number}")
    }

    /// A case in words: `case 3` for the textbook kind, otherwise `KIND case 3`.
    #[must_use]
    pub fn case_words(self, number: u64) -> String {
        match self {
            Self::Textbook => format!("case {number}"),
            kind => format!("{} case {number}", kind.name()),
        }
    }

    /// Position in [`Self::ALL`].
    #[must_use]
    pub fn index(self) -> u64 {
        Self::ALL.iter().zip(0..).find(|(kind, _)| **kind == self).map_or(0, |(_, index)| index)
    }

    /// The error or gap that the number of a case determines, of the kinds that have one.
    #[must_use]
    pub fn subject(self, number: u64) -> Option<&'static str> {
        match self {
            Self::Sensors => Some(chain::of_case(number)),
            Self::Sparse => Some(gap::of_case(number)),
            _ => None,
        }
    }

    /// Whether its cases are scored by what the trace states as certain: see [`super::judgement`].
    #[must_use]
    pub fn is_judged(self) -> bool {
        matches!(self, Self::Sensors | Self::Sparse)
    }

    /// Whether its cases may have no effect of the catalogue beside what makes the kind, so that a false name is seen
    /// that stands for it alone.
    pub(super) fn may_stand_alone(self) -> bool {
        matches!(
            self,
            Self::Shape
                | Self::Friction
                | Self::Foreign
                | Self::Slip
                | Self::Controller
                | Self::Guide
                | Self::Joint
        )
    }
}

impl Display for Kind {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Kind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let named = Self::ALL.into_iter().find(|kind| kind.name() == text);
        named.ok_or_else(|| format!("expected one of {}, or all", Self::ALL.map(Self::name).join(", ")))
    }
}

/// Kinds of a self-test, each once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kinds(Vec<Kind>);

impl Kinds {
    /// The kinds in the order in which they were given.
    pub fn iter(&self) -> impl Iterator<Item = Kind> {
        self.0.iter().copied()
    }
}

/// Names separated by commas, or `all`.
impl FromStr for Kinds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "all" {
            return Ok(Self(Kind::ALL.to_vec()));
        }
        let mut kinds: Vec<Kind> = Vec::new();
        for name in text.split(',') {
            let kind = name.trim().parse()?;
            if kinds.contains(&kind) {
                return Err(format!("expected each kind once, found {kind} twice"));
            }
            kinds.push(kind);
        }
        Ok(Self(kinds))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_a_list_of_names_or_all() {
        let kinds = |text: &str| text.parse::<Kinds>().map(|kinds| kinds.iter().collect::<Vec<_>>());
        assert_eq!(kinds("slip,shape"), Ok(vec![Kind::Slip, Kind::Shape]));
        assert_eq!(kinds("all"), Ok(Kind::ALL.to_vec()));
        assert_eq!(kinds("slip,slip"), Err("expected each kind once, found slip twice".to_owned()));
        assert!(kinds("all,slip").is_err() && kinds("").is_err());
    }

    #[test]
    fn every_kind_is_read_by_its_name_and_has_its_own_index() {
        for (kind, index) in Kind::ALL.into_iter().zip(0..) {
            assert_eq!(kind.name().parse(), Ok(kind));
            assert_eq!(kind.index(), index);
        }
        assert!("plain".parse::<Kind>().is_err_and(|message| message.contains("offspec, shape")));
    }
}
