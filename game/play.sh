#!/usr/bin/env bash
# Plays Syzygy from a fresh checkout: installs what is missing, builds, opens the window.
# Where there is no display it flies the demo flight headless and leaves its film strip in saves/film/.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/system-packages.sh

# shellcheck disable=SC2046
need_packages gcc libc6-dev pkg-config libasound2-dev libudev-dev libxkbcommon-dev libxkbcommon-x11-0 libwayland-dev $(vulkan_packages)
need_cargo
need_runtime_dir

cargo build --release --bin syzygy
if [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
    exec target/release/syzygy play "$@"
fi
echo "syzygy: no display; flying the demo flight headless, pictures go to saves/film/" >&2
mkdir -p saves/film
exec target/release/syzygy headless --start eclipse --ticks 3600 --film saves/film "$@"
