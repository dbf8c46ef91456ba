//! Every threshold by which a trace decides.
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
//!   measured data (`tests/tests/measured_data.rs`: the axis EMPS, a robot, a lead screw) and on corrupted logs
//!   (`tests/tests/corrupted.rs`). A test is named if it fails.

mod declaration;

use declaration::{Scale, options};

options! {
    /// Which logs are taken.
    admission: AdmissionOptions {
        /// Largest relative difference of two sample rates that are taken as equal: times are printed rounded, and any
        /// other rate differs by far more than a per mille.
        ///
        /// Sweep: nothing changes.
        rate_tolerance: f64 = 1e-3,
        /// Most samples of all fit logs together, and of all validation logs: a fit keeps about 50 numbers a sample and
        /// axis, and takes seconds for each 100 000.
        ///
        /// Sweep: the unit test of a long log fails with either; the cases are shorter.
        max_samples: usize = 204_000,
        /// Fewest samples of a log that a model can be fitted to.
        ///
        /// Sweep: nothing changes.
        min_samples: usize = 200,
        /// Shortest travel that is more than presliding and noise, mm or degrees.
        ///
        /// Sweep: the unit test of a log without motion fails with either, as its message states the limit.
        min_travel_mm: f64 = 0.01,
        /// Longest travel, mm or degrees: more is a wrong unit.
        ///
        /// Sweep: nothing changes.
        max_travel_mm: f64 = 1e6,
        /// A sensor is defective that does not move while another travels farther than this, mm or degrees: no backlash is
        /// as wide.
        ///
        /// Sweep: nothing changes.
        max_travel_beside_stuck_mm: f64 = 1.0,
        /// Number of consecutive rows that are compared to find copies: coarse encoders on the same motion give the same
        /// reading in single rows by chance, but hardly in so many in sequence.
        ///
        /// Sweep: ×0.5 and ×2: `a_log_with_rows_or_a_channel_removed_is_a_copy` fails.
        copied_rows: usize = 16,
        /// A log is a copy of another if it shares more than this fraction of its rows in motion.
        ///
        /// Sweep: ×0.5: a log that shares less than half is refused; ×2: copies are accepted (three tests).
        max_shared: f64 = 0.5,
        /// A force counts as saturated from this fraction of its limit on, as the reading has noise.
        ///
        /// Sweep: ×0.5: samples at half the limit count as saturated (two tests); ×2: saturation is never detected.
        saturation: f64 = 0.99,
        /// A log is refused if more than this fraction of its samples is saturated.
        ///
        /// Sweep: ×0.5 and ×2: `a_saturated_force_is_excluded_or_refused` fails.
        max_saturated: f64 = 0.5,
        /// Fraction at the end of each log that is held out where no validation log is given.
        ///
        /// Sweep: ×0.5: `the_stiffness_of_a_gear_is_found_from_torque_and_two_encoders` fails; ×2: nothing changes.
        held_out: f64 = 0.25,
    }
    /// How signals are filtered, which samples count, and what is known of the start of a log.
    samples: SampleOptions {
        /// Half width of the smoothing window of the signals, s: the filter passes the bandwidth of a servo loop and removes
        /// the sensor's noise from velocities.
        ///
        /// Sweep: values in all cases. ×0.5: two more 95 % intervals miss the truth; ×2:
        /// `a_saturated_force_is_excluded_or_refused` fails.
        smoothing_s: f64 = 0.005,
        /// Settling time at the start of a log that is left out, s: the state before the log is not known.
        ///
        /// Sweep: values in all cases. ×2: one more interval misses the truth. Unit tests on the length of the
        /// evaluated log fail with either.
        settling_s: f64 = 0.3,
        /// Shortest standstill, s; a reversal passes through velocity zero in less.
        ///
        /// Sweep: values in all cases; one more interval misses the truth with either. Measured data: nothing
        /// changes.
        min_standstill_s: f64 = 0.05,
        /// Greatest velocity in a standstill, m/s.
        ///
        /// Sweep: values in all cases. ×2: one more interval misses the truth.
        max_standstill_m_per_s: f64 = 10e-6,
        /// The same, in standard deviations of the noise of a difference of two filtered positions; the greater holds.
        ///
        /// Sweep: values in 11 cases. ×2: one more interval misses the truth.
        max_standstill_noise: f64 = 4.0,
        /// Number of samples over which a command must be constant to show that the controller was just switched on.
        ///
        /// Sweep: values in one case. Measured data: nothing changes.
        constant_command: usize = 20,
        /// A motor moves under such a command if it does so by this many standard deviations of its noise.
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
        /// How far the motor stage may change a mass that was fitted to the force, as a fraction of all masses: the error
        /// of the force stage's filter and of the simulation's step.
        ///
        /// Sweep: values in 10 cases with ×0.5, in 2 with ×2.
        mass_trim: f64 = 0.01,
        /// Greatest error of the instants at which table and tool are read, and longest step of the controller's filter,
        /// samples.
        ///
        /// Sweep: values in all cases. `an_effect_replaces_a_trim` fails with either, as it states the bound.
        position_trim: f64 = 0.1,
        /// Greatest error of the instant of a force, which is the mean over an interval, samples.
        ///
        /// Sweep: values in all cases.
        force_trim: f64 = 0.25,
        /// Greatest age of the velocity in the velocity loop, ticks of that loop.
        ///
        /// Sweep: values in all cases. `an_effect_replaces_a_trim` fails with either, as it states the bound.
        velocity_trim: f64 = 0.25,
        /// How early a drive's force may act, ticks of the velocity loop.
        ///
        /// Sweep: values in all cases. ×0.5: one more interval contains the truth.
        drive_trim: f64 = 0.15,
        /// Standard deviation of the prior of these errors, as a fraction of the greatest.
        ///
        /// Sweep: values in all cases.
        trim_prior: f64 = 0.5,
        /// A model in a file that an earlier trace wrote is only replaced by a fit that lowers the residuals by this
        /// fraction in all: from another start a fit ends elsewhere along poorly determined parameters, where a motor stage
        /// at its noise differs by up to 4 %.
        ///
        /// Sweep: nothing changes: no machine file of the cases was written by a trace.
        min_gain_of_refit: f64 = 0.05,
    }
    /// Which effects are added.
    search: SearchOptions {
        /// Most effects that one scope may gain.
        ///
        /// Sweep: ×0.5: the two tests of EMPS fail; ×2: nothing changes.
        max_effects: usize = 10,
        /// Most candidates of a round that get a full fit.
        ///
        /// Sweep: ×0.5: `the_trace_of_emps_matches_the_readme` fails; ×2: nothing changes.
        fitted_candidates: usize = 4,
        /// A candidate gets a full fit if its linear step gains this fraction of what [`Self::min_reduction`] is. Of 800
        /// candidates of 30 traces, none that was supported in the end had less than four times as much.
        ///
        /// Sweep: ×0.5: nothing changes; ×2: `emps_has_no_stribeck_effect` fails.
        promising: f64 = 0.25,
        /// Smallest fraction of Σr² of some stage that a candidate must remove from held-out data.
        ///
        /// Sweep: ×0.5: `the_trace_of_emps_matches_the_readme` fails; ×2: so does `emps_has_no_stribeck_effect`.
        min_reduction: f64 = 0.04,
        /// Smallest gain, in standard errors over the blocks of the logs. With about thirty candidates a round, a normal
        /// deviate exceeds 3.5 by chance in one round of a hundred; blocks are few and their errors have long tails, so
        /// that machines that lack no effect are tested besides.
        ///
        /// Sweep: ×0.5: `the_trace_of_emps_matches_the_readme` and the unit test of `force_windup` fail; ×2:
        /// `the_trace_of_emps_matches_the_readme` and `the_robot_has_latency_and_windup` fail.
        min_t: f64 = 3.5,
        /// Number of standard errors below which a difference of two models may be chance.
        ///
        /// Sweep: nothing changes.
        chance_t: f64 = 2.0,
        /// Fewest counting samples of a block that contributes to a standard error.
        ///
        /// Sweep: nothing changes.
        min_block_samples: usize = 20,
        /// Largest loss of a stage of a log, and of the closed loop by an effect found in table and force, as a fraction
        /// of the gain of all stages; half of [`Self::min_reduction`] is tolerated in any case.
        ///
        /// Sweep: nothing changes, nor did a separate limit of 0.25 for the closed loop when halved or doubled.
        max_loss: f64 = 0.1,
        /// From this ratio of residual to noise on, candidates start from the nominal values: an effect so large has
        /// driven the declared values to their bounds.
        ///
        /// Sweep: values in one case.
        min_gross_ratio: f64 = 20.0,
        /// Smallest gain in log-likelihood a sample of a candidate that is reported although it was not added.
        ///
        /// Sweep: nothing changes in what is found.
        min_reported_gain: f64 = 0.2,
    }
    /// What is excluded from residuals because no effect describes it.
    exclusion: ExclusionOptions {
        /// Most exclusions of a scope.
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
        /// A local defect extends as far as the mean residual differs from its median by more than this fraction of the
        /// greatest difference.
        ///
        /// Sweep: values in one case.
        edge: f64 = 0.02,
        /// Widest local defect, as a fraction of the travel.
        ///
        /// Sweep: nothing changes.
        max_width: f64 = 0.6,
        /// An effect beside an exclusion must explain more than this fraction of the power without the exclusion: smaller
        /// ones are remains of what was excluded.
        ///
        /// Sweep: nothing changes.
        min_effect: f64 = 0.002,
    }
    /// Which effects the validation logs refute.
    validation: ValidationOptions {
        /// An effect is refuted that costs more log-likelihood a sample than this, which is a tenth of the residual: p
        /// uncertain parameters from n independent blocks cost p/(2n) on other data of the same machine, 0.06 for three
        /// parameters and the 24 blocks of one log.
        ///
        /// Sweep: nothing changes.
        max_loss: f64 = 0.095,
        /// A smaller loss refutes an effect if it is beyond chance and greater than this, which is the change by fitting
        /// the declared values again where the validation logs do not show the effect at all.
        ///
        /// Sweep: ×0.5: the unit test of small losses fails, as it states the limit.
        min_loss: f64 = 0.005,
    }
    /// What remains, and how it is reported.
    analysis: AnalysisOptions {
        /// A residual below this ratio to its noise is explained.
        ///
        /// Sweep: ×0.5: noise is reported as unexplained (unit test).
        max_noise_ratio: f64 = 1.15,
        /// A variable that explains less than this fraction of a residual's power is not named.
        ///
        /// Sweep: nothing changes in what is described.
        min_fraction: f64 = 0.1,
        /// Lowest frequency of a vibration, Hz: below is drift.
        ///
        /// Sweep: nothing changes.
        min_frequency_hz: f64 = 2.0,
        /// Velocity below which the direction is noise, m/s.
        ///
        /// Sweep: nothing changes.
        min_direction_m_per_s: f64 = 1e-4,
        /// Fewest samples of a point of an empirical table.
        ///
        /// Sweep: nothing changes; only `--empirical` uses it.
        min_table_samples: usize = 8,
        /// Shortest period after which a command repeats, s.
        ///
        /// Sweep: nothing changes.
        min_period_s: f64 = 0.2,
        /// Two commands are equal within this fraction of the travel: the last digit of a log.
        ///
        /// Sweep: nothing changes.
        command_tolerance: f64 = 1e-7,
    }
    /// Whether a model describes its logs.
    verdict: VerdictOptions {
        /// Largest ratio of residual to noise of a model that describes a log. Machines that are described leave less, even
        /// with small effects outside the catalogue: the measured axis EMPS 29, a robot 22, the demo machines at most 25.
        /// Logs with a scale that slips or sticks, a wrong sign or unit, or masses three times too large leave 100 and
        /// more.
        ///
        /// Sweep: the unit test of gross errors fails with either, as it states the limit; ×2:
        /// `a_model_that_does_not_describe_the_log_is_reported` fails.
        max_noise_ratio: f64 = 50.0,
        /// Smallest noise that is assumed, µm or mdeg (N or N·m): no log is finer.
        ///
        /// Sweep: the unit test of gross errors fails with either, as it states the limit.
        min_noise: f64 = 1e-3,
    }
}

impl SearchOptions {
    /// Gain in log-likelihood a sample of [`Self::min_reduction`]: −½·ln(1 − x) ≈ x/2.
    #[must_use]
    pub fn min_gain(&self) -> f64 {
        0.5 * self.min_reduction
    }
}

impl VerdictOptions {
    /// Largest residual of a model that describes a log with this noise, in the unit of the noise.
    #[must_use]
    pub fn max_described(&self, noise: f64) -> f64 {
        self.max_noise_ratio * noise.max(self.min_noise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_option_is_scaled_by_its_name_alone() {
        let default = TraceOptions::default();
        let doubled = default.scaled("search.min_t", 2.0).unwrap();
        assert_eq!(doubled.search.min_t.to_bits(), 7.0f64.to_bits());
        assert_eq!(doubled.scaled("search.min_t", 0.5), Some(default));
        assert_eq!(default.scaled("min_t", 2.0), None);
        for name in TraceOptions::NAMES {
            assert_ne!(default.scaled(name, 2.0).unwrap(), default, "{name}");
            assert_ne!(default.scaled(name, 2.0).unwrap().value(name), default.value(name));
        }
    }

    #[test]
    fn a_count_is_rounded_and_at_least_one() {
        let options = TraceOptions::default();
        assert_eq!(options.scaled("exclusion.max_count", 0.1).unwrap().exclusion.max_count, 1);
        assert_eq!(options.scaled("search.fitted_candidates", 0.6).unwrap().search.fitted_candidates, 2);
    }
}
