//! Acceleration-correlated position errors (Nguyen, Weikert, Wegener).

mod bench;
mod circles;

use super::{ReproduceError, Study};
use crate::plant::bodies::{Structure, StructureError, Part, JointKind, Assembly};
use bench::{Bench, Gains, Instruments};

impl From<StructureError> for ReproduceError {
    fn from(error: StructureError) -> Self {
        Self::Numerics(error.to_string())
    }
}

pub fn run() -> Result<Study, ReproduceError> {
    let structure: Structure = toml::from_str(include_str!("machine.toml")).map_err(|e| ReproduceError::Numerics(e.to_string()))?;
    let gains = Gains { position_per_s: 100.0, velocity_per_s: 300.0, integral_time_s: 0.015 };
    let a = Assembly::of(&structure)?;
    eprintln!("{:?}", a.natural_frequencies_hz()?);
    eprintln!("{} {}", a.talk_at_rest()?.tool_um_s2_per_m, a.talk_at_rest()?.force_kg);
    eprintln!("{} {}", a.talk_at(50.0)?.tool_um_s2_per_m, a.talk_at(50.0)?.force_kg);
    eprintln!("{} ", a.talk_at(0.5)?.tool_um_s2_per_m);
    let t = std::time::Instant::now();
    for kp in [100.0, 130.0] {
    let gains = Gains { position_per_s: kp, ..gains};
    let bench = Bench::new(&structure, gains, Instruments::default())?;
    let m = circles::evaluate(&circles::run(&bench, 5.0)?)?;
    eprintln!("{} {:?} {:?}", m.talk_um_s2_per_m, m, t.elapsed());
    }
    for part in [Part::Joints(JointKind::Guideway), Part::Joints(JointKind::Flange), Part::Joints(JointKind::Foot), Part::Screws, Part::Masses] {
        let a = Assembly::of(&structure.scaled(part, 0.36))?;
        eprintln!("{part:?} {}", a.talk_at(50.0)?.tool_um_s2_per_m);
    }
    Ok(Study {
        paper: "Nguyen",
        title: "Acceleration-correlated position errors",
        said: Vec::new(),
        outcomes: Vec::new(),
        pictures: Vec::new(),
        notes: Vec::new(),
    })
}
