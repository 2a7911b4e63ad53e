#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace supple::io {

/// A mesh file in memory.
struct MeshSource {
    std::string_view bytes;
    std::string name;              ///< for messages; its ending decides where the content does not
    std::filesystem::path folder;  ///< where the files that it names are; empty: it came from memory and cannot name others
};

/// The text of another file that a mesh file names (TetGen's second file, *INCLUDE).
/// @param where  "file:line" of the one who names it, for messages
/// @error Error(file_unreadable) at `where`, also for what is no plain file; Error(unsupported) where the mesh came from memory
std::string read_partner(const MeshSource& source, const std::filesystem::path& partner, const std::string& where);

}  // namespace supple::io
