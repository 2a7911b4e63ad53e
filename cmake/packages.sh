# shellcheck shell=sh
# Sourced by demos/run.sh and tests/run.sh: the Debian packages that building, recording and testing need. POSIX sh.
# Nothing is fetched when nothing is missing; otherwise one `apt-get update` and one `apt-get install`.

SUPPLE_PACKAGES="
g++ cmake ninja-build pkg-config
libeigen3-dev libxsimd-dev nlohmann-json3-dev libcli11-dev zlib1g-dev libassimp-dev
libepoxy-dev libstb-dev libegl-dev libegl1 libegl-mesa0 libgl1-mesa-dri fonts-dejavu-core
libglfw3-dev libimgui-dev
ffmpeg
libgtest-dev xvfb
"

# Prints those of the given packages that are not installed, one a line.
supple_missing_packages() {
    for package in "$@"; do
        status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) || status=absent
        [ "$status" = installed ] || echo "$package"
    done
}

# Installs what is missing, or says the exact command and returns 3 where there is no permission.
supple_install_packages() {
    if ! command -v dpkg-query >/dev/null 2>&1; then
        echo "supple: this is not a Debian system, so no package is installed. Needed, by their Debian names: $SUPPLE_PACKAGES" >&2
        return 0
    fi
    # shellcheck disable=SC2086  # a list of words
    missing=$(supple_missing_packages $SUPPLE_PACKAGES | tr '\n' ' ')
    missing=${missing% }
    [ -n "$missing" ] || return 0
    echo "supple: packages to install: $missing"
    if [ "$(id -u)" -eq 0 ]; then
        as_root='env'
    elif command -v sudo >/dev/null 2>&1 && { sudo -n true 2>/dev/null || [ -t 0 ]; }; then
        as_root='sudo env'
    else
        echo "supple: no permission to install packages. Ask an administrator to run:" >&2
        echo "    apt-get update && apt-get install --no-install-recommends -y $missing" >&2
        return 3
    fi
    # shellcheck disable=SC2086
    $as_root DEBIAN_FRONTEND=noninteractive apt-get -q update &&
        $as_root DEBIAN_FRONTEND=noninteractive apt-get -q install --no-install-recommends -y $missing
}
