#!/usr/bin/env bash
# The long checks, an hour and more where tests/run.sh takes minutes:
#
#   tests/deep.sh                      all of them
#   tests/deep.sh mutants [PART…]      do the tests of `shared` fail when its source is changed? docs/testing.md
#   tests/deep.sh mutants firmware     do the tests of the emulated chip fail when the firmware is changed?
#   tests/deep.sh miri [MODULE…]       tests/miri.sh
#   tests/deep.sh properties [SEEDS]   the property tests with this many new seeds (100): the usual run has a fixed one
#   tests/deep.sh bits                 a million ticks of random motions, host against emulated core, fixed point and f32
#   tests/deep.sh fuzz [SECONDS]       fuzzing of link, lock-step protocol and readers of files (600), with cargo-fuzz
#   tests/deep.sh host                 tests of `host` that tests/run.sh has no time for: every case in a browser, init on every case, parts of cases, …
#   tests/deep.sh fleet                tools/fleet.py on a local cluster, with and without killed workers: docs/fleet.md
#
# A PART is a module of shared/src: control, drive, feedback, safety, monitor, machine, lockstep unless named; link,
# homing, storage, capture, compensate and others by name; also a file of one, as machine/reference. The parts of the firmware are its
# files, as firmware/board/stage, and firmware/constants: mutants of pins, numbers and wiring. What is done is
# not repeated as long as neither source nor tests change, so that an interrupted run can be continued; FRESH=1 starts
# again. Installs missing tools.
set -euo pipefail
cd "$(dirname "$0")/.."

parts=(control drive feedback safety monitor machine lockstep)
# `firmware` stands for these: what runs on the board. Its bench and its port for the emulator are tools of the tests.
of_firmware=(constants flash setup bin/board board/clock board/converter board/dac board/flash board/link board/mod board/quadrature
  board/registers board/stage board/switches board/tick board/uart board/usb board/watchdog
  two_drives/counters two_drives/hardware two_drives/sensors two_drives/serial two_drives/stages two_drives/switches
  g474/can g474/can_port g474/clock g474/converter g474/counters g474/dac g474/flash g474/mod g474/pins g474/registers g474/stage
  g474/supply g474/tick g474/uart g474/watchdog)
# Minimum percentage of mutants that the tests detect; those listed as equivalent count as not detected.
min_detected=95

work=$PWD/target/deep
tree=$work/tree

step() { printf '\n== %s (%d s)\n' "$1" "$SECONDS"; }

# The source file of a part, or its folder.
files_of() {
  if [[ $1 == firmware/* ]]; then echo "firmware/src/${1#firmware/}.rs"; elif [ -d "shared/src/$1" ]; then echo "shared/src/$1"; else echo "shared/src/$1.rs"; fi
}

# The firmware and the tests of the chip, on which the results of its mutants depend beside the rest.
hash_of_firmware() {
  (cd "$tree" && find firmware tests -type f -print0 | sort -z | xargs -0 cat) | git hash-object --stdin
}

# What the results of all mutants depend on.
hash_of_tree() {
  (
    cd "$tree"
    cat Cargo.lock Cargo.toml .cargo/mutants.toml rust-toolchain.toml shared/Cargo.toml tests/shared_mutants.py
    find shared/src shared/tests -name '*.rs' -print0 | sort -z | xargs -0 cat
  ) | git hash-object --stdin
}

# Copies the working tree: the mutants are made in the copy. All files get the current time, since the last build may be that of a mutant.
copy_tree() {
  rm -rf "$tree"
  mkdir -p "$tree"
  git ls-files -z --cached --others --exclude-standard --deduplicate |
    while IFS= read -r -d '' file; do [ ! -e "$file" ] || printf '%s\0' "$file"; done |
    tar --null --files-from - --create --file - | tar --extract --touch --file - --directory "$tree"
}

# Number of lines; 0 where the file does not exist.
lines() { if [ -f "$1" ]; then wc -l <"$1"; else echo 0; fi; }

mutants_of() {
  if [ "$1" = firmware/src/constants.rs ]; then
    python3 "$tree/tests/firmware_mutants.py" count
  else
    (cd "$tree" && cargo mutants --list --package "${1%%/*}" --file "$1" "${@:2}" | wc -l)
  fi
}

# Tests every mutant of a file of the firmware, in the form of cargo-mutants.
mutate_firmware() {
  local what=$1
  [ "$what" != firmware/src/constants.rs ] || what=constants
  rm -rf "$work/mutants/$1"
  (cd "$tree" && CARGO_TARGET_DIR=$work/build nice python3 tests/firmware_mutants.py "$what" "$work/mutants/$1/mutants.out") || exit
  fingerprint >"$work/mutants/$1/done"
}

# Hash of everything that a result of the firmware depends on.
fingerprint() { echo "$(hash_of_tree) $(hash_of_firmware)"; }

mutants() {
  command -v cargo-mutants >/dev/null || cargo install cargo-mutants --locked
  local part status=0
  local -a shared_parts=() firmware_parts=()
  for part in "$@"; do
    [ "$part" = firmware/constants ] || [ -e "$(files_of "$part")" ] ||
      { echo "$part: expected a part: ${parts[*]}" >&2; exit 2; }
    if [[ $part == firmware/* ]]; then firmware_parts+=("$part"); else shared_parts+=("$part"); fi
  done
  copy_tree
  [ -z "${FRESH:-}" ] || rm -rf "$work/mutants"
  mkdir -p "$work/mutants"
  if [ "${#firmware_parts[@]}" -gt 0 ]; then mutants_of_firmware "${firmware_parts[@]}" || status=1; fi
  if [ "${#shared_parts[@]}" -gt 0 ]; then
    step "mutants: ${shared_parts[*]}"
    CARGO_TARGET_DIR=$work/build nice python3 tests/shared_mutants.py "$tree" "$work/mutants/shared" "$(hash_of_tree)" "${shared_parts[@]}" || status=1
  fi
  return $status
}

mutants_of_firmware() {
  local part file survivors=0 table=""
  local -A sum=([caught]=0 [missed]=0 [timeout]=0 [unviable]=0 [equivalent]=0)
  for part in "$@"; do
    file=$(files_of "$part")
    local results=$work/mutants/$file listed all
    listed=$(mutants_of "$file")
    all=$(mutants_of "$file" --no-config)
    [ "$all" -gt 0 ] || continue
    if [ "$(cat "$results/done" 2>/dev/null)" != "$(fingerprint)" ]; then
      step "$file: $listed mutants"
      if [ "$listed" -gt 0 ]; then mutate_firmware "$file"; fi
    fi
    local -A of=([equivalent]=$((all - listed)))
    for kind in caught missed timeout unviable; do of[$kind]=$(lines "$results/mutants.out/$kind.txt"); done
    table+=$(printf '%-32s %7d %7d %7d %11d %9d' "${file/\/src\///}" "${of[caught]}" "${of[timeout]}" \
      "${of[missed]}" "${of[equivalent]}" "${of[unviable]}")$'\n'
    for kind in "${!sum[@]}"; do sum[$kind]=$((sum[$kind] + of[$kind])); done
    if [ "${of[missed]}" -gt 0 ]; then cat "$results/mutants.out/missed.txt"; fi
  done
  step "mutants: $*"
  printf '%-32s %7s %7s %7s %11s %9s\n' file caught timeout missed equivalent unviable
  printf '%s' "$table"
  printf '%-32s %7d %7d %7d %11d %9d\n' all "${sum[caught]}" "${sum[timeout]}" "${sum[missed]}" \
    "${sum[equivalent]}" "${sum[unviable]}"
  local detected=$((sum[caught] + sum[timeout])) viable
  viable=$((detected + sum[missed] + sum[equivalent]))
  awk -v n="$detected" -v of="$viable" 'BEGIN { printf "%d of %d detected: %.1f %%\n", n, of, of ? 100 * n / of : 100 }'
  [ $((100 * detected)) -ge $((min_detected * viable)) ] || { echo "expected at least $min_detected %" >&2; survivors=1; }
  [ "${sum[missed]}" -eq 0 ] ||
    { echo "expected a test for each, or a line with the reason in .cargo/mutants.toml" >&2; survivors=1; }
  return $survivors
}

# Runs the property tests of `shared` and of the crates of `host-sim`, each time with other random cases.
properties() {
  local seed base=${BASE_SEED:-$(date +%s)}
  cargo test --release --workspace --exclude firmware --exclude tests --lib --no-run
  for ((seed = base; seed < base + $1; seed++)); do
    PROPTEST_RNG_SEED=$seed cargo test --release --quiet --workspace --exclude firmware --exclude tests --lib ||
      { echo "failed with PROPTEST_RNG_SEED=$seed" >&2; return 1; }
  done
  echo "property tests: $1 seeds from $base on"
}

# A million ticks of random motions to the last bit.
bits() { cargo test --release --package tests --test chip random_motions:: -- --ignored --nocapture; }

# Tests for which tests/run.sh has no time. The browser is that of the system: chromium, or google-chrome.
host() {
  rustup target list --installed | grep -qx wasm32-unknown-unknown || rustup target add wasm32-unknown-unknown
  cargo build --release --bins
  cargo test --release --test host -- --nocapture app_in_browser::traced::all_cases init::cases::all_other_cases init::measured::emps \
    incomplete_logs::sweep::parts_of_the_blind_cases model_again::a_model_of_measured_data_is_stable \
    budget::second_simulator::the_first_cause_is_the_true_one_on_fifty_machines
}

# Traces of random parts of the blind cases, of each case as many as given; other parts on every run.
sweep() {
  SWEEP_VARIANTS=$1 SWEEP_SEED=${BASE_SEED:-$(date +%s)} \
    cargo test --release --package tests --test host incomplete_logs:: -- --ignored --nocapture
}

# Fuzzing, a fifth of the time for each target. The corpus is kept in fuzz/corpus for the next run.
fuzz() {
  command -v cargo-fuzz >/dev/null || cargo install cargo-fuzz --locked
  rustup toolchain list | grep -q '^nightly' || rustup toolchain install nightly --profile minimal
  local target limit_mb
  for target in link lockstep import_text import_binary own_files; do
    step "fuzz $target"
    mkdir -p "fuzz/corpus/$target"
    # A page of a Parquet file may claim 2 GiB, which are reserved before it is found to be shorter.
    limit_mb=1024
    if [ "$target" = import_binary ]; then limit_mb=4096; fi
    cargo +nightly fuzz run --fuzz-dir fuzz "$target" "fuzz/corpus/$target" "fuzz/seeds/$target" -- -max_total_time=$(($1 / 5)) -max_len=4096 \
      -print_final_stats=1 -rss_limit_mb="$limit_mb"
  done
}

# The traces of many machines by Dask, in an environment of its own.
fleet() {
  local python=$work/fleet/bin/python program=$PWD/target/release/lost-motion part
  mkdir -p "$work"
  [ -x "$python" ] || python3 -m venv "$work/fleet"
  "$python" -c 'import distributed, pyarrow' 2>/dev/null ||
    "$work/fleet/bin/pip" install --quiet 'dask==2026.8.0' 'distributed==2026.8.0' 'pyarrow==26.0.1'
  cargo build --release --bin lost-motion
  for part in refused foreign kills cases; do
    step "fleet $part"
    if [ "$part" = cases ] && [ ! -d "${LOST_MOTION_DATA:-}/cases" ]; then
      echo "SKIPPED: LOST_MOTION_DATA names no folder with cases" >&2
    else
      "$python" tests/fleet.py "$program" "$part"
    fi
  done
}

case ${1:-all} in
all)
  properties 100
  bits
  host
  sweep 20
  fuzz 600
  fleet
  mutants "${parts[@]}"
  step "Miri"
  tests/miri.sh
  ;;
mutants)
  shift
  if [ $# -eq 0 ]; then set -- "${parts[@]}"; fi
  if [ "$*" = firmware ]; then set -- "${of_firmware[@]/#/firmware/}"; fi
  mutants "$@"
  ;;
miri)
  shift
  tests/miri.sh "$@"
  ;;
properties)
  properties "${2:-100}"
  ;;
bits)
  bits
  ;;
sweep)
  sweep "${2:-100}"
  ;;
fuzz)
  fuzz "${2:-600}"
  ;;
fleet)
  fleet
  ;;
host)
  host
  ;;
*)
  echo "$1: expected mutants, miri, properties, bits, host, sweep, fuzz or fleet" >&2
  exit 2
  ;;
esac
