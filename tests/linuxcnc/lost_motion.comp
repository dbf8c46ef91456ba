component lost_motion "The simulated machine of a machine file, with its drives: two axes";
pin in float command-#[2] "Command of the motor: mm, mm/s or N";
pin out float motor-#[2] "Reading of the motor encoder, mm";
pin out float velocity-#[2] "Change of that reading, mm/s";
pin out float scale-#[2] "Reading of the linear scale, mm";
pin out float tool-#[2] "Reading of a probe at the tool, mm";
pin out float force-#[2] "Force of the motor, N";
pin out bit fault "The machine is broken, or the period of the thread is not that of the machine file";
modparam dummy machine "Path of the machine file";
modparam dummy command_kind "What is commanded: position, velocity or force";
option singleton yes;
option extra_setup yes;
option extra_cleanup yes;
function _;
license "Dual MIT/GPL";
author "Lost Motion";
;;
#include <stdbool.h>

/* As in tests/linuxcnc/machine/src/machine.rs. */
struct axis_pins { double command, motor, velocity, scale, tool, force; };
void *lost_motion_new(const char *path, const char *command);
bool lost_motion_step(void *machine, double period_s, struct axis_pins *pins);
void lost_motion_free(void *machine);

static char *machine;
static char *command_kind;
RTAPI_MP_STRING(machine, "Path of the machine file");
RTAPI_MP_STRING(command_kind, "What is commanded: position, velocity or force");

static void *simulated;

EXTRA_SETUP() {
    simulated = lost_motion_new(machine, command_kind);
    return simulated ? 0 : -1;
}

EXTRA_CLEANUP() {
    lost_motion_free(simulated);
}

FUNCTION(_) {
    struct axis_pins pins[2] = {{0}};
    int i;
    if (fault) return;
    for (i = 0; i < 2; i++) pins[i].command = command(i);
    if (!lost_motion_step(simulated, fperiod, pins)) {
        fault = 1;
        return;
    }
    for (i = 0; i < 2; i++) {
        motor(i) = pins[i].motor;
        velocity(i) = pins[i].velocity;
        scale(i) = pins[i].scale;
        tool(i) = pins[i].tool;
        force(i) = pins[i].force;
    }
}
