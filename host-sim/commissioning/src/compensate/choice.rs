//! What of a possible compensation is used, and how much of it.

use std::collections::BTreeSet;

use crate::compensate::servo::MOST_AHEAD_TICKS;

/// A part of a compensation that can be left out.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Part {
    /// The compensation of an effect: index of the axis, and of the effect among those of the axis.
    Effect(usize, usize),
    /// A term of a law of a residual: index of the axis, of the law among those of the axis, and of the term.
    LawTerm(usize, usize, usize),
    /// Force feed-forward of an axis from its declared masses, friction and loads.
    Force(usize),
    /// The stretch of an axis's drive under the modelled force.
    Stretch(usize),
    /// Velocity feed-forward on all axes.
    Feedforward,
    /// P control in place of HPC on all axes: HPC filters the feed-forward, too, and overshoots with 100 % of it.
    Law,
}

/// Times by which the velocity feed-forward is ahead of the command that are tried, position ticks. Its backward difference is
/// one tick late; drive and velocity reading change that by a part of a tick.
const AHEAD_TICKS: [f64; 7] = [0.0, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0];

/// Shares of the time constant of a drive whose velocity is commanded that are tried as times of the feed-forward, each alone and with the tick
/// of the backward difference.
const AHEAD_SHARES: [f64; 3] = [0.5, 0.75, 1.0];

/// Changes of that time that are tried beside a gentler feed-forward, position ticks.
const OTHER_TICKS: [f64; 4] = [-0.25, 0.0, 0.25, 0.5];

/// Velocity feed-forwards that are tried where an axis with 100 % overshoots its stops, %.
const PERCENTS: [f64; 4] = [100.0, 99.0, 98.0, 96.0];

/// Shares of the stretch that are tried: friction, and with it the stretch, falls at rest, and the compensation keeps it.
const SHARES: [f64; 2] = [1.0, 0.5];

/// How much of a compensation is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Strength {
    /// Velocity feed-forward, %.
    pub percent: f64,
    /// Time by which it is ahead of the command, s.
    pub ahead_s: f64,
    /// Share of the stretch.
    pub stretch: f64,
}

impl Strength {
    /// Everything, with each of the times of the velocity feed-forward. A drive whose velocity is commanded is late by its time constant,
    /// s, as well; 0: there is none.
    pub fn full(tick_s: f64, time_constant_s: f64) -> impl Iterator<Item = Self> {
        let late_s = AHEAD_SHARES.into_iter().filter(move |_| time_constant_s > 0.0).flat_map(move |share| {
            [0.0, 1.0].map(|ticks| (share * time_constant_s + ticks * tick_s).min(MOST_AHEAD_TICKS * tick_s))
        });
        let ahead_s = AHEAD_TICKS.into_iter().map(move |ticks| ticks * tick_s).chain(late_s);
        ahead_s.map(|ahead_s| Self { ahead_s, ..Self::default() })
    }

    /// Other strengths around this one, with which an axis overshoots less.
    pub fn gentler(self, tick_s: f64) -> impl Iterator<Item = Self> {
        let all = SHARES.into_iter().flat_map(move |stretch| {
            PERCENTS.into_iter().flat_map(move |percent| {
                OTHER_TICKS.into_iter().map(move |ticks| Self {
                    percent,
                    ahead_s: (self.ahead_s + ticks * tick_s).max(0.0),
                    stretch,
                })
            })
        });
        all.filter(move |other| *other != self)
    }
}

impl Default for Strength {
    fn default() -> Self {
        Self { percent: 100.0, ahead_s: 0.0, stretch: 1.0 }
    }
}

/// What of the possible compensation is used.
#[derive(Clone, Debug, Default)]
pub(crate) struct Choice {
    /// The parts that are left out.
    pub off: BTreeSet<Part>,
    /// How much of the others is used.
    pub strength: Strength,
}

impl Choice {
    pub fn has(&self, part: &Part) -> bool {
        !self.off.contains(part)
    }

    pub fn without(&self, part: &Part) -> Self {
        let mut choice = self.clone();
        choice.off.insert(part.clone());
        choice
    }

    pub fn with(&self, strength: Strength) -> Self {
        Self { strength, ..self.clone() }
    }
}
