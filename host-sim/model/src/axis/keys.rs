//! The keys of an `[axis.NAME]` table of a machine file, each declared once: documentation, name, type, range.

/// Calls the macro `$then` with the declaration of all keys, in the order in which a machine file is written.
///
/// A group is `name: Type { keys }`. A key is `name ("key"): type [range]`. `("key")` is the name in the file, if it differs
/// from that of the field; `[range]` is the range of a number.
macro_rules! axis_keys {
    ($then:ident) => {
        $then! {
            /// Position loop, velocity loop and drive.
            controller: Controller {
                /// What the position loop commands; absent: a force.
                drive: Drive,
                /// Control law of the position loop.
                law ("controller"): Option<Law>,
                /// Kp, gain of the position loop.
                position_gain_per_s: Option<f64> [Positive],
                /// Kf, velocity feed-forward; absent: none.
                feedforward_percent: Option<f64> [UpTo(200.0)],
                /// Time by which the velocity feed-forward is ahead of the command; absent: none.
                feedforward_ahead_s: Option<f64> [UpTo(0.1)],
                /// Kv, gain of the velocity loop.
                velocity_gain_n_s_per_m: Option<f64> [Positive],
                /// Ti, integral time of the velocity loop; absent: no integral part.
                velocity_integral_time_s: Option<f64> [Positive],
                /// Bandwidth of the observer of the velocity; absent: the velocity is the difference of two readings.
                velocity_observer_hz: Option<f64> [Positive],
                /// Largest force of the drive; absent: not limited.
                force_limit_n: Option<f64> [Positive],
            }
            /// The velocity gain over the command of the axis, or over its speed: points with a ratio each. Absent: it is constant.
            schedule: Schedule {
                /// Commands of the points, ascending.
                position_mm ("gain_schedule_position_mm"): Option<PerPoint>,
                /// Speeds of the points, ascending, in place of commands.
                speed_mm_per_s ("gain_schedule_speed_mm_per_s"): Option<PerPoint> [NotNegative],
                /// Velocity gain at each point over `velocity_gain_n_s_per_m`.
                ratio ("gain_schedule_ratio"): Option<PerPoint> [Positive],
            }
            /// Further terms of the position loop of LinuxCNC, its component pid, beside P (`position_gain_per_s`) and FF1
            /// (`feedforward_percent`). Its output is the velocity command. Absent: the term does not exist.
            pid: Pid {
                /// I.
                i_per_s2 ("pid_i_per_s2"): Option<f64> [NotNegative],
                /// D.
                d ("pid_d"): Option<f64> [NotNegative],
                /// FF0, feed-forward of the position.
                ff0_per_s ("pid_ff0_per_s"): Option<f64>,
                /// FF2, feed-forward of the acceleration.
                ff2_s ("pid_ff2_s"): Option<f64>,
                /// Constant part of the output.
                bias_mm_per_s ("pid_bias_mm_per_s"): Option<f64>,
                /// Error that is taken as none.
                deadband_um ("pid_deadband_um"): Option<f64> [Positive],
                /// maxerror, largest error.
                max_error_mm ("pid_max_error_mm"): Option<f64> [Positive],
                /// maxerrorI, largest integral of the error.
                max_error_i_mm_s ("pid_max_error_i_mm_s"): Option<f64> [Positive],
                /// maxerrorD, largest derivative of the error.
                max_error_d_mm_per_s ("pid_max_error_d_mm_per_s"): Option<f64> [Positive],
                /// maxoutput, largest velocity command.
                max_output_mm_per_s ("pid_max_output_mm_per_s"): Option<f64> [Positive],
            }
            /// Filter of the path, and filters of the force.
            filters: Filters {
                /// Window of the moving average over the path; absent: the path is not filtered.
                smoothing_s: Option<f64> [Positive],
                /// Second, shorter window, which limits the jerk.
                smoothing_jerk_s: Option<f64> [Positive],
                /// Time constant of a first-order lag of the path, in place of the two windows.
                smoothing_time_constant_s: Option<f64> [Positive],
                /// Centre of each notch on the force; absent: no notch.
                notch_frequency_hz: Option<PerNotch> [Positive],
                /// Width of each notch between its −3 dB points at full depth.
                notch_width_hz: Option<PerNotch> [Positive],
                /// Fraction of the amplitude that each notch removes at its centre; 1: all.
                notch_depth: Option<PerNotch> [UpTo(1.0)],
                /// Corner of a second-order low-pass on the force; absent: no low-pass.
                low_pass_frequency_hz: Option<f64> [Positive],
                /// ζ of the low-pass.
                low_pass_damping_ratio: Option<f64> [Positive],
            }
            /// Limits at which the path stops or the drives are switched off.
            limits: Limits {
                /// Smallest and largest command. At a command outside, the path stops. Absent: not monitored.
                travel_mm: Option<[f64; 2]>,
                /// Largest difference of command and reading. If exceeded, the drives are switched off. Absent: 130 mm.
                following_error_limit_mm: Option<f64> [Positive],
                /// Deceleration of a stop along the path; absent: 2 m/s².
                stop_deceleration_m_per_s2: Option<f64> [Positive],
                /// Time at the force limit after which the path stops; absent: 1 s.
                saturation_time_s: Option<f64> [Positive],
                /// Largest difference of motor and table reading. If exceeded, the drives are switched off. Absent: 0.5 mm with
                /// a scale in the loop, otherwise not monitored.
                scale_disagreement_limit_mm: Option<f64> [UpTo(1e3 * TRAVEL_LIMIT_M)],
                /// Largest speed of the motor reading. If exceeded, the drives are switched off. Absent: not monitored.
                fastest_mm_per_s: Option<f64> [Positive],
                /// Travel of the command with an unchanged motor reading, after which the drives are switched off. With a scale
                /// in the loop also the travel of one of motor and table while the other stands, and at most 0.5 mm. Absent:
                /// 0.4 mm with a scale in the loop, otherwise not monitored.
                frozen_encoder_limit_mm: Option<f64> [Positive],
            }
            /// What holds an axis that moves without its drive.
            holding: Holding {
                /// Force with which the drive comes on, signed: the weight of a vertical axis. Absent: not known; it starts from zero.
                preload_n: Option<f64>,
                /// Time from the output of the board until the brake is open; absent: no brake.
                brake_release_s: Option<f64> [UpTo(Brake::LONGEST_S)],
                /// Time from the output of the board until the brake holds the axis.
                brake_engage_s: Option<f64> [UpTo(Brake::LONGEST_S)],
            }
            /// The gantry of which the axis is the second motor: it has the command of the first.
            gantry: Gantry {
                /// Name of the axis of the first motor; absent: the axis has a command of its own.
                gantry_with: Option<AxisName>,
                /// Largest skew. If exceeded, the drives are switched off.
                gantry_skew_limit_mm: Option<f64> [UpTo(1e3 * GantrySettings::MOST_SKEW_M)],
                /// Position of the reference of the second motor less that of the first on a square beam; absent: 0.
                gantry_offset_mm: Option<f64>,
            }
            /// Masses, drive train and friction.
            mechanics: Mechanics {
                /// Motor and screw, reflected to the table.
                motor_mass_kg: Option<f64> [NotNegative],
                /// Table and workpiece.
                table_mass_kg: Option<f64> [NotNegative],
                /// Stiffness between motor and table; absent: rigid, one mass.
                stiffness_n_per_um: Option<f64> [Positive],
                /// Damping between motor and table.
                damping_n_s_per_m: Option<f64> [NotNegative],
                /// Coulomb friction of the table.
                coulomb_n: Option<f64> [NotNegative],
                /// Viscous friction of the table.
                viscous_n_s_per_m: Option<f64> [NotNegative],
                /// Coulomb friction of the motor; multiplied by tanh(v / 0.2 mm/s).
                motor_coulomb_n: Option<f64> [NotNegative],
                /// σ0 of the table's friction (`LuGre`); absent: no presliding.
                presliding_stiffness_n_per_um: Option<f64> [Positive],
                /// σ1 of the table's friction (`LuGre`).
                presliding_damping_n_s_per_m: Option<f64> [NotNegative],
                /// Friction of the table as a published curve, in place of `coulomb_n`.
                friction_curve: Option<Curve>,
                /// Tolerance of the declared mechanical values; absent: 0.
                plant_tolerance_percent: Option<f64> [UpTo(100.0)],
                /// Tolerances of single values, in place of that of all, and of settings of the controller, which are otherwise exact.
                tolerance_percent: Option<Tolerances>,
                /// Travel per turn of the screw.
                lead_mm: Option<f64> [Positive],
                /// Full steps of a stepper motor per turn; absent: 200.
                full_steps_per_turn: Option<u32> [Positive],
            }
            /// Position sensors and position feedback.
            sensors: Sensors {
                /// Electrical periods per turn of the resolver.
                resolver_pole_pairs: Option<u32> [Positive],
                /// Position feedback of the position loop.
                feedback: Feedback,
                /// Time constant of the low-pass of dual feedback.
                dual_feedback_time_constant_s: Option<f64> [Positive],
            }
        }
    };
}

pub(crate) use axis_keys;
