#!/usr/bin/env bash
# The unit tests of `shared` under Miri, which watches every access to memory and every integer that overflows.
# Installs what is missing. Miri computes some hundred times slower than the processor: fewer cases of each property,
# and the tests shorten their long runs under `cfg!(miri)`.
set -euo pipefail
cd "$(dirname "$0")/.."

toolchain=nightly
rustup +"$toolchain" component list --installed 2>/dev/null | grep -q '^miri' ||
  rustup toolchain install "$toolchain" --profile minimal --component miri,rust-src

# Miri's world has neither our environment nor a folder where proptest could keep failures.
export MIRIFLAGS="-Zmiri-env-set=PROPTEST_CASES=${CASES:-4} -Zmiri-env-set=PROPTEST_DISABLE_FAILURE_PERSISTENCE=1"

# libm takes square roots in assembly where it may, which Miri cannot follow.
SECONDS=0
miri() { cargo +"$toolchain" miri test --package shared --lib --features libm/force-soft-floats -- "$@"; }
if [ $# -gt 0 ]; then
  miri "$@"
else
  # A module after the other: what Miri keeps of one test makes the next one slower.
  for module in $(miri --list 2>/dev/null | sed -n 's/::.*: test$//p' | sort -u); do
    miri "$module::"
    echo "$module: ${SECONDS} s so far"
  done
fi
echo "Miri: ${SECONDS} s"
