#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace supple::io {

/// The whole file in memory: snapshots.
/// @error Error(file_unreadable) naming the path and the system's reason
std::vector<std::byte> read_binary_file(const std::filesystem::path& file);

/// The whole file as text, bytes as they are.
std::string read_text_file(const std::filesystem::path& file);

/// Writes all or nothing: into a new file next to `file`, which is then renamed over it; a reader never sees half a file, and an existing
/// one survives a full disk. Devices and pipes (/dev/stdout) are written directly.
/// @error Error(file_unreadable) naming the path and the system's reason
void write_binary_file(const std::filesystem::path& file, std::span<const std::byte> bytes);
void write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace supple::io
