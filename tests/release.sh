#!/usr/bin/env bash
# The checks before a version is tagged, in order: tests/release.sh 0.2.0
#
# It changes nothing. What it cannot check stands at its end.
set -euo pipefail
cd "$(dirname "$0")/.."

version="${1:?the version, as 0.2.0}"

fail() { echo "release $version: $1" >&2; exit 1; }

[[ "$version" =~ ^[0-9]+\.[0-9]+\.[0-9]+$ ]] || fail "expected a version of three numbers"
[ -z "$(git status --porcelain)" ] || fail "there are changes that are not committed"
git rev-parse -q --verify "refs/tags/v$version" >/dev/null && fail "the tag v$version exists"
grep -qx "version = \"$version\"" Cargo.toml || fail "Cargo.toml has another version"
grep -qx "version = \"$version\"" fuzz/Cargo.toml || fail "fuzz/Cargo.toml has another version"
grep -qE "^## $version \([0-9]{4}-[0-9]{2}-[0-9]{2}\)$" CHANGELOG.md || fail "CHANGELOG.md has no heading '## $version (DATE)'"
sed -n '/^## Unreleased/,/^## [0-9]/p' CHANGELOG.md | grep -q '^- ' && fail "CHANGELOG.md has entries under Unreleased"

cargo deny check
# Dependencies that no code uses.
cargo machete --version >/dev/null 2>&1 || cargo install cargo-machete --locked --quiet
cargo machete
bash tests/run.sh all
bash tests/deep.sh

cat <<END
release $version: all checks passed. Before 'git tag -s v$version':
- on a board: the steps of docs/board.md, and which board, or "nothing was run on hardware" in the changelog;
- docs/speed.md: the figures of this version in the history, from an idle computer;
- the report of 'lost-motion demo' looked at.
END
