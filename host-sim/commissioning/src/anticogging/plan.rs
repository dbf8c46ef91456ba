//! Where the axis moves, how fast, and which waves are looked for.

use std::f64::consts::TAU;

use super::declared::Declared;

/// Acceleration of the passes, m/s².
pub const ACCELERATION_M_PER_S2: f64 = 0.2;

/// Highest angular frequency of a wave over the crossover of the velocity loop: the loop then holds the axis against the wave, and the force for
/// its acceleration is a small part of what is recorded.
const HIGHEST_OVER_CROSSOVER: f64 = 0.2;

/// Positions per period of the shortest wave.
const POINTS_PER_WAVE: f64 = 24.0;

/// Least number of samples at a position in a pass.
const LEAST_SAMPLES: f64 = 4.0;

/// Least number of whole periods.
const LEAST_PERIODS: f64 = 2.0;

/// Longest period, mm: the longest line of a motion.
const LONGEST_MM: f64 = 1e5;

/// Greatest number of positions: the least squares over them take a second.
const MOST_POINTS: usize = 20_000;

/// Whole periods of a travel that is not given.
const DEFAULT_PERIODS: f64 = 4.0;

/// Numbers of harmonics of a period. A table has 64 points, between which it is linear: of the twelfth, 17 % would be left.
pub const HARMONICS: std::ops::RangeInclusive<usize> = 1..=12;

/// What is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// Periods, mm; one or two.
    pub periods_mm: Vec<f64>,
    /// Number of harmonics of each period, within [`HARMONICS`].
    pub harmonics: usize,
    /// Ends of the travel, mm; `None`: about the place of the axis.
    pub from_mm: Option<f64>,
    /// The upper end.
    pub to_mm: Option<f64>,
    /// Speed, mm/s; `None`: the greatest that the loops allow.
    pub speed_mm_per_s: Option<f64>,
    /// Place of the axis, mm.
    pub at_mm: f64,
    /// Time between two samples, s.
    pub sample_s: f64,
}

/// A wave that is looked for: a harmonic of a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Number of the period it is a harmonic of.
    pub of_period: usize,
    /// Order, 1 or more.
    pub order: usize,
    /// Period of the wave itself, mm.
    pub period_mm: f64,
}

/// Evenly spaced positions over whole periods. Each stands for the spacing around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Lower end, mm.
    pub from_mm: f64,
    /// Distance of the positions, mm.
    pub spacing_mm: f64,
    /// Number of positions.
    pub points: usize,
}

impl Grid {
    /// A position, mm: the middle of its spacing.
    #[must_use]
    pub fn position_mm(&self, point: usize) -> f64 {
        self.from_mm + (point as f64 + 0.5) * self.spacing_mm
    }

    /// Length of the grid, mm.
    #[must_use]
    pub fn length_mm(&self) -> f64 {
        self.spacing_mm * self.points as f64
    }
}

/// A measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The periods, mm.
    pub periods_mm: Vec<f64>,
    /// The waves that are looked for.
    pub candidates: Vec<Candidate>,
    /// Ends of the travel, mm, ascending: the axis moves between them.
    pub travel_mm: [f64; 2],
    /// The part of it that is evaluated: constant speed, whole numbers of the longest period.
    pub grid: Grid,
    /// Speed, mm/s.
    pub speed_mm_per_s: f64,
}

/// Why nothing can be learned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// A period is out of its range, or there are not one or two of them.
    #[error("expected one or two periods above 0 and up to {LONGEST_MM} mm")]
    Period,
    /// There are too many positions.
    #[error(
        "expected a travel of at most {MOST_POINTS} positions, 24 for each of the shortest waves; it has {points}"
    )]
    Points {
        /// Their number.
        points: usize,
    },
    /// The number of harmonics is out of its range.
    #[error("expected {} to {} harmonics", HARMONICS.start(), HARMONICS.end())]
    Harmonics,
    /// Two waves cannot be told apart over the travel.
    #[error(
        "the waves of {} and {} mm cannot be told apart over {length_mm:.3} mm: give one of them, or a longer travel",
        periods_mm[0], periods_mm[1]
    )]
    Alike {
        /// Their periods, mm.
        periods_mm: [f64; 2],
        /// Length that is evaluated, mm.
        length_mm: f64,
    },
    /// The speed is above what the velocity loop or the samples allow.
    #[error(
        "expected a speed above 0 and up to {most_mm_per_min:.3} mm/min: the wave of {period_mm:.4} mm has to stay below {limit}"
    )]
    Speed {
        /// Greatest speed, mm/min.
        most_mm_per_min: f64,
        /// Shortest period, mm.
        period_mm: f64,
        /// What limits it.
        limit: &'static str,
    },
    /// The travel is shorter than two periods between the accelerations.
    #[error(
        "expected a travel of at least {least_mm:.3} mm: 2 periods of {period_mm} mm, and {margin_mm:.3} mm at either end to accelerate and settle"
    )]
    Travel {
        /// Least length, mm.
        least_mm: f64,
        /// Longest period, mm.
        period_mm: f64,
        /// Length at either end that is not evaluated, mm.
        margin_mm: f64,
    },
    /// The travel leaves the declared soft limits.
    #[error(
        "{from_mm:.3} to {to_mm:.3} mm leaves travel_mm, the soft limits of the axis, {} to {} mm",
        travel_mm[0], travel_mm[1]
    )]
    Beyond {
        /// Lower end, mm.
        from_mm: f64,
        /// Upper end, mm.
        to_mm: f64,
        /// Soft limits, mm.
        travel_mm: [f64; 2],
    },
}

impl Plan {
    /// The plan of a measurement.
    ///
    /// # Errors
    /// [`PlanError`].
    pub fn new(wanted: &Wanted, declared: &Declared) -> Result<Self, PlanError> {
        let periods_mm = &wanted.periods_mm;
        let is_period = |mm: &f64| *mm > 0.0 && *mm <= LONGEST_MM;
        if !(1..=2).contains(&periods_mm.len()) || !periods_mm.iter().all(is_period) {
            return Err(PlanError::Period);
        }
        if !HARMONICS.contains(&wanted.harmonics) {
            return Err(PlanError::Harmonics);
        }
        let longest_mm = periods_mm.iter().copied().fold(0.0, f64::max);
        let shortest_mm = periods_mm.iter().copied().fold(f64::MAX, f64::min) / wanted.harmonics as f64;
        let speed_mm_per_s = speed(wanted, declared, shortest_mm)?;
        let accelerating_mm = speed_mm_per_s * speed_mm_per_s / (2e3 * ACCELERATION_M_PER_S2);
        let margin_mm = accelerating_mm + speed_mm_per_s * declared.settling_s();
        let travel_mm = travel(wanted, declared, DEFAULT_PERIODS * longest_mm + 2.0 * margin_mm)?;
        let evaluated_mm = travel_mm[1] - travel_mm[0] - 2.0 * margin_mm;
        // Rounding does not take a period from a travel that has exactly so many.
        let periods = (evaluated_mm / longest_mm + 1e-9).floor();
        if periods.is_nan() || periods < LEAST_PERIODS {
            let least_mm = LEAST_PERIODS * longest_mm + 2.0 * margin_mm;
            return Err(PlanError::Travel { least_mm, period_mm: longest_mm, margin_mm });
        }
        let grid = grid(travel_mm, periods * longest_mm, shortest_mm);
        if grid.points > MOST_POINTS {
            return Err(PlanError::Points { points: grid.points });
        }
        let candidates = candidates(periods_mm, wanted.harmonics, grid.length_mm())?;
        Ok(Self { periods_mm: periods_mm.clone(), candidates, travel_mm, grid, speed_mm_per_s })
    }
}

/// The speed that is given, or the greatest that is allowed.
fn speed(wanted: &Wanted, declared: &Declared, shortest_mm: f64) -> Result<f64, PlanError> {
    let by_loop = HIGHEST_OVER_CROSSOVER * declared.velocity_crossover_rad_per_s() * shortest_mm / TAU;
    let by_samples = shortest_mm / (POINTS_PER_WAVE * LEAST_SAMPLES * wanted.sample_s);
    let most = by_loop.min(by_samples);
    let speed = wanted.speed_mm_per_s.unwrap_or(most);
    if speed > 0.0 && speed <= most * (1.0 + 1e-9) {
        return Ok(speed);
    }
    let limit = if by_loop <= by_samples {
        "0.2 times the crossover of the velocity loop (gain over mass of the machine file)"
    } else {
        "a 96th of the sample rate"
    };
    Err(PlanError::Speed { most_mm_per_min: 60.0 * most, period_mm: shortest_mm, limit })
}

/// Ends of the travel, mm: what is given; otherwise a length about the place of the axis, moved into the soft limits.
fn travel(wanted: &Wanted, declared: &Declared, length_mm: f64) -> Result<[f64; 2], PlanError> {
    let lower_mm = match (wanted.from_mm, wanted.to_mm) {
        (Some(from_mm), _) => from_mm,
        (None, Some(to_mm)) => to_mm - length_mm,
        (None, None) => {
            let middle_mm = wanted.at_mm - 0.5 * length_mm;
            let within = |[from, to]: [f64; 2]| middle_mm.min(to - length_mm).max(from);
            declared.travel_mm.map_or(middle_mm, within)
        }
    };
    let upper_mm = wanted.to_mm.unwrap_or(lower_mm + length_mm);
    match declared.travel_mm {
        Some(travel_mm) if lower_mm < travel_mm[0] || upper_mm > travel_mm[1] => {
            Err(PlanError::Beyond { from_mm: lower_mm, to_mm: upper_mm, travel_mm })
        }
        _ => Ok([lower_mm, upper_mm]),
    }
}

/// A grid in the middle of a travel.
fn grid(travel_mm: [f64; 2], length_mm: f64, shortest_mm: f64) -> Grid {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive; saturates")]
    let points = (POINTS_PER_WAVE * length_mm / shortest_mm).ceil() as usize;
    let from_mm = 0.5 * (travel_mm[0] + travel_mm[1] - length_mm);
    Grid { from_mm, spacing_mm: length_mm / points as f64, points }
}

/// The harmonics of each period. One that is also a harmonic of the first period is not repeated.
fn candidates(periods_mm: &[f64], harmonics: usize, length_mm: f64) -> Result<Vec<Candidate>, PlanError> {
    let mut candidates: Vec<Candidate> = Vec::new();
    for (of_period, period_mm) in periods_mm.iter().enumerate() {
        for order in 1..=harmonics {
            let new = Candidate { of_period, order, period_mm: period_mm / order as f64 };
            let waves_apart =
                |known: &Candidate| (length_mm / known.period_mm - length_mm / new.period_mm).abs();
            match candidates.iter().find(|known| waves_apart(known) < 1.0 - 1e-6) {
                None => candidates.push(new),
                Some(known) if waves_apart(known) < 1e-6 => {}
                Some(known) => {
                    return Err(PlanError::Alike { periods_mm: [known.period_mm, new.period_mm], length_mm });
                }
            }
        }
    }
    Ok(candidates)
}
