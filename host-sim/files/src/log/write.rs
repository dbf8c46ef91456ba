//! Writing a log.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use flate2::{Compression, write::GzEncoder};

use super::{Channel, Log, Quantity};
use crate::output::{OutputError, write_whole};

/// Decimals of positions: 0.1 nm, below the resolution of any scale.
const POSITION_DECIMALS: usize = 7;
/// Decimals of forces and temperatures: 0.1 mN, 0.1 mK.
const OTHER_DECIMALS: usize = 4;
/// Decimals of times: the smallest number that represents them exactly. A sample time that needs more than the maximum is
/// rounded.
const TIME_DECIMALS: std::ops::RangeInclusive<usize> = 3..=9;

impl Log {
    /// Writes the log completely or not at all, compressed by gzip if the name ends with `.gz`. Interpolated samples have no row.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        write_rows(path, self, |rows| self.fill(rows))
    }

    /// Writes the log as CSV in many small writes; `out` should be buffered.
    ///
    /// # Errors
    /// If `out` fails.
    pub fn write_csv(&self, out: impl Write) -> io::Result<()> {
        self.fill(&mut RowWriter::new(out, self)?)
    }

    fn fill<W: Write>(&self, rows: &mut RowWriter<W>) -> io::Result<()> {
        let channels = self.axes.iter().flat_map(|axis| Channel::ALL.map(|channel| axis.channel(channel)));
        let columns: Vec<&[f64]> = channels.flatten().collect();
        (0..self.len()).try_for_each(|sample| {
            if self.is_measured(sample) {
                rows.row(columns.iter().map(|column| column[sample]))
            } else {
                rows.skip();
                Ok(())
            }
        })
    }

    /// Number of decimals that start and sample time need.
    fn time_decimals(&self) -> usize {
        let fraction = |units: f64| (units - units.round()).abs();
        let is_enough = |decimals: &usize| {
            let units_per_s = libm::pow(10_f64, *decimals as f64);
            let step = self.sample_time_s * units_per_s;
            // The tolerance of the sample time is smaller, as its error accumulates over the log.
            step > 0.5 && fraction(step) < 1e-8 && fraction(self.start_s * units_per_s) < 1e-3
        };
        TIME_DECIMALS.clone().find(is_enough).unwrap_or(*TIME_DECIMALS.end())
    }
}

/// Writes a log row by row without keeping it in memory, completely or not at all, compressed by gzip if the name ends with
/// `.gz`.
///
/// `head` contains names, channels and clock; its samples are not used.
///
/// # Errors
/// If `fill` fails, or the file cannot be written.
pub fn write_rows(
    path: &Path,
    head: &Log,
    fill: impl FnOnce(&mut RowWriter<&mut dyn Write>) -> io::Result<()>,
) -> Result<(), OutputError> {
    let packed = path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("gz"));
    write_whole(path, |out| {
        if !packed {
            return fill(&mut RowWriter::new(out, head)?);
        }
        // Buffered, as many small writes to the encoder are slow.
        let mut buffer = BufWriter::new(GzEncoder::new(out, Compression::default()));
        fill(&mut RowWriter::new(&mut buffer as &mut dyn Write, head)?)?;
        buffer.into_inner()?.finish().map(drop)
    })
}

/// A log that is being written.
pub struct RowWriter<W> {
    out: W,
    clock: Log,
    time_decimals: usize,
    /// Decimals of each column.
    decimals: Vec<usize>,
    /// Number of samples so far.
    samples: usize,
}

impl<W: Write> RowWriter<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// If `out` fails.
    fn new(mut out: W, head: &Log) -> io::Result<Self> {
        write!(out, "time_s")?;
        let mut decimals = Vec::new();
        for axis in &head.axes {
            for channel in Channel::ALL.into_iter().filter(|&channel| axis.channel(channel).is_some()) {
                write!(out, ",{}", axis.column(channel))?;
                decimals.push(match channel.quantity() {
                    Quantity::Position => POSITION_DECIMALS,
                    Quantity::Force | Quantity::Temperature => OTHER_DECIMALS,
                });
            }
        }
        writeln!(out)?;
        Ok(Self { out, clock: head.slice(0..0), time_decimals: head.time_decimals(), decimals, samples: 0 })
    }

    /// Writes the next row: one value for each column after the time.
    ///
    /// # Errors
    /// If `out` fails.
    pub fn row(&mut self, values: impl IntoIterator<Item = f64>) -> io::Result<()> {
        let Self { out, clock, time_decimals, decimals, samples } = self;
        write!(out, "{:.*}", *time_decimals, clock.time_s(*samples))?;
        for (value, decimals) in values.into_iter().zip(decimals) {
            write!(out, ",{value:.*}", *decimals)?;
        }
        *samples += 1;
        writeln!(out)
    }

    /// Leaves out the row of the next sample.
    const fn skip(&mut self) {
        self.samples += 1;
    }
}
