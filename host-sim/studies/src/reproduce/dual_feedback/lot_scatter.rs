//! The two lots of turned parts in tables 1 to 4: mean, scatter S, and histograms.
//!
//! S is twice the standard deviation: of σ, 2σ, 3σ and half the range only 2σ gives the printed ±0.008 mm of the
//! numerically controlled lot. (The divisor, n or n − 1, makes no difference in its one digit.) A class includes its
//! upper bound and excludes its lower one; the printed frequencies require this.

use std::f64::consts::FRAC_1_SQRT_2;

use crate::reproduce::study::{Outcome, Picture, Printed, Study};
use files::format::fixed;
use numerics::mean_and_deviation;
use pages::plot::{Chart, Ink, Layer};

/// Table 1, µm above 39 mm, by part number. Corrected misprints: 18 to 40.019, 23 to 40.025, 42 to 39.989.
const CONVENTIONAL_UM: [u32; 42] = [
    1012, 968, 976, 951, 955, 977, 993, 953, 969, 1025, 958, 982, 1019, 976, 966, 977, 974, 1019, 1011, 979,
    979, 978, 1025, 951, 963, 1008, 986, 967, 975, 978, 1015, 1029, 986, 961, 978, 975, 966, 1021, 989, 979,
    967, 989,
];

/// Table 2, µm above 199 mm, by part number.
const CONTROLLED_UM: [u32; 31] = [
    881, 881, 881, 884, 898, 895, 881, 885, 885, 885, 885, 881, 881, 879, 882, 881, 881, 881, 881, 882, 880,
    881, 881, 881, 881, 881, 882, 885, 881, 881, 881,
];

/// Parts per class in table 3.
const CONVENTIONAL_PRINTED: [Option<usize>; 14] = [
    Some(4),
    Some(2),
    Some(6),
    Some(2),
    Some(12),
    Some(3),
    Some(2),
    Some(1),
    Some(0),
    Some(1),
    Some(2),
    Some(4),
    Some(2),
    Some(1),
];

/// Parts per class in table 4; three are illegible.
const CONTROLLED_PRINTED: [Option<usize>; 11] =
    [Some(1), Some(19), Some(3), None, None, None, Some(0), Some(0), Some(1), Some(0), Some(1)];

/// A lot of parts as printed.
struct Lot {
    /// Name in the report.
    name: &'static str,
    /// Reference size, mm.
    base_mm: f64,
    /// Sizes above the reference, µm.
    sizes_um: &'static [u32],
    /// Lower bound of the first class, µm above the reference.
    first_um: u32,
    /// Width of a class, µm.
    class_um: u32,
    /// Printed parts per class; `None` if illegible.
    printed_parts: &'static [Option<usize>],
    /// Printed S, mm.
    scatter_mm: f64,
}

const LOTS: [Lot; 2] = [
    Lot {
        name: "conventional lot",
        base_mm: 39.0,
        sizes_um: &CONVENTIONAL_UM,
        first_um: 950,
        class_um: 6,
        printed_parts: &CONVENTIONAL_PRINTED,
        scatter_mm: 0.061,
    },
    Lot {
        name: "numerically controlled lot",
        base_mm: 199.0,
        sizes_um: &CONTROLLED_UM,
        first_um: 877,
        class_um: 2,
        printed_parts: &CONTROLLED_PRINTED,
        scatter_mm: 0.008,
    },
];

impl Lot {
    /// Sizes, mm.
    fn sizes_mm(&self) -> Vec<f64> {
        self.sizes_um.iter().map(|&um| self.base_mm + 1e-3 * f64::from(um)).collect()
    }

    /// S = 2σ, mm.
    fn scatter_mm(&self) -> f64 {
        2.0 * mean_and_deviation(&self.sizes_mm()).1
    }

    /// Bounds of a class, µm above the reference; the upper one is included.
    fn class(&self, index: usize) -> (u32, u32) {
        let bound = |classes: usize| self.first_um + self.class_um * u32::try_from(classes).unwrap_or(0);
        (bound(index), bound(index + 1))
    }

    /// Counted parts per class.
    fn frequencies(&self) -> Vec<usize> {
        let count = |index| {
            let (low, high) = self.class(index);
            self.sizes_um.iter().filter(|&&um| low < um && um <= high).count()
        };
        (0..self.printed_parts.len()).map(count).collect()
    }

    /// Number of classes with a legible frequency, and of those where the count agrees.
    fn classes(&self) -> (usize, usize) {
        let found = self.frequencies();
        let same = self
            .printed_parts
            .iter()
            .zip(&found)
            .filter(|(printed, found)| **printed == Some(**found))
            .count();
        (self.printed_parts.iter().flatten().count(), same)
    }

    /// Scatter, and agreement of the histogram.
    fn outcomes(&self) -> [Outcome; 2] {
        let (legible, same) = self.classes();
        let histogram =
            format!("{}: classes of {} µm with the printed number of parts", self.name, self.class_um);
        [
            Outcome::new(
                format!("{}: scatter ±S = 2σ", self.name),
                Printed::to_digit(self.scatter_mm, 1e-3),
                self.scatter_mm(),
                "mm",
            ),
            Outcome::new(histogram, Printed::to_digit(legible as f64, 1.0), same as f64, ""),
        ]
    }

    /// Histogram, printed frequencies, and the normal distribution.
    fn picture(&self) -> Picture {
        let found = self.frequencies();
        let (mean, sigma) = mean_and_deviation(&self.sizes_mm());
        let mm = |um: u32| self.base_mm + 1e-3 * f64::from(um);
        let bars = found.iter().enumerate().map(|(index, &parts)| {
            let ((low, high), parts) = (self.class(index), parts as f64);
            let points = vec![(mm(low), 0.0), (mm(low), parts), (mm(high), parts), (mm(high), 0.0)];
            Layer { ink: Ink::BeforeRange, points, is_marked: false }
        });
        let middle = |index| 0.5 * (mm(self.class(index).0) + mm(self.class(index).1));
        let legible = self.printed_parts.iter().enumerate();
        let marks = legible.filter_map(|(index, parts)| Some((middle(index), (*parts)? as f64)));
        // One layer per marker, so that no line connects them.
        let marks = marks.map(|point| Layer { ink: Ink::After, points: vec![point], is_marked: true });
        let (left, right) = (mm(self.class(0).0), mm(self.class(found.len() - 1).1));
        let per_class = 1e-3 * f64::from(self.class_um) * self.sizes_um.len() as f64;
        let height = per_class * FRAC_1_SQRT_2 / (sigma * std::f64::consts::PI.sqrt());
        let normal = |k: u32| {
            let x = left + f64::from(k) / 200.0 * (right - left);
            (x, height * libm::exp(-0.5 * ((x - mean) / sigma).powi(2)))
        };
        let normal = Layer { ink: Ink::Third, points: (0..=200).map(normal).collect(), is_marked: false };
        let title = format!("Parts per class, {}", self.name);
        let caption = format!(
            "{} parts, mean {} mm, S = 2σ = ±{} mm. Classes of {} µm, each including its upper bound.",
            self.sizes_um.len(),
            fixed(mean, 4),
            fixed(2.0 * sigma, 4),
            self.class_um
        );
        let chart = Chart {
            size: (960, 260),
            title: &title,
            description: &caption,
            x: "size, mm",
            y: "parts",
            noise: Some(0.0),
            layers: bars.chain(marks).chain([normal]).collect(),
        };
        let svg = chart.svg();
        let legend = vec![
            ("before-range", "counted".to_owned()),
            ("after mark", "printed, if legible".to_owned()),
            ("cw", "normal distribution with the same mean and σ".to_owned()),
        ];
        Picture { title, svg, caption, legend }
    }
}

/// Adds both lots.
pub fn add(study: &mut Study) {
    for lot in &LOTS {
        let (mean, sigma) = mean_and_deviation(&lot.sizes_mm());
        study.findings.push(format!(
            "The {} of {} parts has a mean of {} mm and S = 2σ = ±{} mm.",
            lot.name,
            lot.sizes_um.len(),
            fixed(mean, 4),
            fixed(2.0 * sigma, 4)
        ));
        study.outcomes.extend(lot.outcomes());
        study.pictures.push(lot.picture());
    }
    let [conventional, controlled] = LOTS.each_ref().map(Lot::scatter_mm);
    study.outcomes.push(Outcome::new(
        "scatter of the conventional lot, times that of the controlled one",
        Printed::Above(1.0),
        conventional / controlled,
        "",
    ));
    study.notes.extend([
        "Table 1, the conventional lot: the first digits of part 18 are illegible (39.019 or 40.019); the class of \
         40.016 to 40.022 mm requires 40.019. Part 23, printed as 40.625, is read as 40.025, and part 42, printed \
         as 35.989, is read as 39.989; as printed they are in no class. Part 27 is read as 39.986, which its class \
         in table 3 requires."
            .to_owned(),
        "Tables 1 and 3 of the paper disagree on one part: by the sizes, the classes of 40.010 to 40.016 and 40.016 \
         to 40.022 mm have 3 and 3 parts, by the tally 2 and 4. Which part is misread or miscounted cannot be \
         determined."
            .to_owned(),
        "Table 2, the controlled lot, is read part by part as 18 parts of 199.881 and 5 of 199.885 mm. Its tally in \
         table 4 (19 up to 199.881 mm, including the one of 199.880) agrees. S does not depend on this: 19 and 4 \
         give the same ±0.0079 mm. The frequencies from 199.883 to 199.889 mm are illegible."
            .to_owned(),
        "S = ±0.008 mm of the controlled lot is 2σ (0.0079 with n, 0.0081 with n − 1); σ is 0.0040, 3σ 0.0119 and \
         half of the range 0.0095 mm. S of the conventional lot is scanned as 1061, which would be ±0.061 mm. The \
         same definition gives ±0.044 mm, 3σ gives 0.066 mm. As the scan confuses 4 and 1 elsewhere (10.010 for \
         40.010), the printed value may be ±0.044; it is left as scanned, and differs."
            .to_owned(),
    ]);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every part is in a class; σ agrees with Σx² − (Σx)²/n, computed in whole µm.
    #[test]
    fn sigma_agrees_with_the_sum_of_squares() {
        for lot in &LOTS {
            assert_eq!(lot.frequencies().iter().sum::<usize>(), lot.sizes_um.len());
            let n = lot.sizes_um.len() as u64;
            let sum: u64 = lot.sizes_um.iter().map(|&um| u64::from(um)).sum();
            let squares: u64 = lot.sizes_um.iter().map(|&um| u64::from(um).pow(2)).sum();
            let sigma_um = ((n * squares - sum * sum) as f64).sqrt() / n as f64;
            assert!((500.0 * lot.scatter_mm() - sigma_um).abs() < 1e-6);
        }
    }

    /// Of the usual definitions only 2σ rounds to the printed ±0.008 mm.
    #[test]
    fn only_two_sigma_gives_the_printed_scatter() {
        let (_, sigma) = mean_and_deviation(&LOTS[1].sizes_mm());
        let half_range = 0.5e-3 * f64::from(898 - 879);
        let sample = sigma * (31f64 / 30.0).sqrt();
        let rounds = |mm: f64| (0.0075..0.0085).contains(&mm);
        assert!(rounds(2.0 * sigma) && rounds(2.0 * sample));
        assert!(![sigma, sample, 3.0 * sigma, 3.0 * sample, half_range].into_iter().any(rounds));
    }

    /// With the lower bound included instead, the frequencies would differ.
    #[test]
    fn classes_include_their_upper_bound() {
        assert_eq!(LOTS.each_ref().map(Lot::classes), [(14, 12), (8, 8)]);
        assert_eq!(LOTS[1].frequencies(), [1, 19, 3, 6, 0, 0, 0, 0, 1, 0, 1]);
        let below = LOTS[1].sizes_um.iter().filter(|&&um| (879..881).contains(&um)).count();
        assert_eq!(below, 2);
    }
}
