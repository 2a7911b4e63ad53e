#pragma once
// The surface formats, one .cpp each; mesh_formats.cpp lists them for everybody else.
#include <string>
#include <string_view>

#include "supple/io/mesh_source.h"
#include "supple/mesh/triangle_mesh.h"

namespace supple::io {

/// Wavefront OBJ: v, f (with texture and normal numbers, negative numbers, continued lines); curves and free-form surfaces are refused.
/// Format: "Object Files (.obj)", Wavefront Technologies, appendix B1.
mesh::TriangleMesh parse_obj(std::string_view text, const std::string& name);
std::string format_obj(const mesh::TriangleMesh& mesh);

/// STL, ASCII and binary (3D Systems, "StereoLithography Interface Specification", 1988). Corners at equal positions are one vertex.
mesh::TriangleMesh parse_stl(std::string_view bytes, const std::string& name);
std::string format_stl_ascii(const mesh::TriangleMesh& mesh);
std::string format_stl_binary(const mesh::TriangleMesh& mesh);  ///< coordinates in float32
/// Whether the size fits the triangle count at byte 80, which is the only signature that the binary form has.
bool is_binary_stl(std::string_view bytes);

/// PLY 1.0, ASCII and binary of both byte orders, faces and triangle strips, any scalar types (G. Turk, "The PLY Polygon File Format",
/// 1994).
mesh::TriangleMesh parse_ply(std::string_view bytes, const std::string& name);
std::string format_ply_ascii(const mesh::TriangleMesh& mesh);
std::string format_ply_binary(const mesh::TriangleMesh& mesh);  ///< little-endian, coordinates in float64

/// Geomview's OFF, ASCII, with or without colours, normals and texture coordinates (Geomview manual, "OFF Files").
mesh::TriangleMesh parse_off(std::string_view text, const std::string& name);
std::string format_off(const mesh::TriangleMesh& mesh);

/// glTF 2.0, text and binary, through assimp: all triangles of the scene, nodes' transforms applied, equal positions welded.
/// @error Error(unsupported) where the engine was built without assimp
mesh::TriangleMesh parse_gltf(const MeshSource& source);

}  // namespace supple::io
