#!/usr/bin/env python3
"""In the place of LinuxCNC's screen: switches on, homes, and runs motions by MDI while halsampler writes `NAME.txt`: those of the arguments.
LinuxCNC adds arguments of its own.
"""

import os
import signal
import subprocess
import sys
import time

import linuxcnc

# Name, approach, blocks. The feed is in mm/min; each motion starts and ends at rest. The circle is approached slowly, in the directions
# in which its axes start: how friction and gap were left before is not part of it.
MOTIONS = [
    ("circle", ["G0 X42 Y-2", "G1 X40.05 Y-0.05 F300", "G1 X40 Y0 F6"],
     ["G3 X40 Y0 I-40 J0 F3000", "G4 P0.2", "G2 X40 Y0 I-40 J0 F3000"]),
    ("travel", ["G0 X0 Y0"], ["G1 X45 Y30 F3600", "X-45 Y-20", "X-10 Y45", "X20 Y-45", "X0 Y0 F1800",
                                "X12 Y-8", "X-7 Y5", "X30 Y20", "X28 Y19", "X-30 Y-35 F2400", "X45 Y45", "X0 Y0"]),
    ("square", ["G0 X-35 Y-35"], ["G1 X35 Y-35 F2700", "X35 Y35", "X-35 Y35", "X-35 Y-35", "X35 Y-10", "X-35 Y-35"]),
]

command, status = linuxcnc.command(), linuxcnc.stat()


def wait(seconds=60):
    command.wait_complete(seconds)


def mdi(text):
    command.mdi(text)
    wait(120)
    # A block is complete when it is queued; the axes may still move.
    while True:
        status.poll()
        if status.inpos and status.queue == 0 and status.interp_state == linuxcnc.INTERP_IDLE:
            return
        time.sleep(0.01)


command.state(linuxcnc.STATE_ESTOP_RESET)
wait()
command.state(linuxcnc.STATE_ON)
wait()
command.mode(linuxcnc.MODE_MANUAL)
wait()
command.teleop_enable(0)
wait()
command.home(-1)
for _ in range(200):
    status.poll()
    if status.homed[0] and status.homed[1]:
        break
    time.sleep(0.05)
command.mode(linuxcnc.MODE_MDI)
wait()
mdi("G21 G90 G61.1")
for name, approach, blocks in (motion for motion in MOTIONS if motion[0] in sys.argv[1:]):
    for block in approach:
        mdi(block)
    # Long enough for the axes to settle, too short for the integral parts to relax the friction at which they stand.
    time.sleep(0.1)
    with open(f"{name}.txt", "w") as log:
        sampler = subprocess.Popen(["halsampler", "-t"], stdout=log)
        # Only from here on: the sampler keeps its last 32 s for whoever reads it next.
        subprocess.run(["halcmd", "setp", "sampler.0.enable", "1"], check=True)
        time.sleep(0.1)
        for block in blocks:
            mdi(block if block.startswith("G") else f"G1 {block}")
        time.sleep(0.3)
        subprocess.run(["halcmd", "setp", "sampler.0.enable", "0"], check=True)
        time.sleep(0.3)
        sampler.send_signal(signal.SIGINT)
        sampler.wait(timeout=20)
    print(name, os.path.getsize(f"{name}.txt"), flush=True)
