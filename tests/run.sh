#!/bin/sh
# Installs what is missing, builds everything and runs every test. Runs from any directory; arguments go to ctest (-R name, -LE slow).
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
. "$root/cmake/packages.sh"
supple_install_packages
# Some comparisons need other programs. Where they cannot be had the tests say "skipped", and all the others run.
SUPPLE_PACKAGES=calculix-ccx supple_install_packages || echo "supple: without calculix-ccx the comparison with CalculiX is skipped" >&2
SUPPLE_PACKAGES=python3-meshio supple_install_packages || echo "supple: without python3-meshio no other reader is asked about our mesh files" >&2
SUPPLE_PACKAGES=python3-vtk9 supple_install_packages || echo "supple: without python3-vtk9 the reader of ParaView is not asked about our mesh files" >&2

cd "$root"
cmake --preset release
cmake --build --preset release
ctest --preset release --no-tests=error --output-on-failure --parallel 2 "$@"
