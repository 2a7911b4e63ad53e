// libFuzzer target over every mesh reader; the format is found from the bytes, so one target reaches them all. Only supple::Error may escape.
//
//   clang++ -std=c++20 -g -O1 -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all -I<build>/include -I/usr/include/eigen3 \
//       tests/fuzz/fuzz_gmsh.cpp engine/io/{binary_file,gmsh*,medit,mesh_builder,mesh_file,mesh_format,text_scanner,vtk*}.cpp engine/base/error.cpp -o fuzz_gmsh
//   ./fuzz_gmsh -max_len=4096 corpus/
#include <cstdint>
#include <cstdlib>

#include "supple/base/error.h"
#include "supple/io/mesh_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const supple::VolumeMesh mesh = supple::io::parse_mesh({reinterpret_cast<const char*>(data), size}, "fuzz.msh");
        if (mesh.element_count() == 0) std::abort();
        for (const supple::Tet& tet : mesh.tets) {
            for (std::int32_t v : tet) {
                if (v < 0 || std::size_t(v) >= mesh.vertices.size()) std::abort();
            }
        }
        if (mesh.element_region.size() != (mesh.regions.empty() ? 0 : mesh.element_count())) std::abort();
    } catch (const supple::Error&) {
    }
    return 0;
}
