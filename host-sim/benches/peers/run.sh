#!/usr/bin/env bash
# Speed of other programs with the job of ../speed: `bash host-sim/benches/peers/run.sh`. It makes a Python environment of
# its own under target/peers. The first run fetches numba, numpy and mujoco from PyPI, about 400 MB when unpacked.
set -eu

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
environment=${CARGO_TARGET_DIR:-$here/../../../target}/peers
installed=$environment/installed.txt

fail() {
    echo "peers: $1" >&2
    exit 1
}

command -v python3 >/dev/null || fail "no python3: install the package python3"
if ! cmp -s "$here/requirements.txt" "$installed"; then
    python3 -c 'import ensurepip, venv' 2>/dev/null || fail "python3 has no venv: install the package python3-venv"
    python3 -m venv --clear "$environment" >/dev/null 2>&1 || fail "cannot make an environment in $environment"
    log=$environment/pip.log
    "$environment/bin/python" -m pip install --quiet --disable-pip-version-check \
        --requirement "$here/requirements.txt" >"$log" 2>&1 ||
        fail "pip: $(grep -m 1 '^ERROR' "$log" || tail -n 1 "$log") (all of it in $log)"
    cp "$here/requirements.txt" "$installed"
fi
exec "$environment/bin/python" "$here/peers.py"
