"""The machines that LinuxCNC moves: their drives, errors, gains, and what is known of them."""

import dataclasses


@dataclasses.dataclass
class Case:
    """A machine, what the tracer knows of it, and what is expected."""

    name: str
    # HAL file of the drives, and of what their loops are closed on.
    drive: str
    # The machine file of the simulated machine; None: the motors follow their commands, and formulas of textbook.py are the screws.
    truth: str | None
    # The machine file that the tracer gets, first through `init` if so.
    known: str
    has_init: bool
    # What `truth` has and `known` lacks.
    effects: list
    # Lines of both joints in the INI file.
    ini: dict = dataclasses.field(default_factory=dict)
    feedback: str = "motor"
    # Least ratio of the contour errors before and after.
    ratio: float = 4.0
    # How much of P reaches the drives.
    p_share: float = 1.0
    # An earlier case of the same drives, closed on the motors: its model is compensated. On the scale, a loop does not show the friction.
    model_of: str | None = None


# Screws: a slope of 150 µm/m with a wave of 8 µm over 160 mm, and gaps.
PITCH = """[[axis.x.effect]]
name = "pitch_progressive"
slope_um_per_m = 150.0
[[axis.x.effect]]
name = "pitch_cyclic"
amplitude_um = 8.0
period_mm = 160.0
phase_rad = 0.0
"""
GAPS = """[[axis.x.effect]]
name = "backlash"
width_um = 10.0
[[axis.y.effect]]
name = "backlash"
width_um = 6.0
"""

MASSES = {"x": {"motor_mass_kg": 90.0, "table_mass_kg": 160.0, "stiffness_n_per_um": 400.0, "damping_n_s_per_m": 60000.0},
          "y": {"motor_mass_kg": 110.0, "table_mass_kg": 120.0, "stiffness_n_per_um": 400.0, "damping_n_s_per_m": 60000.0}}
VISCOUS = {"x": {"viscous_n_s_per_m": 1000.0}, "y": {"viscous_n_s_per_m": 900.0}}
FRICTION = {"x": {"coulomb_n": 180.0, "presliding_stiffness_n_per_um": 40.0, "presliding_damping_n_s_per_m": 2000.0,
                  "motor_coulomb_n": 30.0},
            "y": {"coulomb_n": 150.0, "presliding_stiffness_n_per_um": 40.0, "presliding_damping_n_s_per_m": 2000.0,
                  "motor_coulomb_n": 35.0}}


def machine(rates, axes, *tables, effects=""):
    """A machine file: top-level keys, keys of both axes, and tables of keys for each axis."""
    text = 'name = "mill"\n' + lines({"sample_rate_hz": 1000.0, **rates})
    for axis in ("x", "y"):
        keys = dict(axes)
        for table in tables:
            keys.update(table[axis])
        text += f"[axis.{axis}]\n" + lines(keys)
    return text + effects


def lines(keys):
    return "".join(f"{key} = {value!r}\n".replace("'", '"') for key, value in keys.items())


# Time constants of 4 ms.
VELOCITY_LOOP = {"controller": "p", "position_gain_per_s": 50.0, "feedforward_percent": 100.0, "velocity_gain_n_s_per_m": 62500.0,
                 "velocity_integral_time_s": 0.016, "feedback": "motor"}
# Of a torque drive, this is LinuxCNC's own: P and FF1 of the first pid, VELOCITY_P and VELOCITY_I of the second.
TORQUE_LOOP = {"controller": "p", "position_gain_per_s": 50.0, "feedforward_percent": 100.0, "velocity_gain_n_s_per_m": 60000.0,
               "velocity_integral_time_s": 0.016}
ON_MOTOR, ON_SCALE = ({"feedback": feedback} for feedback in ("motor", "table"))
VELOCITY_INI = {"P": 50.0, "FF1": 1.0, "FF2": 0.0, "FRICTION": 0.0, "FRICTION_PER_MM": 0.0, "FRICTION_DECAY": 0.0}
TORQUE_INI = {"P": 50.0, "FF1": 1.0, "FF2": 0.0, "VELOCITY_P": 60.0, "VELOCITY_I": 3750.0, "FORCE_FF1": 0.0, "FORCE_FF2": 0.0,
              "FRICTION": 0.0, "FRICTION_PER_MM": 0.0, "MOTOR_FRICTION": 0.0, "MOTOR_FRICTION_FF1": 0.0}


def steppers(errors):
    """Small axes."""
    return machine({"velocity_loop_rate_hz": 20000.0},
                   {"controller": "p", "position_gain_per_s": 800.0, "feedforward_percent": 100.0,
                    "velocity_gain_n_s_per_m": 40000.0, "feedback": "motor",
                    "motor_mass_kg": 5.0, "table_mass_kg": 20.0, "stiffness_n_per_um": 200.0, "damping_n_s_per_m": 20000.0,
                    "coulomb_n": 30.0, "viscous_n_s_per_m": 100.0, "presliding_stiffness_n_per_um": 10.0,
                    "presliding_damping_n_s_per_m": 500.0}, effects=errors)


def velocity_drives(errors):
    return machine({"velocity_loop_rate_hz": 4000.0}, VELOCITY_LOOP, MASSES, VISCOUS, FRICTION, effects=errors)


def torque_drives(feedback, errors=""):
    return machine({}, TORQUE_LOOP | feedback, MASSES, VISCOUS, FRICTION, effects=errors)


def known_velocity(percent, **keys):
    return machine({}, {"drive": "velocity", "position_gain_per_s": 50.0, "feedforward_percent": percent, **keys})


KNOWN_STEPPERS = machine({}, {"drive": "stepper"})
SCREWS = ["pitch_map", "backlash"]
FRICTIONS = ["reversal_friction"]

CASES = [
    Case("torque drives, friction", "torque-drives", torque_drives(ON_MOTOR), machine({}, TORQUE_LOOP | ON_MOTOR, MASSES), True,
         FRICTIONS, TORQUE_INI, ratio=2.0),
    Case("torque drives", "torque-drives", torque_drives(ON_MOTOR, PITCH + GAPS), machine({}, TORQUE_LOOP | ON_MOTOR), True,
         SCREWS + FRICTIONS, TORQUE_INI),
    Case("torque drives on the scale", "torque-drives", torque_drives(ON_SCALE, PITCH + GAPS),
         machine({}, TORQUE_LOOP | ON_SCALE, MASSES), True, SCREWS + FRICTIONS, TORQUE_INI, "scale"),
    Case("velocity drives", "velocity-drives", velocity_drives(PITCH + GAPS), known_velocity(100.0), True, SCREWS + FRICTIONS, VELOCITY_INI),
    Case("velocity drives on the scale", "velocity-drives", velocity_drives(PITCH + GAPS), known_velocity(100.0, feedback="table"), False,
         SCREWS + FRICTIONS, VELOCITY_INI, "scale", model_of="velocity drives"),
    Case("velocity drives, no feed-forward", "velocity-drives", velocity_drives(""), known_velocity(0.0), True,
         ["missing_feedforward"] + FRICTIONS, VELOCITY_INI | {"FF1": 0.0}),
    Case("velocity drives, low gain", "velocity-drives", velocity_drives(""), known_velocity(60.0), False, ["low_gain"] + FRICTIONS,
         VELOCITY_INI | {"FF1": 0.6}, p_share=0.7),
    Case("steppers, pitch", "steppers", steppers(PITCH), KNOWN_STEPPERS, False, ["pitch_map"] + FRICTIONS),
    Case("steppers, gaps", "steppers", steppers(GAPS), KNOWN_STEPPERS, False, ["backlash"] + FRICTIONS, ratio=2.0),
    Case("steppers", "steppers", steppers(PITCH + GAPS), KNOWN_STEPPERS, False, SCREWS + FRICTIONS),
    Case("steppers by formulas", "loopback", None, KNOWN_STEPPERS, True, SCREWS),
]
