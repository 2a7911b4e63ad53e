#!/bin/sh
# Installs what is missing, builds, records the main demo to out/ and prints its frame-time table. Runs from any directory.
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
. "$root/cmake/packages.sh"
supple_install_packages

cd "$root"
cmake --preset release
cmake --build --preset release --target supple

mkdir -p out
rm -f out/liver.mp4 out/liver_*.png
build/release/demos/supple record liver --out out/liver.mp4 --stills 6
