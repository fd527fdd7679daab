#!/usr/bin/env bash
# Every check of the house, from a fresh checkout: installs what is missing, then format, lints, tests, replays.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/system-packages.sh

# shellcheck disable=SC2046
need_packages gcc libc6-dev pkg-config libasound2-dev libudev-dev libxkbcommon-dev libxkbcommon-x11-0 libwayland-dev $(vulkan_packages)
need_cargo
need_runtime_dir

step() { printf '\n== %s\n' "$*"; "$@"; }

step cargo fmt --all --check
step cargo clippy --workspace --all-targets -- -D warnings
step cargo test --workspace
step cargo build --release --bin syzygy
step target/release/syzygy check-assets
for log in tests/replays/*.syzlog; do
    step target/release/syzygy replay "$log"
    step target/release/syzygy replay --heavy "$log"
done
