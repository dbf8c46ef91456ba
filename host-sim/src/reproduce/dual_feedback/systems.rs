//! scratch
use super::trial::*;
use crate::machine::Feedback;
use crate::reproduce::{ReproduceError, Study};
pub fn add(_study: &mut Study) -> Result<(), ReproduceError> {
    let mut all = vec![System{feedback: Feedback::Motor, shift_s: 0.1}, System{feedback: Feedback::Table, shift_s: 0.1}];
    for t in [0.005,0.01,0.02, 0.05,0.1,0.2] { all.push(System{feedback: Feedback::Dual, shift_s: t}); }
    for s in all {
        let g = highest_gain_per_s(s)?;
        eprintln!("{s:?} {g}");
        for k in [2.0, 5.0,10.0,20.0,40.0,80.0] { eprint!(" {k}:{:.2}", swing_um(s,k)?); }
        eprintln!();
        for k in [0.5*g, 8.0] {
        eprintln!("  {k} {:?} {:?}", positioning(s, k), creeping(s, k));
        }
    }
    Ok(())
}
