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
# Mesa 22.3's software driver corrupts its heap now and then where one process bakes these tables several times: a process each.
for test in even_entries_are_the_formula_less_closely the_difference_of_two_depths_keeps_its_digits before_a_surface_there_is_its_share_of_the_air nothing_is_nan_wherever_one_stands the_ground_is_lit_by_its_own_tables; do
    step cargo test --workspace --test twin_view_table -- --ignored --exact "$test"
done
step cargo build --release --bin syzygy
step target/release/syzygy check-assets
for log in tests/replays/*.syzlog; do
    step target/release/syzygy replay "$log"
    step target/release/syzygy replay --heavy "$log"
done
