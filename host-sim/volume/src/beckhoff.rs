//! The tables of Beckhoff's volumetric compensation (TF5280), in its CSV format; sources: `docs/volume.md`.
//!
//! Positions are in mm, errors along an axis in mm, about an axis in rad. Levers count from the machine's zero there, and from the
//! first measurement of each error here: what a tilt makes on the way between the two is added to the errors along the axes. Squareness is in
//! the slope of the straightness, so that the file needs no errors of position.

use super::analysis::Analysis;
use super::component::{Axis, carried};
use super::field::turned_um;

/// Name of the file.
pub const FILE: &str = "volume.csv";

/// The file.
#[must_use]
pub fn csv(analysis: &Analysis) -> String {
    let mut text =
        "// Errors: actual less commanded position of the tool, mm; rotations right-handed, rad\n".to_owned();
    for axis in Axis::ALL {
        let name = axis.name().to_uppercase();
        if axis != Axis::X {
            text += "#\n";
        }
        text += &format!("{name} EX{name} EY{name} EZ{name} EA{name} EB{name} EC{name}\n");
        let table = &analysis.tables[axis as usize];
        for (index, mm) in table.position_mm.iter().enumerate() {
            let about_urad = table.about_urad[index];
            let from_mm = &analysis.lever_from_mm[axis as usize];
            let moved_um = turned_um(&carried(analysis.chain, axis), about_urad, from_mm, [0.0; 3]);
            text += &format!("{mm:.4}");
            for (along_um, moved_um) in table.along_um[index].iter().zip(moved_um) {
                text += &format!(" {:.6}", 1e-3 * (along_um + moved_um));
            }
            for urad in about_urad {
                text += &format!(" {:.9}", 1e-6 * urad);
            }
            text.push('\n');
        }
    }
    text
}
