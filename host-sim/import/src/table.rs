//! Columns of numbers, as a foreign file has them.

use files::error::InputError;

use crate::format::Format;

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub struct ForeignColumn {
    /// Name without its unit; without a header the number of the column, counted from 1.
    pub name: String,
    /// Unit that the file tells.
    pub unit: Option<String>,
    /// Values, NaN for an empty cell.
    pub values: Vec<f64>,
    /// Index of the column of its own times, in a file with several clocks.
    pub times: Option<usize>,
}

impl ForeignColumn {
    /// A column of a file with one clock at most.
    #[must_use]
    pub const fn new(name: String, unit: Option<String>, values: Vec<f64>) -> Self {
        Self { name, unit, values, times: None }
    }
}

/// A table. Its columns are of equal length, except in a file of several arrays or several clocks.
#[derive(Clone, Debug, PartialEq)]
pub struct ForeignTable {
    /// What it was read as.
    pub format: Format,
    /// The columns.
    pub columns: Vec<ForeignColumn>,
    /// Sampling period that the file tells beside its columns, s.
    pub period_s: Option<f64>,
    /// Line of the header, or of the first row, counted from 1; `None` in a binary file.
    pub header_line: Option<usize>,
}

impl ForeignTable {
    /// An error at the header of this table.
    #[must_use]
    pub fn at_header(&self, error: InputError) -> InputError {
        match self.header_line {
            Some(line) => error.at_line(line),
            None => error,
        }
    }
}
