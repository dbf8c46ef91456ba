//! The formats of foreign files.

use std::str::FromStr;

/// What a file is read as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `halsampler` of LinuxCNC: numbers between spaces, with `-t` after the number of the sample; no header.
    Halsampler,
    /// `halscope` of LinuxCNC: the sampling period in the first line.
    Halscope,
    /// Export of TwinCAT Scope as text: blocks of columns, each with its own times.
    Twincat,
    /// Accelerations that Klipper records.
    Klipper,
    /// A MAT-file of level 5, as MATLAB saves it with `-v6` or `-v7`.
    Matlab,
    /// An array of NumPy (`.npy`), or an archive of arrays (`.npz`).
    Numpy,
    /// Apache Parquet.
    Parquet,
    /// MCAP with messages in JSON.
    Mcap,
    /// Any other separated text.
    Text,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 9] = [
        Self::Halsampler,
        Self::Halscope,
        Self::Twincat,
        Self::Klipper,
        Self::Matlab,
        Self::Numpy,
        Self::Parquet,
        Self::Mcap,
        Self::Text,
    ];

    /// The name of its preset.
    #[must_use]
    pub const fn preset(self) -> &'static str {
        match self {
            Self::Halsampler => "halsampler",
            Self::Halscope => "halscope",
            Self::Twincat => "twincat",
            Self::Klipper => "klipper",
            Self::Matlab => "matlab",
            Self::Numpy => "numpy",
            Self::Parquet => "parquet",
            Self::Mcap => "mcap",
            Self::Text => "text",
        }
    }

    /// For a sentence.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Halsampler => "LinuxCNC halsampler",
            Self::Halscope => "LinuxCNC halscope",
            Self::Twincat => "TwinCAT Scope",
            Self::Klipper => "accelerations of Klipper",
            Self::Matlab => "MATLAB level 5",
            Self::Numpy => "NumPy",
            Self::Parquet => "Parquet",
            Self::Mcap => "MCAP",
            Self::Text => "separated text",
        }
    }

    /// Title, and whether the user or the content says it.
    #[must_use]
    pub fn said(self, preset: Option<Self>) -> String {
        let by = if preset.is_some() { "as asked for" } else { "recognised by content" };
        format!("{} (preset {}, {by})", self.title(), self.preset())
    }

    /// The format of a binary file, by its first bytes.
    #[must_use]
    pub fn of_binary(bytes: &[u8]) -> Option<Self> {
        let begins = |start: &[u8]| bytes.starts_with(start);
        // The bytes 124 to 127 of a MAT-file: version, and the order of its bytes.
        let is_matlab = matches!(bytes.get(126..128), Some(b"IM" | b"MI")) && begins(b"MATLAB");
        match () {
            () if is_matlab => Some(Self::Matlab),
            () if begins(b"\x93NUMPY") || begins(b"PK\x03\x04") => Some(Self::Numpy),
            () if begins(b"PAR1") => Some(Self::Parquet),
            () if begins(b"\x89MCAP") => Some(Self::Mcap),
            () => None,
        }
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|format| format.preset() == text);
        found.ok_or_else(|| format!("expected one of {}", Self::ALL.map(Self::preset).join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_preset_is_one_of_those_listed() {
        for format in Format::ALL {
            assert_eq!(format.preset().parse(), Ok(format));
        }
        let message = "excel".parse::<Format>().unwrap_err();
        assert_eq!(
            message,
            "expected one of halsampler, halscope, twincat, klipper, matlab, numpy, parquet, mcap, text"
        );
    }

    #[test]
    fn binary_files_are_recognised_by_their_first_bytes() {
        let mut matlab = b"MATLAB 5.0 MAT-file".to_vec();
        matlab.resize(124, b' ');
        matlab.extend(b"\x00\x01IM");
        assert_eq!(Format::of_binary(&matlab), Some(Format::Matlab));
        assert_eq!(Format::of_binary(&matlab[..127]), None);
        assert_eq!(Format::of_binary(b"\x93NUMPY\x01"), Some(Format::Numpy));
        assert_eq!(Format::of_binary(b"time,PAR1"), None);
    }
}
