#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "supple/math/types.h"

namespace supple::io {

/// Reads one vector per line, "x y z": positions [m], velocities [m/s], forces [N], in the order of the mesh. Empty lines and lines that
/// begin with # are skipped.
/// @param expected  number of vectors, usually that of the vertices; any number where it is empty
/// @error Error(parse) at "file:line", also for a wrong count; Error(file_unreadable)
std::vector<Vec3> read_vectors(const std::filesystem::path& file, std::optional<std::size_t> expected = {});
std::vector<Vec3> parse_vectors(std::string_view text, const std::string& name, std::optional<std::size_t> expected = {});

/// Writes one vector per line with 17 digits: read_vectors() gives the same bits back.
void write_vectors(const std::filesystem::path& file, std::span<const Vec3> vectors);

/// Writes one line per vertex or element: von Mises stress, then the Cauchy tensor xx yy zz xy yz zx (tensor shears), 17 digits [Pa].
void write_stress(const std::filesystem::path& file, std::span<const Voigt> cauchy_pa);

/// Reads the six components back; the von Mises number is not kept.
std::vector<Voigt> read_stress(const std::filesystem::path& file, std::optional<std::size_t> expected = {});
std::vector<Voigt> parse_stress(std::string_view text, const std::string& name, std::optional<std::size_t> expected = {});

}  // namespace supple::io
