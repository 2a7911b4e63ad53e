#include "output_files.h"

#include <unistd.h>

#include "supple/base/error.h"

namespace supple::demos {

void require_writable(const std::filesystem::path& file) {
    if (file.empty()) return;
    std::error_code ignored;
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    // A plain file is replaced by a new one of its folder; a device or a pipe is written itself.
    const bool is_special = std::filesystem::exists(file, ignored) && !std::filesystem::is_regular_file(file, ignored);
    const std::filesystem::path target = is_special ? file : folder;
    if (std::filesystem::is_directory(file, ignored) || access(target.c_str(), W_OK) != 0)
        throw Error(ErrorCode::file_unreadable, file.string(), "cannot be written; check that its folder exists, and the permissions");
}

}  // namespace supple::demos
