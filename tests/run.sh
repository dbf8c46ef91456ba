#!/usr/bin/env bash
# Everything that must hold: format, lints, documentation, both chip programs, all tests.
# Installs what is missing: the target of the chip, and the emulator by the system's package manager.
set -euo pipefail
cd "$(dirname "$0")/.."

step() { printf '\n== %s (%d s)\n' "$1" "$SECONDS"; }

target=thumbv7em-none-eabihf

step "tools"
if command -v rustup >/dev/null; then
  rustup target list --installed | grep -qx "$target" || rustup target add "$target"
  for component in rustfmt clippy; do
    cargo "${component/rustfmt/fmt}" --version >/dev/null 2>&1 || rustup component add "$component"
  done
fi
if ! command -v qemu-system-arm >/dev/null; then
  as_root=""
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
fi

step "format"
cargo fmt --all --check

step "lints"
cargo clippy --workspace --exclude firmware --all-targets -- -D warnings
for program in board emulated servo cost; do
  cargo clippy --package firmware --bin "$program" --features "$program" --target "$target" -- -D warnings
done

step "documentation"
# A module's front page may point at its private parts: they are documented, too.
RUSTDOCFLAGS="-D warnings -A rustdoc::private_intra_doc_links" \
  cargo doc --no-deps --document-private-items --workspace --exclude firmware --exclude tests

step "programs of the chip"
cargo board
cargo emulated
cargo servo

step "tests"
if [ -z "${LOST_MOTION_DATA:-}" ]; then
  echo "LOST_MOTION_DATA is not set: tests on measured data will be skipped"
fi
cargo test --release

step "done"
