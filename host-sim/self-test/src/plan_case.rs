//! Machines with a log that is too short to tell what they have, and whether the log of a planned motion does.

use serde_json::{Value, json};

use super::case::{Case, Purpose, Session, block, run_session, stream};
use super::draw::Drawn;
use super::kind::Kind;
use super::machine::AXES;
use super::motion::{Pace, Segment, sampled};
use super::servo::SAMPLE_S;
use super::simulation;
use super::truth::Truth;
use files::error::InputError;
use files::log::Log;
use motion::{Block, Motion};
use plan::limits::StatedLimits;
use plan::outcome::Expected;
use plan::questions::Question;
use plan::{MotionLimits, Plan, Planning};
use trace::Machine;

/// Samples of the circle that are in the log.
const SHORT: usize = 3000;

/// Time between the short log and the planned motion, s.
const PAUSE_S: f64 = 20.0;

/// What the owner of the machine permits: speed, mm/s, acceleration, m/s², and time, s.
const PERMITTED: [f64; 3] = [100.0, 2.0, 60.0];

/// A machine with a short log.
pub struct PlanCase {
    /// Number of the case.
    pub number: u64,
    seed: u64,
    drawn: Drawn,
    truths: Vec<Truth>,
    declared: Machine,
    log: Log,
    /// The three motions that a session fits.
    session: Vec<Log>,
}

/// What became of the questions of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanOutcome {
    /// Number of the case.
    pub number: u64,
    /// The questions: axis and names of the candidates.
    pub questions: Vec<Value>,
    /// The effects of the machine.
    pub truths: Vec<String>,
    /// Duration of the planned motion, s; `None`: none was planned.
    pub duration_s: Option<f64>,
    /// Duration of the three motions that a session fits, s.
    pub session_s: f64,
    /// Whether the logs of these decide them, rightly.
    pub is_session_right: bool,
    /// Width of the intervals with the planned motion over that with the session: of each value that both find.
    pub widths: Vec<f64>,
    /// Whether the plan says that its motion decides all questions.
    pub is_promised: bool,
    /// Whether the log of the planned motion decides them, rightly.
    pub is_decided: bool,
    /// Effects that the trace of this log states as certain and that the machine does not have.
    pub false_names: Vec<String>,
    /// Values whose interval was promised: whether the true value is within it around the value found.
    pub is_within_promise: Vec<bool>,
}

impl PlanCase {
    /// Draws a case, which follows from seed and number: a textbook machine, and the first 3 s of its circle.
    ///
    /// # Errors
    /// As [`Case::draw`].
    pub fn draw(seed: u64, number: u64) -> Result<Self, InputError> {
        let Session { drawn, motions, truths, .. } = Session::draw(Kind::Textbook, seed, number);
        let logs = run_session(&drawn, &motions[..3], |log| noise(seed, number, log));
        let Case { machine, fit: session, .. } =
            Case::new((Kind::Textbook, number), &drawn, Vec::new(), logs)?;
        let log = session.first().map_or_else(
            || Err(InputError::expected("self-test", "a log".to_owned(), "none")),
            |log| Ok(log.slice(0..SHORT.min(log.len()))),
        )?;
        Ok(Self { number, seed, drawn, truths, declared: machine, log, session })
    }

    /// Traces the short log, plans, runs and traces the planned motion; `None` if the short log leaves no question.
    ///
    /// # Errors
    /// If a log cannot be traced, or the limits of the motion do not fit.
    pub fn judged(&self, progress: &(dyn Fn(&str) + Sync)) -> Result<Option<PlanOutcome>, InputError> {
        let logs = std::slice::from_ref(&self.log);
        let model = trace::trace(&self.declared, logs, &[], progress)?.better_machine();
        if plan::questions::questions(&model).is_empty() {
            return Ok(None);
        }
        let [speed, acceleration, time_s] = PERMITTED;
        let stated = StatedLimits {
            travel_mm: Vec::new(),
            speed_mm_s: Some(speed),
            acceleration_m_per_s2: Some(acceleration),
        };
        let limits = MotionLimits::new(&model, &stated, logs, time_s)?;
        let planning = Planning { model: &model, limits: &limits, logs, interval_percent: None };
        let plan = plan::plan(&planning, progress);
        let motion = plan.motion.as_ref().and_then(|candidate| candidate.motion.motion());
        let traced = motion.map(|motion| self.traced(motion, progress)).transpose()?;
        let session = self.traced_logs(&self.session, progress)?;
        Ok(Some(self.outcome(&plan, traced.as_ref(), &session)))
    }

    /// The JSON of a trace of the short log and that of a motion on the machine, both on one clock.
    fn traced(&self, motion: &Motion, progress: &(dyn Fn(&str) + Sync)) -> Result<Value, InputError> {
        let mut random = noise(self.seed, self.number, 1);
        let start_s = SAMPLE_S * SHORT as f64 + PAUSE_S;
        let log = simulation::run(&self.drawn.axes, &positions(motion), start_s, &mut random);
        self.traced_logs(&[self.log.clone(), log], progress)
    }

    fn traced_logs(&self, logs: &[Log], progress: &(dyn Fn(&str) + Sync)) -> Result<Value, InputError> {
        let trace = trace::trace(&self.declared, logs, &[], progress)?;
        Ok(trace::json::Document::of(&trace, &[], false).value())
    }

    fn outcome(&self, plan: &Plan, traced: Option<&Value>, session: &Value) -> PlanOutcome {
        let found = traced.map(effects_of).unwrap_or_default();
        let false_names = self.false_names(&found);
        let at_session = effects_of(session);
        let session_s = SAMPLE_S * self.session.iter().map(Log::len).sum::<usize>() as f64;
        PlanOutcome {
            number: self.number,
            questions: plan
                .questions
                .iter()
                .map(|question| json!({"axis": question.axis, "candidates": question.names()}))
                .collect(),
            truths: self.truths.iter().map(|truth| format!("{}: {}", truth.axis, truth.name)).collect(),
            duration_s: plan.motion.as_ref().map(|candidate| candidate.seconds),
            session_s,
            is_session_right: self.decides(plan, &at_session),
            widths: self.width_ratios(&found, &at_session),
            is_promised: (0..plan.questions.len()).all(|question| plan.decides(question)),
            is_decided: traced.is_some() && self.decides(plan, &found),
            false_names,
            is_within_promise: plan.expected.iter().filter_map(|one| self.is_within(one, &found)).collect(),
        }
    }

    fn has(&self, axis: &str, name: &str) -> bool {
        self.truths.iter().any(|truth| truth.axis == axis && truth.name == name)
    }

    /// Whether effects that were found decide all questions rightly: a candidate that is not there must not be named at all, one that is there
    /// must be certain, and nothing may be certain that is not there.
    fn decides(&self, plan: &Plan, found: &[Value]) -> bool {
        let is_right = |axis: &str, name: &str| {
            let mut named = found.iter().filter(|one| one["axis"] == axis && one["name"] == name);
            if self.has(axis, name) { named.any(is_certain) } else { named.next().is_none() }
        };
        let decided =
            |question: &Question| question.names().into_iter().all(|name| is_right(&question.axis, name));
        plan.questions.iter().all(decided) && self.false_names(found).is_empty()
    }

    /// Effects that are stated as certain and that the machine does not have.
    fn false_names(&self, found: &[Value]) -> Vec<String> {
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let certain = found.iter().filter(|one| is_certain(one));
        certain
            .map(|one| (text(&one["axis"]), text(&one["name"])))
            .filter(|(axis, name)| !self.has(axis, name))
            .map(|(axis, name)| format!("{axis}: {name}"))
            .collect()
    }

    /// Width of the intervals in one trace over that in another: of each value of a true effect that both state as certain.
    fn width_ratios(&self, one: &[Value], other: &[Value]) -> Vec<f64> {
        let width = |found: &[Value], truth: &Truth, key: &str| {
            let is_same = |one: &&Value| one["axis"] == truth.axis && one["name"] == truth.name;
            let ends = &found.iter().filter(|one| is_certain(one)).find(is_same)?["parameters"][key]["ci95"];
            Some(ends[1].as_f64()? - ends[0].as_f64()?).filter(|width| *width > 0.0)
        };
        let ratio = |(truth, key): (&Truth, &str)| Some(width(one, truth, key)? / width(other, truth, key)?);
        let values =
            self.truths.iter().flat_map(|truth| truth.parameters.iter().map(move |(key, _)| (truth, *key)));
        values.filter_map(ratio).collect()
    }

    /// Whether a true value is within the promised interval around the one found; `None` if the machine does not have the effect, or the
    /// trace did not find it.
    fn is_within(&self, expected: &Expected, found: &[Value]) -> Option<bool> {
        let half_width = expected.after?;
        let truth = self
            .truths
            .iter()
            .find(|truth| truth.axis == expected.axis && truth.name == expected.effect)
            .and_then(|truth| truth.parameters.iter().find(|(key, _)| *key == expected.key))?;
        let same = found.iter().find(|one| one["axis"] == expected.axis && one["name"] == expected.effect)?;
        let value = same["parameters"][expected.key]["value"].as_f64()?;
        Some((value - truth.1).abs() <= half_width)
    }
}

/// The effects of the JSON of a trace.
fn effects_of(trace: &Value) -> Vec<Value> {
    trace["effects"].as_array().cloned().unwrap_or_default()
}

fn is_certain(found: &Value) -> bool {
    found["certainty"] == "certain"
}

fn noise(seed: u64, number: u64, log: u64) -> rand_chacha::ChaCha8Rng {
    stream(block::PLANS, seed, number, Purpose::Log(log))
}

/// Commanded positions of a planned motion at each sample, mm.
fn positions(motion: &Motion) -> Vec<[f64; 2]> {
    let place = |of: &indexmap::IndexMap<String, f64>| AXES.map(|name| of.get(name).copied().unwrap_or(0.0));
    let mut from = place(&motion.start_mm);
    let mut positions = Vec::new();
    for block in &motion.blocks {
        match block {
            Block::Dwell { seconds } => {
                positions.extend(sampled(from, &[Segment::Dwell(*seconds)], Pace::default()));
            }
            Block::Line { to_mm, pace } => {
                let to = place(to_mm);
                let pace = Pace {
                    speed: pace.feed_mm_per_min / 60.0,
                    acceleration: 1e3 * pace.acceleration_m_per_s2,
                    averaged_samples: 0,
                };
                positions.extend(sampled(from, &[Segment::Line(to)], pace));
                from = to;
            }
            // A planned motion has none.
            Block::Arc { .. } => {}
        }
    }
    positions
}

impl PlanOutcome {
    /// Its entry in the JSON of the self-test.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "case": self.number,
            "truths": self.truths,
            "questions": self.questions,
            "duration_s": self.duration_s,
            "session_s": self.session_s,
            "is_session_right": self.is_session_right,
            "widths": self.widths,
            "is_promised": self.is_promised,
            "is_decided": self.is_decided,
            "false": self.false_names,
            "is_within_promise": self.is_within_promise,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A machine is drawn, planned for and judged without its own simulator being asked for the answer.
    #[test]
    fn a_planned_motion_is_executed_as_it_is_written() {
        let text = "name = \"p\"\nfeed_mm_per_min = 6000.0\nacceleration_m_per_s2 = 2.0\nstart_mm = { x = 1.0, y = 2.0 }\n\
                    [[block]]\ndwell_s = 0.5\n[[block]]\nline_to_mm = { x = 31.0, y = 42.0 }\n";
        let positions = positions(&Motion::parse(text, "p.toml").unwrap());
        // 50 mm at 100 mm/s and 2 m/s²: 0.5 s and one ramp of 0.05 s, after 0.5 s.
        assert!((1050..=1053).contains(&positions.len()), "{}", positions.len());
        let [first, last] = [positions[0], positions[positions.len() - 1]];
        assert!((first[0] - 1.0).abs() < 1e-12 && (first[1] - 2.0).abs() < 1e-12);
        assert!((last[0] - 31.0).abs() < 1e-9 && (last[1] - 42.0).abs() < 1e-9);
    }
}
