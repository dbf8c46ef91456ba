#!/usr/bin/env bash
# LinuxCNC moves machines with errors, and moves them better: logs, init, trace, compensate --format linuxcnc, verify.
#
#   tests/linuxcnc.sh [FOLDER]
#
# Installs LinuxCNC where apt has it, and makes the user `lostmotion` for it where this is root. About 10 minutes. The last line is JSON:
# the contour error on a circle before, predicted and after, µm rms. docs/linuxcnc.md says what is run.
set -euo pipefail
cd "$(dirname "$0")/.."

command -v linuxcnc >/dev/null || {
  as_root=""
  [ "$(id -u)" = 0 ] || as_root=sudo
  $as_root apt-get update -qq
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends linuxcnc-uspace >/dev/null
}
user=""
if [ "$(id -u)" = 0 ]; then
  user=lostmotion
  id "$user" >/dev/null 2>&1 || useradd --create-home "$user"
fi
cargo build --release --package host-sim
folder="${1:-$(mktemp -d)}"
mkdir -p "$folder"
chmod 755 "$folder"
python3 tests/linuxcnc/linuxcnc.py target/release/lost-motion "$folder" $user
