#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace supple::io {

/// What a mesh file is, found from its first bytes and, where these say nothing, from its ending.
struct MeshFormat {
    enum class Kind {
        gmsh,
        medit,
        vtk_legacy,
        vtk_xml,
        surface,  ///< known, holds surfaces only
        volume,   ///< known, may hold volumes, is not read
        unknown,
    };
    Kind kind = Kind::unknown;
    std::string name;    ///< "Wavefront OBJ"
    std::string advice;  ///< what to do, where it is not read
};

MeshFormat detect_mesh_format(std::string_view bytes, const std::filesystem::path& file);

}  // namespace supple::io
