"""The machines that LinuxCNC moves: their drives, errors, gains, and what is known of them.

A case has: `drive`, a HAL file; `feedback`, what the loop is closed on; `ini`, lines of both joints; `truth`, the machine file of the
simulated machine, or None: the motors follow their commands, and the screw is computed by the formulas of textbook.py; `known`, the machine
file that the tracer gets; `has_init`: first through `init`; `ratio`, the least ratio of the contour errors before and after.
"""

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


def rigid(coulomb_n):
    """Motors of 1 kg with tables of 20 kg on stiff screws."""
    return {axis: {"motor_mass_kg": 5.0, "table_mass_kg": 20.0, "stiffness_n_per_um": 200.0, "damping_n_s_per_m": 20000.0,
                   "coulomb_n": coulomb_n, "viscous_n_s_per_m": 100.0, "presliding_stiffness_n_per_um": 10.0,
                   "presliding_damping_n_s_per_m": 500.0} for axis in ("x", "y")}


STEPPERS = machine({"velocity_loop_rate_hz": 20000.0},
                   {"controller": "p", "position_gain_per_s": 800.0, "feedforward_percent": 100.0,
                    "velocity_gain_n_s_per_m": 40000.0, "feedback": "motor"}, rigid(30.0), effects=PITCH + GAPS)
# A time constant of 4 ms.
VELOCITY_LOOP = {"controller": "p", "position_gain_per_s": 50.0, "feedforward_percent": 100.0, "velocity_gain_n_s_per_m": 62500.0,
                 "velocity_integral_time_s": 0.016, "feedback": "motor"}
QUICK = {"velocity_loop_rate_hz": 4000.0}
TORQUE_LOOP = {"controller": "p", "position_gain_per_s": 50.0, "feedforward_percent": 100.0, "velocity_gain_n_s_per_m": 60000.0,
               "velocity_integral_time_s": 0.016}
TORQUE_INI = {"P": 50.0, "FF1": 1.0, "FF2": 0.0, "VELOCITY_P": 60.0, "VELOCITY_I": 3750.0, "FORCE_FF1": 0.0, "FORCE_FF2": 0.0,
              "FRICTION": 0.0, "FRICTION_PER_MM": 0.0, "MOTOR_FRICTION": 0.0, "MOTOR_FRICTION_FF1": 0.0}
VELOCITY_INI = {"P": 50.0, "FF1": 1.0, "FF2": 0.0, "FRICTION": 0.0, "FRICTION_PER_MM": 0.0, "FRICTION_DECAY": 0.0}
KNOWN_VELOCITY = {"drive": "velocity", "position_gain_per_s": 50.0, "feedforward_percent": 100.0}
NOTHING = {"x": {}, "y": {}}
TOLERANCE = {"plant_tolerance_percent": 10.0}


def case(name, drive, ini, truth, known, effects, feedback="motor", has_init=False, ratio=4.0, p_share=1.0):
    return {"name": name, "drive": drive, "ini": ini, "truth": truth, "known": known, "effects": effects, "feedback": feedback,
            "has_init": has_init, "ratio": ratio, "p_share": p_share}


CASES = [
    case("steppers by formulas", "loopback", {}, None, machine({}, {"drive": "stepper"}), ["pitch_map", "backlash"], has_init=True),
    case("steppers", "steppers", {}, STEPPERS, machine({}, {"drive": "stepper"}), ["pitch_map", "backlash", "reversal_friction"]),
    case("velocity drives", "velocity-drives", VELOCITY_INI,
         machine(QUICK, VELOCITY_LOOP, MASSES, VISCOUS, FRICTION, effects=PITCH + GAPS), machine({}, KNOWN_VELOCITY),
         ["pitch_map", "backlash", "reversal_friction"], has_init=True),
    case("velocity drives on the scale", "velocity-drives", VELOCITY_INI,
         machine(QUICK, VELOCITY_LOOP, MASSES, VISCOUS, FRICTION, effects=PITCH + GAPS),
         machine({}, KNOWN_VELOCITY | {"feedback": "table"}), ["pitch_map", "backlash", "reversal_friction"], feedback="scale"),
    case("no feed-forward", "velocity-drives", VELOCITY_INI | {"FF1": 0.0},
         machine(QUICK, VELOCITY_LOOP, MASSES, VISCOUS, FRICTION), machine({}, KNOWN_VELOCITY | {"feedforward_percent": 0.0}),
         ["missing_feedforward"], has_init=True),
    case("low gain", "velocity-drives", VELOCITY_INI | {"FF1": 0.6},
         machine(QUICK, VELOCITY_LOOP, MASSES, VISCOUS, FRICTION), machine({}, KNOWN_VELOCITY | {"feedforward_percent": 60.0}),
         ["low_gain"], p_share=0.7),
    case("torque drives, friction", "torque-drives", TORQUE_INI, machine({}, TORQUE_LOOP | {"feedback": "motor"}, MASSES, VISCOUS, FRICTION),
         machine({}, TORQUE_LOOP | {"feedback": "motor"}, MASSES), ["reversal_friction"], has_init=True, ratio=2.0),
    case("torque drives", "torque-drives", TORQUE_INI,
         machine({}, TORQUE_LOOP | {"feedback": "motor"}, MASSES, VISCOUS, FRICTION, effects=PITCH + GAPS),
         machine({}, TORQUE_LOOP | {"feedback": "motor"}), ["pitch_map", "backlash", "reversal_friction"], has_init=True),
    case("torque drives on the scale", "torque-drives", TORQUE_INI,
         machine({}, TORQUE_LOOP | {"feedback": "table"}, MASSES, VISCOUS, FRICTION, effects=PITCH + GAPS),
         machine({}, TORQUE_LOOP | {"feedback": "table"}, MASSES), ["pitch_map", "backlash", "reversal_friction"], feedback="scale",
         has_init=True),
]
