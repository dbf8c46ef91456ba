//! Acceleration-correlated position errors (Nguyen, Weikert, Wegener).

mod bench;
mod circles;
mod identify;
mod machines;
mod travel;

use super::{ReproduceError, Study};
use crate::plant::bodies::{StructureError, Assembly};
use bench::{Bench, Gains, Instruments};

impl From<StructureError> for ReproduceError {
    fn from(error: StructureError) -> Self {
        Self::Numerics(error.to_string())
    }
}

pub fn run() -> Result<Study, ReproduceError> {
    let catalogue = machines::catalogue()?;
    let truth = machines::truth(&catalogue);
    let a = Assembly::of(&catalogue)?;
    eprintln!("{:?}", a.natural_frequencies_hz()?);
    eprintln!("{:?}", Assembly::of(&truth)?.natural_frequencies_hz()?);
    eprintln!("{} {}", a.talk_at_rest()?.tool_um_s2_per_m, a.talk_at_rest()?.force_kg);
    let t = std::time::Instant::now();
    for kp in [80.0, 100.0, 130.0, 160.0, 200.0] { for ti in [0.01, 0.02, 0.04] { for v in [200.0, 300.0,400.0] {
    let gains = Gains { position_per_s: kp, velocity_per_s: v, integral_time_s: ti};
    let bench = Bench::new(&catalogue, gains, Instruments::default())?;
    let m = circles::evaluate(&circles::run(&bench, 5.0)?)?;
    let tr = travel::Travel::run(&bench)?;
    eprintln!("{kp} {ti} {v} {} exz {} travel {:?} {:?}", m.reached_m_per_s2, m.talk_um_s2_per_m[(0,2)], tr.at_most(0), t.elapsed());
    }}}
    let bench = Bench::new(&catalogue, machines::GAINS, Instruments::default())?;
    let m = circles::evaluate(&circles::run(&bench, 5.0)?)?;
    eprintln!("{m:?}");
    let shop = Bench::new(&truth, machines::GAINS, machines::instruments())?;
    let la = circles::run(&shop, 5.0)?;
    let lb = circles::run(&shop.reseeded(500), 4.5)?;
    let (ma, mb) = (circles::evaluate(&la)?, circles::evaluate(&lb)?);
    eprintln!("{ma:?}\n{mb:?}");
    for c in identify::candidates(&catalogue, &ma, &mb, machines::WEIGHTS)? {
        let talk = Assembly::of(&catalogue.scaled(c.part, c.factor))?.talk_at(mb.rad_per_s)?;
        eprintln!("{c:?} {}", identify::left_um(&lb, Some(&talk)));
    }
    eprintln!("{}", identify::left_um(&lb, None));
    eprintln!("{:?} {:?}", travel::by_jerk_alone(0.02,250.0), travel::commanded(travel::PRINTED)?);
    Ok(Study {
        paper: "Nguyen",
        title: "Acceleration-correlated position errors",
        said: Vec::new(),
        outcomes: Vec::new(),
        pictures: Vec::new(),
        notes: Vec::new(),
    })
}
