//! Preparation of the pieces of logs that are evaluated.

use crate::data_faults::excluded::{self, Excluded};
use crate::data_faults::late_command::{self, Late};
use crate::input::parts::Piece;
use crate::input::saturation;
use crate::input::signals::Signals;
use crate::options::TraceOptions;
use model::axis::Drive;
use model::machine::{Axis, Machine};

/// What the signals of a piece depend on besides the log.
#[derive(Clone, Copy, Debug)]
pub struct Preparation<'a> {
    /// The declared machine.
    pub machine: &'a Machine,
    /// Names of its axes.
    pub names: &'a [String],
    /// Source of the first fit log: in other recordings, the zeros of the encoders may differ.
    pub first: Option<&'a str>,
    /// Samples that a fault of the data spoils.
    pub excluded: &'a [Excluded],
    /// The thresholds of the trace.
    pub options: &'a TraceOptions,
}

impl Preparation<'_> {
    /// The signals of a piece, with saturated and faulty samples marked.
    #[must_use]
    pub fn signals(&self, piece: &Piece<'_>) -> Signals {
        let samples = piece.samples();
        let part = (samples != (0..piece.log.len())).then(|| piece.log.slice(samples));
        let log = part.as_ref().unwrap_or(piece.log);
        let mut signals = [Signals {
            has_own_zero: self.first.is_some_and(|first| first != log.source),
            lead_in: piece.lead_in,
            lead_out: piece.lead_out,
            ..Signals::of_machine(log, self.names, &self.steppers(), &self.options.samples)
        }];
        saturation::mark(self.machine, &mut signals, &self.options.admission);
        excluded::mark(self.excluded, self.names, &mut signals);
        let [mut signals] = signals;
        signals.estimate_noise_without_faults(&self.options.samples);
        signals
    }

    /// Names of the axes whose motor is a stepper.
    fn steppers(&self) -> Vec<String> {
        let is_stepper = |axis: &Axis| axis.settings.controller.drive == Drive::Stepper;
        self.machine.axis.iter().filter(|(_, axis)| is_stepper(axis)).map(|(name, _)| name.clone()).collect()
    }

    /// These signals with the commands shifted back that are late in a part of a set.
    #[must_use]
    pub fn corrected(&self, piece: &Piece<'_>, set: usize, late: &[Late]) -> Signals {
        let mut signals = self.signals(piece);
        for late in late.iter().filter(|late| (late.set, late.log) == (set, piece.part)) {
            let _ = late_command::shift_back(&mut signals, late.axis, &self.names[late.axis], late.samples);
        }
        signals
    }
}
