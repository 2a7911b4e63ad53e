#pragma once
#include <CLI/CLI.hpp>
#include <filesystem>

#include "supple/mesh/triangle_mesh.h"
#include "supple/mesh/volume_mesh.h"

namespace supple::demos {

// Subcommands of `supple mesh`, one per file.
void add_mesh_cook_command(CLI::App& mesh, int& status);
void add_mesh_skin_command(CLI::App& mesh, int& status);
void add_mesh_refine_command(CLI::App& mesh, int& status);

/// Embeds a surface, says how it fits, and writes it: with its weights where the file ends in .skin, else the surface alone.
void write_skin_or_surface(const std::filesystem::path& file, const VolumeMesh& mesh, const mesh::TriangleMesh& surface);

}  // namespace supple::demos
