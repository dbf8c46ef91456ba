//! Units of columns.

use files::log::{Channel, Quantity as Measured, Unit as AxisUnit};

/// What a column measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A position of a linear axis, in mm.
    Length,
    /// A position of a rotary axis, in degrees.
    Angle,
    /// A force, in N.
    Force,
    /// A torque, in N·m.
    Torque,
    /// A time, in s.
    Time,
    /// A temperature, in °C.
    Temperature,
}

impl Quantity {
    /// The quantity of a channel: positions and forces of linear axes, angles and torques of rotary ones, temperatures.
    #[must_use]
    pub const fn of(unit: AxisUnit, channel: Channel) -> Self {
        match (unit, channel.quantity()) {
            (AxisUnit::Millimetre, Measured::Position) => Self::Length,
            (AxisUnit::Degree, Measured::Position) => Self::Angle,
            (AxisUnit::Millimetre, Measured::Force) => Self::Force,
            (AxisUnit::Degree, Measured::Force) => Self::Torque,
            (_, Measured::Temperature) => Self::Temperature,
        }
    }

    /// Names of units, and how many of the unit of a log one of them is.
    const fn units(self) -> &'static [(&'static [&'static str], f64)] {
        match self {
            Self::Length => &[
                (&["mm"], 1.0),
                (&["m"], 1e3),
                (&["um", "µm", "μm", "micron", "microns"], 1e-3),
                (&["nm"], 1e-6),
                (&["in", "inch", "inches", "\""], 25.4),
            ],
            Self::Angle => &[
                (&["deg", "°", "degree", "degrees"], 1.0),
                (&["mdeg"], 1e-3),
                (&["rad"], 180.0 / std::f64::consts::PI),
                (&["mrad"], 0.18 / std::f64::consts::PI),
                (&["rev", "turn", "turns"], 360.0),
            ],
            Self::Force => &[(&["n"], 1.0), (&["kn"], 1e3), (&["mn"], 1e-3), (&["lbf"], 4.448_221_615_260_5)],
            Self::Torque => &[(&["nm", "n·m", "n*m", "n.m"], 1.0), (&["mnm"], 1e-3), (&["knm"], 1e3)],
            Self::Temperature => &[(&["celsius", "°c", "c", "degc"], 1.0)],
            Self::Time => &[
                (&["s", "sec", "second", "seconds"], 1.0),
                (&["ms", "msec"], 1e-3),
                (&["us", "µs", "μs", "usec"], 1e-6),
                (&["ns", "nsec"], 1e-9),
                (&["min"], 60.0),
            ],
        }
    }

    /// How many of the unit of a log one of the given unit is; `counts*SCALE` is the scale. `None`: not a unit of this quantity.
    #[must_use]
    pub fn factor(self, unit: &str) -> Option<f64> {
        if let Some(scale) = unit.strip_prefix("counts*") {
            return scale.parse().ok().filter(|scale: &f64| scale.is_finite() && *scale != 0.0);
        }
        let lower = unit.to_lowercase();
        let known = self.units().iter().find(|(names, _)| names.contains(&lower.as_str()));
        known.map(|(_, factor)| *factor)
    }

    /// How many of the unit of a log per second one of the given unit is: `mm/s`, `rev/min`, `counts/s*SCALE`. `None`: not a
    /// velocity of this quantity.
    #[must_use]
    pub fn rate_factor(self, unit: &str) -> Option<f64> {
        let lower = unit.to_lowercase();
        match self {
            Self::Angle if lower == "rpm" => return Some(6.0),
            Self::Angle | Self::Length => {}
            _ => return None,
        }
        if let Some(scale) = unit.strip_prefix("counts/s*") {
            return self.factor(&format!("counts*{scale}"));
        }
        let (base, per) = lower.rsplit_once('/')?;
        let factor = self.factor(base.trim())?;
        match per.trim() {
            "s" | "sec" => Some(factor),
            "min" => Some(factor / 60.0),
            _ => None,
        }
    }

    /// The names of its units, for a message.
    #[must_use]
    pub fn allowed(self) -> String {
        let names: Vec<&str> = self.units().iter().filter_map(|(names, _)| names.first().copied()).collect();
        format!("{} or counts*SCALE", names.join(", "))
    }
}

/// Whether a text is a unit of any quantity.
#[must_use]
pub fn is_unit(text: &str) -> bool {
    use Quantity::{Angle, Force, Length, Temperature, Time, Torque};
    let is_of = |quantity: Quantity| quantity.factor(text).or_else(|| quantity.rate_factor(text)).is_some();
    [Length, Angle, Force, Torque, Time, Temperature].into_iter().any(is_of)
}

/// Name and unit of a header: `X cmd (in)`, `pos [µm]`, `time/ms`.
#[must_use]
pub fn split(header: &str) -> (&str, Option<&str>) {
    for (open, close) in [('(', ')'), ('[', ']')] {
        let inner = header.strip_suffix(close).and_then(|rest| rest.rsplit_once(open));
        if let Some((name, unit)) = inner.filter(|(_, unit)| is_unit(unit.trim())) {
            return (name.trim(), Some(unit.trim()));
        }
    }
    match header.rsplit_once('/') {
        Some((name, unit)) if is_unit(unit.trim()) => (name.trim(), Some(unit.trim())),
        _ => (header, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_converted() {
        let near = |quantity: Quantity, unit: &str, expected: f64| {
            let factor = quantity.factor(unit).unwrap();
            assert!((factor / expected - 1.0).abs() < 1e-12, "{unit}: {factor}");
        };
        near(Quantity::Length, "in", 25.4);
        near(Quantity::Length, "µm", 1e-3);
        near(Quantity::Length, "counts*0.0001", 1e-4);
        near(Quantity::Angle, "rad", 57.295_779_513_082_32);
        near(Quantity::Angle, "mrad", 0.057_295_779_513_082_32);
        near(Quantity::Time, "ms", 1e-3);
        // Nm is a torque, nm a length; of either quantity the other is no unit.
        near(Quantity::Torque, "Nm", 1.0);
        near(Quantity::Length, "nm", 1e-6);
        assert_eq!(Quantity::Force.factor("mm"), None);
        assert_eq!(Quantity::Length.factor("counts*0"), None);
        assert_eq!(Quantity::Length.factor("counts*inf"), None);
    }

    #[test]
    fn velocities_are_converted() {
        let near = |quantity: Quantity, unit: &str, expected: f64| {
            let factor = quantity.rate_factor(unit).unwrap();
            assert!((factor / expected - 1.0).abs() < 1e-12, "{unit}: {factor}");
        };
        near(Quantity::Length, "mm/s", 1.0);
        near(Quantity::Length, "m/s", 1e3);
        near(Quantity::Length, "in/min", 25.4 / 60.0);
        near(Quantity::Length, "counts/s*0.0005", 5e-4);
        near(Quantity::Angle, "rad/s", 180.0 / std::f64::consts::PI);
        near(Quantity::Angle, "rpm", 6.0);
        near(Quantity::Angle, "rev/min", 6.0);
        assert_eq!(Quantity::Length.rate_factor("rpm"), None);
        assert_eq!(Quantity::Length.rate_factor("mm"), None);
        assert_eq!(Quantity::Length.rate_factor("mm/s/s"), None);
        assert_eq!(Quantity::Force.rate_factor("N/s"), None);
        assert_eq!(Quantity::Length.rate_factor("counts/s*0"), None);
    }

    #[test]
    fn a_header_has_name_and_unit() {
        assert_eq!(split("v [mm/s]"), ("v", Some("mm/s")));
        assert_eq!(split("X cmd (in)"), ("X cmd", Some("in")));
        assert_eq!(split("pos [µm]"), ("pos", Some("µm")));
        assert_eq!(split("Time/ms"), ("Time", Some("ms")));
        assert_eq!(split("axis (left)"), ("axis (left)", None));
        assert_eq!(split("x_command_mm"), ("x_command_mm", None));
    }
}
