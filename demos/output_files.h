#pragma once
#include <filesystem>

namespace supple::demos {

/// Refuses an output file that cannot be written before the long computation, not after it. An empty name is fine: no file is wanted.
/// @error Error(file_unreadable)
void require_writable(const std::filesystem::path& file);

}  // namespace supple::demos
