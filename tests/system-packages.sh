# Sourced by game/play.sh and tests/run.sh: installs the system packages that are missing, and says so.
# Debian/Ubuntu through apt-get; elsewhere it names what is needed and goes on.

need_packages() {
    local missing=() package
    if ! command -v dpkg-query >/dev/null 2>&1; then
        echo "syzygy: no dpkg here; needed are: $*" >&2
        return 0
    fi
    for package in "$@"; do
        dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
    done
    [ ${#missing[@]} -eq 0 ] && return 0
    echo "syzygy: installing missing system packages: ${missing[*]}" >&2
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null 2>&1; then
            echo "syzygy: not root and no sudo; please run: apt-get install ${missing[*]}" >&2
            return 1
        fi
        as_root=(sudo)
    fi
    "${as_root[@]}" apt-get update -qq &&
        "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

need_cargo() {
    command -v cargo >/dev/null 2>&1 && return 0
    [ -x "$HOME/.cargo/bin/cargo" ] && export PATH="$HOME/.cargo/bin:$PATH" && return 0
    echo "syzygy: cargo is missing. Install Rust 1.95 or newer (rustup), then run this again." >&2
    return 1
}

# A Vulkan driver: a real one where there is a GPU; lavapipe, which draws on the processor, otherwise.
vulkan_packages() {
    echo "libvulkan1 mesa-vulkan-drivers"
}

# lavapipe and winit want a runtime directory; a bare container has none.
need_runtime_dir() {
    if [ -z "${XDG_RUNTIME_DIR:-}" ]; then
        XDG_RUNTIME_DIR="$(mktemp -d)"
        chmod 700 "$XDG_RUNTIME_DIR"
        export XDG_RUNTIME_DIR
    fi
}
