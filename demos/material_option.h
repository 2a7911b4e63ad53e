#pragma once
#include <string>

#include "supple/material/material.h"

namespace supple::demos {

/// A --material option: JSON as in a scene file, with its keys, defaults and messages; one young_pa and poisson for all elements.
Material parse_material(const std::string& text);

}  // namespace supple::demos
