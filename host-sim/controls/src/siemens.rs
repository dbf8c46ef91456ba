//! Siemens SINUMERIK 840D sl, 828D, 808D: leadscrew error compensation (LEC) and backlash.
//!
//! A compensation value, mm, is added to the actual position: a positive one moves the axis in negative direction, so it is the error.
//! There is one table of both directions; the difference of the directions is the backlash, MD32450.

use std::fmt::Write;

use crate::control::{ControlFile, Written};
use crate::errors::AxisErrors;

/// The files.
#[must_use]
pub fn write(axes: &[AxisErrors<'_>]) -> Written {
    let mut written = Written::default();
    let mut text = "%_N_AX_EEC_INI\nCHANDATA(1)\n".to_owned();
    let mut machine_data = String::new();
    for axis in axes.iter().filter(|axis| axis.has_errors()) {
        let name = format!("{}1", axis.upper());
        if let Some(table) = &axis.table {
            let count = table.forward_um.len();
            let _ = writeln!(
                machine_data,
                "; {name}: MD38000 $MA_MM_ENC_COMP_MAX_POINTS[0,{name}] of at least {count}, then\n$MA_ENC_COMP_ENABLE[0,{name}]=1"
            );
            for (k, mean_um) in table.mean_um().enumerate() {
                let _ = writeln!(text, "$AA_ENC_COMP[0,{k},{name}]={:.6}", 1e-3 * mean_um);
            }
            let end_mm = table.spacing_mm.mul_add((count - 1) as f64, table.start_mm);
            let _ = write!(
                text,
                "$AA_ENC_COMP_STEP[0,{name}]={:.6}\n$AA_ENC_COMP_MIN[0,{name}]={:.6}\n$AA_ENC_COMP_MAX[0,{name}]={end_mm:.6}\n\
                 $AA_ENC_COMP_IS_MODULO[0,{name}]=0\n",
                table.spacing_mm, table.start_mm
            );
            if table.has_directions() {
                written.remarks.push(format!(
                    "{}: the gap varies over the travel; the table has the mean of both directions, and MD32450 the mean gap.",
                    axis.axis
                ));
            }
        }
        let _ = writeln!(machine_data, "$MA_BACKLASH[0,{name}]={:.6}", 1e-3 * axis.mean_backlash_um());
    }
    text += "M17\n";
    if !machine_data.is_empty() {
        let head = "; Machine data (MD32700, MD32450); the tables are written while MD32700 is 0.\n";
        written.files.push(ControlFile { name: "AX_EEC.INI".to_owned(), text });
        let text = format!("{head}{machine_data}");
        written.files.push(ControlFile { name: "machine_data.txt".to_owned(), text });
        written.remarks.push(
            "The value of the table at the reference point should be 0: otherwise the axis moves by it when the table becomes active."
                .to_owned(),
        );
    }
    written
}
