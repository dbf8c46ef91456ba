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

/// Standard deviation of white noise from third differences, which are zero for a parabola. Their variance is
/// 1 + 9 + 9 + 1 = 20 times that of the noise.
#[derive(Clone, Debug, Default)]
pub(crate) struct Noise {
    last: [f64; 3],
    known: usize,
    differences: Magnitude,
}

impl Noise {
    pub fn add(&mut self, value: f64) {
        if self.known == 3 {
            let [a, b, c] = self.last;
            self.differences.add(value - 3.0 * c + 3.0 * b - a);
        }
        self.last = [self.last[1], self.last[2], value];
        self.known = (self.known + 1).min(3);
    }

    /// Leaves out the differences across a jump of the signal.
    pub fn interrupt(&mut self) {
        self.known = 0;
    }

    pub fn deviation(&self) -> f64 {
        self.differences.rms() / 20_f64.sqrt()
    }
}
