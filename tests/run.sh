#!/usr/bin/env bash
# The tests of a change, and of everything:
#
#   tests/run.sh              format, whether the programs of the chip compile, and the tests of the host that take minutes
#   tests/run.sh all          also lints, documentation, the programs and tests of the chip, and the long tests: what a submission has
#                             to pass
#   tests/run.sh all PART     one part of that, for several machines: lint, chip, crates or host
#
# docs/testing.md lists what each part would catch and how long it takes. Installs what is missing: the target of the chip, and
# the emulator by the system's package manager.
set -euo pipefail
cd "$(dirname "$0")/.."

target=thumbv7em-none-eabihf

# Tests of the program `host` that are left to `all`, by parts of their names. They repeat at length, or on other logs, what
# another test would catch: no mutant of `shared` and no false name of docs/testing.md is found by one of these alone.
long=(
  compensation::watched:: example_machines:: demo_seeds::
  command_line::improve:: command_line::reproduce:: command_line::compare:: command_line::worked_example::
  model_again::a_model_of_a_case_is_stable
  pages_in_browser:: app_in_browser::
)

# Tests of `host` that are left to `tests/deep.sh host`: with them, `all` would not end within the time of CI on two cores.
deep=(
  app_in_browser::traced::all_cases init::cases::all_other_cases init::measured::emps
  incomplete_logs::sweep::parts_of_the_blind_cases model_again::a_model_of_measured_data_is_stable
  budget::second_simulator::the_first_cause_is_the_true_one_on_fifty_machines
)

step() { printf '\n== %s (%d s)\n' "$1" "$SECONDS"; }

install_tools() {
  if command -v rustup >/dev/null; then
    rustup target list --installed | grep -qx "$target" || rustup target add "$target"
    for component in rustfmt clippy; do
      cargo "${component/rustfmt/fmt}" --version >/dev/null 2>&1 || rustup component add "$component"
    done
  fi
  command -v qemu-system-arm >/dev/null || install_emulator
}

# Looks at pages in `all`, and runs the tracer in one.
install_browser() {
  if command -v rustup >/dev/null; then
    rustup target list --installed | grep -qx wasm32-unknown-unknown || rustup target add wasm32-unknown-unknown ||
      echo "no target wasm32-unknown-unknown: the tracer in a browser is not tested"
  fi
  command -v chromium >/dev/null || command -v chromium-browser >/dev/null || command -v google-chrome >/dev/null || {
    local as_root=""
    [ "$(id -u)" = 0 ] || as_root="$(command -v sudo || true)"
    if command -v apt-get >/dev/null; then
      $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends chromium >/dev/null ||
        echo "chromium cannot be installed: the pages are not looked at"
    else
      echo "chromium is missing: the pages are not looked at"
    fi
  }
}

# The libraries with which Python reads what the program writes, in an environment of their own. Without them these tests are skipped.
install_python() {
  local folder=$PWD/target/python
  [ -x "$folder/bin/pip" ] || python3 -m venv "$folder" || {
    echo "python3 cannot make an environment: its libraries read nothing that is written"
    return 0
  }
  "$folder/bin/python3" -c 'import numpy, scipy, pyarrow, mcap, pytcs' 2>/dev/null ||
    "$folder/bin/pip" install --quiet numpy==2.4.6 scipy==1.17.1 pyarrow==26.0.1 mcap==1.6.0 pytcs==0.2.2 ||
    echo "the libraries of Python cannot be installed: they read nothing that is written"
  export PATH=$folder/bin:$PATH
}

install_emulator() {
  local as_root=""
  [ "$(id -u)" = 0 ] || as_root="$(command -v sudo || true)"
  if command -v apt-get >/dev/null; then
    $as_root apt-get update -qq
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends qemu-system-arm >/dev/null
  elif command -v dnf >/dev/null; then
    $as_root dnf install -y -q qemu-system-arm
  elif command -v pacman >/dev/null; then
    $as_root pacman -S --noconfirm qemu-system-arm
  elif command -v brew >/dev/null; then
    brew install qemu
  else
    echo "qemu-system-arm is missing, and no package manager that this script knows: please install it" >&2
    exit 1
  fi
}

lints() {
  cargo clippy --workspace --exclude firmware --all-targets -- -D warnings
  local program
  for program in board board-g474 emulated servo servo-four cost cost-four; do
    cargo clippy --package firmware --bin "$program" --features "${program%-four}" --target "$target" -- -D warnings
  done
}

documentation() {
  # A module's front page may point at its private parts: they are documented, too.
  RUSTDOCFLAGS="-D warnings -A rustdoc::private_intra_doc_links" \
    cargo doc --no-deps --document-private-items --workspace --exclude firmware --exclude tests --exclude random-motion
}

# The programs that are flashed, and those of the emulator: whether they compile.
check_programs_of_chip() {
  local program
  for program in board board-g474 emulated servo servo-four; do
    cargo check --package firmware --bin "$program" --features "${program%-four}" --target "$target"
  done
}

# Runs all tests of some targets also after a failure, so that one run shows everything that fails. Targets are chosen and not packages, with
# which cargo would compile dependencies again with other features.
failed=0
run_tests() { cargo test --release --no-fail-fast "$@" || failed=1; }

tests_of_crates() {
  run_tests --lib --bins
  run_tests --test integration --test memory
}

# The tests of the host without some, by parts of their names.
tests_of_host_without() {
  local test skipped=()
  for test in "$@"; do skipped+=(--skip "$test"); done
  run_tests --test host -- "${skipped[@]}"
}

lint() {
  step "format"
  cargo fmt --all --check
  step "lints"
  lints
  step "documentation"
  documentation
}

# These talk to an emulated board, which ticks in real time: nothing else runs beside them.
chip() {
  step "programs of the chip"
  cargo board
  cargo board-g474
  cargo emulated
  cargo servo
  step "tests of the chip"
  run_tests --test chip
}

crates() {
  step "tests of the crates"
  tests_of_crates
  run_tests --test second_simulator --test textbook --test measured --test rigid_bodies --test mutated_files
  run_tests --doc
  run_tests --examples
}

host() {
  step "tests of the program"
  tests_of_host_without "${deep[@]}"
}

parts=(lint chip crates host)
usage() {
  echo "$1: expected nothing, or all, or all and one of: ${parts[*]}" >&2
  exit 2
}
case ${1:-} in
"" | all) ;;
*) usage "$1" ;;
esac
if [ -n "${2:-}" ]; then
  [[ " ${parts[*]} " == *" $2 "* ]] || usage "$2"
  parts=("$2")
fi

step "tools"
install_tools
if [ -z "${LOST_MOTION_DATA:-}" ]; then
  echo "LOST_MOTION_DATA is not set: tests on measured data will be skipped"
fi
if [ "${1:-}" = all ]; then
  install_browser
  install_python
  for part in "${parts[@]}"; do "$part"; done
else
  step "format"
  cargo fmt --all --check
  step "programs of the chip"
  check_programs_of_chip
  step "tests"
  tests_of_crates
  tests_of_host_without "${long[@]}" "${deep[@]}"
fi
if [ "$failed" != 0 ]; then
  step "failed: see above"
  exit 1
fi
step "done"
