//! Running sums of the contour error.

/// Maximum and root mean square of a signal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Magnitude {
    squares: f64,
    max: f64,
    samples: u64,
}

impl Magnitude {
    pub fn add(&mut self, value: f64) {
        self.squares += value * value;
        self.max = self.max.max(value.abs());
        self.samples += 1;
    }

    pub fn samples(&self) -> u64 {
        self.samples
    }

    pub fn max(&self) -> f64 {
        self.max
    }

    /// Zero without samples.
    pub fn rms(&self) -> f64 {
        (self.squares / self.samples.max(1) as f64).sqrt()
    }
}

/// Classes of a histogram per factor of two: each is 4.4 % wide.
const CLASSES_PER_OCTAVE: f64 = 16.0;

/// Lower end of the histogram, m: far below the resolution of any sensor.
const SMALLEST_M: f64 = 1e-13;

/// Number of classes: up to 1 mm.
const CLASSES: usize = 530;

/// Magnitudes above this multiple of the deviation are sharp changes of the error.
const MAX_DEVIATIONS: f64 = 5.0;

/// Median of the magnitude of a normal distribution, standard deviations.
const NORMAL_MEDIAN: f64 = 0.6745;

/// Standard deviation of white noise from third differences, which are zero for a parabola. Their variance is
/// 1 + 9 + 9 + 1 = 20 times that of the noise.
///
/// A few differences contain sharp changes of the error. Their root mean square is therefore taken without those above five
/// deviations, which the median of the magnitudes gives; both come from a histogram, in constant memory. Its classes are 4.4 %
/// wide, so that the median is within 2.2 %, and the errors of the many classes of the mean square cancel.
#[derive(Clone, Debug)]
pub(crate) struct Noise {
    last: [f64; 3],
    known: usize,
    histogram: Vec<u32>,
}

impl Noise {
    pub fn new() -> Self {
        Self { last: [0.0; 3], known: 0, histogram: vec![0; CLASSES] }
    }

    pub fn add(&mut self, value: f64) {
        if self.known == 3 {
            let [a, b, c] = self.last;
            self.histogram[class((value - 3.0 * c + 3.0 * b - a).abs())] += 1;
        }
        self.last = [self.last[1], self.last[2], value];
        self.known = (self.known + 1).min(3);
    }

    /// Zero without differences, or if most of them are zero.
    pub fn deviation(&self) -> f64 {
        let total: u64 = self.histogram.iter().copied().map(u64::from).sum();
        let mut below = 0;
        let median = self.histogram.iter().position(|count| {
            below += u64::from(*count);
            2 * below > total
        });
        // The lowest class contains zero.
        let Some(median) = median.filter(|class| *class > 0) else { return 0.0 };
        let limit = class(MAX_DEVIATIONS * middle(median) / NORMAL_MEDIAN);
        let counted = self.histogram[..=limit].iter().enumerate();
        let (squares, count) = counted.fold((0.0, 0.0), |(squares, all), (class, &count)| {
            (squares + f64::from(count) * middle(class).powi(2), all + f64::from(count))
        });
        (squares / count / 20.0).sqrt()
    }
}

/// Middle of a class, m.
fn middle(class: usize) -> f64 {
    SMALLEST_M * libm::exp2((class as f64 + 0.5) / CLASSES_PER_OCTAVE)
}

fn class(magnitude: f64) -> usize {
    let octaves = libm::log2((magnitude / SMALLEST_M).max(1.0));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "not negative, limited below"
    )]
    let class = (octaves * CLASSES_PER_OCTAVE) as usize;
    class.min(CLASSES - 1)
}
