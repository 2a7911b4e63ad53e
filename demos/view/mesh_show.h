#pragma once
#include <filesystem>
#include <memory>

#include "demo.h"

namespace supple::demos::view {

/// A lone volume mesh as a show: it stands on the lowest twentieth of its height, which is held, in gravity along -y, of corotational matter with 1000 kg/m^3
/// and a Young's modulus of fifty times its own pressure at the foot, so that it gives without collapsing, whatever its size.
/// @error what io::read_mesh and BodyTemplate::build throw
std::unique_ptr<Show> open_mesh(const std::filesystem::path& file, const ShowOptions& options);

}  // namespace supple::demos::view
