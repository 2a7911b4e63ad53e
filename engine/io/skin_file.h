#pragma once
#include <filesystem>
#include <string>

#include "supple/mesh/skin.h"

namespace supple::io {

/// A skin with its weights, for hosts that move it on a graphics processor. Little-endian bytes behind a head of text lines:
///
///   supple_skin 1
///   vertices <N>  triangles <T>  corners <C>  mesh_vertices <M>      (a line each; C is 4 or 8)
///   end_head
///   float32 [N][3]  rest position [m]         float32 [N][3]  unit rest normal (mean of the triangles' by area)
///   int32   [T][3]  triangles, vertices of the skin
///   int32   [N]     element of the mesh (tets, then hexes)
///   int32   [N][C]  vertices of the mesh      float32 [N][C]  their weights, which sum to one
///   float32 [N][C][3]  derivatives of the weights by rest position [1/m]
///
/// With x_c the positions of the mesh's vertices: position = sum_c w_c x_c, F = sum_c x_c g_c^T, normal = cof(F) n, made a unit.
/// The offset of each array follows from the numbers in the head.
std::string format_skin(const Skin& skin);

/// @error Error(file_unreadable) where the file cannot be written
void write_skin(const std::filesystem::path& file, const Skin& skin);

/// The surface of a .skin file; its weights are made anew by Skin::build(), for whatever mesh. Other endings: as read_surface().
/// @error Error(parse) naming what does not fit
mesh::TriangleMesh read_skin_surface(const std::filesystem::path& file);

}  // namespace supple::io
