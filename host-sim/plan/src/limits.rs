//! What a planned motion may use of a machine.

use files::error::InputError;
use files::log::Log;
use model::machine::Machine;
use trace::TraceOptions;
use trace::input::motion_range::MotionRange;
use trace::input::signals::Signals;

/// Part of the soft travel that is used: an axis overshoots.
const WITHIN: f64 = 0.95;

/// Limits of one axis; mm, or degrees for a rotary axis.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisLimits {
    /// Name of the axis.
    pub name: String,
    /// Middle of the travel that may be used.
    pub middle_mm: f64,
    /// Half of the travel that may be used.
    pub half_mm: f64,
    /// Largest speed.
    pub speed_mm_s: f64,
    /// Largest acceleration, m/s², or 1000°/s².
    pub acceleration_m_per_s2: f64,
}

/// Limits of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionLimits {
    /// Limits of each axis, in the order of the machine file.
    pub axes: Vec<AxisLimits>,
    /// Longest duration, s.
    pub time_s: f64,
}

/// Limits that a user states, of all axes; what is not stated follows from logs or from the machine file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StatedLimits {
    /// Travel of axes by their names: from, to; mm or degrees.
    pub travel_mm: Vec<(String, [f64; 2])>,
    /// Largest speed, mm/s.
    pub speed_mm_s: Option<f64>,
    /// Largest acceleration, m/s².
    pub acceleration_m_per_s2: Option<f64>,
}

impl MotionLimits {
    /// The limits of a machine: as stated, otherwise as in the logs, otherwise as in the machine file.
    ///
    /// # Errors
    /// A travel of an axis that the machine does not have, or beyond its soft limits; a limit that is not known.
    pub fn new(
        machine: &Machine,
        stated: &StatedLimits,
        logs: &[Log],
        time_s: f64,
    ) -> Result<Self, InputError> {
        if let Some((name, _)) = stated.travel_mm.iter().find(|(name, _)| !machine.axis.contains_key(name)) {
            let names = machine.axis.keys().cloned().collect::<Vec<_>>().join(", ");
            return Err(InputError::expected("--travel", format!("one of the axes {names}"), name));
        }
        for (number, (name, _)) in stated.travel_mm.iter().enumerate() {
            if stated.travel_mm[..number].iter().any(|(earlier, _)| earlier == name) {
                return Err(InputError::expected("--travel", format!("one travel of {name}"), "two"));
            }
        }
        let names: Vec<String> = machine.axis.keys().cloned().collect();
        let options = TraceOptions::default();
        let signals: Vec<Signals> =
            logs.iter().map(|log| Signals::new(log, &names, &options.samples)).collect();
        let of_axis = |(index, name): (usize, &String)| {
            let logged = MotionRange::of(&signals, index, options.admission.min_travel_mm);
            axis(machine, name, stated, logged)
        };
        let axes = names.iter().enumerate().map(of_axis).collect::<Result<_, InputError>>()?;
        Ok(Self { axes, time_s })
    }
}

fn axis(
    machine: &Machine,
    name: &str,
    stated: &StatedLimits,
    logged: Option<MotionRange>,
) -> Result<AxisLimits, InputError> {
    let limits = machine.axis.get(name).map(|axis| &axis.settings.limits);
    let soft_mm = limits.and_then(|limits| limits.travel_mm);
    let unknown = |option: &str, what: &str| {
        let expected =
            format!("{what} of {name}, as no log of --within in which it moves, nor the model, has it");
        InputError::expected(option, expected, "nothing")
    };
    let (middle_mm, half_mm) = match (stated.travel_mm.iter().find(|(axis, _)| axis == name), logged, soft_mm)
    {
        (Some((_, [from, to])), _, _) => (0.5 * (from + to), 0.5 * (to - from)),
        (None, Some(logged), _) => (logged.middle_mm, logged.half_mm),
        (None, None, Some([from, to])) => (0.5 * (from + to), WITHIN * 0.5 * (to - from)),
        (None, None, None) => return Err(unknown("--travel", "the travel")),
    };
    if let Some([from, to]) = soft_mm
        && (middle_mm - half_mm < from || middle_mm + half_mm > to)
    {
        let found = format!("{} to {}", middle_mm - half_mm, middle_mm + half_mm);
        let expected = format!("a travel of {name} within its travel_mm, {from} to {to}");
        return Err(InputError::expected("--travel", expected, found));
    }
    let speed = stated.speed_mm_s.or_else(|| logged.map(|logged| logged.speed_mm_s));
    let fastest = limits.and_then(|limits| limits.fastest_mm_per_s);
    let speed = match (speed, fastest) {
        (Some(speed), Some(fastest)) => Some(speed.min(fastest)),
        (one, other) => one.or(other),
    };
    let acceleration = stated.acceleration_m_per_s2.or_else(|| logged.map(|one| one.acceleration_m_per_s2));
    Ok(AxisLimits {
        name: name.to_owned(),
        middle_mm,
        half_mm,
        speed_mm_s: speed.ok_or_else(|| unknown("--speed-mm-per-s", "the speed"))?,
        acceleration_m_per_s2: acceleration
            .ok_or_else(|| unknown("--acceleration-m-per-s2", "the acceleration"))?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn machine(limits: &str) -> Machine {
        let text =
            format!("name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ntable_mass_kg = 100.0\n{limits}");
        Machine::parse(&text, "m.toml").unwrap()
    }

    #[test]
    fn what_is_stated_comes_first_and_what_nobody_knows_is_asked_for() {
        let soft = machine("travel_mm = [-100.0, 300.0]\n");
        let stated = StatedLimits {
            travel_mm: vec![("x".to_owned(), [0.0, 40.0])],
            speed_mm_s: Some(80.0),
            acceleration_m_per_s2: Some(2.0),
        };
        let limits = MotionLimits::new(&soft, &stated, &[], 60.0).unwrap();
        assert_eq!((limits.axes[0].middle_mm, limits.axes[0].half_mm), (20.0, 20.0));
        let without_travel = StatedLimits { travel_mm: Vec::new(), ..stated.clone() };
        let limits = MotionLimits::new(&soft, &without_travel, &[], 60.0).unwrap();
        // 95 % of the soft travel of 400 mm, half of it on each side of 100 mm.
        assert_eq!((limits.axes[0].middle_mm, limits.axes[0].half_mm), (100.0, 190.0));
        let error = MotionLimits::new(&machine(""), &without_travel, &[], 60.0).unwrap_err().to_string();
        assert!(error.starts_with("--travel: expected the travel of x"), "{error}");
        let without_speed = StatedLimits { speed_mm_s: None, ..stated };
        let error = MotionLimits::new(&soft, &without_speed, &[], 60.0).unwrap_err().to_string();
        assert!(error.starts_with("--speed-mm-per-s"), "{error}");
    }

    #[test]
    fn a_travel_beyond_the_soft_limits_of_no_axis_or_stated_twice_is_refused() {
        let soft = machine("travel_mm = [-100.0, 300.0]\n");
        let refused = |travels: &[(&str, [f64; 2])]| {
            let stated = StatedLimits {
                travel_mm: travels.iter().map(|(axis, travel)| ((*axis).to_owned(), *travel)).collect(),
                speed_mm_s: Some(80.0),
                acceleration_m_per_s2: Some(2.0),
            };
            MotionLimits::new(&soft, &stated, &[], 60.0).unwrap_err().to_string()
        };
        assert!(refused(&[("x", [-101.0, 0.0])]).contains("within its travel_mm, -100 to 300"));
        assert!(refused(&[("y", [0.0, 1.0])]).contains("one of the axes x"));
        assert!(refused(&[("x", [0.0, 1.0]), ("x", [0.0, 2.0])]).contains("one travel of x"));
    }
}
