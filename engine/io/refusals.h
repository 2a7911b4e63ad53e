#pragma once
#include <string>

#include "supple/base/error.h"

namespace supple::io {

/// The one wording for "this is a surface where a volume mesh is needed".
/// @param holds  what was found, e.g. "6966 triangles" or "a Wavefront OBJ file"
Error surface_error(const std::string& where, const std::string& holds);

}  // namespace supple::io
