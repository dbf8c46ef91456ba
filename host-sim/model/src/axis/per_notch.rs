//! A number for each notch of an axis.

use std::fmt;

use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use shared::config::Notch;

/// A number for each notch of an axis, in the order in which they act. In a file a number, or a list of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct PerNotch(pub Vec<f64>);

impl PerNotch {
    /// Frequencies (Hz), widths (Hz) and depths of notches.
    #[must_use]
    pub fn of_notches(notches: &[Notch]) -> [Self; 3] {
        let of = |value: fn(&Notch) -> f64| Self(notches.iter().map(value).collect());
        [of(|notch| notch.frequency_hz), of(|notch| notch.width_hz), of(|notch| notch.depth)]
    }

    /// The notches of [`Self::of_notches`]; the shortest of the three lists determines their number.
    pub fn notches([frequencies_hz, widths_hz, depths]: [&Self; 3]) -> impl Iterator<Item = Notch> {
        let numbers = frequencies_hz.0.iter().zip(&widths_hz.0).zip(&depths.0);
        numbers.map(|((&frequency_hz, &width_hz), &depth)| Notch { frequency_hz, width_hz, depth })
    }

    /// The key of one of the numbers, of a key whose value has this many.
    #[must_use]
    pub fn key(key: &str, index: usize, count: usize) -> String {
        if count == 1 { key.to_owned() } else { format!("{key}[{index}]") }
    }

    /// The numbers, rounded and separated by commas.
    #[must_use]
    pub fn words(&self, decimals: usize) -> String {
        let words: Vec<String> = self.0.iter().map(|value| format!("{value:.decimals$}")).collect();
        words.join(", ")
    }

    /// As a value of a machine file: a number, or a list.
    #[must_use]
    pub fn toml(&self, decimals: usize) -> String {
        if self.0.len() == 1 { self.words(decimals) } else { format!("[{}]", self.words(decimals)) }
    }
}

impl Serialize for PerNotch {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0.as_slice() {
            [value] => value.serialize(serializer),
            values => values.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for PerNotch {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NumberOrList)
    }
}

struct NumberOrList;

impl<'de> Visitor<'de> for NumberOrList {
    type Value = PerNotch;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or a list of numbers")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<PerNotch, E> {
        Ok(PerNotch(vec![value]))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<PerNotch, E> {
        Ok(PerNotch(vec![value as f64]))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<PerNotch, E> {
        Ok(PerNotch(vec![value as f64]))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<PerNotch, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = list.next_element()? {
            values.push(value);
        }
        Ok(PerNotch(values))
    }
}
