#pragma once
#include <string>

#include "supple/mesh/surface_check.h"

namespace supple::demos {

/// What `supple mesh info` says of a volume mesh; repairs it as a body would. As lines of text, or as JSON.
std::string describe(VolumeMesh mesh, const std::string& file, bool as_json);
/// The same of a surface.
std::string describe(const mesh::TriangleMesh& surface, const std::string& file, bool as_json);

}  // namespace supple::demos
