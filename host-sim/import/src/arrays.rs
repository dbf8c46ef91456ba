//! Named arrays, as MATLAB and NumPy save them, as columns.
//!
//! A vector is the column `VARIABLE`; a matrix has the columns `VARIABLE:1`, `VARIABLE:2`, and so on. Of a matrix the longer dimension is
//! time, whichever way round it was saved.

use files::error::quoted;

use crate::table::ForeignColumn;

/// Greatest number of columns of a matrix; what has more is a picture or a map.
const MOST_COLUMNS: usize = 1000;

/// An array of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Its name; empty if the file has a single array without a name.
    pub name: String,
    /// Its dimensions; their product is the number of values.
    pub shape: Vec<usize>,
    /// Whether the first index changes fastest, as in MATLAB; else the last one.
    pub is_column_major: bool,
    /// The values.
    pub values: Vec<f64>,
}

/// Columns of arrays; what cannot be one is told.
#[must_use]
pub fn columns(arrays: Vec<Array>, notes: &mut Vec<String>) -> Vec<ForeignColumn> {
    let mut columns = Vec::new();
    let mut single = Vec::new();
    for array in arrays {
        let long: Vec<usize> = array.shape.iter().copied().filter(|&length| length != 1).collect();
        match long[..] {
            [] => single.push(quoted(&array.name)),
            [_] => {
                let name = if array.name.is_empty() { "1".to_owned() } else { array.name };
                columns.push(ForeignColumn::new(name, None, array.values));
            }
            [rows, width] if rows.min(width) > 0 && rows.min(width) <= MOST_COLUMNS => {
                columns.extend(of_matrix(&array, [rows, width], notes));
            }
            _ => {
                notes.push(format!(
                    "not read: {}, an array of {:?} values",
                    quoted(&array.name),
                    array.shape
                ));
            }
        }
    }
    if !single.is_empty() {
        notes.push(format!("single numbers, not used: {}", single.join(", ")));
    }
    columns
}

fn of_matrix(array: &Array, [first, second]: [usize; 2], notes: &mut Vec<String>) -> Vec<ForeignColumn> {
    let is_wide = second > first;
    if is_wide {
        let name = quoted(&array.name);
        notes.push(format!("{name} has {first} rows and {second} columns: each row is read as a column"));
    }
    let (length, count) = (first.max(second), first.min(second));
    // Whether the values of a column are neighbours.
    let is_together = array.is_column_major != is_wide;
    let column = |index: usize| {
        let values = if is_together {
            array.values[index * length..(index + 1) * length].to_vec()
        } else {
            array.values[index..].iter().step_by(count).copied().collect()
        };
        let separator = if array.name.is_empty() { "" } else { ":" };
        ForeignColumn::new(format!("{}{separator}{}", array.name, index + 1), None, values)
    };
    (0..count).map(column).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three rows of two columns, 1 2 / 3 4 / 5 6, in each order and each way round.
    #[test]
    fn the_longer_dimension_is_time() {
        let of = |shape: [usize; 2], is_column_major, values: [u8; 6]| {
            let values = values.map(f64::from).to_vec();
            let array = Array { name: "m".to_owned(), shape: shape.to_vec(), is_column_major, values };
            columns(vec![array], &mut Vec::new())
        };
        let expected = [("m:1", [1.0, 3.0, 5.0]), ("m:2", [2.0, 4.0, 6.0])]
            .map(|(name, values)| ForeignColumn::new(name.to_owned(), None, values.to_vec()));
        assert_eq!(of([3, 2], true, [1, 3, 5, 2, 4, 6]), expected);
        assert_eq!(of([3, 2], false, [1, 2, 3, 4, 5, 6]), expected);
        assert_eq!(of([2, 3], true, [1, 2, 3, 4, 5, 6]), expected);
        assert_eq!(of([2, 3], false, [1, 3, 5, 2, 4, 6]), expected);
    }

    #[test]
    fn single_numbers_and_solids_are_told() {
        let of = |name: &str, shape: &[usize]| Array {
            name: name.to_owned(),
            shape: shape.to_vec(),
            is_column_major: true,
            values: vec![0.0; shape.iter().product()],
        };
        let mut notes = Vec::new();
        let found = columns(
            vec![of("J", &[1, 1]), of("v", &[1, 3, 1]), of("cube", &[2, 2, 2]), of("none", &[0, 0])],
            &mut notes,
        );
        assert_eq!(found, [ForeignColumn::new("v".to_owned(), None, vec![0.0; 3])]);
        assert!(notes.iter().any(|note| note == "single numbers, not used: \"J\""), "{notes:?}");
        assert!(notes.iter().any(|note| note.starts_with("not read: \"cube\"")), "{notes:?}");
    }
}
