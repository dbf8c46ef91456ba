"""Speed of other programs with the job of ../speed: two axes of two masses, 20 kHz ticks, one core.

numba   A compiled loop with the equations of ../speed/plain.rs: the command (a circle of 50 mm at 100 mm/s by sine and
        cosine), P position loop, velocity feed-forward and PI velocity loop with limit in every tick, and LuGre
        friction; semi-implicit Euler steps.
MuJoCo  Two slide joints per axis with a spring tendon between them; MuJoCo's Euler integrator. No controller: a constant
        force keeps the tables at 100 mm/s. No LuGre friction: frictionloss (Coulomb) and joint damping instead. All steps
        of a lap are one call, so that no time is spent in Python.

Laps are those of ../speed; a figure is the 10 % quantile of the laps.
"""

import math
import sys
from time import perf_counter_ns

TICK_HZ = 20_000.0
LAP = 2000
LAPS = 300

RADIUS = 0.05
FEED = 0.1
# Acceleration along the circle: 15/16 of 2 m/s2, minus (as vectors) the centripetal part.
RAMP_S = FEED / math.sqrt((2.0 * 15.0 / 16.0) ** 2 - (FEED * FEED / RADIUS) ** 2)

KP = 50.0
LEAD = 0.6 * TICK_HZ / KP
KV = 60_000.0
KI = KV / (TICK_HZ * 0.016)
LIMIT = 20_000.0

MOTOR = 90.0
TABLE = 160.0
STIFFNESS = 200e6
DAMPING = 1e4
COULOMB = 180.0
VISCOUS = 1000.0
BRISTLE_STIFFNESS = 40e6
BRISTLE_DAMPING = 2000.0

# Rows of the state of the compiled loop; a column per axis.
COMMAND, LAST_MOTOR, INTEGRAL, MOTOR_X, MOTOR_V, TABLE_X, TABLE_V, BRISTLE = range(8)


def lap(state, first, ticks, steps):
    """Ticks of the compiled loop; `first` is the number of the first one."""
    h = 1.0 / (TICK_HZ * steps)
    command = [0.0, 0.0]
    force = [0.0, 0.0]
    for tick in range(first, first + ticks):
        time = (tick + 1) / TICK_HZ
        travel = FEED / RAMP_S * time * time / 2.0 if time < RAMP_S else FEED * (time - RAMP_S / 2.0)
        command[0] = RADIUS * math.cos(travel / RADIUS)
        command[1] = RADIUS * math.sin(travel / RADIUS)
        for i in range(2):
            lead = LEAD * (command[i] - state[COMMAND, i])
            velocity_command = KP * (command[i] - state[MOTOR_X, i] + lead)
            error = velocity_command - TICK_HZ * (state[MOTOR_X, i] - state[LAST_MOTOR, i])
            integral = state[INTEGRAL, i] + KI * error
            wanted = KV * error + integral
            force[i] = min(max(wanted, -LIMIT), LIMIT)
            if abs(wanted) <= LIMIT or (error > 0.0) != (wanted > 0.0):
                state[INTEGRAL, i] = integral
            state[COMMAND, i] = command[i]
            state[LAST_MOTOR, i] = state[MOTOR_X, i]
        for _ in range(steps):
            for i in range(2):
                v, z = state[TABLE_V, i], state[BRISTLE, i]
                screw = STIFFNESS * (state[MOTOR_X, i] - state[TABLE_X, i]) + DAMPING * (state[MOTOR_V, i] - v)
                bristle_rate = v - BRISTLE_STIFFNESS / COULOMB * abs(v) * z
                friction = BRISTLE_STIFFNESS * z + BRISTLE_DAMPING * bristle_rate + VISCOUS * v
                state[MOTOR_V, i] += h / MOTOR * (force[i] - screw)
                state[TABLE_V, i] += h / TABLE * (screw - friction)
                state[MOTOR_X, i] += h * state[MOTOR_V, i]
                state[TABLE_X, i] += h * state[TABLE_V, i]
                state[BRISTLE, i] += h * bristle_rate


def model(steps):
    """The plant as a MuJoCo model."""

    def axis(name, direction):
        return f"""
        <body><inertial pos="0 0 0" mass="{MOTOR}" diaginertia="1 1 1"/>
          <joint name="motor_{name}" type="slide" axis="{direction}"/></body>
        <body><inertial pos="0 0 0" mass="{TABLE}" diaginertia="1 1 1"/>
          <joint name="table_{name}" type="slide" axis="{direction}" damping="{VISCOUS}" frictionloss="{COULOMB}"/>
        </body>"""

    def screw(name):
        return f"""
        <fixed stiffness="{STIFFNESS}" damping="{DAMPING}" springlength="0">
          <joint joint="motor_{name}" coef="1"/><joint joint="table_{name}" coef="-1"/></fixed>"""

    return f"""
    <mujoco>
      <option timestep="{1.0 / (TICK_HZ * steps)!r}" integrator="Euler" gravity="0 0 0">
        <flag contact="disable" gravity="disable"/></option>
      <worldbody>{axis("x", "1 0 0")}{axis("y", "0 1 0")}</worldbody>
      <tendon>{screw("x")}{screw("y")}</tendon>
      <actuator><motor joint="motor_x"/><motor joint="motor_y"/></actuator>
    </mujoco>"""


def fastest_tenth(run):
    """Time of a tick, ns, the 10 % quantile of the laps; a first lap for compilation and caches is not counted."""
    run(0)
    laps = []
    for number in range(1, LAPS + 1):
        start = perf_counter_ns()
        run(number)
        laps.append((perf_counter_ns() - start) / LAP)
    return sorted(laps)[LAPS // 10]


def numba_loop(steps):
    import numba
    import numpy

    compiled = numba.njit(lap)
    state = numpy.zeros((8, 2))
    state[[COMMAND, LAST_MOTOR, MOTOR_X, TABLE_X], 0] = RADIUS
    ns = fastest_tenth(lambda number: compiled(state, number * LAP, LAP, steps))
    # The following error is along the circle, not across it.
    if not abs(math.hypot(*state[TABLE_X]) - RADIUS) < 0.01 * RADIUS:
        raise RuntimeError(f"numba: the tool has left the circle at {state[TABLE_X]} m")
    return f"numba {numba.__version__}", ns


def mujoco_plant(steps):
    import mujoco

    compiled = mujoco.MjModel.from_xml_string(model(steps))
    data = mujoco.MjData(compiled)
    data.qvel[:] = FEED
    data.ctrl[:] = COULOMB + VISCOUS * FEED
    ns = fastest_tenth(lambda number: mujoco.mj_step(compiled, data, nstep=LAP * steps))
    # The force balances the friction, through the spring.
    stretch = data.qpos[0] - data.qpos[1]
    expected = (COULOMB + VISCOUS * FEED) / STIFFNESS
    if not (abs(data.qvel[1] / FEED - 1.0) < 0.01 and abs(stretch / expected - 1.0) < 0.01):
        raise RuntimeError(f"mujoco: the table moves at {data.qvel[1]} m/s, the screw is stretched by {stretch} m")
    return f"MuJoCo {mujoco.__version__}, no controller", ns


def main():
    print(f"{'peer':<30}{'steps':>12}{'ns a tick':>14}{'of real time':>16}")
    for peer in (numba_loop, mujoco_plant):
        for steps in (1, 5):
            name, ns = peer(steps)
            print(f"{name:<30}{steps:>12}{ns:>14.1f}{1e9 / TICK_HZ / ns:>16.0f}", flush=True)


if __name__ == "__main__":
    try:
        main()
    except Exception as error:
        sys.exit(f"peers: {' '.join(str(error).split()) or type(error).__name__}")
