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

/// Standard deviation of white noise from third differences, which are zero for a parabola. Their variance is
/// 1 + 9 + 9 + 1 = 20 times that of the noise.
///
/// The median of their magnitude is used, 0.6745 standard deviations of a normal distribution, as a few differences
/// contain sharp changes of the error; it is taken from a histogram, in constant memory, to ±2.2 %.
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

    /// Leaves out the differences across a jump of the signal.
    pub fn interrupt(&mut self) {
        self.known = 0;
    }

    /// Zero without differences.
    pub fn deviation(&self) -> f64 {
        let total: u64 = self.histogram.iter().copied().map(u64::from).sum();
        let mut below = 0;
        let median = self.histogram.iter().position(|count| {
            below += u64::from(*count);
            2 * below > total
        });
        // The lowest class contains zero.
        let middle = |class: usize| {
            SMALLEST_M * ((class as f64 + 0.5) / CLASSES_PER_OCTAVE).exp2() / 0.6745 / 20_f64.sqrt()
        };
        median.filter(|class| *class > 0).map_or(0.0, middle)
    }
}

fn class(magnitude: f64) -> usize {
    let octaves = (magnitude / SMALLEST_M).max(1.0).log2();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "not negative, limited below"
    )]
    let class = (octaves * CLASSES_PER_OCTAVE) as usize;
    class.min(CLASSES - 1)
}
