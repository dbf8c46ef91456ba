//! All decision thresholds of a trace.
//!
//! The fields, their defaults and their names for a sweep come from the list at the end of this file. Numbers that only
//! affect the numerical method (the step of a derivative, the maximum number of iterations) are constants where they are
//! used.
//!
//! The line "Sweep" of an option states the effect of halving (×0.5) and doubling (×2) it, with all others at their
//! defaults:
//! - in 12 cases of the self-test, seed 1: `cargo run --release -p self-test --example threshold_sweep -- 12`. No option
//!   changed which effects are found or described in any case. "Values" are figures that change without changing a name;
//!   where an option is not reached in these cases, nothing changes.
//! - in the unit tests of this crate, and for the options of search, exclusion, validation and verdict in the tests on
//!   measured data (`tests/tests/host/measured_data.rs`: the axis EMPS, a robot, a lead screw) and on corrupted logs
//!   (`tests/tests/host/corrupted.rs`). A test is named if it fails.
//!
//! Options without such a line were not halved and doubled, as those of [`FaultOptions`], which decide before any fit, and the
//! latest ones of the search.

mod declaration;
mod significance;

use declaration::{Scale, options};
pub use significance::BLOCKS;

options! {
    /// Which logs are accepted.
    admission: AdmissionOptions {
        /// Largest relative difference between sample rates that count as equal. Printed times are rounded; different rates
        /// differ by far more than this.
        ///
        /// Sweep: nothing changes.
        rate_tolerance: f64 = 1e-3,
        /// Maximum number of samples of all fit logs together, and of all validation logs, in which effects are searched for as
        /// a whole. With many effects the search stores about 7 kB for each sample of an axis: its derivatives with respect to
        /// all parameters, for several candidates.
        ///
        /// Sweep: the unit test of a long log fails with either; the cases are shorter.
        max_samples: usize = 96_000,
        /// Maximum number of samples of all fit logs times number of axes up to which the axes are traced at the same time.
        ///
        /// Sweep: nothing changes but time and memory.
        max_samples_at_once: usize = 80_000,
        /// Number of samples of longer logs in which effects are searched for, those that are held out included.
        searched_samples: usize = 48_000,
        /// Minimum number of samples of a log.
        ///
        /// Sweep: nothing changes.
        min_samples: usize = 200,
        /// Minimum travel, mm or degrees. A shorter one may be presliding and noise.
        ///
        /// Sweep: the unit test of a log without motion fails with either, as its message states the limit.
        min_travel_mm: f64 = 0.01,
        /// Maximum travel, mm or degrees. A longer one indicates a wrong unit.
        ///
        /// Sweep: nothing changes.
        max_travel_mm: f64 = 1e6,
        /// A sensor whose reading is constant while another sensor of the axis travels farther than this, mm or degrees,
        /// is defective: no backlash is that wide.
        ///
        /// Sweep: nothing changes.
        max_travel_beside_stuck_mm: f64 = 1.0,
        /// Number of consecutive rows that are compared to find copies. On the same motion, coarse encoders give equal
        /// readings in single rows by chance, but not in this many consecutive rows.
        ///
        /// Sweep: ×0.5 and ×2: `a_log_with_rows_or_a_channel_removed_is_a_copy` fails.
        copied_rows: usize = 16,
        /// A log is a copy of another if more than this fraction of its rows in motion is equal.
        ///
        /// Sweep: ×0.5: a log that shares less than half is refused; ×2: copies are accepted (three tests).
        max_shared: f64 = 0.5,
        /// A force counts as saturated above this fraction of its limit, because the reading has noise.
        ///
        /// Sweep: ×0.5: samples at half the limit count as saturated (two tests); ×2: saturation is never detected.
        saturation: f64 = 0.99,
        /// A log is refused if more than this fraction of its samples is saturated.
        ///
        /// Sweep: ×0.5 and ×2: `a_saturated_force_is_excluded_or_refused` fails.
        max_saturated: f64 = 0.5,
        /// Fraction at the end of each log that is held out if no validation log is given.
        ///
        /// Sweep: ×0.5: `the_stiffness_of_a_gear_is_found_from_torque_and_two_encoders` fails; ×2: nothing changes.
        held_out: f64 = 0.25,
    }
    /// Which data are regarded as broken.
    faults: FaultOptions {
        /// Smallest slip or spike, smallest motion that a repeated reading misses, and smallest deviation due to a late
        /// command, µm or mdeg. Smaller jumps of a reading may be those of a
        /// friction that breaks away.
        min_jump_um: f64 = 4.0,
        /// Smallest slip, spike or missed motion in standard deviations of the noise of the channel: with a million samples, six are
        /// exceeded once in a thousand logs.
        min_jump_noise: f64 = 8.0,
        /// Smallest slip, spike or missed motion in steps of the encoder. Near standstill, single steps are isolated.
        min_jump_resolution: f64 = 3.5,
        /// Smallest ratio of a slip or spike to the other irregularities of the channel within 200 samples, and to the
        /// scatter of its difference to another channel.
        min_jump_context: f64 = 4.0,
        /// Motion of another sensor, µm or mdeg, beside which a constant reading is stuck even if it does not jump when it
        /// is released: no backlash is that wide.
        min_held_travel_um: f64 = 1000.0,
        /// Shortest duration of a repeated reading that is reported by itself, s; shorter ones are counted together.
        min_stuck_s: f64 = 0.02,
        /// A channel is not used if more than this fraction of its readings is repeated.
        max_held: f64 = 0.2,
        /// Largest relative difference of the motions of two sensors that may be a pitch error, wind-up or in-talk, which
        /// changes the motion of the tool by 4 % on small circles at high feed. A lead that is off by a factor is 8 mm
        /// instead of 10 mm, or further away.
        max_sensor_factor: f64 = 0.15,
        /// Largest relative difference of the motions of command and sensors that may be a following error. On small circles
        /// at high feed the motion is up to 27 % larger or smaller than its command.
        max_command_factor: f64 = 0.5,
        /// Largest median deviation of the ratios of increments of two channels whose motions are proportional, as a
        /// fraction of the ratio.
        max_factor_spread: f64 = 0.05,
        /// Smallest ratio of the difference between a channel and its own axis to that between it and another axis, if the
        /// channels of both axes are exchanged.
        min_exchanged_ratio: f64 = 20.0,
        /// Smallest shift of a sensor that is regarded as a fault, s: a `latency` of up to 0.1 s is an effect.
        min_shift_s: f64 = 0.11,
        /// Smallest difference between two sensors of an axis, which 5 % of the samples exceed, at which a shift is looked for, mm or degrees.
        min_shifted_mm: f64 = 0.1,
        /// Largest difference after a shift is corrected, as a fraction of that before.
        max_shifted_remainder: f64 = 0.1,
        /// Smallest ratio of the residual with gain and feed-forward fitted to that with a late command, for the command to
        /// be regarded as late.
        min_rival_ratio: f64 = 3.0,
    }
    /// Filter of the signals, standstills, and the initial state of a log.
    samples: SampleOptions {
        /// Half width of the smoothing window of the signals, s: the filter passes the bandwidth of a servo loop and removes
        /// the sensor's noise from velocities.
        ///
        /// Sweep: values in all cases. ×0.5: two more 95 % intervals miss the truth; ×2:
        /// `a_saturated_force_is_excluded_or_refused` fails.
        smoothing_s: f64 = 0.005,
        /// Time over which the readings of a temperature are averaged, s.
        temperature_smoothing_s: f64 = 5.0,
        /// Least range of the temperatures of all fit logs, °C, by which a dependence on them is searched for: with less, the error of a
        /// sensor and the difference between its place and the guide are not small.
        min_temperature_range_c: f64 = 2.0,
        /// Settling time at the start of a log that is not evaluated, s: the state before the log is unknown.
        ///
        /// Sweep: values in all cases. ×2: one more interval misses the truth. Unit tests on the length of the
        /// evaluated log fail with either.
        settling_s: f64 = 0.3,
        /// Minimum duration of a standstill, s; a reversal passes through velocity zero in less time.
        ///
        /// Sweep: values in all cases; one more interval misses the truth with either. Measured data: nothing
        /// changes.
        min_standstill_s: f64 = 0.05,
        /// Maximum velocity in a standstill, m/s.
        ///
        /// Sweep: values in all cases. ×2: one more interval misses the truth.
        max_standstill_m_per_s: f64 = 10e-6,
        /// Maximum velocity in a standstill, in standard deviations of the noise of a difference of two filtered positions;
        /// the larger limit applies.
        ///
        /// Sweep: values in 11 cases. ×2: one more interval misses the truth.
        max_standstill_noise: f64 = 4.0,
        /// Travel, µm or mdeg, after which the friction of an axis that moved at the start of a log is that of sliding: ten times
        /// the distance Fc/σ0 of a guide with 200 N and 40 N/µm.
        min_sliding_um: f64 = 50.0,
        /// Number of samples over which a command must be constant to show that the controller was just switched on.
        ///
        /// Sweep: values in one case. Measured data: nothing changes.
        constant_command: usize = 20,
        /// Minimum motion of the motor under such a command, in standard deviations of its noise.
        ///
        /// Sweep: values in one case.
        min_motion_noise: f64 = 6.0,
        /// Play on either side through which the motor's reading drives the guide's friction, standard deviations of its
        /// noise.
        ///
        /// Sweep: no unit test fails; it was added after the run of the cases.
        play_noise: f64 = 1.5,
    }
    /// How far values may differ from those that the machine file declares.
    model: ModelOptions {
        /// Standard deviation of the prior of a declared value, as a fraction of its tolerance. The tolerance is two
        /// standard deviations, as users state it, and no bound: logs may show that a value is outside
        /// ([`fit_range`](model::machine::nominal::fit_range)).
        prior: f64 = 0.5,
        /// Maximum change, by the motor stage, of a mass that was fitted to the force, as a fraction of the total mass. It
        /// covers the error of the force stage's filter and of the simulation step.
        ///
        /// Sweep: values in 10 cases with ×0.5, in 2 with ×2.
        mass_trim: f64 = 0.01,
        /// Maximum error of the sampling instants of table and tool, and maximum step of the controller's filter, samples.
        ///
        /// Sweep: values in all cases. `an_effect_replaces_a_trim` fails with either, as it states the bound.
        position_trim: f64 = 0.1,
        /// Maximum error of the sampling instant of a force, which is the mean over an interval, samples.
        ///
        /// Sweep: values in all cases.
        force_trim: f64 = 0.25,
        /// Maximum delay of the velocity in the velocity loop, ticks of that loop.
        ///
        /// Sweep: values in all cases. `an_effect_replaces_a_trim` fails with either, as it states the bound.
        velocity_trim: f64 = 0.25,
        /// Maximum time by which the drive's force acts early, ticks of the velocity loop.
        ///
        /// Sweep: values in all cases. ×0.5: one more interval contains the truth.
        drive_trim: f64 = 0.15,
        /// Largest time constant of the drive's force that is not reported, ms: a current loop of 1 kHz has 0.16 ms.
        drive_lag_trim_ms: f64 = 0.15,
        /// Standard deviation of the prior of these errors, as a fraction of their maximum.
        ///
        /// Sweep: values in all cases.
        trim_prior: f64 = 0.5,
        /// A model that an earlier trace wrote is replaced only by a fit that lowers the sum of the residuals by this
        /// fraction. From other initial values, a fit ends at other values of poorly determined parameters, and the
        /// residual of a motor stage at noise level differs by up to 4 %.
        ///
        /// Sweep: nothing changes: no machine file of the cases was written by a trace.
        min_gain_of_refit: f64 = 0.05,
    }
    /// Which effects are added.
    search: SearchOptions {
        /// Maximum number of effects that are added to one scope.
        ///
        /// Sweep: ×0.5: the two tests of EMPS fail; ×2: nothing changes.
        max_effects: usize = 10,
        /// Maximum number of candidates of a round that get a full fit.
        ///
        /// Sweep: ×0.5: `the_trace_of_emps_matches_the_readme` fails; ×2: nothing changes.
        fitted_candidates: usize = 5,
        /// A candidate gets a full fit if the predicted gain of its linear step is at least this fraction of
        /// [`Self::min_gain`]. Of 800 candidates of 30 traces, all that were accepted had at least four times as much.
        ///
        /// Sweep: ×0.5: nothing changes; ×2: `emps_has_no_stribeck_effect` fails.
        promising: f64 = 0.25,
        /// Smallest fraction of Σr² of some stage that a candidate must remove from held-out data.
        ///
        /// Sweep: ×0.5: `the_trace_of_emps_matches_the_readme` fails; ×2: so does `emps_has_no_stribeck_effect`.
        min_reduction: f64 = 0.04,
        /// Minimum gain, in standard errors over the blocks of the logs. With about thirty candidates per round, a normal
        /// deviate exceeds 3.5 by chance in one of a hundred rounds. Blocks are few and their errors have long tails, so
        /// machines without undeclared effects are tested as well.
        ///
        /// Sweep: ×0.5: `the_trace_of_emps_matches_the_readme` and the unit test of `force_windup` fail; ×2:
        /// `the_trace_of_emps_matches_the_readme` and `the_robot_has_latency_and_windup` fail.
        min_t: f64 = 3.5,
        /// Smallest gain in log-likelihood of all samples of a stage together, on held-out data: the noise alone hardly gives
        /// any of the thirty candidates of a round as much. Only logs of a few seconds come near it.
        min_evidence: f64 = 15.0,
        /// Smallest length of a block, s: 3/Kp of a position gain of 30 1/s, over which the residual of a loop is correlated. A
        /// log too short for 24 blocks has fewer, which must show more: [`Self::min_t_of`].
        min_block_s: f64 = 0.1,
        /// Smallest size of an effect, in half widths of its confidence interval. An effect that is significant by its gain
        /// is many half widths large; one of a few half widths follows a chance shape of the residual.
        min_size: f64 = 1.5,
        /// Number of standard errors below which a difference between two models is not significant.
        ///
        /// Sweep: nothing changes.
        chance_t: f64 = 2.0,
        /// Minimum number of evaluated samples of a block that contributes to a standard error.
        ///
        /// Sweep: nothing changes.
        min_block_samples: usize = 20,
        /// Maximum loss in log-likelihood per sample that a candidate causes in a stage of a log, or in the closed loop, as
        /// a fraction of its gain over all stages. [`Self::min_gain`] is always tolerated.
        ///
        /// Sweep: nothing changes, nor did a separate limit of 0.25 for the closed loop when halved or doubled.
        max_loss: f64 = 0.1,
        /// Maximum of this loss however large the gain is: a constant error of the force gains as much as it is large, and
        /// makes the closed loop worse.
        max_stage_loss: f64 = 0.25,
        /// Smallest gain of a rival that held-out data do not support by itself, as a fraction of the gain of the added effect.
        min_rival_gain: f64 = 0.5,
        /// Largest ratio of residual to noise beside effects that were added provisionally. A larger residual has another cause, of
        /// which they may describe parts.
        max_provisional_ratio: f64 = 5.0,
        /// Above this ratio of residual to noise, candidates are fitted from the nominal values: an effect of that size
        /// moves the declared values to their bounds in the fit without it.
        ///
        /// Sweep: values in one case.
        min_gross_ratio: f64 = 20.0,
        /// Minimum gain in log-likelihood per sample of a candidate that is reported although it was not added.
        ///
        /// Sweep: nothing changes in what is found.
        min_reported_gain: f64 = 0.2,
    }
    /// What is excluded from residuals because no effect describes it.
    exclusion: ExclusionOptions {
        /// Maximum number of exclusions per scope.
        ///
        /// Sweep: nothing changes.
        max_count: usize = 2,
        /// Smallest fraction of a residual's power that its variable explains.
        ///
        /// Sweep: nothing changes.
        min_fraction: f64 = 0.3,
        /// Smallest ratio of residual to noise.
        ///
        /// Sweep: nothing changes.
        min_noise_ratio: f64 = 2.0,
        /// A local defect extends over the positions at which the mean residual differs from its median by more than this
        /// fraction of the maximum difference.
        ///
        /// Sweep: values in one case.
        edge: f64 = 0.02,
        /// Maximum width of a local defect, as a fraction of the travel.
        ///
        /// Sweep: nothing changes.
        max_width: f64 = 0.25,
        /// A local defect is subtracted as a bump if the bump explains at least this fraction of the mean residual over the
        /// position that is left beside a straight line.
        min_bump_fraction: f64 = 0.9,
        /// A map of the screw is a local defect if a bump explains at least this fraction of what the map describes beside a
        /// straight line.
        min_map_bump_fraction: f64 = 0.97,
        /// Largest ratio of the table's residual with a bump to that with the map. In logs of six machines with a defect it is
        /// 0.2 to 2.3; 3.9, 8 and 45 in those of three machines with a pitch error whose map resembles a bump.
        max_bump_residual: f64 = 3.0,
        /// Minimum fraction of the residual's power before the exclusion that an effect must explain in a scope with an
        /// exclusion. Smaller effects are residuals of the excluded part.
        ///
        /// Sweep: nothing changes.
        min_effect: f64 = 0.002,
    }
    /// Which effects the validation logs refute.
    validation: ValidationOptions {
        /// An effect is refuted if it costs more log-likelihood per sample than this (a tenth of the residual). On other data
        /// of the same machine, p uncertain parameters from n independent blocks cost p/(2n): 0.06 for three parameters and
        /// the 24 blocks of one log.
        ///
        /// Sweep: nothing changes.
        max_loss: f64 = 0.095,
        /// A smaller loss refutes an effect if it is significant and greater than this. Refitting the declared values
        /// changes the likelihood by this much on validation logs in which the effect is not visible.
        ///
        /// Sweep: ×0.5: the unit test of small losses fails, as it states the limit.
        min_loss: f64 = 0.005,
    }
    /// How the remaining residual is analysed and reported.
    analysis: AnalysisOptions {
        /// A residual is explained if its ratio to the noise is below this.
        ///
        /// Sweep: ×0.5: noise is reported as unexplained (unit test).
        max_noise_ratio: f64 = 1.15,
        /// A variable that explains less than this fraction of a residual's power is not named.
        ///
        /// Sweep: nothing changes in what is described.
        min_fraction: f64 = 0.1,
        /// Minimum frequency of a vibration, Hz; lower frequencies are drift.
        ///
        /// Sweep: nothing changes.
        min_frequency_hz: f64 = 2.0,
        /// Minimum number of samples per point of an empirical table.
        ///
        /// Sweep: nothing changes; only `--empirical` uses it.
        min_table_samples: usize = 8,
        /// Minimum period of a repeating command, s.
        ///
        /// Sweep: nothing changes.
        min_period_s: f64 = 0.2,
        /// Commands are equal if they differ by less than this fraction of the travel, the last digit of a log.
        ///
        /// Sweep: nothing changes.
        command_tolerance: f64 = 1e-7,
    }
    /// Whether a model describes its logs.
    verdict: VerdictOptions {
        /// Maximum ratio of residual to noise of a model that describes a log. The ratio is 29 for the measured axis EMPS, 22
        /// for a robot, and at most 25 for the demo machines, small effects outside the catalogue included. It is 100 and
        /// more for a scale that slips or sticks, a wrong sign or unit, or masses three times too large.
        ///
        /// Sweep: the unit test of gross errors fails with either, as it states the limit; ×2:
        /// `a_model_that_does_not_describe_the_log_is_reported` fails.
        max_noise_ratio: f64 = 50.0,
        /// Maximum ratio of residual to noise in the stage of an effect that is certain. A larger residual has a cause of which
        /// the effect may describe a part. It is at most 1.5 for the true effects of the nine blind cases.
        max_certain_ratio: f64 = 2.0,
        /// Minimum noise that is assumed, µm or mdeg (N or N·m): the resolution of logs.
        ///
        /// Sweep: the unit test of gross errors fails with either, as it states the limit.
        min_noise: f64 = 1e-3,
    }
}

impl SearchOptions {
    /// Gain in log-likelihood per sample of [`Self::min_reduction`]: −½·ln(1 − x) ≈ x/2.
    #[must_use]
    pub fn min_gain(&self) -> f64 {
        0.5 * self.min_reduction
    }

    /// The loss in log-likelihood per sample of a stage or of the closed loop that an effect with this gain may cause.
    #[must_use]
    pub fn tolerable_loss(&self, gain: f64) -> f64 {
        (self.max_loss * gain).min(self.max_stage_loss).max(self.min_gain())
    }
}

impl VerdictOptions {
    /// Maximum residual of a model that describes a log with this noise, in the unit of the noise.
    #[must_use]
    pub fn max_described(&self, noise: f64) -> f64 {
        self.max_noise_ratio * noise.max(self.min_noise)
    }

    /// Maximum residual of a model whose effects are certain, of a log with this noise, in the unit of the noise.
    #[must_use]
    pub fn max_certain(&self, noise: f64) -> f64 {
        self.max_certain_ratio * noise.max(self.min_noise)
    }
}

#[cfg(test)]
mod tests;
