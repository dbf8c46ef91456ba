#!/usr/bin/env bash
# LinuxCNC moves machines with errors, and moves them better: logs, init, trace, compensate --format linuxcnc, verify.
#
#   tests/linuxcnc.sh [FOLDER]
#
# Installs LinuxCNC where apt has it, and makes the user `lostmotion` for it where this is root. About 20 minutes, and compiling. FOLDER/index.html shows the
# circles. The last line is JSON: the contour error on a circle before, predicted and after, µm rms. docs/linuxcnc.md says what is run.
set -euo pipefail
cd "$(dirname "$0")/.."

as_root=""
[ "$(id -u)" = 0 ] || as_root=sudo
{ command -v linuxcnc && command -v halcompile; } >/dev/null || {
  $as_root apt-get update -qq
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
    linuxcnc-uspace linuxcnc-uspace-dev >/dev/null
}
user=""
if [ "$(id -u)" = 0 ]; then
  user=lostmotion
  id "$user" >/dev/null 2>&1 || useradd --create-home "$user"
fi
folder="${1:-$(mktemp -d)}"
mkdir -p "$folder"
folder="$(cd "$folder" && pwd)"
chmod 755 "$folder"

cargo build --release --package host-sim --package linuxcnc-machine
# The link of a realtime component takes a library by LDFLAGS alone.
cp tests/linuxcnc/lost_motion.comp "$folder"
library="$PWD/target/release/liblinuxcnc_machine.a"
(
  cd "$folder"
  $as_root env LDFLAGS="-Wl,--whole-archive $library -Wl,--no-whole-archive -lpthread -ldl -lm" \
    halcompile --install lost_motion.comp
)

python3 -B tests/linuxcnc/linuxcnc.py target/release/lost-motion "$folder" "$user"
