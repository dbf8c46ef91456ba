//! A kinematics component of LinuxCNC that moves the joints against the errors; source of its form: `docs/volume.md`.

use super::analysis::Analysis;
use super::axis_table::AxisTable;
use super::component::Axis;

/// Name of the file.
pub const FILE: &str = "volumekins.comp";

/// Lines between which the file is plain C without LinuxCNC.
pub const PLAIN: [&str; 2] = ["/* plain C from here */", "/* plain C to here */"];

/// The file for halcompile. Its length unit is mm.
#[must_use]
pub fn component(analysis: &Analysis) -> String {
    let [from, to] = PLAIN;
    let mut plain = String::new();
    for (axis, table) in Axis::ALL.into_iter().zip(&analysis.tables) {
        plain += &declared(axis, table);
    }
    let numbers = |values: [f64; 3]| values.map(|value| format!("{value:.4}")).join(", ");
    let chain = analysis.chain.map(|axis| (axis as usize).to_string()).join(", ");
    let of_axis = |places_mm: [[f64; 3]; 3]| {
        format!("{{{}}}", places_mm.map(|mm| format!("{{{}}}", numbers(mm))).join(", "))
    };
    let places = analysis.lever_from_mm.map(of_axis).join(",\n    ");
    plain += &format!(
        "/* From where levers count: of x, y and z, for errors along x, y and z. */\nstatic const double lever_from_mm[3][3][3] = {{\n    {places}\n}};\n"
    );
    plain += &format!(
        "/* The axes from the workpiece to the tool. */\nstatic const int chain[3] = {{{chain}}};\n"
    );
    plain += FUNCTIONS;
    format!("{HEADER}{from}\n{plain}{to}\n{KINEMATICS}")
}

/// The tables of an axis.
fn declared(axis: Axis, table: &AxisTable) -> String {
    let name = axis.name();
    let count = table.position_mm.len();
    let positions: Vec<String> = table.position_mm.iter().map(|mm| format!("{mm:.4}")).collect();
    let rows = table.along_um.iter().zip(&table.about_urad).map(|(along_um, about_urad)| {
        let values = along_um.iter().chain(about_urad).map(|value| format!("{value:.4}"));
        format!("    {{{}}}", values.collect::<Vec<_>>().join(", "))
    });
    format!(
        "static const double {name}_mm[{count}] = {{{}}};\n/* Along x, y, z, um; about x, y, z, urad. */\nstatic const double {name}_errors[{count}][6] = {{\n{}\n}};\n",
        positions.join(", "),
        rows.collect::<Vec<_>>().join(",\n"),
    )
}

const HEADER: &str = r#"component volumekins "Moves three joints against the geometric errors of their axes";
description "Made by lost-motion volume. Lengths are in mm. Joints 0, 1 and 2 are X, Y and Z.";
pin out bit unused;
license "GPL";
;;
#include "rtapi_math.h"
#include "kinematics.h"
"#;

const FUNCTIONS: &str = r"static void errors_at(const double *mm, const double (*errors)[6], int count, double at, double out[6]) {
    int after = 1, i;
    double part;
    while (after < count - 1 && mm[after] <= at)
        after++;
    part = (at - mm[after - 1]) / (mm[after] - mm[after - 1]);
    part = part < 0.0 ? 0.0 : part > 1.0 ? 1.0 : part;
    for (i = 0; i < 6; i++)
        out[i] = errors[after - 1][i] * (1.0 - part) + errors[after][i] * part;
}

/* Actual less commanded position of the tool, mm, with the joints at a position. */
static void volume_error(const double at[3], double error[3]) {
    double own[3][6];
    int i, j, k;
    errors_at(x_mm, x_errors, sizeof x_mm / sizeof *x_mm, at[0], own[0]);
    errors_at(y_mm, y_errors, sizeof y_mm / sizeof *y_mm, at[1], own[1]);
    errors_at(z_mm, z_errors, sizeof z_mm / sizeof *z_mm, at[2], own[2]);
    for (k = 0; k < 3; k++) {
        error[k] = 0.0;
        for (i = 0; i < 3; i++) {
            const double *about = own[chain[i]] + 3;
            double lever[3] = {0.0, 0.0, 0.0};
            for (j = i + 1; j < 3; j++)
                lever[chain[j]] = at[chain[j]] - lever_from_mm[chain[i]][k][chain[j]];
            error[k] += 1e-3 * own[chain[i]][k]
                + 1e-6 * (about[(k + 1) % 3] * lever[(k + 2) % 3] - about[(k + 2) % 3] * lever[(k + 1) % 3]);
        }
    }
}
";

const KINEMATICS: &str = r"
KINS_NOT_SWITCHABLE
EXPORT_SYMBOL(kinematicsType);
EXPORT_SYMBOL(kinematicsInverse);
EXPORT_SYMBOL(kinematicsForward);

KINEMATICS_TYPE kinematicsType() { return KINEMATICS_BOTH; }

int kinematicsForward(const double *joints, EmcPose *pos, const KINEMATICS_FORWARD_FLAGS *fflags, KINEMATICS_INVERSE_FLAGS *iflags) {
    double error[3];
    volume_error(joints, error);
    pos->tran.x = joints[0] + error[0];
    pos->tran.y = joints[1] + error[1];
    pos->tran.z = joints[2] + error[2];
    return 0;
}

int kinematicsInverse(const EmcPose *pos, double *joints, const KINEMATICS_INVERSE_FLAGS *iflags, KINEMATICS_FORWARD_FLAGS *fflags) {
    /* The error changes by far less than itself between a position and the corrected one: two rounds are exact to a nanometre. */
    double error[3], at[3] = {pos->tran.x, pos->tran.y, pos->tran.z};
    int round;
    for (round = 0; round < 3; round++) {
        volume_error(at, error);
        at[0] = pos->tran.x - error[0];
        at[1] = pos->tran.y - error[1];
        at[2] = pos->tran.z - error[2];
    }
    joints[0] = at[0];
    joints[1] = at[1];
    joints[2] = at[2];
    return 0;
}
";
