//! One case: a drawn machine, its logs, and its undeclared effects.

use std::fs;
use std::path::{Path, PathBuf};

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde_json::json;

use super::truth::{Truth, draw_effects};
use super::{draw, motion, simulation};
use files::error::InputError;
use files::log::Log;
use files::output::{OutputError, write_whole};
use trace::Machine;

/// Pause between two motions of a session, s.
const PAUSE_S: f64 = 20.0;

/// A machine with logs.
pub struct Case {
    /// Number of the case, from 1.
    pub number: u64,
    /// Text of the machine file.
    pub machine_text: String,
    /// The declared machine.
    pub machine: Machine,
    /// The undeclared effects.
    pub truths: Vec<Truth>,
    /// Logs to fit.
    pub fit: Vec<Log>,
    /// Logs to validate.
    pub validate: Vec<Log>,
}

impl Case {
    /// Draws a case and simulates it. The result depends on seed and number only.
    ///
    /// # Errors
    /// None in practice: the text of a drawn machine file is valid, but it is checked like any other.
    pub fn draw(seed: u64, number: u64) -> Result<Self, InputError> {
        let mut random = stream(seed, number, 0);
        let mut drawn = draw::machine(&mut random);
        let session = draw::session(&mut random);
        let truths = draw_effects(&mut drawn, &mut random);
        let name = format!("case-{number}");
        let machine_text = format!(
            "name = \"{name}\"\nsample_rate_hz = 1000.0\nvelocity_loop_rate_hz = 4000.0\n\n{}\n{}",
            drawn.declared[0].text, drawn.declared[1].text
        );
        let machine = Machine::parse(&machine_text, &name)?;
        let paths = session.map(|m| (m.name, motion::sampled(m.start, &m.segments, m.pace)));
        let mut start_s = 0.0;
        let timed = paths.map(|(name, positions)| {
            let own_start_s = start_s;
            // Whole ms, as in the log.
            start_s = (1e3 * (start_s + PAUSE_S) + positions.len() as f64).round() / 1e3;
            (name, positions, own_start_s)
        });
        let logs: Vec<Log> = timed
            .into_par_iter()
            .enumerate()
            .map(|(index, (name, positions, start_s))| {
                let mut noise = stream(seed, number, 1 + index as u64);
                Log {
                    source: name.to_owned(),
                    ..simulation::run(&drawn.axes, &positions, start_s, &mut noise)
                }
            })
            .collect();
        let (fit, validate) = logs.into_iter().partition(|log| log.source.starts_with("fit"));
        Ok(Self { number, machine_text, machine, truths, fit, validate })
    }

    /// Writes `machine.toml`, the logs and `truth.json` into a folder named after the case, which is created.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn keep(&self, folder: &Path) -> Result<PathBuf, OutputError> {
        let folder = folder.join(format!("case-{}", self.number));
        fs::create_dir_all(&folder).map_err(|cause| OutputError { path: folder.clone(), cause })?;
        let write =
            |name: &str, text: &str| write_whole(&folder.join(name), |out| out.write_all(text.as_bytes()));
        write("machine.toml", &self.machine_text)?;
        for log in self.fit.iter().chain(&self.validate) {
            log.write(&folder.join(format!("{}.csv.gz", log.source)))?;
        }
        let effects: Vec<_> = self.truths.iter().map(Truth::json).collect();
        write("truth.json", &format!("{:#}\n", json!({"effects": effects})))?;
        Ok(folder)
    }
}

/// Random numbers for one purpose in one case, independent of other purposes and cases.
fn stream(seed: u64, number: u64, purpose: u64) -> ChaCha8Rng {
    const MAX_PURPOSES: u64 = 8;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(MAX_PURPOSES * number + purpose);
    random
}
