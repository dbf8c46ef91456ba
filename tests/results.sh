#!/usr/bin/env bash
# Whether a change leaves all results as they were: a change of the design must, a mend explains each difference.
#
#   tests/results.sh write FOLDER [PROGRAM]   all results of the working tree, or of a program, as JSON files
#   tests/results.sh compare COMMIT           builds a commit and the working tree, and lists the files that differ
#
# Ten seeds of the demo, forty machines of the self-test, the experiments of the papers and of `compare`. With
# LOST_MOTION_DATA also each blind case, EMPS, the robot and the lead screw. About 20 minutes for each program on two cores.
set -euo pipefail
cd "$(dirname "$0")/.."

# Traces a folder of machine.toml and logs.
trace_case() {
  local program=$1 case=$2 json=$3 log
  local -a logs=()
  for log in "$case"/fit*.csv*; do logs+=(--fit "$log"); done
  for log in "$case"/validate*.csv*; do [ ! -e "$log" ] || logs+=(--validate "$log"); done
  "$program" trace --machine "$case/machine.toml" "${logs[@]}" --json "$json"
}

write() {
  local folder program seed case name
  mkdir -p "$1"
  folder=$(realpath "$1") program=$(realpath "$2")
  for seed in {1..10}; do
    "$program" demo --seed "$seed" --json "$folder/demo-$seed.json" --report "$folder/report" >/dev/null
  done
  rm -rf "$folder/report"
  "$program" self-test --cases 40 --json "$folder/self-test.json" >/dev/null
  "$program" reproduce --json "$folder/reproduce.json" >/dev/null
  # In a folder without the program of the emulated core: the instructions of a tick are measured by `cargo cost`.
  (cd "$folder" && "$program" compare --json compare.json >/dev/null)
  if [ -z "${LOST_MOTION_DATA:-}" ]; then
    echo "LOST_MOTION_DATA is not set: no result on measured data and blind cases" >&2
    return
  fi
  for case in "$LOST_MOTION_DATA"/cases*/*/; do
    name=$(basename "$(dirname "$case")")-$(basename "$case")
    # A case that is refused has its message in place of its result.
    trace_case "$program" "$case" "$folder/$name.json" >/dev/null 2>"$folder/$name.error" && rm "$folder/$name.error" ||
      sed -i "s,$LOST_MOTION_DATA,," "$folder/$name.error"
  done
  local data=$LOST_MOTION_DATA/data
  "$program" trace --machine "$data/emps/machine.toml" --fit "$data/emps/train.csv" --json "$folder/emps.json" >/dev/null
  "$program" trace --machine "$data/kuka/machine.toml" --fit "$data/kuka/recording_a.csv" --json "$folder/kuka.json" >/dev/null
  "$program" trace --friction-map "$data/leadscrew/friction_drive1.csv" --json "$folder/leadscrew.json" >/dev/null
}

# Builds the program of a source tree, and prints its path.
build() {
  CARGO_TARGET_DIR=$PWD/target/results/build cargo build --quiet --release --package host-sim --manifest-path "$1/Cargo.toml"
  cp target/results/build/release/lost-motion "target/results/$2"
  echo "$PWD/target/results/$2"
}

compare() {
  local commit tree=$PWD/target/results/tree before after
  commit=$(git rev-parse --verify "$1^{commit}")
  before=$PWD/target/results/$commit
  after=$PWD/target/results/working-tree
  if [ ! -e "$before/done" ]; then
    rm -rf "$tree" "$before"
    git worktree prune
    git worktree add --quiet --detach "$tree" "$commit"
    write "$before" "$(build "$tree" before)"
    git worktree remove --force "$tree"
    touch "$before/done"
  fi
  rm -rf "$after"
  write "$after" "$(build . after)"
  touch "$after/done"
  diff --recursive --brief "$before" "$after" && echo "all results as with $commit"
}

case ${1:-} in
write) write "${2:?expected a folder}" "${3:-$(mkdir -p target/results && build . after)}" ;;
compare) compare "${2:?expected a commit}" ;;
*)
  echo "${1:-nothing}: expected write FOLDER [PROGRAM] or compare COMMIT" >&2
  exit 2
  ;;
esac
