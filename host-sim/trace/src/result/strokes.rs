//! Strokes in which what the terms of a law depend on is different: one axis after the other, where the logs moved both, at two places of the axis at rest, at two
//! speeds or accelerations, over two lengths, or again after a pause, as the terms ask for.

use crate::analysis::law::equation::variable_unit;
use crate::input::motion_range::MotionRange;
use crate::input::signals::Signals;
use crate::options::AdmissionOptions;
use files::format::significant;
use files::log::Unit;
use model::residual_law::Term;
use model::residual_table::{TableVariable as V, first_other};
use motion::Lines;

/// Fractions of speed or acceleration, where a term depends on it.
const PACES: [f64; 2] = [0.25, 0.9];

/// Fraction of speed or acceleration, where no term depends on it.
const USUAL_PACE: f64 = 0.5;

/// Fraction of the travel of a stroke.
const TRAVEL: f64 = 0.9;

/// Places of an axis at rest, as fractions of half its travel, where a term depends on them.
const PLACES: [f64; 2] = [-0.7, 0.7];

/// Lengths of strokes, in distances of a hysteresis.
const DISTANCES: [f64; 2] = [1.0, 5.0];

/// Pause before the last strokes, where a term depends on the time, s.
const PAUSE_S: f64 = 60.0;

/// Shorter ways are not moved, mm.
const SHORTEST_MM: f64 = 0.01;

/// A motion with its words.
pub struct Strokes {
    /// The motion.
    pub motion: Lines,
    /// Which axis moves where, and how.
    pub how: String,
}

/// An axis that takes part.
struct Part<'a> {
    name: &'a str,
    unit: Unit,
    range: MotionRange,
}

/// The axes that move in a series of strokes together, and the one at rest with its places.
struct Series<'a> {
    moving: Vec<&'a Part<'a>>,
    resting: Option<(&'a Part<'a>, &'static [f64])>,
}

/// What the terms ask of all strokes.
struct Asked {
    speeds: Vec<f64>,
    accelerations: Vec<f64>,
    distance_mm: Option<f64>,
    pause_s: Option<f64>,
}

impl Strokes {
    /// The strokes for these terms, of an axis by its number, within the motion of the logs; `None` if its axes do not move there.
    #[must_use]
    pub fn of(
        terms: &[&Term],
        (names, axis): (&[String], usize),
        logs: &[Signals],
        options: &AdmissionOptions,
    ) -> Option<Self> {
        let part = |index: usize| {
            let unit = logs.iter().find_map(|log| log.axes.get(index)?.unit);
            let range = MotionRange::of(logs, index, options.min_travel_mm)?;
            Some(Part { name: names.get(index)?, unit: unit.unwrap_or(Unit::Millimetre), range })
        };
        let [own, other] = [axis, first_other(axis)].map(part);
        let all = series(terms, own.as_ref(), other.as_ref());
        let asked = Asked::by(terms);
        let first = all.first()?;
        let at_rest = names.iter().enumerate().filter_map(|(i, name)| Some((name.clone(), part(i)?.range)));
        let start_mm = |(name, range): (String, MotionRange)| {
            let moving = first.moving.iter().find(|part| part.name == name);
            let resting = first.resting.filter(|(part, _)| part.name == name);
            let moving_mm = moving.map(|part| part.at(-asked.fractions(part)[0]));
            let resting_mm = resting.map(|(part, places)| part.at(places[0]));
            (name, moving_mm.or(resting_mm).unwrap_or(range.middle_mm))
        };
        let position_mm: Vec<(String, f64)> = at_rest.map(start_mm).collect();
        let pace = first.pace([USUAL_PACE; 2]);
        let lines = Lines::begin("strokes", position_mm.iter().cloned().collect(), pace);
        let mut moved = Moved { lines, position_mm };
        moved.lines.dwell(0.5);
        for series in &all {
            moved.series(series, &asked);
        }
        if let Some(pause_s) = asked.pause_s {
            moved.lines.dwell(pause_s);
            moved.series(first, &asked);
        }
        let how: Vec<String> = all.iter().map(|series| series.words(&asked)).collect();
        let pause = asked.pause_s.map_or_else(String::new, |pause_s| format!(", again after {pause_s} s"));
        Some(Self { motion: moved.lines, how: format!("{}{pause}", how.join(", and ")) })
    }
}

/// The series of strokes that terms ask for.
fn series<'a>(terms: &[&Term], own: Option<&'a Part<'a>>, other: Option<&'a Part<'a>>) -> Vec<Series<'a>> {
    let has = |is: &dyn Fn(&V) -> bool| terms.iter().any(|term| term.variables().iter().any(is));
    let is_own = |one: &V| !one.is_of_other_axis() && *one != V::TimeS;
    let moves_other = |one: &V| one.is_of_other_axis() && *one != V::OtherPositionMm;
    let moves_own = |one: &V| is_own(one) && *one != V::PositionMm;
    let has_place = |place: V| has(&|one| *one == place);
    let places = |is_asked: bool| if is_asked { &PLACES[..] } else { &[0.0][..] };
    let is_together = terms.iter().any(|term| {
        let of = term.variables();
        of.iter().any(moves_other) && of.iter().any(moves_own)
    });
    if let (true, Some(own), Some(other)) = (is_together, own, other) {
        return vec![Series { moving: vec![own, other], resting: None }];
    }
    let mut all = Vec::new();
    let is_of_other_alone = !has(&is_own) && has_place(V::OtherPositionMm);
    if let Some(own) = own.filter(|_| !is_of_other_alone && (has(&is_own) || !has(&moves_other))) {
        let resting = other.map(|other| (other, places(has_place(V::OtherPositionMm))));
        all.push(Series { moving: vec![own], resting });
    }
    if let Some(other) = other.filter(|_| is_of_other_alone || has(&moves_other)) {
        let resting = own.map(|own| (own, places(has_place(V::PositionMm))));
        all.push(Series { moving: vec![other], resting });
    }
    all
}

impl Asked {
    fn by(terms: &[&Term]) -> Self {
        let has = |all: &[V]| terms.iter().any(|term| term.variables().iter().any(|one| all.contains(one)));
        let paces = |is_asked: bool| if is_asked { PACES.to_vec() } else { vec![USUAL_PACE] };
        let distance = |term: &&Term| match term {
            Term::Hysteresis { distance_mm, .. } => Some(*distance_mm),
            _ => None,
        };
        Self {
            speeds: paces(has(&[V::VelocityMPerS, V::SpeedMPerS, V::OtherVelocityMPerS])),
            accelerations: paces(has(&[V::AccelerationMPerS2, V::OtherAccelerationMPerS2, V::ForceN])),
            distance_mm: terms.iter().find_map(distance),
            pause_s: has(&[V::TimeS]).then_some(PAUSE_S),
        }
    }

    /// The strokes of an axis, as fractions of half its travel.
    fn fractions(&self, part: &Part<'_>) -> Vec<f64> {
        let Some(distance_mm) = self.distance_mm else { return vec![TRAVEL] };
        let fraction = |factor: f64| (0.5 * factor * distance_mm / part.range.half_mm).min(TRAVEL);
        let mut all = DISTANCES.map(fraction).to_vec();
        all.dedup();
        all
    }
}

impl Part<'_> {
    /// The position at a fraction of half the travel, mm.
    fn at(&self, fraction: f64) -> f64 {
        let mm = self.range.middle_mm + fraction * self.range.half_mm;
        // As motion files have it, without a negative zero.
        1e-3 * (1e3 * mm).round() + 0.0
    }

    /// Unit of its positions.
    fn symbol(&self) -> &'static str {
        variable_unit(V::PositionMm, self.unit).unwrap_or_default()
    }
}

impl Series<'_> {
    /// Feed (mm/min) and acceleration (m/s²) as fractions of those of the logs.
    fn pace(&self, [speed, acceleration]: [f64; 2]) -> [f64; 2] {
        let least =
            |of: fn(&MotionRange) -> f64| numerics::min(self.moving.iter().map(|part| of(&part.range)));
        [
            60.0 * speed * least(|range| range.speed_mm_s),
            acceleration * least(|range| range.acceleration_m_per_s2),
        ]
    }

    /// Which axis moves where, and how.
    fn words(&self, asked: &Asked) -> String {
        let numbers = |all: Vec<f64>| {
            let all: Vec<String> = all.into_iter().map(|value| significant(value, 3)).collect();
            all.join(" and ")
        };
        let stroke = |part: &&Part<'_>| {
            let ends = |fraction: &f64| {
                let [from, to] = [-1.0, 1.0].map(|end| significant(part.at(end * fraction), 3));
                format!("from {from} to {to}")
            };
            let all: Vec<String> = asked.fractions(part).iter().map(ends).collect();
            format!("{} {} {}", part.name, all.join(" and "), part.symbol())
        };
        let strokes: Vec<String> = self.moving.iter().map(stroke).collect();
        let symbol = self.moving.first().map_or("mm", |part| part.symbol());
        let speeds =
            asked.speeds.iter().map(|&speed| self.pace([speed, 1.0])[0] / 60.0).collect::<Vec<f64>>();
        let mut said = format!(
            "strokes of {} and back at {} {symbol}/s",
            strokes.join(" together with "),
            numbers(speeds)
        );
        if asked.accelerations.len() > 1 {
            let all = asked.accelerations.iter().map(|&acceleration| self.pace([1.0, acceleration])[1]);
            said += &format!(" with accelerations of {} m/s²", numbers(all.collect()));
        }
        if let Some((resting, places)) = self.resting {
            let at = places.iter().map(|&place| resting.at(place)).collect();
            said += &format!(" with {} at {} {}", resting.name, numbers(at), resting.symbol());
        }
        said
    }
}

/// A motion as far as it is built.
struct Moved {
    lines: Lines,
    position_mm: Vec<(String, f64)>,
}

impl Moved {
    /// Adds the strokes of a series.
    fn series(&mut self, series: &Series<'_>, asked: &Asked) {
        let usual = series.pace([USUAL_PACE; 2]);
        let places: &[f64] = series.resting.map_or(&[0.0], |(_, places)| places);
        for &place in places {
            if let Some((resting, _)) = series.resting {
                self.line(&[(resting.name, resting.at(place))], usual);
            }
            for &speed in &asked.speeds {
                for &acceleration in &asked.accelerations {
                    self.strokes(series, asked, series.pace([speed, acceleration]));
                }
            }
        }
    }

    /// Adds strokes of each length; of two axes in equal, then in opposite directions.
    fn strokes(&mut self, series: &Series<'_>, asked: &Asked, pace: [f64; 2]) {
        let count = series.moving.first().map_or(0, |part| asked.fractions(part).len());
        let ends: &[[f64; 2]] = match series.moving.len() {
            1 => &[[1.0; 2], [-1.0; 2]],
            _ => &[[1.0; 2], [-1.0; 2], [-1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0; 2]],
        };
        for length in 0..count {
            for end in ends {
                let at = |(part, end): (&&Part<'_>, &f64)| {
                    let all = asked.fractions(part);
                    (part.name.to_owned(), part.at(end * all[length.min(all.len() - 1)]))
                };
                let to: Vec<(String, f64)> = series.moving.iter().zip(end).map(at).collect();
                let to: Vec<(&str, f64)> = to.iter().map(|(name, mm)| (name.as_str(), *mm)).collect();
                self.line(&to, pace);
            }
        }
    }

    /// Adds a line, if it is one.
    fn line(&mut self, to_mm: &[(&str, f64)], pace: [f64; 2]) {
        let is_there = |&(name, mm): &(&str, f64)| {
            self.position_mm.iter().any(|(known, at)| known == name && (at - mm).abs() < SHORTEST_MM)
        };
        if to_mm.iter().all(is_there) {
            return;
        }
        for (name, at) in &mut self.position_mm {
            *at = to_mm.iter().find(|(moved, _)| moved == name).map_or(*at, |(_, mm)| *mm);
        }
        self.lines.line(to_mm.iter().copied(), pace);
    }
}
