//! The margins for a terminal.

use super::axis_margins::{AxisMargins, LoopMargins, MarginLimits};
use super::margin::At;
use super::mechanics::Condition;

/// A sentence for each axis and a table.
#[must_use]
pub fn of(axes: &[AxisMargins], limits: MarginLimits) -> String {
    let mut lines: Vec<String> = axes.iter().map(|axis| sentence(axis, limits)).collect();
    lines.push(String::new());
    lines.push(format!(
        "{:<6}{:<10}{:>16}{:>10}  {:<12}{:>18}{:>10}  {:<12}",
        "axis", "loop", "gain margin dB", "at Hz", "", "phase margin deg", "at Hz", ""
    ));
    for axis in axes {
        for (name, margins) in [("velocity", &axis.velocity), ("position", &axis.position)] {
            lines.push(row(&axis.axis, name, margins));
        }
    }
    lines.join("\n")
}

fn sentence(axis: &AxisMargins, limits: MarginLimits) -> String {
    let MarginLimits { gain_db, phase_deg } = limits;
    let asked = format!("{gain_db} dB and {phase_deg}°");
    let present = match (axis.velocity.unstable, axis.position.unstable) {
        (Some(condition), _) => format!("the velocity loop is unstable ({})", condition.name()),
        (None, Some(condition)) => format!("the position loop is unstable ({})", condition.name()),
        (None, None) if axis.meet(limits) => {
            format!("both loops have margins of at least {asked}")
        }
        (None, None) => format!("a loop has margins below {asked}"),
    };
    let highest = axis.highest_position_gain_per_s.map_or("none".to_owned(), |gain| format!("{gain:.1}/s"));
    format!(
        "{}: {present}; highest Kp with these margins of the position loop: {highest}, set: {:.1}/s.",
        axis.axis, axis.position_gain_per_s
    )
}

fn row(axis: &str, name: &str, margins: &LoopMargins) -> String {
    if let Some(condition) = margins.unstable {
        return format!("{axis:<6}{name:<10}{:>16}  {}", "unstable", condition.name());
    }
    let cells = |margin: Option<(At, Condition)>, width: usize| {
        margin.map_or(format!("{:>width$}{:>10}  {:<12}", "–", "–", ""), |(at, condition)| {
            format!("{:>width$.2}{:>10.2}  {:<12}", at.value, at.hz, condition.name())
        })
    };
    format!("{axis:<6}{name:<10}{}{}", cells(margins.gain_db, 16), cells(margins.phase_deg, 18))
        .trim_end()
        .to_owned()
}
