//! A series of values, watched for changes from the first on.

use crate::change::{self, Change};
use crate::control_chart::Chart;
use crate::scores;

/// A change that the chart announced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alarm {
    /// Index of the value that raised it.
    pub at: usize,
    /// Index of the first value of the stretch before it.
    pub start: usize,
    /// What changed; its indices count from the first value of the series.
    pub change: Change,
}

/// All alarms of a series, earliest first. After an alarm the values since the change are what later ones are held against.
#[must_use]
pub fn alarms(rows: &[Vec<f64>], values: &[f64], days: &[f64], chart: Chart) -> Vec<Alarm> {
    let mut alarms = Vec::new();
    // The stretch of one level, and the first value that raised no alarm yet.
    let (mut start, mut next) = (0, 0);
    while let Some(at) = first_alarm(&rows[start..], &values[start..], next - start, chart) {
        let at = start + at;
        let stretch = start..=at;
        let Some(mut change) = change::of(&rows[stretch.clone()], &values[stretch.clone()], &days[stretch])
        else {
            break;
        };
        change.first += start;
        change.range = change.range.map(|index| index + start);
        alarms.push(Alarm { at, start, change });
        (start, next) = (change.first, at + 1);
    }
    alarms
}

/// Index of the first value from `next` on that raises an alarm.
fn first_alarm(rows: &[Vec<f64>], values: &[f64], next: usize, chart: Chart) -> Option<usize> {
    let mut chart = chart.restarted();
    let scores = scores::of(rows, values);
    let is_alarm = |(_, score): &(usize, Option<f64>)| score.is_some_and(|score| chart.alarms(score));
    scores.into_iter().enumerate().skip(next).find(is_alarm).map(|(at, _)| at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::change::Shape;
    use crate::control_chart::TRACES_TO_FALSE_ALARM;
    use numerics::noise::box_muller;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Days between two traces.
    const WEEK: f64 = 7.0;

    /// Backlash of a machine at a temperature that swings by 6 K over the year and 2 K from one day to the next: 3 µm with 0.08 µm/K
    /// and a scatter of 0.3 µm from one mounting of the sensors to the next, growing from `since_days` on.
    struct Machine {
        rows: Vec<Vec<f64>>,
        values: Vec<f64>,
        days: Vec<f64>,
    }

    fn machine(seed: u64, weeks: usize, um_a_month: f64, since_days: f64) -> Machine {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let phase = rng.random_range(0.0..1.0);
        let days: Vec<f64> = (0..weeks).map(|week| WEEK * week as f64).collect();
        let kelvin: Vec<f64> = days
            .iter()
            .map(|day| {
                6.0 * (std::f64::consts::TAU * (day / 365.25 + phase)).sin() + 2.0 * box_muller(&mut rng)
            })
            .collect();
        let grown = |day: f64| um_a_month * (day - since_days).max(0.0) / 30.4375;
        let values = days
            .iter()
            .zip(&kelvin)
            .map(|(day, kelvin)| 3.0 + grown(*day) + 0.08 * kelvin + 0.3 * box_muller(&mut rng))
            .collect();
        Machine { rows: kelvin.iter().map(|kelvin| vec![1.0, *kelvin]).collect(), values, days }
    }

    /// 100 machine-years of weekly traces. Scores begin with the sixth value, and each alarm begins the chart anew.
    #[test]
    fn a_steady_machine_alarms_as_often_as_stated() {
        let chart = Chart::with_run_length(TRACES_TO_FALSE_ALARM);
        let count: usize = (0..50)
            .map(|seed| {
                let Machine { rows, values, days } = machine(seed, 104, 0.0, 0.0);
                alarms(&rows, &values, &days, chart).len()
            })
            .sum();
        // 50·99/370 = 13.4 are expected; 4 and 25 are beyond three standard deviations of a Poisson count. After an alarm, the values
        // since the change are those that raised it, which raises a few more.
        println!("{count} false alarms in 100 machine-years of weekly traces");
        assert!((3..=25).contains(&count), "{count}");
    }

    /// Half a micrometre a month after a year: announced before 2 µm are lost.
    #[test]
    fn a_growing_backlash_is_announced_before_two_micrometres_are_lost() {
        let chart = Chart::with_run_length(20.0 * TRACES_TO_FALSE_ALARM);
        let (machines, mut announced, mut lost_um, mut growth) = (200_u32, 0, 0.0, 0);
        for seed in 1000..1000 + u64::from(machines) {
            let since_days = 52.0 * WEEK;
            let Machine { rows, values, days } = machine(seed, 104, 0.5, since_days);
            let all = alarms(&rows, &values, &days, chart);
            let Some(alarm) = all.iter().find(|alarm| days[alarm.at] > since_days) else { continue };
            let lost = 0.5 * (days[alarm.at] - since_days) / 30.4375;
            announced += u32::from(lost < 2.0);
            lost_um += lost / f64::from(machines);
            growth += u32::from(alarm.change.shape != Shape::Step);
        }
        println!("{announced} of {machines} announced before 2 µm, after {lost_um:.2} µm on average");
        assert_eq!(announced, machines, "of {machines} announced in time");
        // 0.115 µm a week against 0.3: half a scatter a trace is a standard deviation after three traces.
        assert!((0.4..1.4).contains(&lost_um), "{lost_um} µm lost on average");
        assert!(growth > machines / 2, "{growth} are not told to be steps");
    }
}
