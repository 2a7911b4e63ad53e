#pragma once
// Reference data that lies beside the repository and is not part of it: $SUPPLE_SHARED, or ../shared.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "supple/math/types.h"

namespace supple::test {

inline std::filesystem::path shared_directory() {
    if (const char* given = std::getenv("SUPPLE_SHARED")) return given;
    return std::filesystem::path(SUPPLE_SOURCE_DIR) / ".." / "shared";
}

/// True when the file is missing; says so where nobody can overlook it.
inline bool skipped_for_want_of(const std::filesystem::path& file) {
    if (std::filesystem::exists(file)) return false;
    std::printf("skipped: no %s (set SUPPLE_SHARED); this test compared nothing with the reference\n", file.string().c_str());
    return true;
}

/// Three numbers a line.
inline std::vector<Vec3> read_vectors(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::vector<Vec3> vectors;
    for (Vec3 v; in >> v[0] >> v[1] >> v[2];) vectors.push_back(v);
    return vectors;
}

}  // namespace supple::test
