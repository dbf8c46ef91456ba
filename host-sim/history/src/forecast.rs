//! When a series reaches a limit, if it goes on as it does.

use std::fmt;
use std::str::FromStr;

use jiff::ToSpan;
use jiff::civil::Date;
use numerics::distributions::student_t_975;

use crate::least_squares::Regression;

/// Beyond this many days nothing is foretold: no trend of a machine lasts longer.
const HORIZON_DAYS: f64 = 20.0 * 365.25;

/// Which side of a limit is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Values up to the limit.
    AtMost,
    /// Values from the limit on.
    AtLeast,
}

/// A limit of a series.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Name of the series.
    pub name: String,
    /// The limit, in the unit of the series.
    pub value: f64,
    /// Which side is kept.
    pub side: Side,
}

impl FromStr for Limit {
    type Err = String;

    /// A limit that is not to be exceeded, as `x.backlash.lost_motion_um=5`.
    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || "expected NAME=VALUE, as x.backlash.lost_motion_um=5".to_owned();
        let (name, value) = text.split_once('=').ok_or_else(expected)?;
        let value: f64 = value.trim().parse().map_err(|_| expected())?;
        if name.is_empty() || !value.is_finite() {
            return Err(expected());
        }
        Ok(Self { name: name.to_owned(), value, side: Side::AtMost })
    }
}

/// Whether and when a limit is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reached {
    /// The series is beyond it: the whole interval of its last value.
    Already,
    /// The interval of the last value contains it.
    AboutNow,
    /// At about this date, at the earliest and at the latest (95 %); without a latest, it may never be.
    On {
        /// Where the trend crosses it.
        date: Date,
        /// Not before.
        earliest: Option<Date>,
        /// Not after.
        latest: Option<Date>,
    },
    /// No trend towards it is shown; it may be reached at this date at the earliest.
    NotInSight {
        /// Not before; `None`: not within twenty years.
        earliest: Option<Date>,
    },
    /// There are too few values.
    Unknown,
}

impl fmt::Display for Reached {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Already => f.write_str("is exceeded"),
            Self::AboutNow => f.write_str("is reached about now: the interval of the value contains it"),
            Self::On { date, earliest, latest } => {
                write!(f, "is reached about {date}")?;
                match (earliest, latest) {
                    (Some(earliest), Some(latest)) => write!(f, " ({earliest} to {latest})"),
                    (Some(earliest), None) => write!(f, " (not before {earliest})"),
                    _ => Ok(()),
                }
            }
            Self::NotInSight { earliest: Some(date) } => {
                write!(f, "is not in sight, and not reached before {date}")
            }
            Self::NotInSight { earliest: None } => f.write_str("is not in sight within twenty years"),
            Self::Unknown => f.write_str("is not known: too few values"),
        }
    }
}

/// The trend of a series: a line over the days since its first trace, at a temperature.
#[derive(Clone, Debug)]
pub struct Trend {
    /// The regression on 1, days, and what else the series is known to depend on, of which 0 is the mean.
    pub fit: Regression,
    /// The last day.
    pub last_days: f64,
    /// The first trace of the machine.
    pub start: Date,
}

impl Trend {
    fn row(&self, days: f64) -> Vec<f64> {
        let mut row = vec![0.0; self.fit.coefficients.len()];
        (row[0], row[1]) = (1.0, days);
        row
    }

    /// Change per day with the half width of its 95 % interval.
    #[must_use]
    pub fn per_day(&self) -> [f64; 2] {
        let mut slope = self.row(1.0);
        slope[0] = 0.0;
        [self.fit.at(&slope), self.fit.half_width(&slope)]
    }

    /// The line at a day with the half width of its 95 % interval.
    #[must_use]
    pub fn at(&self, days: f64) -> [f64; 2] {
        let row = self.row(days);
        [self.fit.at(&row), self.fit.half_width(&row)]
    }

    /// When the line reaches a limit: the interval has all days on which the limit lies within the 95 % interval of the line
    /// (E. C. Fieller, *J. R. Stat. Soc. B* 16, 1954).
    #[must_use]
    pub fn reaches(&self, limit: &Limit) -> Reached {
        if self.fit.freedom == 0 {
            return Reached::Unknown;
        }
        // Above zero: beyond the limit.
        let sign = if limit.side == Side::AtMost { 1.0 } else { -1.0 };
        let beyond = |days: f64| sign * (self.fit.at(&self.row(days)) - limit.value);
        let half = |days: f64| self.fit.half_width(&self.row(days));
        let now = self.last_days;
        if beyond(now) > half(now) {
            return Reached::Already;
        }
        if beyond(now) > -half(now) {
            return Reached::AboutNow;
        }
        let date = |days: f64| -> Option<Date> {
            #[expect(clippy::cast_possible_truncation, reason = "within the horizon")]
            let days = (days <= now + HORIZON_DAYS).then_some(days.round() as i64)?;
            self.start.checked_add(days.days()).ok()
        };
        let [earliest, latest] = self.crossings(limit.value).map(|days| days.and_then(date));
        let [slope, uncertainty] = self.per_day();
        let crossing = now - beyond(now) / (sign * slope);
        match date(crossing) {
            Some(date) if sign * slope > uncertainty => Reached::On { date, earliest, latest },
            _ => Reached::NotInSight { earliest },
        }
    }

    /// Days after the last one on which the limit enters the interval of the line and on which it leaves it again.
    fn crossings(&self, limit: f64) -> [Option<f64>; 2] {
        let t = student_t_975(self.fit.freedom);
        let factor = t * t * self.fit.variance();
        let (constant, slope) = (self.row(0.0), {
            let mut row = self.row(1.0);
            row[0] = 0.0;
            row
        });
        let (offset, per_day) = (self.fit.at(&constant) - limit, self.fit.at(&slope));
        // (offset + per_day·d)² = factor·variance(d), a quadratic in d.
        let a = per_day * per_day - factor * self.fit.leverage(&slope);
        let b = 2.0 * (offset * per_day - factor * self.fit.joint_leverage(&constant, &slope));
        let c = offset * offset - factor * self.fit.leverage(&constant);
        let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
        let mut later: Vec<f64> = [(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)]
            .into_iter()
            .filter(|days| days.is_finite() && *days > self.last_days)
            .collect();
        later.sort_by(f64::total_cmp);
        [later.first().copied(), later.get(1).copied()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::noise::box_muller;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    fn trend(values: &[f64]) -> Trend {
        let rows: Vec<Vec<f64>> = (0..values.len()).map(|i| vec![1.0, 7.0 * i as f64]).collect();
        let fit = Regression::of(&rows, values).unwrap();
        let last_days = 7.0 * (values.len() - 1) as f64;
        Trend { fit, last_days, start: Date::new(2026, 1, 1).unwrap() }
    }

    fn limit(value: f64, side: Side) -> Limit {
        Limit { name: String::new(), value, side }
    }

    /// Half a unit a month from 3 on, of 26 weeks, with a scatter of 0.3: the day on which 8 is reached is within the interval in 95 of
    /// 100; 500 draws have a standard error of 1 %.
    #[test]
    fn the_day_of_a_limit_is_within_its_interval() {
        let per_day = 0.5 / 30.0;
        let true_day = 5.0 / per_day;
        for (sign, side) in [(1.0, Side::AtMost), (-1.0, Side::AtLeast)] {
            let (mut held, mut told) = (0, 0);
            for seed in 0..500 {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                let value = |i: i32| 3.0 + per_day * 7.0 * f64::from(i);
                let values: Vec<f64> =
                    (0..26).map(|i| sign * (value(i) + 0.3 * box_muller(&mut rng))).collect();
                let Reached::On { earliest, latest, .. } = trend(&values).reaches(&limit(sign * 8.0, side))
                else {
                    continue;
                };
                told += 1;
                let days = |date: Date| f64::from((date - Date::new(2026, 1, 1).unwrap()).get_days());
                let is_within =
                    days(earliest.unwrap()) <= true_day && true_day <= latest.map_or(f64::MAX, days);
                held += usize::from(is_within);
            }
            assert!(told >= 490, "{told}");
            assert!((462..=488).contains(&held), "{held} of {told}");
        }
    }

    #[test]
    fn a_steady_series_reaches_nothing_and_one_beyond_its_limit_is_told() {
        let steady: Vec<f64> = (0..30).map(|i| if i % 2 == 0 { 1.0 } else { 1.2 }).collect();
        assert!(matches!(trend(&steady).reaches(&limit(8.0, Side::AtMost)), Reached::NotInSight { .. }));
        assert!(matches!(trend(&steady).reaches(&limit(-8.0, Side::AtLeast)), Reached::NotInSight { .. }));
        assert_eq!(trend(&steady).reaches(&limit(0.5, Side::AtMost)), Reached::Already);
        assert_eq!(trend(&steady).reaches(&limit(1.5, Side::AtLeast)), Reached::Already);
        assert_eq!(trend(&steady).reaches(&limit(1.1, Side::AtMost)), Reached::AboutNow);
    }
}
