//! One case: a drawn machine, its logs, and its undeclared effects.

use std::fs;
use std::path::{Path, PathBuf};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::draw::{Drawn, Motion};
use super::effect_draw::{draw_beside, draw_textbook};
use super::kind::Kind;
use super::machine::Axis;
use super::truth::Truth;
use super::{chain, draw, effect, extra, fault, gap, joint, motion, simulation};
use files::error::InputError;
use files::log::Log;
use files::output::{OutputError, write_whole};
use trace::Machine;

/// Pause between two motions of a session, s.
const PAUSE_S: f64 = 20.0;

/// Samples over which the speed of the kind `jerk` is averaged: 20 to 60 ms.
const AVERAGED_SAMPLES: std::ops::RangeInclusive<usize> = 20..=60;

/// A machine with logs.
pub struct Case {
    /// Its kind.
    pub kind: Kind,
    /// Number of the case, from 1.
    pub number: u64,
    /// Text of the machine file.
    pub machine_text: String,
    /// The declared machine.
    pub machine: Machine,
    /// The true values of its axes.
    pub axes: [Axis; 2],
    /// The undeclared effects.
    pub truths: Vec<Truth>,
    /// What else is in the machine or its logs.
    pub extras: Vec<Truth>,
    /// Logs to fit.
    pub fit: Vec<Log>,
    /// Logs to validate.
    pub validate: Vec<Log>,
}

impl Case {
    /// Draws a case of the textbook kind and simulates it. The result depends on seed and number only.
    ///
    /// # Errors
    /// None in practice: the text of a drawn machine file is valid, but it is checked like any other.
    pub fn draw(seed: u64, number: u64) -> Result<Self, InputError> {
        Self::draw_kind(Kind::Textbook, seed, number)
    }

    /// Draws a case of a kind and simulates it. The result depends on kind, seed and number only.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn draw_kind(kind: Kind, seed: u64, number: u64) -> Result<Self, InputError> {
        let Session { drawn, motions, truths, mut extras } = Session::draw(kind, seed, number);
        let stream = |purpose| stream(block::of(kind), seed, number, purpose);
        let mut logs = run_session(&drawn, &motions, |log| stream(Purpose::Log(log)));
        if kind == Kind::Joint {
            logs.iter_mut().for_each(joint::in_degrees);
        }
        if kind == Kind::Sparse {
            gap::thin(gap::of_case(number), &mut logs);
        }
        if kind == Kind::Slip {
            extras.extend(fault::draw(&mut logs, &mut stream(Purpose::Fault)));
        }
        Ok(Self { extras, ..Self::new((kind, number), &drawn, truths, logs)? })
    }

    /// The undeclared effects of a case of the textbook kind, without simulating it.
    #[must_use]
    pub fn undeclared(seed: u64, number: u64) -> Vec<Truth> {
        Session::draw(Kind::Textbook, seed, number).truths
    }

    /// A case from its parts, without extras.
    pub(super) fn new(
        (kind, number): (Kind, u64),
        drawn: &Drawn,
        truths: Vec<Truth>,
        logs: Vec<Log>,
    ) -> Result<Self, InputError> {
        let name = kind.case_name(number);
        let machine_text = format!(
            "name = \"{name}\"\nsample_rate_hz = 1000.0\nvelocity_loop_rate_hz = 4000.0\n\n{}\n{}",
            drawn.declared[0].text, drawn.declared[1].text
        );
        let machine = Machine::parse(&machine_text, &name)?;
        let (fit, validate) = logs.into_iter().partition(|log| log.source.starts_with("fit"));
        let axes = drawn.axes.clone();
        Ok(Self { kind, number, machine_text, machine, axes, truths, extras: Vec::new(), fit, validate })
    }

    /// Its name, which is also that of its folder.
    #[must_use]
    pub fn name(&self) -> String {
        self.kind.case_name(self.number)
    }

    /// Writes `machine.toml`, the logs and `truth.json` into a folder named after the case, which is created.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn keep(&self, folder: &Path) -> Result<PathBuf, OutputError> {
        let folder = folder.join(self.name());
        fs::create_dir_all(&folder).map_err(|cause| OutputError { path: folder.clone(), cause })?;
        let write =
            |name: &str, text: &str| write_whole(&folder.join(name), |out| out.write_all(text.as_bytes()));
        write("machine.toml", &self.machine_text)?;
        for log in self.fit.iter().chain(&self.validate) {
            log.write(&folder.join(format!("{}.csv.gz", log.source)))?;
        }
        write("truth.json", &format!("{:#}\n", self.truth_json()))?;
        Ok(folder)
    }

    /// The content of `truth.json`: `effects` of the catalogue; for kinds other than the textbook one, `extra` with name
    /// and axis of what is outside it, and `extra_parameters` with its sizes.
    fn truth_json(&self) -> Value {
        let entry = |truth: &Truth| match self.kind {
            Kind::Joint => joint::with_rotary_keys(&truth.json()),
            _ => truth.json(),
        };
        let of = |truths: &[Truth]| truths.iter().map(entry).collect::<Vec<_>>();
        let effects = of(&self.truths);
        if self.kind == Kind::Textbook {
            return json!({"effects": effects});
        }
        let names: Vec<_> = self.extras.iter().map(|extra| [extra.name, extra.axis]).collect();
        let kind = self
            .extras
            .first()
            .filter(|_| self.kind.is_judged())
            .map_or(self.kind.name(), |extra| extra.name);
        json!({"kind": kind, "effects": effects, "extra": names, "extra_parameters": of(&self.extras)})
    }
}

/// What is drawn of a case before it is simulated.
pub(super) struct Session {
    pub(super) drawn: Drawn,
    pub(super) motions: [Motion; 5],
    pub(super) truths: Vec<Truth>,
    extras: Vec<Truth>,
}

impl Session {
    pub(super) fn draw(kind: Kind, seed: u64, number: u64) -> Self {
        let mut random = stream(block::of(kind), seed, number, Purpose::Machine);
        let deviations = match kind {
            Kind::Offspec => draw::BEYOND_TOLERANCE,
            Kind::Sensors if chain::is_declared_truly(chain::of_case(number)) => draw::TRUE,
            Kind::Sparse if gap::is_declared_truly(gap::of_case(number)) => draw::TRUE,
            _ => draw::WITHIN_TOLERANCE,
        };
        let mut drawn = draw::machine(&deviations, &mut random);
        let mut motions = draw::session(&mut random);
        let (truths, extras) = undeclared((kind, number), &mut drawn, &mut random);
        if kind == Kind::Jerk {
            let averaged_samples = random.random_range(AVERAGED_SAMPLES);
            for motion in &mut motions {
                motion.pace.averaged_samples = averaged_samples;
            }
        }
        Self { drawn, motions, truths, extras }
    }
}

/// Draws the undeclared effects of the catalogue, and what else the machine has.
fn undeclared(
    (kind, number): (Kind, u64),
    drawn: &mut Drawn,
    random: &mut ChaCha8Rng,
) -> (Vec<Truth>, Vec<Truth>) {
    match kind {
        Kind::Textbook => (draw_textbook(drawn, random), Vec::new()),
        Kind::Controller => {
            let index = random.random_range(0..drawn.axes.len());
            let mut truths = vec![effect::draw_controller(index, random)];
            effect::apply(&truths[0], &mut drawn.axes[index]);
            let beside = draw_beside(&truths, kind, drawn, random);
            truths.extend(beside);
            (truths, Vec::new())
        }
        _ => {
            let extras = match kind {
                Kind::Sensors => chain::draw(chain::of_case(number), drawn, random),
                Kind::Sparse => gap::draw(gap::of_case(number), drawn, random),
                _ => extra::draw(kind, drawn, random),
            };
            (draw_beside(&extras, kind, drawn, random), extras)
        }
    }
}

/// Runs the motions of a session, one after the other on one clock.
pub(super) fn run_session(
    drawn: &Drawn,
    session: &[Motion],
    noise: impl Fn(u64) -> ChaCha8Rng + Sync,
) -> Vec<Log> {
    let mut start_s = 0.0;
    let timed: Vec<_> = session
        .iter()
        .map(|motion| {
            let positions = motion::sampled(motion.start, &motion.segments, motion.pace);
            let own_start_s = start_s;
            // Whole ms, as in the log.
            start_s = (1e3 * (start_s + PAUSE_S) + positions.len() as f64).round() / 1e3;
            (motion.name, positions, own_start_s)
        })
        .collect();
    let run = |(index, (name, positions, start_s)): (usize, (&str, Vec<_>, f64))| {
        let (mut random, times_s) = (noise(index as u64), [start_s, drawn.recorder.jitter_s]);
        let mut log = simulation::run_jittered(&drawn.axes, &positions, times_s, &mut random);
        drawn.recorder.lose_rows(&mut log, &mut random);
        Log { source: name.to_owned(), ..log }
    };
    timed.into_par_iter().enumerate().map(run).collect()
}

/// Blocks of random numbers, which do not change when a kind is added.
pub(super) mod block {
    use super::super::kind::Kind;

    /// The kinds that there were first.
    const KINDS: u64 = 13;
    /// Of the detection curve.
    pub const DETECTION: u64 = KINDS;
    /// Of the cases with laws.
    pub const LAWS: u64 = KINDS + 1;
    /// Of planned motions.
    pub const PLANS: u64 = KINDS + 2;
    /// Of the kinds that were added later.
    const LATER_KINDS: u64 = KINDS + 3;

    /// Of a kind.
    pub fn of(kind: Kind) -> u64 {
        let index = kind.index();
        if index < KINDS { index } else { LATER_KINDS + index - KINDS }
    }
}

/// What random numbers of a case are for.
#[derive(Clone, Copy)]
pub(super) enum Purpose {
    /// Machine, motions and effects.
    Machine,
    /// Noise of the log with this index, below 5.
    Log(u64),
    /// Faults of the logs.
    Fault,
}

/// Random numbers for one purpose in one case, independent of other purposes and cases. `block` is one of [`block`].
pub(super) fn stream(block: u64, seed: u64, number: u64, purpose: Purpose) -> ChaCha8Rng {
    const MAX_PURPOSES: u64 = 8;
    /// Above the numbers of all cases.
    const MAX_CASES: u64 = 1 << 40;
    let purpose = match purpose {
        Purpose::Machine => 0,
        Purpose::Log(index) => 1 + index,
        Purpose::Fault => 6,
    };
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(MAX_PURPOSES * (MAX_CASES * block + number) + purpose);
    random
}
