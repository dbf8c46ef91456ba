//! The windows of the axis filters, and their step.

use super::{CommonMeans, Divisor, Filter, Filters, WINDOW};
use crate::integer::mul_q32;
use crate::one_after_the_other;
use crate::units::Position;

/// State of the filters of all axes.
// In this order: an instruction reaches the first 1 KiB.
#[repr(C)]
#[derive(Clone, Debug)]
pub struct State<const N: usize> {
    axes: [AxisState; N],
    /// Last outputs.
    outputs: [Position; N],
    next: u16,
    /// Number of inputs written, up to the length of the window.
    written: u16,
    /// Number of ticks for which no input has changed.
    unchanged_ticks: u16,
    /// Whether every filter has all the inputs that it depends on.
    is_filled: bool,
    /// The last inputs; the next ones are written at `next`. Inputs before the last [`State::rest_at`] count as those of it, so
    /// that the window need not be written then.
    window: [[i64; N]; WINDOW],
}

/// State of the filter of an axis.
#[derive(Clone, Copy, Debug)]
struct AxisState {
    /// Input at the last rest.
    initial: i64,
    /// Growth of the sum of two means per tick.
    growth: i64,
    /// Sum − divisor·output of the means.
    remainder: i64,
}

impl AxisState {
    const fn at(position: Position) -> Self {
        Self { initial: position.0, growth: 0, remainder: 0 }
    }

    /// Two means: inputs now, after the ticks of each, and after the sum of both.
    fn add_to_means(&mut self, output: &mut Position, [now, long, short, both]: [i64; 4], divisor: &Divisor) {
        let growth = now.wrapping_sub(long).wrapping_sub(short.wrapping_sub(both));
        self.growth = self.growth.wrapping_add(growth);
        self.add(output, self.growth, divisor);
    }

    /// Adds to the sum that the output is a fraction of.
    fn add(&mut self, output: &mut Position, growth: i64, divisor: &Divisor) {
        let remainder = self.remainder.wrapping_add(growth);
        // An error for a large remainder is corrected in the next tick, since the remainder itself is exact.
        let change = divisor.quotient(remainder);
        *output += change;
        self.remainder = remainder.wrapping_sub(change.wrapping_mul(i64::from(divisor.value)));
    }
}

impl<const N: usize> State<N> {
    /// At rest at zero.
    pub const AT_ZERO: Self = Self {
        window: [[0; N]; WINDOW],
        next: 0,
        written: 0,
        is_filled: false,
        unchanged_ticks: u16::MAX,
        axes: [AxisState::at(Position(0)); N],
        outputs: [Position(0); N],
    };

    /// At rest.
    #[must_use]
    pub fn at(positions: [Position; N]) -> Self {
        Self { axes: positions.map(AxisState::at), outputs: positions, ..Self::AT_ZERO }
    }

    /// Rests at other positions, without writing the window.
    pub fn rest_at(&mut self, positions: &[Position; N]) {
        (self.axes, self.outputs) = (positions.map(AxisState::at), *positions);
        (self.written, self.is_filled, self.unchanged_ticks) = (0, false, u16::MAX);
    }

    /// The last commands.
    #[must_use]
    pub const fn outputs(&self) -> &[Position; N] {
        &self.outputs
    }

    /// Computes the commands for positions on the path, once per position tick. `changed`: whether these may differ from those of the
    /// previous tick.
    pub fn step(&mut self, filters: &Filters<N>, inputs: &[Position; N], changed: bool) {
        if !filters.active {
            self.outputs = *inputs;
            return;
        }
        self.unchanged_ticks = if changed { 0 } else { self.unchanged_ticks.saturating_add(1) };
        match &filters.common_means {
            Some(means) if self.is_filled => self.step_together(means, inputs),
            _ => self.step_each(filters, inputs),
        }
        if let Some(slot) = self.window.get_mut(Self::index(self.next)) {
            *slot = inputs.map(|input| input.0);
        }
        self.next = self.next.wrapping_add(1);
    }

    /// Two means that are the same on every axis, for a window that has been filled.
    fn step_together(&mut self, means: &CommonMeans, inputs: &[Position; N]) {
        let [long, short] = means.ticks;
        let delayed = |ticks| self.window.get(Self::index(self.next.wrapping_sub(ticks)));
        let (Some(longs), Some(shorts), Some(both)) = (delayed(long), delayed(short), delayed(long + short))
        else {
            return;
        };
        for (((((axis, output), input), long), short), both) in
            self.axes.iter_mut().zip(&mut self.outputs).zip(inputs).zip(longs).zip(shorts).zip(both)
        {
            axis.add_to_means(output, [input.0, *long, *short, *both], &means.divisor);
            one_after_the_other();
        }
    }

    /// Any filters.
    #[inline(never)]
    fn step_each(&mut self, filters: &Filters<N>, inputs: &[Position; N]) {
        for (i, (filter, input)) in filters.axes.iter().zip(inputs).enumerate() {
            let delayed = |ticks| self.delayed(i, ticks);
            let taps = match filter {
                Filter::Mean(long, _) => [delayed(*long), 0, 0],
                Filter::Means([long, short], _) => [delayed(*long), delayed(*short), delayed(*long + *short)],
                Filter::Pass | Filter::Lag(_) => [0; 3],
            };
            let (Some(axis), Some(output)) = (self.axes.get_mut(i), self.outputs.get_mut(i)) else { return };
            let ([long, short, both], input) = (taps, input.0);
            match filter {
                Filter::Pass => *output = Position(input),
                Filter::Mean(_, divisor) => axis.add(output, input.wrapping_sub(long) << 1, divisor),
                Filter::Means(_, divisor) => axis.add_to_means(output, [input, long, short, both], divisor),
                Filter::Lag(alpha) => {
                    let lag = Position(input) - *output;
                    // Rounded away from zero, so that the lag ends.
                    let change = mul_q32(lag, *alpha).wrapping_add(i64::from(lag > 0));
                    *output += change;
                }
            }
        }
        self.written = self.written.saturating_add(1);
        self.is_filled = self.written >= filters.memory;
    }

    /// The input of an axis 1 to [`WINDOW`] ticks ago.
    fn delayed(&self, axis: usize, ticks: u16) -> i64 {
        let written =
            self.window.get(Self::index(self.next.wrapping_sub(ticks))).filter(|_| ticks <= self.written);
        let initial = || self.axes.get(axis).map_or(0, |axis| axis.initial);
        written.and_then(|inputs| inputs.get(axis)).copied().unwrap_or_else(initial)
    }

    /// Place in the window.
    fn index(count: u16) -> usize {
        usize::from(count) % WINDOW
    }

    /// Whether the commands have reached the last inputs, and stay there while these do not change.
    #[must_use]
    pub fn is_settled(&self, filters: &Filters<N>, inputs: &[Position; N]) -> bool {
        self.unchanged_ticks >= filters.memory && self.outputs == *inputs
    }
}
