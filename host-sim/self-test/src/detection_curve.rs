//! How often an effect of a given size is found, and from which size on its name may be trusted.

use serde_json::{Map, Value, json};

use super::detection::{Detection, SIZES};
use super::summary::Proportion;
use super::truth::NAMES;

/// Smallest fraction, of effects found or of correct names, at a size that is called reliable or trusted.
const RELIABLE: f64 = 0.95;

/// The cases whose size is nearest to one of [`SIZES`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// The size, in units of the noise.
    pub size: f64,
    /// Cases in which the effect was found.
    pub found: Proportion,
    /// Cases in which an effect was found that is not there, and not called ambiguous.
    pub with_false_name: usize,
    /// Cases in which one was found that is called ambiguous.
    pub with_ambiguous_name: usize,
    /// Names that were given without being called ambiguous, and those of them that are correct.
    pub names: Proportion,
}

/// The cases of one effect.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectDetections {
    /// Name of the effect.
    pub name: &'static str,
    /// Size and whether it was found, by size.
    pub points: Vec<(f64, bool)>,
}

impl EffectDetections {
    /// Largest size at which it was missed.
    #[must_use]
    pub fn largest_missed(&self) -> Option<f64> {
        self.points.iter().rev().find(|(_, found)| !found).map(|&(size, _)| size)
    }

    /// Smallest size from which on it was always found.
    #[must_use]
    pub fn found_from(&self) -> Option<f64> {
        let always = self.points.iter().rev().take_while(|(_, found)| *found);
        always.last().map(|&(size, _)| size)
    }
}

/// The detection curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// One for each of [`SIZES`].
    pub bins: Vec<Bin>,
    /// By effect, in the order of the catalogue; only those that occur.
    pub effects: Vec<EffectDetections>,
}

impl Curve {
    /// The curve through these cases.
    #[must_use]
    pub fn new(detections: &[Detection]) -> Self {
        let bin = |(index, &size): (usize, &f64)| {
            let inside = || detections.iter().filter(move |detection| bin_of(detection.size) == index);
            Bin {
                size,
                found: Proportion::of(inside().map(|detection| detection.is_found)),
                names: names(inside()),
                with_false_name: inside().filter(|detection| !detection.false_names.is_empty()).count(),
                with_ambiguous_name: inside().filter(|d| !d.ambiguous_names.is_empty()).count(),
            }
        };
        let of = |name: &'static str| {
            let same = detections.iter().filter(|detection| detection.truth.name == name);
            let mut points: Vec<(f64, bool)> = same.map(|d| (d.size, d.is_found)).collect();
            points.sort_by(|one, other| one.0.total_cmp(&other.0));
            EffectDetections { name, points }
        };
        Self {
            bins: SIZES.iter().enumerate().map(bin).collect(),
            effects: NAMES.map(of).into_iter().filter(|effect| !effect.points.is_empty()).collect(),
        }
    }

    /// Smallest size from which on at least 95 % of the effects were found, at it and at every larger size.
    #[must_use]
    pub fn reliable_from(&self) -> Option<f64> {
        let occurring = self.bins.iter().rev().filter(|bin| bin.found.trials > 0);
        occurring.take_while(|bin| bin.found.fraction() >= RELIABLE).last().map(|bin| bin.size)
    }

    /// Smallest size from which on at least 95 % of the names given were correct, at it and at every larger size.
    #[must_use]
    pub fn trusted_from(&self) -> Option<f64> {
        let named = self.bins.iter().rev().filter(|bin| bin.names.trials > 0);
        named.take_while(|bin| bin.names.fraction() >= RELIABLE).last().map(|bin| bin.size)
    }

    /// Number of effects that were found in every case of at least this size.
    #[must_use]
    pub fn always_found_from(&self, size: f64) -> usize {
        let is_missed =
            |effect: &&EffectDetections| effect.largest_missed().is_some_and(|missed| missed >= size);
        self.effects.iter().filter(|effect| !is_missed(effect)).count()
    }

    /// Its entry in the JSON of the self-test.
    #[must_use]
    pub fn json(&self) -> Value {
        let bin = |bin: &Bin| json!({"size": bin.size, "found": bin.found.json(), "with_false_name": bin.with_false_name, "with_ambiguous_name": bin.with_ambiguous_name, "names_correct": bin.names.json()});
        let effect = |effect: &EffectDetections| {
            let entry = json!({
                "cases": effect.points.len(),
                "found_from": effect.found_from(),
                "largest_missed": effect.largest_missed(),
            });
            (effect.name.to_owned(), entry)
        };
        json!({
            "sizes": self.bins.iter().map(bin).collect::<Vec<_>>(),
            "reliable_from": self.reliable_from(),
            "trusted_from": self.trusted_from(),
            "effects": self.effects.iter().map(effect).collect::<Map<_, _>>(),
        })
    }
}

/// Correct names among those given.
fn names<'a>(detections: impl Iterator<Item = &'a Detection>) -> Proportion {
    detections.fold(Proportion::default(), |sum, detection| {
        let hits = usize::from(detection.is_found);
        Proportion { hits: sum.hits + hits, trials: sum.trials + hits + detection.false_names.len() }
    })
}

/// Index of the size nearest to this one, by ratio.
fn bin_of(size: f64) -> usize {
    let distance = |index: &usize| libm::log(size.max(f64::MIN_POSITIVE) / SIZES[*index]).abs();
    (0..SIZES.len()).min_by(|one, other| distance(one).total_cmp(&distance(other))).unwrap_or(0)
}

/// The JSON of `self-test --detection --json`.
#[must_use]
pub fn json(seed: u64, asked: u64, detections: &[Detection], curve: &Curve) -> Value {
    let case = |detection: &Detection| {
        json!({
            "case": detection.number,
            "truth": detection.truth.json(),
            "size": detection.size,
            "found": detection.is_found,
            "false": detection.false_names,
            "ambiguous": detection.ambiguous_names,
        })
    };
    json!({
        "seed": seed,
        "asked": asked,
        "detection": curve.json(),
        "cases": detections.iter().map(case).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::score::tests::truth;
    use super::*;

    pub fn detections() -> Vec<Detection> {
        let of = |(number, (name, size, is_found)): (u64, (&'static str, f64, bool))| Detection {
            number,
            truth: truth(name, "x", &[]),
            size,
            is_found,
            false_names: if number == 2 { vec![("intalk".to_owned(), "x".to_owned())] } else { Vec::new() },
            ambiguous_names: if number == 4 {
                vec![("latency".to_owned(), "y".to_owned())]
            } else {
                Vec::new()
            },
        };
        let points = [
            ("backlash", 0.11, false),
            ("windup", 0.3, false),
            ("backlash", 1.0, true),
            ("windup", 2.9, false),
            ("backlash", 3.1, true),
            ("windup", 9.0, true),
            ("backlash", 28.0, true),
        ];
        (1..).zip(points).map(of).collect()
    }

    #[test]
    fn cases_are_counted_at_the_nearest_size() {
        let curve = Curve::new(&detections());
        let at = |size: f64| curve.bins[bin_of(size)];
        assert_eq!(at(3.06).found, Proportion { hits: 1, trials: 2 });
        assert_eq!((at(0.31).found.trials, at(0.31).with_false_name), (1, 1));
        assert_eq!((at(0.31).names, at(3.06).names.trials), (Proportion { hits: 0, trials: 1 }, 1));
        assert_eq!((at(0.31).with_ambiguous_name, at(3.06).with_ambiguous_name), (0, 1));
        assert_eq!(curve.bins.iter().map(|bin| bin.found.trials).sum::<usize>(), 7);
        // The bounds between sizes are their geometric means: √(9.58 · 17.0) = 12.76.
        assert_eq!((bin_of(12.7), bin_of(12.8)), (8, 9));
        assert_eq!((bin_of(0.0), bin_of(1e6)), (0, SIZES.len() - 1));
    }

    #[test]
    fn a_size_is_reliable_if_all_larger_ones_are() {
        let curve = Curve::new(&detections());
        assert_eq!(curve.reliable_from(), Some(9.58));
        // The only false name is at 0.3; above it the next size at which a name was given is 0.98.
        assert_eq!(curve.trusted_from(), Some(0.98));
        assert_eq!([0.1, 0.2, 3.0].map(|size| curve.always_found_from(size)), [0, 1, 2]);
        let [backlash, windup] = &curve.effects[..] else { panic!("{:?}", curve.effects) };
        assert_eq!((backlash.found_from(), backlash.largest_missed()), (Some(1.0), Some(0.11)));
        assert_eq!((windup.found_from(), windup.largest_missed()), (Some(9.0), Some(2.9)));
        let missed: Vec<_> = detections().into_iter().map(|d| Detection { is_found: false, ..d }).collect();
        let curve = Curve::new(&missed);
        assert_eq!((curve.reliable_from(), curve.effects[0].found_from()), (None, None));
    }
}
