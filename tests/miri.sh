#!/usr/bin/env bash
# The unit tests of `shared` under Miri, which detects undefined behaviour and integer overflow. Installs missing
# tools. Miri is some hundred times slower than the processor: property tests have fewer cases, and the tests shorten
# their long runs under `cfg!(miri)`.
set -euo pipefail
cd "$(dirname "$0")/.."

toolchain=nightly
rustup +"$toolchain" component list --installed 2>/dev/null | grep -q '^miri' ||
  rustup toolchain install "$toolchain" --profile minimal --component miri,rust-src

# Miri isolates the program from the environment and from the file system, where proptest would store failures.
export MIRIFLAGS="-Zmiri-env-set=PROPTEST_CASES=${CASES:-4} -Zmiri-env-set=PROPTEST_DISABLE_FAILURE_PERSISTENCE=1"

# libm computes square roots in assembly where it can, which Miri does not support.
SECONDS=0
miri() { cargo +"$toolchain" miri test --package shared --lib --features libm/force-soft-floats -- "$@"; }
if [ $# -gt 0 ]; then
  miri "$@"
else
  # One module at a time: Miri's state of one test slows down the next one.
  for module in $(miri --list 2>/dev/null | sed -n 's/::.*: test$//p' | sort -u); do
    miri "$module::"
    echo "$module: ${SECONDS} s so far"
  done
fi
echo "Miri: ${SECONDS} s"
