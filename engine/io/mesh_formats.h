#pragma once
#include <filesystem>
#include <span>
#include <string_view>

#include "supple/io/mesh_source.h"
#include "supple/mesh/triangle_mesh.h"

namespace supple::io {

class MeshBuilder;

/// A kind of file that may be read, or that is known by name in order to be refused well.
struct InputFormat {
    std::string_view key;                                   ///< "gmsh"
    std::string_view title;                                 ///< "a Gmsh file"
    std::string_view endings;                               ///< ".node .ele"
    bool is_surface;                                        ///< holds no volume elements ever
    void (*read)(const MeshSource&, MeshBuilder&);          ///< volumes and surfaces; or
    mesh::TriangleMesh (*read_surface)(const MeshSource&);  ///< surfaces only; or
    std::string_view advice;                                ///< neither: what to do
};

/// A kind of file that can be written, the first of its ending being what the ending alone means.
struct OutputFormat {
    std::string_view key;      ///< "gmsh41-binary"
    std::string_view endings;  ///< ".msh"
    std::string_view title;    ///< "Gmsh 4.1, binary"
    std::string_view loses;    ///< what of a volume mesh does not fit into it; empty where everything does
    void (*write)(const std::filesystem::path&, const VolumeMesh&);
    void (*write_surface)(const std::filesystem::path&, const mesh::TriangleMesh&);
};

/// THE table of formats; a new one is its .cpp and a row here (mesh_formats.cpp).
std::span<const InputFormat> input_formats();
std::span<const OutputFormat> output_formats();

/// Found from the first bytes and, where these say nothing, from the ending; null if unknown.
const InputFormat* detect_format(std::string_view bytes, const std::filesystem::path& file);

/// @param key  of output_formats(); empty: by the file's ending
/// @error Error(unsupported) naming what can be written; also where the format holds no volumes (surfaces) and one is to be written
const OutputFormat& choose_volume_format(const std::filesystem::path& file, std::string_view key);
const OutputFormat& choose_surface_format(const std::filesystem::path& file, std::string_view key);

}  // namespace supple::io
