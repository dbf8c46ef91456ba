//! Beckhoff `TwinCAT` CNC: leadscrew error compensation (`kw.ssfk`) and backlash.
//!
//! A value is the actual less the commanded position, for each direction, in 0.1 µm, as are the positions (P-COMP-00017 to 00025).

use std::fmt::Write;

use crate::control::{ControlFile, Written};
use crate::errors::{AxisErrors, ErrorTable};

/// Units of the list per mm and µm.
const PER_MM: f64 = 1e4;
const PER_UM: f64 = 10.0;

/// The files.
#[must_use]
pub fn write(axes: &[AxisErrors<'_>]) -> Written {
    let mut written = Written::default();
    for axis in axes.iter().filter(|axis| axis.has_errors()) {
        let mut parameters = String::new();
        if let Some(table) = &axis.table {
            let text = list(axis, table);
            written.files.push(ControlFile { name: format!("achskw_{}.lis", axis.axis), text });
            parameters += "lr_param.ssfk                        1\n";
        } else {
            let _ = write!(
                parameters,
                "lr_param.anwahl_losekomp             1\ngetriebe[0].lose                     {:.0}\n",
                PER_UM * axis.backlash_um
            );
        }
        let text = format!(
            "# Axis parameters of {} (P-AXIS-00175, P-AXIS-00021, P-AXIS-00103)\n{parameters}",
            axis.axis
        );
        written.files.push(ControlFile { name: format!("axis_{}.txt", axis.axis), text });
    }
    written
}

/// The list, both directions with half of the backlash.
fn list(axis: &AxisErrors<'_>, table: &ErrorTable) -> String {
    let count = table.forward_um.len();
    let mut text = format!(
        "kopf.achs_nr                        {}\nkopf.log_achs_name                  {}\nkw.ssfk.unit                        1\n\
         kw.ssfk.interval                    0\nkw.ssfk.kw_startpos                 {:.0}\nkw.ssfk.kw_nr_max                   {count}\n\
         kw.ssfk.bilateral                   1\n",
        axis.number + 1,
        axis.upper(),
        PER_MM * table.start_mm,
    );
    for (i, position_mm) in table.positions_mm().enumerate() {
        let _ = writeln!(text, "kw.ssfk.table[{i}].setpoint          {:.0}", PER_MM * position_mm);
    }
    for (direction, column) in [("pos", 1), ("neg", 2)] {
        for (i, row) in axis.rows().enumerate() {
            let _ =
                writeln!(text, "kw.ssfk.table[{i}].{direction}               {:.0}", PER_UM * row[column]);
        }
    }
    text
}
