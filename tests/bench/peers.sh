#!/bin/sh
# Times one implicit step of the same bar in Supple and in Debian's Bullet, in turns, and says how far each is from the converged step.
# Usage: sh tests/bench/peers.sh [cells along x: 16 32 64]      (default: 16 and 32; 64 takes minutes of Bullet's time)
# Needs libbullet-dev (fetched if missing and permitted) and what Supple's own build needs. SUPPLE_BENCH_BUILD names the build folder.
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)
build=${SUPPLE_BENCH_BUILD:-$root/build/release}
. "$root/cmake/packages.sh"
SUPPLE_PACKAGES="$SUPPLE_PACKAGES libbullet-dev"
supple_install_packages
[ -f "$build/CMakeCache.txt" ] || cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release
cmake "$build" >/dev/null  # finds Bullet if it has just come
cmake --build "$build" --target supple_peers
[ $# -gt 0 ] || set -- 16 32
echo "$(date -u +%Y-%m-%d), commit $(git -C "$root" describe --always --dirty 2>/dev/null || echo unknown)"
exec "$build/tests/bench/supple_peers" "$@"
