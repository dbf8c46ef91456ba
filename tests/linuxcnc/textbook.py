"""The table behind a motor by textbook formulas, for cases without the simulated machine."""

import math

GAP_UM = {"x": 10.0, "y": 6.0}


def screw_um(axis, x):
    """Pitch error of the screw at a position, mm: a slope of 150 µm/m and a wave of 8 µm over 160 mm; y has none."""
    return 0.15 * x + 8.0 * math.sin(2.0 * math.pi * x / 160.0 + 0.4) if axis == "x" else 0.0


def tables_mm(axis, motors_mm):
    """The tables behind screw and gap: the nut stays where it is until the screw takes it along."""
    behind = None
    half = 5e-4 * GAP_UM[axis]
    for motor in motors_mm:
        screw = motor + 1e-3 * screw_um(axis, motor)
        behind = screw if behind is None else min(max(behind, screw - half), screw + half)
        yield behind
