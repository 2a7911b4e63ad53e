#!/bin/sh
# Fuzzes the mesh readers: run.sh [SECONDS] [FOLDER]. Needs clang with libFuzzer (Debian: clang, libclang-rt-14-dev). New inputs are kept in
# FOLDER (build/fuzz/corpus); a crash leaves its input in build/fuzz and a status that is not 0.
set -eu
cd "$(dirname "$0")/../.."
seconds=${1:-60}
folder=${2:-build/fuzz/corpus}
clang=$(command -v clang++ || command -v clang++-14 || true)
if [ -z "$clang" ]; then
    echo "fuzzing skipped: clang++ is not here (apt-get install clang libclang-rt-14-dev)" >&2
    exit 0
fi
mkdir -p "$folder" build/fuzz/include
printf 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }\n' >build/fuzz/probe.cpp
if ! "$clang" -fsanitize=fuzzer,address,undefined build/fuzz/probe.cpp -o build/fuzz/probe 2>/dev/null; then
    echo "fuzzing skipped: $clang has no libFuzzer here (apt-get install libclang-rt-14-dev)" >&2
    exit 0
fi
ln -sfn "$(pwd)/engine" build/fuzz/include/supple
sources="engine/base/error.cpp engine/mesh/volume_mesh.cpp engine/mesh/topology.cpp engine/mesh/surface.cpp
    engine/mesh/skin.cpp engine/mesh/embedding.cpp engine/mesh/triangle_tree.cpp engine/mesh/box_tree.cpp engine/mesh/surface_check.cpp"
for name in $(ls engine/io/*.cpp); do
    case $name in
        */json_node.cpp | */material_keys.cpp | */matrix_market.cpp | */probe_table.cpp | */report.cpp | */scene*.cpp | */result_*.cpp | */text_files.cpp | */mesh_units.cpp) ;;
        *) sources="$sources $name" ;;
    esac
done
flags="-std=c++20 -g1 -O1 -fno-omit-frame-pointer -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all"
flags="$flags -Ibuild/fuzz/include -isystem /usr/include/eigen3 -Itests/fuzz"
# Most of the time goes into headers: parsed once.
printf '%s\n' '#include <Eigen/Geometry>' '#include <algorithm>' '#include <charconv>' '#include <filesystem>' '#include <map>' '#include <string>' \
    '#include <unordered_map>' '#include <vector>' >build/fuzz/all.h
# shellcheck disable=SC2086
"$clang" $flags -x c++-header build/fuzz/all.h -o build/fuzz/all.pch
objects=
for source in tests/fuzz/fuzz_meshes.cpp tests/fuzz/one_input.cpp $sources; do
    object=build/fuzz/$(basename "$source" .cpp).o
    # shellcheck disable=SC2086
    "$clang" $flags -include-pch build/fuzz/all.pch -c "$source" -o "$object"
    objects="$objects $object"
done
# shellcheck disable=SC2086
"$clang" $flags $objects -lz -o build/fuzz/fuzz_meshes
cd build/fuzz
case $folder in /*) ;; *) folder=../../$folder ;; esac
# No input of 8 kB deserves 256 MB at once, or five seconds.
exec ./fuzz_meshes -max_total_time="$seconds" -max_len=8192 -rss_limit_mb=1024 -malloc_limit_mb=256 -timeout=5 -print_final_stats=1 \
    -dict=../../tests/fuzz/meshes.dict "$folder" ../../tests/fuzz/corpus
