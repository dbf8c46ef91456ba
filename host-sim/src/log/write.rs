//! Writing a log.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use flate2::{Compression, write::GzEncoder};

use super::{Channel, Log};
use crate::output::{OutputError, write_whole};

/// 0.1 nm: below what any scale resolves.
const POSITION_DECIMALS: usize = 7;
/// 0.1 mN.
const FORCE_DECIMALS: usize = 4;
/// The fewest decimals of times that show the sampling; beyond these it is not a round number.
const TIME_DECIMALS: std::ops::RangeInclusive<usize> = 3..=9;

impl Log {
    /// Writes the log whole or not at all, packed if the name ends in `.gz`.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        let packed = path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("gz"));
        write_whole(path, |out| {
            if !packed {
                return self.write_csv(out);
            }
            // The encoder is slow with many small pieces.
            let mut buffer = BufWriter::new(GzEncoder::new(out, Compression::default()));
            self.write_csv(&mut buffer)?;
            buffer.into_inner()?.finish().map(drop)
        })
    }

    /// Writes the log as CSV. Many small writes: `out` should be buffered.
    ///
    /// # Errors
    /// If `out` fails.
    pub fn write_csv(&self, mut out: impl Write) -> io::Result<()> {
        let columns: Vec<(String, &[f64], usize)> = self.columns();
        let names: Vec<&str> = columns.iter().map(|(name, ..)| name.as_str()).collect();
        writeln!(out, "time_s,{}", names.join(","))?;
        let time_decimals = self.time_decimals();
        for sample in 0..self.len() {
            write!(out, "{:.time_decimals$}", self.time_s(sample))?;
            for (_, values, decimals) in &columns {
                write!(out, ",{:.decimals$}", values[sample])?;
            }
            writeln!(out)?;
        }
        Ok(())
    }

    /// Name, samples and number of decimals of each column.
    fn columns(&self) -> Vec<(String, &[f64], usize)> {
        let columns = self.axes.iter().flat_map(|axis| {
            Channel::ALL.map(|channel| {
                let decimals = if channel.is_force() { FORCE_DECIMALS } else { POSITION_DECIMALS };
                Some((axis.column(channel), axis.channel(channel)?, decimals))
            })
        });
        columns.flatten().collect()
    }

    /// As many decimals as start and step need; a step that never comes out even gets the most.
    fn time_decimals(&self) -> usize {
        let off = |ticks: f64| (ticks - ticks.round()).abs();
        let enough = |decimals: &usize| {
            let ticks_per_s = 10_f64.powf(*decimals as f64);
            let step = self.sample_time_s * ticks_per_s;
            // The step's error adds up over the log, that of the start does not.
            step > 0.5 && off(step) < 1e-8 && off(self.start_s * ticks_per_s) < 1e-3
        };
        TIME_DECIMALS.clone().find(enough).unwrap_or(*TIME_DECIMALS.end())
    }
}
