//! The separator of the columns and the decimal sign of a text.

/// How a line is divided into cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    /// One character; neighbouring ones have an empty cell between them.
    Character(char),
    /// Any white space.
    Space,
}

/// Separator and decimal sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dialect {
    /// Between the columns.
    pub separator: Separator,
    /// Whether the decimal sign is a comma.
    pub has_decimal_comma: bool,
}

/// Words that are read as numbers: the direction of a circle, counter-clockwise positive.
const DIRECTIONS: [(&str, f64); 2] = [("ccw", 1.0), ("cw", -1.0)];

/// Lines from which the dialect is found.
const LINES: usize = 2000;

impl Dialect {
    /// All dialects: of two that read the same, the first is taken.
    const ALL: [Self; 7] = [
        Self::new(Separator::Character('\t'), false),
        Self::new(Separator::Character(';'), false),
        Self::new(Separator::Character(','), false),
        Self::new(Separator::Space, false),
        Self::new(Separator::Character('\t'), true),
        Self::new(Separator::Character(';'), true),
        Self::new(Separator::Space, true),
    ];

    const fn new(separator: Separator, has_decimal_comma: bool) -> Self {
        Self { separator, has_decimal_comma }
    }

    /// The dialect in which most lines are rows of numbers; of several, the one with the most columns. `None`: no line is one.
    #[must_use]
    pub fn of(lines: &[&str]) -> Option<Self> {
        let lines = &lines[..lines.len().min(LINES)];
        let score = |dialect: &Self| {
            let widths = lines.iter().filter_map(|line| Some(dialect.numbers(line)?.len()));
            widths.fold((0, 0), |(rows, cells), width| (rows + 1, cells + width))
        };
        let scored = Self::ALL.into_iter().map(|dialect| (score(&dialect), dialect));
        let best = scored.reduce(|best, other| if other.0 > best.0 { other } else { best })?;
        (best.0.0 > 0).then_some(best.1)
    }

    /// The cells of a line, trimmed, without quotation marks. A separator at the end of the line has no cell after it.
    #[must_use]
    pub fn cells<'a>(self, line: &'a str) -> Vec<&'a str> {
        let trimmed = |cell: &'a str| cell.trim().trim_matches('"').trim();
        match self.separator {
            Separator::Space => line.split_whitespace().map(trimmed).collect(),
            Separator::Character(separator) => {
                let line = line.trim_matches([' ', '\r']);
                let line = line.strip_suffix(separator).unwrap_or(line);
                line.split(separator).map(trimmed).collect()
            }
        }
    }

    /// The numbers of a line, NaN for an empty cell; `None` if one cell is no number, or all are empty.
    #[must_use]
    pub fn numbers(self, line: &str) -> Option<Vec<f64>> {
        let number = |cell: &str| if cell.is_empty() { Some(f64::NAN) } else { self.number(cell) };
        let numbers: Vec<f64> = self.cells(line).into_iter().map(number).collect::<Option<_>>()?;
        numbers.iter().any(|number| !number.is_nan()).then_some(numbers)
    }

    fn number(self, cell: &str) -> Option<f64> {
        if let Some((_, sign)) = DIRECTIONS.iter().find(|(word, _)| cell.eq_ignore_ascii_case(word)) {
            return Some(*sign);
        }
        let begins = cell.starts_with(|c: char| c.is_ascii_digit() || "+-.,".contains(c));
        if !begins {
            return None;
        }
        if self.has_decimal_comma {
            if cell.contains('.') {
                return None;
            }
            return cell.replacen(',', ".", 1).parse().ok();
        }
        cell.parse().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separator_and_decimal_sign_are_found() {
        let of = |text: &str| Dialect::of(&text.lines().collect::<Vec<_>>());
        let found = |separator, has_decimal_comma| Some(Dialect { separator, has_decimal_comma });
        assert_eq!(of("t,x\n0,1.5\n1,2.5"), found(Separator::Character(','), false));
        assert_eq!(of("t;x\n0;1.5;\n1;2.5;"), found(Separator::Character(';'), false));
        assert_eq!(of("t;x\n0,0;1,5\n0,1;2,5"), found(Separator::Character(';'), true));
        assert_eq!(of("t\tx\n0,0\t1,5\n0,1\t2,5"), found(Separator::Character('\t'), true));
        assert_eq!(of("0 1.5 \n1 2.5 \n"), found(Separator::Space, false));
        assert_eq!(of("0 1,5\n1 2,5"), found(Separator::Space, true));
        assert_eq!(of("a,b\nc,d"), None);
    }

    #[test]
    fn an_empty_cell_is_no_number_and_a_word_makes_no_row() {
        let dialect = Dialect::of(&["1,2"]).unwrap();
        let numbers = dialect.numbers("1,,3").unwrap();
        assert_eq!([numbers[0], numbers[2]].map(f64::to_bits), [1.0_f64, 3.0].map(f64::to_bits));
        assert!(numbers[1].is_nan());
        assert_eq!(dialect.numbers("1,overrun,3"), None);
        assert_eq!(dialect.numbers("1,cw,CCW"), Some(vec![1.0, -1.0, 1.0]));
        assert_eq!(dialect.numbers("nan,inf"), None);
        assert_eq!(dialect.numbers(",,"), None);
    }
}
